//! A few control faces and all that their surface depends on, as a mesh of its own.

use crate::mesh::SubdivMesh;
use std::collections::{HashMap, HashSet};

/// Who is beside whom in a control mesh, and how its ptex faces are counted.
#[derive(Debug)]
pub(super) struct Neighbours<'a> {
    pub mesh: &'a SubdivMesh,
    /// First vertex of each face in `mesh.face_vertices`, and the end.
    offsets: Vec<usize>,
    /// Faces at each vertex.
    faces_at: Vec<Vec<u32>>,
    /// First ptex face of each control face, and the number of all.
    first_ptex: Vec<u32>,
}

impl<'a> Neighbours<'a> {
    pub fn of(mesh: &'a SubdivMesh) -> Self {
        let (mut offsets, mut first_ptex) = (vec![0], vec![0]);
        let mut faces_at = vec![Vec::new(); mesh.points.len()];
        for (face, vertices) in mesh.faces() {
            vertices.iter().for_each(|&vertex| faces_at[vertex as usize].push(face as u32));
            offsets.push(offsets[face] + vertices.len());
            first_ptex.push(first_ptex[face] + if vertices.len() == 4 { 1 } else { vertices.len() as u32 });
        }
        Self { mesh, offsets, faces_at, first_ptex }
    }

    fn vertices(&self, face: u32) -> &'a [u32] {
        let face = face as usize;
        &self.mesh.face_vertices[self.offsets[face]..self.offsets[face + 1]]
    }

    /// The control face of a ptex face.
    pub fn control_face(&self, ptex: u32) -> u32 {
        self.first_ptex.partition_point(|&first| first <= ptex) as u32 - 1
    }

    /// Ptex faces of a control face.
    fn ptex(&self, face: u32) -> std::ops::Range<u32> {
        self.first_ptex[face as usize]..self.first_ptex[face as usize + 1]
    }
}

/// Control faces with two rings of faces round them. The rings are holes: they have no patches of their own, so whoever refines adaptively
/// spends nothing on them but what the faces inside need.
#[derive(Debug)]
pub(super) struct Excerpt {
    pub mesh: SubdivMesh,
    /// For each ptex face of the whole that is in it: its ptex face in `mesh`, and whether it is a part of a face that is no quad.
    ptex: HashMap<u32, (u32, bool)>,
}

impl Excerpt {
    pub fn new(of: &Neighbours<'_>, faces: &[u32]) -> Self {
        let mut taken: HashSet<u32> = faces.iter().copied().collect();
        let mut all: Vec<u32> = taken.iter().copied().collect();
        let mut inner = 0;
        for _ring in 0..2 {
            let outer = all.len();
            for i in inner..outer {
                for &vertex in of.vertices(all[i]) {
                    all.extend(of.faces_at[vertex as usize].iter().filter(|&&face| taken.insert(face)));
                }
            }
            inner = outer;
        }
        all.sort_unstable();
        Self::with(of, faces, &all)
    }

    /// `faces` of `all`, which ascend; the others are holes.
    fn with(of: &Neighbours<'_>, faces: &[u32], all: &[u32]) -> Self {
        let core: HashSet<u32> = faces.iter().copied().collect();
        let holes: HashSet<u32> = of.mesh.holes.iter().copied().collect();
        let mut own: HashMap<u32, u32> = HashMap::new();
        let mut edges: HashSet<[u32; 2]> = HashSet::new();
        let mut mesh = SubdivMesh {
            name: of.mesh.name.clone(),
            scheme: of.mesh.scheme,
            boundary: of.mesh.boundary,
            creasing: of.mesh.creasing,
            ..SubdivMesh::default()
        };
        let (mut ptex, mut next_ptex) = (HashMap::new(), 0);
        for (&face, index) in all.iter().zip(0..) {
            let vertices = of.vertices(face);
            mesh.face_sizes.push(vertices.len() as u32);
            for (&a, &b) in vertices.iter().zip(vertices.iter().cycle().skip(1)) {
                let vertex = *own.entry(a).or_insert_with(|| {
                    mesh.points.push(of.mesh.points[a as usize]);
                    mesh.points.len() as u32 - 1
                });
                mesh.face_vertices.push(vertex);
                edges.insert([a.min(b), a.max(b)]);
            }
            if holes.contains(&face) || !core.contains(&face) {
                mesh.holes.push(index);
            }
            for whole in of.ptex(face) {
                ptex.insert(whole, (next_ptex, vertices.len() != 4));
                next_ptex += 1;
            }
        }
        for crease in &of.mesh.creases {
            let [a, b] = crease.vertices;
            if edges.contains(&[a.min(b), a.max(b)]) {
                mesh.creases.push(crate::mesh::Crease { vertices: [own[&a], own[&b]], ..*crease });
            }
        }
        for corner in &of.mesh.corners {
            if let Some(&vertex) = own.get(&corner.vertex) {
                mesh.corners.push(crate::mesh::Corner { vertex, ..*corner });
            }
        }
        Self { mesh, ptex }
    }

    /// The ptex face here of one of the whole mesh.
    pub fn ptex(&self, whole: u32) -> Option<u32> {
        Some(self.ptex.get(&whole)?.0)
    }

    /// Whether a ptex face of the whole mesh is a part of a control face that is no quad.
    pub fn is_part(&self, whole: u32) -> Option<bool> {
        Some(self.ptex.get(&whole)?.1)
    }
}
