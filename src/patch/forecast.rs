//! What refining a mesh will take, before it is refined.

use super::refine::RINGS_STAND_ALONE;
use crate::mesh::{Boundary, Scheme, SubdivMesh};
use crate::osd::INFINITE_SHARPNESS;

/// Bytes that a refined face takes while its piece is at work: OpenSubdiv's topology, our copy and the walk over it. (Measured on
/// meshes of triangles, quads and creases: 380 to 620.)
const FACE: u64 = 640;

/// Faces of all levels that refinement to `isolation` gives, at most about: each vertex that is refined at a level brings the
/// children of its faces and some round them, and no level has more faces than uniform refinement.
pub(super) fn refined_faces(mesh: &SubdivMesh, isolation: u32) -> u64 {
    let count = mesh.points.len();
    let (mut faces_at, mut in_polygon) = (vec![0u32; count], vec![false; count]);
    // What comes after a vertex in its faces, less what comes before, and all of it without signs: 0 where each neighbour comes in
    // pairs, once each way.
    let (mut turns, mut pairs) = (vec![0u64; count], vec![0u64; count]);
    let scattered = |vertex: u32| (u64::from(vertex) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let sides = if mesh.scheme == Scheme::Loop { 3 } else { 4 };
    for (_, face) in mesh.faces() {
        for (&vertex, &next) in face.iter().zip(face.iter().cycle().skip(1)) {
            faces_at[vertex as usize] += 1;
            in_polygon[vertex as usize] |= face.len() != sides;
            for (at, other, turn) in [(vertex, next, 1), (next, vertex, u64::MAX)] {
                turns[at as usize] = turns[at as usize].wrapping_add(scattered(other).wrapping_mul(turn));
                pairs[at as usize] ^= scattered(other);
            }
        }
    }
    // Finite sharpness at each vertex: the number of edges, the least and the greatest.
    let mut creases: Vec<(u8, f32, f32)> = vec![(0, f32::INFINITY, 0.0); count];
    let finite = |sharpness: f32| sharpness > 0.0 && sharpness < INFINITE_SHARPNESS;
    // Infinitely sharp edges at each vertex, and whether it is itself: two pass for the regular crease that they mostly are.
    let mut infinite = vec![0u8; count];
    for crease in &mesh.creases {
        for vertex in crease.vertices.into_iter().filter(|_| crease.sharpness >= INFINITE_SHARPNESS) {
            infinite[vertex as usize] = infinite[vertex as usize].saturating_add(1);
        }
        for vertex in crease.vertices.into_iter().filter(|_| finite(crease.sharpness)) {
            let (edges, least, greatest) = &mut creases[vertex as usize];
            *edges = edges.saturating_add(1);
            (*least, *greatest) = (least.min(crease.sharpness), greatest.max(crease.sharpness));
        }
    }
    for corner in &mesh.corners {
        if !finite(corner.sharpness) {
            infinite[corner.vertex as usize] += u8::from(corner.sharpness > 0.0);
            continue;
        }
        let (edges, least, greatest) = &mut creases[corner.vertex as usize];
        (*edges, *least, *greatest) = (u8::MAX, 0.0, greatest.max(corner.sharpness));
    }
    let (inner, border) = if mesh.scheme == Scheme::Loop { (6, 3) } else { (4, 2) };
    let has_corners = mesh.boundary == Boundary::EdgeAndCorner;
    let depth = |vertex: usize| {
        let (edges, least, greatest) = creases[vertex];
        // Along a crease of one sharpness nothing is refined.
        let is_single = edges == 2 && least == greatest && faces_at[vertex] == 4 && mesh.scheme != Scheme::Loop;
        let sharp = if edges == 0 || is_single { 0 } else { greatest.ceil() as u32 };
        let is_crease = matches!(infinite[vertex], 0 | 2);
        let is_even = match (turns[vertex] == 0, pairs[vertex] == 0) {
            (true, true) => faces_at[vertex] == inner,
            (false, false) => faces_at[vertex] == border || has_corners && faces_at[vertex] == 1,
            _ => false, // not manifold
        };
        let is_regular = is_even && !in_polygon[vertex] && is_crease;
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

#[cfg(test)]
mod tests {
    use super::super::refine::isolation;
    use super::*;
    use crate::osd::Refiner;
    use std::path::Path;

    /// On every mesh of ours that is not tiny, 0.9 to 3 times the faces that OpenSubdiv makes. (Faces that meet at a vertex alone pass
    /// for a boundary: `bow_tie`.)
    #[test]
    fn forecasts_hold() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
        let files = std::fs::read_dir(folder).expect("tests/meshes is there");
        let meshes = files.filter_map(|file| crate::mesh::read(&file.expect("an entry").path()).ok());
        let (mut compared, mut failed) = (0, 0);
        for mesh in meshes.chain([crate::mesh::sample()]).filter(|mesh| !mesh.scheme.is_linear()) {
            let isolation = isolation(&mesh);
            let single = mesh.scheme != Scheme::Loop;
            let refiner = Refiner::adaptive(&mesh, isolation, RINGS_STAND_ALONE, single).expect("the mesh is valid");
            let faces = |level: usize| refiner.level(level).expect("it is there").face_count();
            let made: usize = (0..refiner.level_count()).map(faces).sum();
            let ratio = refined_faces(&mesh, isolation) as f64 / made as f64;
            println!("{}: {made} faces, forecast {ratio:.2} of them", mesh.name);
            failed += usize::from(!(0.9..3.0).contains(&ratio) && made > 60);
            compared += 1;
        }
        assert!(compared > 30 && failed == 0, "{failed} of {compared} meshes");
    }
}
