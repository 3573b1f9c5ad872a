//! Subdivision schemes other than Catmull and Clark's: Loop's, bilinear, none.

#[path = "../common/mod.rs"]
mod common;
mod flat;
mod pixels;
mod properties;
#[path = "../common/random_mesh.rs"]
mod random_mesh;
mod reference;
mod refusals;

use catoptric::mesh::{self, Scheme, SubdivMesh};
use std::path::Path;

/// The meshes of `tests/meshes/schemes`.
fn meshes() -> Vec<SubdivMesh> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/schemes");
    let entries = std::fs::read_dir(folder).expect("the test meshes are there");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
    paths.sort();
    assert!(paths.len() >= 58, "test meshes are missing");
    paths.iter().map(|path| mesh::read(path).expect("a test mesh is valid")).collect()
}

/// Those of Loop's scheme.
fn loop_meshes() -> Vec<SubdivMesh> {
    meshes().into_iter().filter(|mesh| mesh.scheme == Scheme::Loop).collect()
}

/// A mesh of the folder by its name.
fn named(name: &str) -> SubdivMesh {
    meshes().into_iter().find(|mesh| mesh.name == name).expect("a test mesh")
}

/// A mesh of any polygons as one of Loop's scheme: every face is a fan from its first vertex, with its features.
fn triangulated(mesh: &SubdivMesh) -> SubdivMesh {
    let mut faces = Vec::new();
    let mut holes = Vec::new();
    for (index, face) in mesh.faces() {
        let first = faces.len() as u32;
        faces.extend((2..face.len()).map(|k| [face[0], face[k - 1], face[k]]));
        if mesh.holes.contains(&(index as u32)) {
            holes.extend(first..faces.len() as u32);
        }
    }
    SubdivMesh {
        face_sizes: vec![3; faces.len()],
        face_vertices: faces.into_flattened(),
        holes,
        scheme: Scheme::Loop,
        ..mesh.clone()
    }
}
