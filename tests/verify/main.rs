//! The regression against OpenSubdiv: that it passes, that it can fail, and what it tells whom.

mod answers;
mod baseline;
mod command;
#[path = "../common/mod.rs"]
mod common;
mod conformance;
mod corpus;
mod crash;
mod html;
mod inputs;
mod only;
mod planted;
mod programs;

use catoptric::gpu::Gpu;
use catoptric::mesh::{self, SubdivMesh};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn gpu() -> Gpu {
    Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one")
}

/// File of one of the project's own meshes.
fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj")
}

fn own(name: &str) -> SubdivMesh {
    mesh::read(&file(name)).expect("a test mesh is valid")
}

/// Runs `catoptric verify` in a folder, with a view small enough for tests.
fn run(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_catoptric"))
        .args(["verify", "--size", "48x48"])
        .args(words)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).expect("it was written")).expect("JSON")
}

/// A folder with copies of some of the project's own meshes.
fn folder(names: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for name in names {
        let to = folder.path().join(name).with_extension("obj");
        std::fs::create_dir_all(to.parent().expect("a folder")).expect("it is made");
        let stem = Path::new(name).file_name().and_then(|stem| stem.to_str()).expect("a name");
        std::fs::copy(file(stem), to).expect("it is copied");
    }
    folder
}
