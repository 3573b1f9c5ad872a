//! Files, folders and patterns.

use super::{file, folder, json, run, text};
use std::fs;

/// Names of the meshes of a report, in its order.
fn names(report: &serde_json::Value) -> Vec<String> {
    let meshes = report["meshes"].as_array().expect("a list");
    meshes.iter().map(|mesh| mesh["path"].as_str().unwrap_or("sample").to_owned()).collect()
}

#[test]
fn folders_and_patterns_are_sorted_and_no_mesh_comes_twice() {
    let folder = folder(&["b/cube", "b/a/dart", "hole", "pole_5"]);
    fs::write(folder.path().join("b/notes.txt"), "no mesh").expect("it is written");
    let words = ["pole_5.obj", "b", "*.obj", "b/*.obj", "--json", "v.json"];
    let outputs = [(); 2].map(|()| {
        let output = run(folder.path(), &words);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report = fs::read(folder.path().join("v.json")).expect("it was written");
        (text(&output.stdout), report)
    });
    assert_eq!(names(&json(&folder.path().join("v.json"))), ["pole_5.obj", "b/a/dart.obj", "b/cube.obj", "hole.obj"]);
    assert!(outputs[0].1 == outputs[1].1, "the report does not depend on who is first");
    // A line each, and the verdict.
    let lines: Vec<_> = outputs[0].0.lines().collect();
    assert_eq!(lines.len(), 5, "{lines:?}");
    assert!(lines[..4].iter().all(|line| line.starts_with("pass  ")), "{lines:?}");
    let version = catoptric::osd::version();
    let verdict = format!("pass: 4 meshes against OpenSubdiv {version}: 4 passed (");
    assert!(lines[4].starts_with(&verdict), "{lines:?}");
    let verbose = text(&run(folder.path(), &["b", "-v"]).stdout);
    assert!(verbose.matches("limit stencils level 10").count() >= 4, "{verbose}");
}

#[test]
fn what_is_refused_in_a_folder_stops_nothing_and_fails_unless_allowed() {
    let folder = folder(&["m/cube", "m/pole_5"]);
    fs::write(folder.path().join("m/bad.obj"), "v 0 0 0\nf 1 2 3\n").expect("it is written");
    // Every face is a hole: read, but nothing to check.
    let cube = fs::read_to_string(file("cube")).expect("it is there");
    fs::write(folder.path().join("m/holes.obj"), cube + "t hole 6/0/0 0 1 2 3 4 5\n").expect("it is written");
    let output = run(folder.path(), &["m", "--json", "v.json", "--junit", "v.xml"]);
    assert_eq!(output.status.code(), Some(1));
    let stdout = text(&output.stdout);
    assert!(stdout.contains("refused  m/bad.obj:2: ") && stdout.contains("refused  m/holes.obj: no face"), "{stdout}");
    let version = catoptric::osd::version();
    let verdict = format!("FAIL: 4 meshes against OpenSubdiv {version}: 2 passed, 2 refused");
    assert!(stdout.contains(&verdict), "{stdout}");
    let report = json(&folder.path().join("v.json"));
    assert_eq!(names(&report), ["m/cube.obj", "m/pole_5.obj"]);
    assert_eq!(report["refused"][0]["path"], "m/bad.obj");
    assert_eq!((&report["pass"], &report["meshes"][0]["pass"]), (&false.into(), &true.into()));
    let junit = fs::read_to_string(folder.path().join("v.xml")).expect("it was written");
    assert!(junit.contains("errors=\"2\"") && junit.contains("<error message=\"m/bad.obj:2: "), "{junit}");

    let output = run(folder.path(), &["m", "--allow-refused", "--json", "v.json", "--junit", "v.xml"]);
    assert!(output.status.success(), "{}", text(&output.stdout));
    assert_eq!(json(&folder.path().join("v.json"))["refused_allowed"], true);
    let junit = fs::read_to_string(folder.path().join("v.xml")).expect("it was written");
    assert!(junit.contains("errors=\"0\"") && junit.contains("<skipped message=\"m/bad.obj:2: "), "{junit}");
}

#[test]
fn what_is_named_and_refused_ends_the_run_before_it_begins() {
    let folder = folder(&["cube"]);
    fs::write(folder.path().join("bad.obj"), "v 0 0 0\nf 1 2 3\n").expect("it is written");
    fs::write(folder.path().join("bad.txt"), "no mesh").expect("it is written");
    fs::create_dir(folder.path().join("empty")).expect("it is made");
    for (words, message) in [
        (["cube.obj", "bad.obj"], "bad.obj:2: "),
        (["cube.obj", "none.obj"], "none.obj: no such file"),
        (["cube.obj", "none/"], "none/: no such folder; check the path"),
        (["cube.obj", "none"], "none: no such file or folder; check the path"),
        (["cube.obj", "none/*.obj"], "none/*.obj: the folder none does not exist; check the path"),
        (["cube.obj", "cube.obj/*.obj"], "cube.obj/*.obj: cube.obj is a file, not a folder; check the path"),
        (["cube.obj", "ba*.txt"], "ba*.txt: 1 file matches, but none is a mesh (.obj,"),
        (["cube.obj", "empty"], "empty: the folder has no mesh (.obj, .usd, .usda, .usdc, .usdz)"),
        (["cube.obj", "*.usd"], "*.usd: no mesh matches (.obj, .usd, .usda, .usdc, .usdz)"),
        (["cube.obj", "[.obj"], "[.obj: "),
    ] {
        let output = run(folder.path(), &[&words[..], &["--json", "v.json", "--junit", "v.xml"]].concat());
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.lines().count() == 1 && stderr.contains(message), "{stderr}");
        assert!(
            output.stdout.is_empty() && !folder.path().join("v.json").exists() && !folder.path().join("v.xml").exists()
        );
    }
}
