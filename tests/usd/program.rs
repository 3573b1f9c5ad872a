//! The program takes USD wherever it takes an OBJ.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::{HEADER, SQUARE, converted, prim};

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

#[test]
fn eval_info_and_verify_read_usd() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let usda = folder.path().join("mesh.usda");
    fs::write(&usda, HEADER.to_owned() + &prim("m", SQUARE)).expect("a file");
    converted(&usda);
    fs::write(folder.path().join("samples.csv"), "face,u,v\n0,0,0\n0,0.5,0.25\n").expect("a file");
    let mut answers = Vec::new();
    for name in ["mesh.usda", "mesh.usdc", "mesh.usdz"] {
        let evaluated = run(folder.path(), &["eval", name, "--samples", "samples.csv"]);
        assert!(evaluated.status.success(), "{}", String::from_utf8_lossy(&evaluated.stderr));
        answers.push(String::from_utf8_lossy(&evaluated.stdout).into_owned());
        let told = run(folder.path(), &["info", name, "--json"]);
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    }
    assert!(answers.iter().all(|answer| *answer == answers[0] && answer.lines().count() == 3), "{answers:?}");
}

#[test]
fn what_is_refused_ends_with_two() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = prim("m", &format!("{SQUARE}uniform token subdivisionScheme = \"doo\""));
    fs::write(folder.path().join("mesh.usda"), HEADER.to_owned() + &text).expect("a file");
    let told = run(folder.path(), &["info", "mesh.usda"]);
    let message = String::from_utf8_lossy(&told.stderr);
    assert_eq!(told.status.code(), Some(2));
    let expected = "subdivisionScheme 'doo' is none of USD's; use catmullClark, loop, bilinear or none";
    assert_eq!(message, format!("catoptric: mesh.usda: /m: {expected}\n"));
}

/// Where the stage has Y up, views do; a flag counts before that.
#[test]
fn views_stand_as_the_stage_does() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (axis, expected) in [("Y", "up = [0.0, 1.0, 0.0]"), ("Z", "up = [0.0, 0.0, 1.0]")] {
        let text = format!("{HEADER}(\n    upAxis = \"{axis}\"\n)\n{}", prim("m", SQUARE));
        fs::write(folder.path().join("mesh.usda"), text).expect("a file");
        for (flags, expected) in [(&[][..], expected), (&["--up", "1,0,0"][..], "up = [1.0, 0.0, 0.0]")] {
            let mut args = vec!["lines", "mesh.usda", "-o", "lines.json", "--save-rig", "rig.toml"];
            args.extend(flags);
            let told = run(folder.path(), &args);
            assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
            let rig = fs::read_to_string(folder.path().join("rig.toml")).expect("a rig");
            assert!(rig.contains(expected), "{rig}");
        }
    }
}
