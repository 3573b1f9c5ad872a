//! What several tests need.

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
    assert!(paths.len() >= 20, "test meshes are missing");
    let mut meshes: Vec<_> = paths.iter().map(|path| mesh::read(path).expect("a test mesh is valid")).collect();
    meshes.push(mesh::sample());
    meshes
}

/// Angle in degrees, exact for small ones.
pub fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}
