//! Refinement in pieces: as many control faces at a time as fit a cache of reasonable size, with the faces round them.
//!
//! What a face becomes depends on the faces at its corners, and whether it meets a neighbour that is split on those at the
//! neighbour's. So a piece is a range of control faces and two rings of faces round it: refined alone, its faces
//! become what they are in the whole mesh. Memory for topology is that of a few pieces, whatever the size of the mesh,
//! and pieces are refined in parallel.

use crate::mesh::{Corner, Crease, Scheme, SubdivMesh};
use crate::osd::Level;
use std::borrow::Cow;
use std::ops::Range;

/// Control faces of a piece: enough that its rings are few beside them (8 % of a square of quads).
pub(super) const PIECE: usize = 32_768;

/// Most faces in all pieces together, as a multiple of those of the mesh: where faces that lie side by side are far apart in
/// the mesh's order, pieces are mostly rings, and the mesh is better refined whole.
const MOST_REPEATED: f64 = 2.0;

/// A range of control faces, and what they depend on, as a mesh of its own.
#[derive(Debug)]
pub(super) struct Piece<'a> {
    /// Faces and vertices keep their order.
    pub mesh: Cow<'a, SubdivMesh>,
    /// The control mesh's vertex that each vertex of `mesh` is; `None` if `mesh` is the control mesh.
    pub vertices: Option<Vec<u32>>,
    /// The faces that patches are wanted of, in `mesh`.
    pub core: Range<usize>,
    /// Control face of the first of them.
    pub first_face: usize,
    /// Its first ptex face.
    pub first_ptex: u32,
}

impl<'a> Piece<'a> {
    /// All of a mesh.
    pub fn whole(mesh: &'a SubdivMesh) -> Self {
        let core = 0..mesh.face_sizes.len();
        Self { mesh: Cow::Borrowed(mesh), vertices: None, core, first_face: 0, first_ptex: 0 }
    }

    /// The faces of the ring that share an edge with one of the piece's own.
    pub fn beside(&self, control: &Level) -> Vec<usize> {
        let is_beside = |face: &usize| {
            let edges = control.edges_of_face(*face).map(|[.., edge]| control.edge_faces[edge]);
            edges.flatten().filter_map(|face| usize::try_from(face).ok()).any(|face| self.core.contains(&face))
        };
        let ring = (0..control.face_count()).filter(|face| !self.core.contains(face));
        ring.filter(is_beside).collect()
    }
}

/// How a valid mesh is divided.
#[derive(Debug)]
pub(super) struct Division<'a> {
    mesh: &'a SubdivMesh,
    /// First vertex of each face in `mesh.face_vertices`.
    offsets: Vec<u32>,
    /// First ptex face of each face.
    ptex: Vec<u32>,
    /// All faces of each piece, ascending, and where its own ones are among them.
    pieces: Vec<(Vec<u32>, Range<usize>)>,
    creases: ByVertex<(u32, f32)>,
    corners: ByVertex<f32>,
    holes: Vec<bool>,
}

impl<'a> Division<'a> {
    /// Divides a mesh that has passed validation; `None` if it is to be refined whole.
    pub fn new(mesh: &'a SubdivMesh) -> Option<Self> {
        match mesh.face_sizes.len().div_ceil(PIECE) {
            ..2 => None,
            parts => Self::into_parts(mesh, parts, MOST_REPEATED),
        }
    }

    /// Divides into `parts`, unless they have more than `most` times the faces of the mesh.
    pub(super) fn into_parts(mesh: &'a SubdivMesh, parts: usize, most: f64) -> Option<Self> {
        let count = mesh.face_sizes.len();
        let running = |sizes: &mut dyn Iterator<Item = u32>| -> Vec<u32> {
            let sums = sizes.scan(0, |sum, size| Some(std::mem::replace(sum, *sum + size)));
            sums.collect()
        };
        let total = mesh.face_vertices.len() as u32;
        let offsets = running(&mut mesh.face_sizes.iter().copied().chain([total]));
        let whole = if mesh.scheme == Scheme::Loop { 3 } else { 4 };
        let ptex = running(&mut mesh.face_sizes.iter().map(|&size| if size == whole { 1 } else { size }));
        let faces_at = ByVertex::new(mesh.points.len(), || {
            mesh.faces().flat_map(|(face, vertices)| vertices.iter().map(move |&v| (v, face as u32)))
        });
        let mut out = Self {
            mesh,
            offsets,
            ptex,
            pieces: Vec::with_capacity(parts),
            creases: ByVertex::new(mesh.points.len(), || {
                mesh.creases.iter().map(|&Crease { vertices: [a, b], sharpness }| (a.min(b), (a.max(b), sharpness)))
            }),
            corners: ByVertex::new(mesh.points.len(), || mesh.corners.iter().map(|c| (c.vertex, c.sharpness))),
            holes: vec![false; count],
        };
        mesh.holes.iter().for_each(|&face| out.holes[face as usize] = true);
        let mut seen = vec![false; count];
        let mut repeated = 0;
        for part in 0..parts {
            let [start, end] = [part, part + 1].map(|i| count * i / parts);
            let mut faces: Vec<u32> = (start as u32..end as u32).collect();
            let mut inner = 0;
            for _ring in 0..2 {
                faces[inner..].iter().for_each(|&face| seen[face as usize] = true);
                let outer = faces.len();
                for i in inner..outer {
                    for &vertex in out.face(faces[i]) {
                        for &face in faces_at.at(vertex) {
                            if !std::mem::replace(&mut seen[face as usize], true) {
                                faces.push(face);
                            }
                        }
                    }
                }
                inner = outer;
            }
            faces.iter().for_each(|&face| seen[face as usize] = false);
            faces.sort_unstable();
            let first = faces.partition_point(|&face| (face as usize) < start);
            repeated += faces.len();
            if repeated as f64 > most * count as f64 {
                return None;
            }
            out.pieces.push((faces, first..first + end - start));
        }
        Some(out)
    }

    /// Number of pieces.
    pub fn count(&self) -> usize {
        self.pieces.len()
    }

    fn face(&self, face: u32) -> &'a [u32] {
        let face = face as usize;
        &self.mesh.face_vertices[self.offsets[face] as usize..self.offsets[face + 1] as usize]
    }

    /// A piece, as a mesh of its own. `local` is room for a number a vertex of the control mesh, zero before and after.
    pub fn piece(&self, index: usize, local: &mut Vec<u32>) -> Piece<'a> {
        let (faces, core) = &self.pieces[index];
        local.resize(self.mesh.points.len(), 0);
        let mut vertices: Vec<u32> = Vec::with_capacity(faces.len());
        for &vertex in faces.iter().flat_map(|&face| self.face(face)) {
            if std::mem::replace(&mut local[vertex as usize], 1) == 0 {
                vertices.push(vertex);
            }
        }
        vertices.sort_unstable();
        vertices.iter().zip(0..).for_each(|(&vertex, own)| local[vertex as usize] = own);
        let mut mesh = SubdivMesh {
            name: self.mesh.name.clone(),
            points: vertices.iter().map(|&vertex| self.mesh.points[vertex as usize]).collect(),
            scheme: self.mesh.scheme,
            boundary: self.mesh.boundary,
            creasing: self.mesh.creasing,
            triangles: self.mesh.triangles,
            ..SubdivMesh::default()
        };
        for (&face, own) in faces.iter().zip(0..) {
            let corners = self.face(face);
            mesh.face_sizes.push(corners.len() as u32);
            mesh.face_vertices.extend(corners.iter().map(|&vertex| local[vertex as usize]));
            if self.holes[face as usize] {
                mesh.holes.push(own);
            }
            // An edge of two faces is found twice, which does no harm: it is sharpened to the same value.
            for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                let (low, high) = (a.min(b), a.max(b));
                // The last one counts.
                if let Some(&(_, sharpness)) = self.creases.at(low).iter().rfind(|&&(end, _)| end == high) {
                    mesh.creases.push(Crease { vertices: [low, high].map(|v| local[v as usize]), sharpness });
                }
            }
        }
        for (&vertex, own) in vertices.iter().zip(0..) {
            if let Some(&sharpness) = self.corners.at(vertex).last() {
                mesh.corners.push(Corner { vertex: own, sharpness });
            }
            local[vertex as usize] = 0;
        }
        let first_face = faces[core.start] as usize;
        Piece {
            mesh: Cow::Owned(mesh),
            vertices: Some(vertices),
            core: core.clone(),
            first_face,
            first_ptex: self.ptex[first_face],
        }
    }
}

/// Lists by vertex.
#[derive(Debug)]
struct ByVertex<T> {
    offsets: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> ByVertex<T> {
    /// Lists what `items` gives for each vertex, in its order. It is run twice.
    fn new<I: Iterator<Item = (u32, T)>>(vertices: usize, items: impl Fn() -> I) -> Self {
        // Counted one place late, so that filling moves every start to where the next list begins.
        let mut offsets = vec![0; vertices + 2];
        items().for_each(|(vertex, _)| offsets[vertex as usize + 2] += 1);
        for i in 2..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut listed = vec![T::default(); offsets[vertices + 1] as usize];
        for (vertex, item) in items() {
            let next = &mut offsets[vertex as usize + 1];
            listed[*next as usize] = item;
            *next += 1;
        }
        Self { offsets, items: listed }
    }

    fn at(&self, vertex: u32) -> &[T] {
        let vertex = vertex as usize;
        &self.items[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
    }
}
