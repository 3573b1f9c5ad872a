//! Subdivision schemes other than Catmull and Clark's: Loop's, bilinear, none.

#[path = "../common/mod.rs"]
mod common;
mod flat;
mod properties;
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

/// OpenSubdiv's own shapes for Loop's scheme, whose files say so in their name; none where they are not beside the project.
fn loop_corpus() -> Vec<SubdivMesh> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes/opensubdiv");
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("loop_")));
    paths.sort();
    let read = |path: &std::path::PathBuf| mesh::read(path).ok();
    paths.iter().filter_map(read).map(|mesh| SubdivMesh { scheme: Scheme::Loop, ..mesh }).collect()
}
