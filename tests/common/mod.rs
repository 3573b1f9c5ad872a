//! What several tests need.
#![allow(dead_code, reason = "each test program uses its part")]

use catoptric::mesh::{self, SubdivMesh};
use glam::DVec3;
use std::path::Path;

/// The project's own meshes and the sample.
pub fn meshes() -> Vec<SubdivMesh> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .expect("the test meshes are there")
        .map(|entry| entry.expect("a readable entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "obj"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 60, "test meshes are missing");
    let mut meshes: Vec<_> = paths.iter().map(|path| mesh::read(path).expect("a test mesh is valid")).collect();
    meshes.push(mesh::sample());
    meshes
}

/// Angle in degrees, exact for small ones.
pub fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// A face and its mirror image: closed, four vertices of valence 2. Its surface folds along the edges: every control edge
/// is a line without a tangent plane, so it is none of [`meshes`].
pub fn pillow() -> SubdivMesh {
    SubdivMesh {
        name: "pillow".into(),
        points: vec![
            DVec3::new(0.05, 0.04, 0.08),
            DVec3::new(2.05, 0.06, 0.26),
            DVec3::new(2.04, 1.93, -0.05),
            DVec3::new(0.04, 1.94, 0.28),
        ],
        face_sizes: vec![4, 4],
        face_vertices: vec![0, 1, 2, 3, 3, 2, 1, 0],
        ..SubdivMesh::default()
    }
}
