//! USD: what is read is what the schema says, in all three formats, and what is wrong is said in one line.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/rng.rs"]
mod rng;

mod bad_faces;
mod blender;
mod corrupt;
mod differential;
mod fixtures;
mod forms;
mod instances;
mod mixture;
mod prims;
mod program;
mod refused;
mod schema;
mod time;
mod transforms;
mod trials;
mod twins;

use std::fs;
use std::path::Path;

use catoptric::mesh::{self, MeshError, SubdivMesh};

const HEADER: &str = "#usda 1.0\n";

/// A square, as the attributes of a Mesh prim.
const SQUARE: &str = "point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]\n";

/// A square and a triangle at its right edge.
const HOUSE: &str = "point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0.5, 0)]
    int[] faceVertexCounts = [4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 2, 1, 4]\n";

/// The text of a Mesh prim.
fn prim(name: &str, attributes: &str) -> String {
    format!("def Mesh \"{name}\"\n{{\n    {attributes}\n}}\n")
}

/// Reads text as a file `mesh.usda`.
fn read_text(text: &str) -> Result<SubdivMesh, MeshError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.usda");
    fs::write(&path, format!("{HEADER}{text}")).expect("a temporary file");
    mesh::read(&path)
}

fn accepted(text: &str) -> SubdivMesh {
    read_text(text).expect("a mesh that is accepted")
}

/// The message about text that is refused, from the file's own name on.
fn refusal(text: &str) -> String {
    let message = read_text(text).expect_err("a mesh that is refused").to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    let start = message.find("mesh.usda").expect("the name of the file");
    message[start..].to_owned()
}

/// Writes the layer of a usda file as usdc, and as a package.
fn converted(usda: &Path) -> [std::path::PathBuf; 2] {
    let [crate_file, package] = ["usdc", "usdz"].map(|extension| usda.with_extension(extension));
    let layer = openusd::sdf::Layer::open(usda.to_str().expect("UTF-8")).expect("a layer");
    layer.export(crate_file.to_str().expect("UTF-8")).expect("written as usdc");
    let mut archive = openusd::usdz::ArchiveWriter::create(&package).expect("a package");
    archive.add_layer("mesh.usdc", &fs::read(&crate_file).expect("usdc")).expect("a layer in it");
    archive.finish().expect("a whole package");
    [crate_file, package]
}
