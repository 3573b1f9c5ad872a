//! Whatever ends OpenSubdiv ends one row of the report, and nothing else.

use super::{folder, json, run, text};
use std::fmt::Write;

/// A book: `pages` quads at one edge.
fn book(pages: usize) -> String {
    let mut text = String::from("v 0 0 -1\nv 0 0 1\n");
    for page in 0..pages {
        let (sin, cos) = (page as f64 * std::f64::consts::TAU / pages as f64).sin_cos();
        writeln!(text, "v {cos} {sin} -1\nv {cos} {sin} 1\nf 1 {} {} 2", 2 * page + 3, 2 * page + 4)
            .expect("it takes text");
    }
    text
}

#[test]
fn a_reference_that_crashes_is_a_row_and_the_others_go_on() {
    for (plant, rows) in [
        ("crash:masks", &[("vertex", "limit masks")][..]),
        ("crash:stencils", &[("dyadic", "limit stencils level 10"), ("regular", "limit stencils level 10")]),
        ("crash:far", &[("dyadic", "Far level 10"), ("regular", "Far level 10"), ("fragment", "Far level 10")]),
        ("crash:bfr", &[("regular", "Bfr"), ("endcap", "Bfr 2/6")]),
    ] {
        let folder = folder(&["cube", "pole_5"]);
        let words = [".", "--plant", plant, "--json", "v.json", "--junit", "v.xml", "--html", "v.html"];
        let output = run(folder.path(), &words);
        assert_eq!(output.status.code(), Some(1), "{}{}", text(&output.stdout), text(&output.stderr));
        let report = json(&folder.path().join("v.json"));
        let meshes = report["meshes"].as_array().expect("a list");
        assert_eq!(meshes.len(), 2, "{plant}");
        for mesh in meshes {
            let unanswered = mesh["reference_unanswered"].as_array().expect("a list");
            let found: Vec<_> = unanswered
                .iter()
                .map(|row| (row["tier"].as_str().unwrap(), row["reference"].as_str().unwrap()))
                .collect();
            assert!(unanswered.iter().all(|row| row["reason"] == "OpenSubdiv ended with SIGSEGV"), "{unanswered:?}");
            let named = |row: &(&str, &str)| rows.contains(&(row.0, row.1)) || row.1.starts_with("Bfr");
            assert!(!found.is_empty() && found.iter().all(named), "{plant}: {found:?}");
            assert!(rows.iter().all(|row| found.iter().any(|found| found.0 == row.0)), "{plant}: {found:?}");
            // All other rows are there, and right.
            let rows = mesh["tiers"].as_array().expect("a list");
            assert!(rows.len() >= 4 && rows.iter().all(|row| row["pass"] == true), "{plant}: {mesh}");
            assert_eq!(mesh["pass"], false);
        }
        let stdout = text(&output.stdout);
        assert_eq!(stdout.matches("<- FAIL").count(), 2 * rows.len(), "{stdout}");
        assert!(stdout.contains("FAIL: 2 meshes"), "{stdout}");
        for file in ["v.xml", "v.html"] {
            let written = std::fs::read_to_string(folder.path().join(file)).expect("it was written");
            assert!(written.contains("OpenSubdiv ended with SIGSEGV"), "{plant} {file}");
        }
    }
}

#[test]
fn a_point_is_shown_though_a_reference_crashes() {
    let folder = folder(&["cube"]);
    let output = run(folder.path(), &["cube.obj", "--only", "0,0.5,0.5", "--plant", "crash:far"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let shown = text(&output.stdout);
    assert!(shown.contains("OpenSubdiv ended with SIGSEGV") && shown.contains("limit stencils level 10"), "{shown}");
}

/// From 11 faces at an edge on, `PrimvarRefiner::Limit` writes beyond its arrays: it is not asked, and that is said.
#[test]
fn limit_masks_are_not_asked_where_they_write_beyond_their_arrays() {
    for pages in [3, 10, 11, 12, 20, 64] {
        let folder = folder(&[]);
        std::fs::write(folder.path().join("book.obj"), book(pages)).expect("it is written");
        let output = run(folder.path(), &["book.obj", "--json", "v.json", "--junit", "v.xml"]);
        let stdout = text(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{pages}: {stdout}{}", text(&output.stderr));
        let mesh = &json(&folder.path().join("v.json"))["meshes"][0];
        let asked = mesh["tiers"].as_array().expect("a list").iter().any(|row| row["tier"] == "vertex");
        assert_eq!(asked, pages <= 10, "{pages}: {stdout}");
        // Level 2 has three vertices on the edge that all pages share, besides its ends.
        let crowded = if pages <= 10 { 0 } else { 3 };
        assert_eq!(mesh["limit_masks_not_asked"], crowded, "{pages}");
        assert_eq!(stdout.contains("limit masks: not asked"), crowded > 0, "{stdout}");
        let junit = std::fs::read_to_string(folder.path().join("v.xml")).expect("it was written");
        assert_eq!(junit.contains("not asked: more faces meet"), crowded > 0, "{junit}");
    }
}
