//! Comparison with an earlier run.

use super::{folder, json, run, text};
use serde_json::{Value, json as value};
use std::fs;
use std::path::Path;

/// Runs against the baseline as changed, and returns what is worse.
fn regressions(folder: &Path, change: impl FnOnce(&mut Value)) -> Vec<String> {
    let mut old = json(&folder.join("old.json"));
    change(&mut old);
    fs::write(folder.join("changed.json"), old.to_string()).expect("it is written");
    let output = run(folder, &["m", "--baseline", "changed.json", "--json", "new.json", "--junit", "v.xml"]);
    let new = json(&folder.join("new.json"));
    let worse = new["baseline"]["regressions"].as_array().expect("a list");
    let lines: Vec<_> =
        worse.iter().map(|w| format!("{} {} {}", w["mesh"], w["row"], w["what"]).replace('"', "")).collect();
    assert_eq!(output.status.code(), Some(i32::from(!lines.is_empty())), "{}", text(&output.stderr));
    assert_eq!(new["pass"], lines.is_empty());
    assert_eq!(text(&output.stdout).matches("  worse  ").count(), lines.len());
    let junit = fs::read_to_string(folder.join("v.xml")).expect("it was written");
    assert!(junit.contains(&format!("failures=\"{}\"", lines.len())), "{junit}");
    assert_eq!(junit.matches("worse than in the baseline changed.json: ").count(), 2 * lines.len(), "{junit}");
    let count = match lines.len() {
        0 => "nothing is worse".to_owned(),
        1 => "1 thing is worse".to_owned(),
        many => format!("{many} things are worse"),
    };
    let verdict = new["verdict"].as_str().expect("a text");
    assert!(verdict.ends_with(&format!("; {count} than in the baseline changed.json")), "{verdict}");
    assert!(verdict.starts_with(if lines.is_empty() { "pass: " } else { "FAIL: " }), "{verdict}");
    assert!(text(&output.stdout).lines().last().is_some_and(|line| line.starts_with(verdict)), "{verdict}");
    assert!(junit.contains(&format!("name=\"verdict\" value=\"{verdict}\"")), "{junit}");
    lines
}

#[test]
fn what_is_worse_than_before_fails() {
    let folder = folder(&["m/dart", "m/cube"]);
    let folder = folder.path();
    assert!(run(folder, &["m", "--json", "old.json"]).status.success());
    assert!(json(&folder.join("old.json"))["baseline"].is_null());
    assert_eq!(regressions(folder, |_| {}), [""; 0]);
    // Rounding noise is no regression: an error of 1e-16 was 1e-17.
    let row = |old: &mut Value, i: usize, key: &str| old["meshes"][0]["tiers"][i][key].take();
    assert_eq!(
        regressions(folder, |old| {
            row(old, 1, "position_max");
            old["meshes"][0]["tiers"][1]["position_max"] = 1e-17.into();
        }),
        [""; 0]
    );
    // The end caps' own error is not noise, and a row of the picture has its budget.
    let index = |old: &Value, tier: &str| {
        let rows = old["meshes"][0]["tiers"].as_array().expect("rows");
        rows.iter().position(|row| row["tier"] == tier).expect("the tier ran")
    };
    let worse = regressions(folder, |old| {
        let endcap = index(old, "endcap");
        old["meshes"][0]["tiers"][endcap]["position_max"] = 1e-6.into();
        let fragment = index(old, "fragment");
        old["meshes"][0]["tiers"][fragment]["position_max"] = 1e-12.into();
    });
    assert!(
        worse.len() == 1 && worse[0].starts_with("m/cube.obj endcap smooth / Bfr 2/6 position error "),
        "{worse:?}"
    );
    // Fewer samples, judged normals, rows and meshes; more patches that nothing judges.
    let worse = regressions(folder, |old| {
        old["meshes"][0]["tiers"][0]["samples"] = 1_000_000.into();
        old["meshes"][0]["tiers"][0]["histogram"]["normal_deg"]["zero"] = 1_000_000.into();
        let mut extra = old["meshes"][0]["tiers"][1].clone();
        extra["kind"] = "corner".into();
        old["meshes"][0]["tiers"].as_array_mut().expect("rows").push(extra);
        let mut gone = old["meshes"][1].clone();
        gone["mesh"] = "gone".into();
        gone["path"] = "m/gone.obj".into();
        old["meshes"].as_array_mut().expect("meshes").push(gone);
    });
    let expected =
        ["samples, 1000000 then", "judged normals, 1000", "the row was there then", "the mesh was verified then"];
    assert_eq!(worse.len(), 4, "{worse:?}");
    assert!(worse.iter().zip(expected).all(|(line, part)| line.contains(part)), "{worse:?}");
}

#[test]
fn a_planted_error_is_worse_than_before() {
    let folder = folder(&["cube"]);
    assert!(run(folder.path(), &["cube.obj", "--json", "old.json"]).status.success());
    let output = run(folder.path(), &["cube.obj", "--baseline", "old.json", "--plant", "point:5"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("limit stencils level 10: it passed then and fails now"));
    let html = ["cube.obj", "--baseline", "old.json", "--plant", "point:5", "--html", "v.html"];
    assert_eq!(run(folder.path(), &html).status.code(), Some(1));
    let page = fs::read_to_string(folder.path().join("v.html")).expect("it was written");
    assert!(page.contains("than in the baseline old.json"), "the page says so too");
}

#[test]
fn what_is_no_baseline_is_refused_before_anything_runs() {
    let folder = folder(&["cube"]);
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("it is written");
    write("text.json", "no JSON");
    write("other.json", "{\"a\": 1}");
    write("old.json", "{\"version\": \"0.1.0\", \"meshes\": []}");
    let size = value!({"schema": 2, "size": [64, 64], "meshes": []});
    write("size.json", &size.to_string());
    for (name, message) in [
        ("none.json", "cannot be read"),
        ("text.json", "not a report"),
        ("other.json", "not a report"),
        ("old.json", "schema 1, but this version compares schema 2"),
        ("size.json", "made with --size 64x64, this run has 48x48"),
    ] {
        let output = run(folder.path(), &["cube.obj", "--baseline", name, "--json", "v.json"]);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.lines().count() == 1 && stderr.contains(message) && stderr.contains(name), "{stderr}");
        assert!(output.stdout.is_empty() && !folder.path().join("v.json").exists());
    }
}
