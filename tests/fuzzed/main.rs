//! What fuzzing found and what it kept, run again through the functions that it called (docs/FUZZING.md).

#[path = "../../fuzz/targets/mod.rs"]
mod targets;

use std::path::Path;

/// Runs all that is kept for a target; the name of the last file shown is that of the one which failed.
fn run(name: &str, target: fn(&[u8]), least: usize) {
    let mut count = 0;
    for kind in ["found", "corpus"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzzed").join(kind).join(name);
        // Where nothing was found there is no folder.
        let entries = std::fs::read_dir(folder).into_iter().flatten();
        let mut paths: Vec<_> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
        paths.sort();
        for path in paths {
            println!("{}", path.display());
            target(&std::fs::read(&path).expect("a readable file"));
            count += 1;
        }
    }
    assert!(count >= least, "{count} inputs are there, {least} should be");
}

#[test]
fn obj() {
    run("obj", targets::obj, 1);
}

#[test]
fn tags() {
    run("tags", targets::tags, 1);
}

#[test]
fn rig() {
    run("rig", targets::rig, 1);
}

#[test]
fn samples() {
    run("samples", targets::samples, 1);
}

#[test]
fn usd_file() {
    run("usd_file", targets::usd_file, 1);
}

#[test]
fn usd_attributes() {
    run("usd_attributes", targets::usd_attributes, 1);
}

#[test]
fn surface() {
    run("surface", targets::surface, 1);
}
