//! What comes in: the OBJ reader, its tags, and everything that is refused.

mod api;
mod bad_faces;
mod corpus;
mod fixtures;
mod forms;
mod oracle;
mod orientation;
mod packed;
mod passed;
mod random;
mod refused;
mod refused_tags;

use std::fs;
use std::path::{Path, PathBuf};

use catoptric::mesh::{self, Choice, MeshError, SubdivMesh};

/// Four vertices on lines 1 to 4.
const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Reads text as a file `mesh.obj`.
fn read_text(text: impl AsRef<[u8]>) -> Result<SubdivMesh, MeshError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.obj");
    fs::write(&path, text).expect("a temporary file");
    mesh::read(&path)
}

/// Reads text as [`read_text`] does, strictly.
fn read_strictly(text: impl AsRef<[u8]>) -> Result<SubdivMesh, MeshError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.obj");
    fs::write(&path, text).expect("a temporary file");
    mesh::read_choice(&path, &Choice { strict: true, ..Choice::default() })
}

/// The message about text that is refused by strict reading, from the file's own name on.
fn refusal(text: impl AsRef<[u8]>) -> String {
    let error = read_strictly(text).expect_err("a mesh that is refused");
    let message = error.to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    let start = message.find("mesh.obj").expect("the name of the file");
    message[start..].to_owned()
}

fn accepted(text: &str) -> SubdivMesh {
    read_text(text).expect("a mesh that is accepted")
}

fn manifest_path(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// All OBJ files of a folder, by name; none if there is no such folder.
fn obj_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        println!("skipped: no folder {}", folder.display());
        return Vec::new();
    };
    let mut files: Vec<_> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|e| e == "obj"))
        .collect();
    files.sort();
    files
}
