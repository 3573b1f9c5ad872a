//! What fuzzing found and what it kept, run again through the functions that it called (docs/FUZZING.md).

#[path = "../../fuzz/targets/mod.rs"]
mod targets;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::path::Path;

/// Runs all that is kept for a target; the name of the last input shown is that of the one which failed.
fn run(name: &str, target: fn(&[u8]), least: usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzzed");
    // Where nothing was found there is no folder.
    for entry in std::fs::read_dir(folder.join("found").join(name)).into_iter().flatten() {
        let path = entry.expect("a readable entry").path();
        println!("{}", path.display());
        target(&std::fs::read(&path).expect("a readable file"));
    }
    let corpus = folder.join("corpus").join(name).with_extension("txt");
    let corpus = std::fs::read_to_string(corpus).expect("the corpus is there");
    for (number, line) in (1..).zip(corpus.lines()) {
        println!("corpus/{name}.txt, line {number}");
        target(&STANDARD.decode(line).expect("base64"));
    }
    let count = corpus.lines().count();
    assert!(count >= least, "{count} inputs are there, {least} should be");
}

#[test]
fn obj() {
    run("obj", targets::obj, 300);
}

#[test]
fn tags() {
    run("tags", targets::tags, 100);
}

#[test]
fn rig() {
    run("rig", targets::rig, 500);
}

#[test]
fn samples() {
    run("samples", targets::samples, 80);
}

#[test]
fn usd_file() {
    run("usd_file", targets::usd_file, 800);
}

#[test]
fn usd_attributes() {
    run("usd_attributes", targets::usd_attributes, 200);
}

#[test]
fn surface() {
    run("surface", targets::surface, 100);
}
