//! What `info`, `verify` and `render` say and write.

use super::{Folder, mesh};
use std::path::PathBuf;

#[test]
fn info_counts_features_and_patches() {
    let folder = Folder::new();
    let output = folder.run(["info".as_ref(), mesh("pole_5").as_os_str(), "--json".as_ref()]);
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(info["patches"]["smooth"], 5);
    assert_eq!(info["interior_valences"]["5"], 1);
    let text = folder.run(["info".as_ref(), mesh("pole_5").as_os_str()]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("smooth: 5"));
    let levels = info["opensubdiv"].as_array().expect("a list of levels");
    assert_eq!(levels.len(), 10);
    for pair in levels.windows(2) {
        assert!(pair[1]["patches"].as_u64() > pair[0]["patches"].as_u64());
        assert!(pair[1]["bytes"].as_u64() > pair[0]["bytes"].as_u64());
        let position = |level: &serde_json::Value| level["gregory"]["position"]["max"].as_f64().expect("a number");
        assert!(position(&pair[1]) < position(&pair[0]) && position(&pair[1]) > 0.0);
    }
    // A pole of valence 5 inside: five end caps at every level, on an area that shrinks by four.
    assert!(levels.iter().all(|level| level["end_caps"] == 5));
    let area = |i: usize| levels[i]["gregory"]["area"].as_f64().expect("a number");
    assert!((area(3) * 4.0 - area(2)).abs() < 1e-12);
    let by_level = levels[9]["patches_by_level"].as_object().expect("a map").values();
    assert_eq!(
        by_level.map(|count| count.as_u64().expect("a count")).sum::<u64>(),
        levels[9]["patches"].as_u64().unwrap()
    );
    assert!(String::from_utf8_lossy(&text.stdout).contains("OpenSubdiv's feature-adaptive patches"));
    let text = folder.run(["info".as_ref(), mesh("pole_5").as_os_str(), "--levels".as_ref(), "0".as_ref()]);
    assert!(!String::from_utf8_lossy(&text.stdout).contains("OpenSubdiv"));
}

#[test]
fn verify_passes_and_says_so_everywhere() {
    let folder = Folder::new();
    let meshes = [mesh("cube"), mesh("dart")];
    let flags = ["verify", "--json", "v.json", "--size", "64x64"].map(PathBuf::from);
    let output = folder.run(flags.iter().chain(&meshes));
    let text = std::fs::read(folder.path("v.json")).expect("the report is written");
    let report: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    assert_eq!(report["pass"], true, "{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stdout).contains("pass: 2 meshes against"));
    let row = &report["meshes"][0]["tiers"][0];
    assert_eq!((&row["failed"], &row["normals_skipped"]), (&0.into(), &0.into()));
    let one = folder.run(["verify".as_ref(), mesh("cube").as_os_str(), "--size".as_ref(), "32x32".as_ref()]);
    assert!(String::from_utf8_lossy(&one.stdout).contains("pass: 1 mesh against"));
    let tiers = |mesh: usize| -> std::collections::BTreeSet<String> {
        let rows = report["meshes"][mesh]["tiers"].as_array().expect("rows");
        rows.iter().map(|row| row["tier"].as_str().expect("a name").to_owned()).collect()
    };
    let expected = ["dyadic", "endcap", "fragment", "regular", "vertex"].map(String::from);
    assert_eq!(tiers(0), expected.iter().cloned().collect());
    // Where OpenSubdiv is wrong, the report names it.
    assert!(!report["meshes"][1]["reference_known_wrong"].as_array().expect("a list").is_empty());
}

#[test]
fn pictures_have_their_size_and_repeat_bit_by_bit() {
    let folder = Folder::new();
    let render = |name: &str, pipeline: &str| {
        let mesh = mesh("corner");
        let args = ["render", mesh.to_str().expect("UTF-8"), "-o", name, "--size", "96x64", "--pipeline", pipeline];
        let output = folder.run(args);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(folder.path(name)).expect("the picture is written")
    };
    for pipeline in ["limit", "polygon", "points"] {
        let first = render("a.png", pipeline);
        assert_eq!(first, render("b.png", pipeline));
        let picture = image::load_from_memory(&first).expect("a PNG");
        assert_eq!((picture.width(), picture.height()), (96, 64));
    }
}

/// The certificates on standard error and in JSON, and as colours.
#[test]
fn certificates_are_told() {
    let folder = Folder::new();
    let output = folder.run(["render", "-o", "a.png", "--size", "64x48", "--json", "a.json", "--show", "residual"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{message}");
    let written = "0 not converged\nwrote a.png, 64x48 pixels\nwrote a.json\n";
    assert!(message.starts_with("exact: ") && message.ends_with(written), "{message}");
    let json = std::fs::read(folder.path("a.json")).expect("it was written");
    let json: serde_json::Value = serde_json::from_slice(&json).expect("it is JSON");
    let certificate = &json["certificate"];
    assert_eq!(certificate["samples"], 64 * 48);
    assert_eq!(certificate["unconverged"], 0);
    let residual = certificate["residual_max_pixels"].as_f64().expect("a number");
    assert!(residual > 0.0 && residual < 1e-3, "{residual}");
    assert_eq!(image::open(folder.path("a.png")).expect("a picture").to_rgb8().dimensions(), (64, 48));
}

/// Every file that is written is named, and those of a series in one line.
#[test]
fn written_files_are_named() {
    let folder = Folder::new();
    let said = |args: &str| {
        let output = folder.run(args.split_whitespace());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{args}: {message}");
        // Bars are for terminals.
        assert!(!message.contains(['\r', '\u{1b}']), "{message:?}");
        message.lines().filter(|line| line.starts_with("wrote")).map(str::to_owned).collect::<Vec<_>>()
    };
    folder.file("samples.csv", "face,u,v\n0,0.5,0.5\n");
    assert_eq!(said("render --size 32x24 --save-rig rig.toml"), ["wrote view.png, 32x24 pixels", "wrote rig.toml"]);
    assert_eq!(said("eval --samples samples.csv -o out.csv"), ["wrote out.csv"]);
    assert_eq!(said("verify --samples-out standard.csv --samples 1").len(), 1);
    let lines = said("lines -o lines.svg --count 2 --size 32x24");
    assert!(
        lines.len() == 1 && lines[0].starts_with("wrote lines.svg, ") && lines[0].ends_with(" curves"),
        "{lines:?}"
    );
    let series = "render --size 32x24 --frames 3 --orbit 90";
    assert_eq!(said(series), ["wrote view_0001.png to view_0003.png, 3 pictures of 32x24 pixels"]);
    let again = format!("{series} --resume");
    assert_eq!(said(&again), ["wrote no picture: all 3 were there already"]);
    std::fs::remove_file(folder.path("view_0002.png")).expect("it is there");
    assert_eq!(said(&again), ["wrote view_0002.png, 32x24 pixels; 2 were there already"]);
}
