//! Which line of the control mesh a patch's edge lies on, and which vertex its corner is.

use super::joint::on_edge;
use crate::mesh::SubdivMesh;
use crate::patch::Patch;
use std::collections::HashMap;

/// A line along which patches join.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Line {
    /// An edge of the control mesh, the lower vertex first.
    Edge([u32; 2]),
    /// Between quadrants of an n-gon: from the middle of the edge at this corner to the centre.
    Spoke {
        /// Control face.
        face: u32,
        /// Corner at which the edge begins.
        corner: u32,
    },
    /// A line u = const or v = const inside a ptex face.
    Inside {
        /// Ptex face.
        ptex: u32,
    },
}

/// A point of the control mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Spot {
    /// A control vertex.
    Vertex(u32),
    /// The centre of an n-gon.
    Centre(u32),
    /// The middle of an edge, the lower vertex first: of edges that are not manifold.
    Middle([u32; 2]),
    /// A point inside a ptex face.
    Inside(u32),
}

/// The control mesh as its ptex faces see it.
pub(super) struct Control<'a> {
    pub mesh: &'a SubdivMesh,
    /// First corner of each face.
    offsets: Vec<u32>,
    /// Control face of each ptex face, and which quadrant of it.
    ptex: Vec<[u32; 2]>,
    /// By vertices, the lower one first.
    sharpness: HashMap<[u32; 2], f32>,
}

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Control<'_> {
    pub fn new(mesh: &SubdivMesh) -> Control<'_> {
        let mut offset = 0;
        let mut control = Control {
            mesh,
            offsets: Vec::new(),
            ptex: Vec::new(),
            sharpness: HashMap::with_capacity(mesh.creases.len()),
        };
        for (face, &size) in mesh.face_sizes.iter().enumerate() {
            control.offsets.push(offset);
            offset += size;
            let quadrants = if size == 4 { 1 } else { size };
            control.ptex.extend((0..quadrants).map(|k| [face as u32, k]));
        }
        // The last one counts.
        control.sharpness.extend(mesh.creases.iter().map(|crease| (ordered(crease.vertices), crease.sharpness)));
        control
    }

    /// Vertices of a face.
    pub fn corners(&self, face: u32) -> &[u32] {
        let [face, size] = [face as usize, self.mesh.face_sizes[face as usize] as usize];
        let first = self.offsets[face] as usize;
        &self.mesh.face_vertices[first..first + size]
    }

    /// The edge of a face from its corner `k` on.
    pub fn edge(&self, face: u32, k: u32) -> [u32; 2] {
        let corners = self.corners(face);
        ordered([0, 1].map(|step| corners[(k as usize + step) % corners.len()]))
    }

    /// Control face of a patch.
    pub fn face(&self, patch: &Patch) -> u32 {
        self.ptex[patch.ptex as usize][0]
    }

    /// The line that a patch's local edge lies on.
    pub fn line(&self, patch: &Patch, edge: u8) -> Line {
        // Edge e of the cell, counted from v = 0 counter-clockwise.
        let cell_edge = (edge + patch.rotation) % 4;
        let across = usize::from(cell_edge.is_multiple_of(2));
        let far = matches!(cell_edge, 1 | 2);
        let place = u32::from(patch.origin[across]) + u32::from(far);
        if place != 0 && place != 1 << patch.depth[across] {
            return Line::Inside { ptex: patch.ptex };
        }
        let [face, quadrant] = self.ptex[patch.ptex as usize];
        let size = self.mesh.face_sizes[face as usize];
        let before = (quadrant + size - 1) % size;
        match cell_edge {
            _ if size == 4 => Line::Edge(self.edge(face, u32::from(cell_edge))),
            0 => Line::Edge(self.edge(face, quadrant)),
            1 => Line::Spoke { face, corner: quadrant },
            2 => Line::Spoke { face, corner: before },
            _ => Line::Edge(self.edge(face, before)),
        }
    }

    /// The control edge that a patch's local edge lies on, the lower vertex first, and which part of it the point `t` of the local edge
    /// is at, counted from that vertex. Only for an edge whose [`line`](Self::line) is an edge.
    pub fn along(&self, patch: &Patch, edge: u8, t: f64) -> ([u32; 2], f64) {
        let cell_edge = u32::from((edge + patch.rotation) % 4);
        let [u, v] = patch.to_ptex(on_edge(edge, t));
        // Counter-clockwise round the ptex face.
        let part = [u, v, 1.0 - u, 1.0 - v][cell_edge as usize];
        let [face, quadrant] = self.ptex[patch.ptex as usize];
        let size = self.mesh.face_sizes[face as usize];
        let (corner, part) = match cell_edge {
            _ if size == 4 => (cell_edge, part),
            // The first half of the edge at the quadrant's corner, or the second half of the one before.
            0 => (quadrant, 0.5 * part),
            _ => ((quadrant + size - 1) % size, 0.5 + 0.5 * part),
        };
        let corners = self.corners(face);
        let is_upwards = corners[corner as usize] < corners[(corner as usize + 1) % corners.len()];
        (self.edge(face, corner), if is_upwards { part } else { 1.0 - part })
    }

    /// A number for each control face: the same for faces that hang together by vertices, over faces that are no holes.
    pub fn components(&self) -> Vec<u32> {
        fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
            while parent[vertex as usize] != vertex {
                parent[vertex as usize] = parent[parent[vertex as usize] as usize];
                vertex = parent[vertex as usize];
            }
            vertex
        }
        let mut is_hole = vec![false; self.mesh.face_count()];
        self.mesh.holes.iter().for_each(|&hole| is_hole[hole as usize] = true);
        let mut parent: Vec<u32> = (0..self.mesh.points.len() as u32).collect();
        for (_, face) in self.mesh.faces().filter(|(face, _)| !is_hole[*face]) {
            let first = root(&mut parent, face[0]);
            for &vertex in &face[1..] {
                let other = root(&mut parent, vertex);
                parent[other as usize] = first;
            }
        }
        self.mesh.faces().map(|(_, face)| root(&mut parent, face[0])).collect()
    }

    /// The point at a patch's local (0,0).
    pub fn spot(&self, patch: &Patch) -> Spot {
        let [u, v] = patch.to_ptex([0.0; 2]);
        let [face, quadrant] = self.ptex[patch.ptex as usize];
        let size = self.mesh.face_sizes[face as usize];
        let corner = match [u, v] {
            [0.0, 0.0] => 0,
            [1.0, 0.0] => 1,
            [1.0, 1.0] => 2,
            [0.0, 1.0] => 3,
            _ => return Spot::Inside(patch.ptex),
        };
        match corner {
            _ if size == 4 => Spot::Vertex(self.corners(face)[corner]),
            0 => Spot::Vertex(self.corners(face)[quadrant as usize]),
            1 => Spot::Middle(self.edge(face, quadrant)),
            2 => Spot::Centre(face),
            _ => Spot::Middle(self.edge(face, (quadrant + size - 1) % size)),
        }
    }

    /// Sharpness of an edge, 0 where it has none.
    pub fn sharpness(&self, edge: [u32; 2]) -> f32 {
        self.sharpness.get(&edge).copied().unwrap_or(0.0)
    }
}
