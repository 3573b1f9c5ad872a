//! The forms of the report: text, JSON by its schema, JUnit.

use super::{folder, json, run, text};
use std::fs;

/// Errors of a report by docs/verify-report.schema.json.
pub fn schema_errors(report: &serde_json::Value) -> Vec<String> {
    let schema: serde_json::Value =
        serde_json::from_str(include_str!("../../docs/verify-report.schema.json")).expect("the schema is JSON");
    let validator = jsonschema::validator_for(&schema).expect("the schema is one");
    validator.iter_errors(report).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

#[test]
fn reports_are_what_the_schema_says() {
    let folder = folder(&["m/dart", "m/boundary_none_crease", "m/valence_2_interior"]);
    fs::write(folder.path().join("m/bad.obj"), "f").expect("it is written");
    for (words, code) in [
        (vec!["m", "--allow-refused", "--timings"], 0),
        (vec!["m/dart.obj", "--baseline", "v.json"], 1), // the other meshes are missing
        (vec!["m/dart.obj", "--plant", "point:1"], 1),
        (vec!["--plant", "crease"], 1),
    ] {
        let output = run(folder.path(), &[&words[..], &["--json", "v.json"]].concat());
        assert_eq!(output.status.code(), Some(code), "{}{}", text(&output.stdout), text(&output.stderr));
        let report = json(&folder.path().join("v.json"));
        assert_eq!(schema_errors(&report), [""; 0]);
        assert_eq!((&report["schema"], &report["pass"]), (&2.into(), &(code == 0).into()));
        for mesh in report["meshes"].as_array().expect("a list") {
            assert_eq!(mesh["timings"].is_array(), words.contains(&"--timings"));
            for row in mesh["tiers"].as_array().expect("a list") {
                let histogram = &row["histogram"]["position"];
                let counts = histogram["counts"].as_array().expect("a list").iter().chain([&histogram["zero"]]);
                let counted: u64 = counts.chain([&histogram["not_finite"]]).filter_map(|count| count.as_u64()).sum();
                assert_eq!(Some(counted), row["samples"].as_u64(), "every sample has its bin: {row}");
            }
        }
    }
    // The schema is no rubber stamp.
    let mut report = json(&folder.path().join("v.json"));
    report["meshes"][0]["tiers"][0]["samples"] = (-1).into();
    report["new"] = 1.into();
    assert_eq!(schema_errors(&report).len(), 2);
}

#[test]
fn junit_says_failed_where_and_skips_what_judges_nothing() {
    let folder = folder(&["m/dart", "m/cube"]);
    let output = run(folder.path(), &["m", "--junit", "v.xml"]);
    assert!(output.status.success(), "{}", text(&output.stdout));
    let junit = || fs::read_to_string(folder.path().join("v.xml")).expect("it was written");
    let passed = junit();
    assert!(passed.contains("failures=\"0\" errors=\"0\"") && passed.matches("<testsuite ").count() == 2, "{passed}");
    assert!(passed.contains("<skipped message=\"reference wrong: end cap at infinitely sharp darts\""), "{passed}");
    assert!(passed.contains("<skipped message=\"the reference&apos;s own error, reported only"), "{passed}");
    // Suites are as deterministic as the meshes.
    run(folder.path(), &["m", "--junit", "v.xml"]);
    assert_eq!(passed, junit());

    let output = run(folder.path(), &["m/cube.obj", "--plant", "point:3", "--junit", "v.xml"]);
    assert_eq!(output.status.code(), Some(1));
    let failed = junit();
    for part in ["<failure message=\"failed: ", "patch 3 (smooth), ptex face 0 (u 0..0.5, v 0.5..1), control face 0"] {
        assert!(failed.contains(part), "{part}: {failed}");
    }
    let command = failed.split("look: ").nth(1).and_then(|rest| rest.split('<').next()).expect("a command");
    assert!(command.starts_with("catoptric verify --plant point:3 m/cube.obj --only 0,"), "{command}");
    // The command runs.
    let words: Vec<&str> = command.split_whitespace().skip(2).collect();
    let shown = run(folder.path(), &words);
    assert!(shown.status.success() && text(&shown.stdout).contains("patch 3 (smooth)"), "{}", text(&shown.stderr));
    assert!(text(&output.stdout).contains(command), "the text names it too");
}

#[test]
fn the_adapter_is_named_in_the_reports() {
    let folder = folder(&["cube"]);
    let output = run(folder.path(), &["cube.obj", "--json", "v.json", "--junit", "v.xml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "wrote v.json\nwrote v.xml\n");
    let report = json(&folder.path().join("v.json"));
    let adapter = super::gpu().adapter().to_owned();
    assert_eq!(report["adapter"], adapter);
    let junit = fs::read_to_string(folder.path().join("v.xml")).expect("it was written");
    for (name, value) in [("adapter", &*adapter), ("opensubdiv", &catoptric::osd::version().to_string())] {
        assert!(junit.contains(&format!("<property name=\"{name}\" value=\"{value}\"/>")), "{junit}");
    }
    // Two reports in one file would be one.
    let both = run(folder.path(), &["cube.obj", "--json", "v.all", "--html", "v.all"]);
    assert!(both.status.code() == Some(2) && text(&both.stderr).contains("--html would overwrite the JSON report"));
}
