//! What refining a mesh will take, before it is refined.

use super::refine::RINGS_STAND_ALONE;
use crate::mesh::{Scheme, SubdivMesh};
use crate::osd::INFINITE_SHARPNESS;

/// Bytes that a refined face takes while its piece is at work: OpenSubdiv's topology, our copy and the walk over it. (Measured on
/// meshes of triangles, quads and creases: 380 to 620.)
const FACE: u64 = 640;

/// Faces of all levels that refinement to `isolation` gives, at most about: each vertex that is refined at a level brings the
/// children of its faces and some round them, and no level has more faces than uniform refinement.
pub(super) fn refined_faces(mesh: &SubdivMesh, isolation: u32) -> u64 {
    let count = mesh.points.len();
    let (mut faces_at, mut in_polygon) = (vec![0u32; count], vec![false; count]);
    let sides = if mesh.scheme == Scheme::Loop { 3 } else { 4 };
    for (_, face) in mesh.faces() {
        for &vertex in face {
            faces_at[vertex as usize] += 1;
            in_polygon[vertex as usize] |= face.len() != sides;
        }
    }
    // Finite sharpness at each vertex: the number of edges, the least and the greatest.
    let mut creases: Vec<(u8, f32, f32)> = vec![(0, f32::INFINITY, 0.0); count];
    let finite = |sharpness: f32| sharpness > 0.0 && sharpness < INFINITE_SHARPNESS;
    for crease in mesh.creases.iter().filter(|crease| finite(crease.sharpness)) {
        for vertex in crease.vertices {
            let (edges, least, greatest) = &mut creases[vertex as usize];
            *edges = edges.saturating_add(1);
            (*least, *greatest) = (least.min(crease.sharpness), greatest.max(crease.sharpness));
        }
    }
    for corner in mesh.corners.iter().filter(|corner| finite(corner.sharpness)) {
        let (edges, least, greatest) = &mut creases[corner.vertex as usize];
        (*edges, *least, *greatest) = (u8::MAX, 0.0, greatest.max(corner.sharpness));
    }
    let regular = if mesh.scheme == Scheme::Loop { [1, 3, 6] } else { [1, 2, 4] };
    let depth = |vertex: usize| {
        let (edges, least, greatest) = creases[vertex];
        // Along a crease of one sharpness nothing is refined.
        let is_single = edges == 2 && least == greatest && faces_at[vertex] == 4 && mesh.scheme != Scheme::Loop;
        let sharp = if edges == 0 || is_single { 0 } else { greatest.ceil() as u32 };
        let is_regular = regular.contains(&faces_at[vertex]) && !in_polygon[vertex];
        sharp.max(if is_regular && edges == 0 { 0 } else { RINGS_STAND_ALONE }).min(isolation)
    };
    // For each level, the faces round vertices that are refined so deep, and along creases how many vertices there are by then.
    let mut rings = [0u64; 16];
    for vertex in (0..count).filter(|&vertex| faces_at[vertex] > 0) {
        (1..=depth(vertex)).for_each(|level| rings[level as usize] += u64::from(faces_at[vertex]));
    }
    let mut uniform = mesh.face_vertices.len() as u64;
    let mut faces = mesh.face_sizes.len() as u64;
    for ring in &rings[1..=isolation as usize] {
        faces = faces.saturating_add(uniform.min(10 * ring));
        uniform = uniform.saturating_mul(4);
    }
    faces
}

/// Bytes at work while a piece is refined.
pub(super) fn working(mesh: &SubdivMesh, isolation: u32) -> u64 {
    refined_faces(mesh, isolation).saturating_mul(FACE)
}
