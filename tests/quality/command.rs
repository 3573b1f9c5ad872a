//! `catoptric quality` as a user meets it.

use catoptric::field::{Method, Scout};
use catoptric::mesh;
use catoptric::quality::{Limits, Line, Quality, Reading, Subject};
use catoptric::stam::LimitSurface;
use glam::DVec3;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn mesh_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj")
}

fn quality(folder: &Path, name: &str, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.arg("quality").arg(mesh_path(name)).args(args).current_dir(folder);
    command.output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Exit code, standard output and the JSON.
fn run(name: &str, args: &[&str]) -> (Option<i32>, String, Value) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = quality(folder.path(), name, &[args, &["--json", "q.json"]].concat());
    assert_eq!(text(&output.stderr), "wrote q.json\n");
    let json = fs::read(folder.path().join("q.json")).expect("it was written");
    (output.status.code(), text(&output.stdout), serde_json::from_slice(&json).expect("JSON"))
}

fn places(json: &Value) -> &[Value] {
    json["places"].as_array().expect("a list")
}

#[test]
fn exit_codes_say_what_the_limits_say() {
    // Smooth but for a crease that turns: sectors of 1 and 3 faces.
    let name = "crease_sectors_1_3";
    let (code, out, json) = run(name, &[]);
    assert_eq!((code, &json["pass"]), (Some(1), &false.into()), "{out}");
    assert!(out.contains("\nFAIL: 3 of 3 over their limits\n"), "{out}");
    let (code, out, json) = run(name, &["--ignore", "creases,vertices"]);
    assert_eq!((code, &json["pass"], &json["judged"]), (Some(0), &true.into(), &0.into()), "{out}");
    assert!(places(&json).iter().all(|place| place["rank"].is_null()) && places(&json).len() == 3);
    assert!(out.contains("\npass: the smooth joints (") && out.ends_with(") are within their limits\n"), "{out}");
    let (code, _, json) = run(name, &["--angle", "180", "--curvature=200"]);
    assert_eq!((code, &json["over"], &json["judged"]), (Some(0), &0.into(), &3.into()));
    // Between the angle of the crease and a hair more: a limit is kept by what is equal to it.
    let angle =
        places(&json).iter().find(|place| place["kind"] == "crease").expect("a crease")["angle_deg"].to_string();
    let only = |angle: &str| run(name, &["--angle", angle, "--curvature=200"]).0;
    assert_eq!(only(&angle), Some(0));
    assert_eq!(only(&format!("{}", angle.parse::<f64>().expect("a number") * (1.0 - 1e-12))), Some(1));
    // No feature at all.
    let (code, out, json) = run("boundary_edge_and_corner", &[]);
    assert_eq!((code, places(&json).len()), (Some(0), 0), "{out}");
    // Finite sharpness is no break.
    let (code, out, json) = run("semi_sharp_crease", &[]);
    assert_eq!((code, places(&json).len()), (Some(0), 1), "{out}");
    assert!(out.contains("sharp 2.3") && out.contains("within"), "{out}");
}

/// Ulmet 2003, figures 6.1 and 6.2: surfaces of revolution that are C1 and C2. The same control points, with a sharp ring and without.
#[test]
fn kinks_are_found_on_the_c1_lathe_and_none_on_the_c2_one() {
    let (code, out, json) = run("lathe_c1", &["--field", "sphere"]);
    let [kink] = places(&json) else { panic!("one crease: {out}") };
    let number = |value: &Value| value.as_f64().expect("a number");
    assert_eq!(
        (code, &kink["kind"], &kink["worst"], &kink["closed"]),
        (Some(1), &"crease".into(), &"curvature".into(), &true.into())
    );
    // Tangent planes agree as well as a spline of 24 points is a circle; one side is straight, so the difference is all there is.
    assert!(number(&kink["angle_deg"]) < 0.02 && kink["curvature_percent"] == 200.0, "{kink}");
    assert!(number(&kink["line"]["turn_deg"]) > 20.0, "{kink}");
    let (code, out, json) = run("lathe_c2", &["--field", "sphere"]);
    assert_eq!((code, places(&json).len()), (Some(0), 0), "{out}");
    let smooth = &json["smooth_joints"];
    assert_eq!((&smooth["curvature_percent"], &smooth["concave"]), (&0.0.into(), &false.into()));
    assert!(number(&smooth["joints"]) == 24.0 * 17.0 && number(&smooth["line"]["turn_deg"]) < 1e-6, "{smooth}");
}

/// JSON is the library's measurement, in its order.
#[test]
fn json_is_what_the_library_measures() {
    for name in ["three_creases", "corner", "ngon_at_crease"] {
        let (_, out, json) = run(name, &["--field", "isophote", "--mm-per-unit", "10", "--gap", "0.5"]);
        let mesh = mesh::read(&mesh_path(name)).expect("a test mesh is valid");
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let scout = Scout::new(&surface).expect("it has faces");
        let camera = scout.camera([1024, 1024], DVec3::Z);
        let field = scout.field(&Method::Isophote, &camera);
        let limits = Limits { gap: 0.05, ..Limits::default() };
        let quality = Quality::measure(&mesh, &surface, Some(Reading { field: &field, camera: &camera }), &limits);
        let ranked = quality.ranked(&limits);
        assert!(ranked.len() > 2 && ranked.len() == places(&json).len());
        let close = |value: &Value, expected: Option<f64>, what: &str| match expected {
            None => assert!(value.is_null(), "{name} {what}: {value}"),
            Some(expected) => {
                // The light of the command is made of what its record says of it: a few roundings.
                let found = value.as_f64().unwrap_or_else(|| panic!("{name} {what}: {value}"));
                assert!((found - expected).abs() <= 1e-9 * expected.abs() + 1e-9, "{name} {what}: {found} {expected}");
            }
        };
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        let mut before = f64::INFINITY;
        for (i, (place, ranked)) in places(&json).iter().zip(&ranked).enumerate() {
            assert_eq!((&place["rank"], &place["kind"]), (&(i + 1).into(), &ranked.kind().name().into()));
            assert_eq!(place["over"], ranked.is_over());
            let severity = ranked.severity();
            assert!(severity <= before, "{out}");
            before = severity;
            close(&place["severity"], finite(severity), "severity");
            for (key, (what, ratio)) in ["gap", "angle", "curvature"].into_iter().zip(ranked.ratios) {
                assert_eq!(key, what.name());
                close(&place["times_limit"][key], finite(ratio), key);
            }
            let percent = |difference: Option<f64>| difference.map(|difference| 100.0 * difference);
            match ranked.subject {
                Subject::Feature(feature) => {
                    close(&place["gap"], Some(10.0 * feature.extremes.gap), "gap");
                    close(&place["angle_deg"], feature.extremes.angle_deg, "angle");
                    close(&place["curvature_percent"], percent(feature.extremes.difference), "curvature");
                    assert_eq!(place["concave"], feature.extremes.concave);
                    let line = feature.extremes.line;
                    close(&place["line"]["jump"], line.map(|line| line.jump), "jump");
                    close(&place["line"]["jump_lines"], line.map(|line| line.lines), "lines");
                    close(&place["line"]["along"], line.and_then(|line| line.along), "along");
                    close(&place["line"]["turn_deg"], line.and_then(|line| line.turn_deg), "turn");
                    close(&place["radius"], feature.radius.and_then(finite).map(|radius| 10.0 * radius), "radius");
                    let chain = feature.chain.as_ref().expect("a chain");
                    let Line::Edge(edge) = feature.line else { panic!("creases are edges") };
                    assert_eq!(place["lies_on"]["edge"], serde_json::json!(edge));
                    assert_eq!(place["vertices"].as_array().map(Vec::len), Some(chain.vertices.len()));
                }
                Subject::Vertex(vertex) => {
                    close(&place["gap"], Some(10.0 * vertex.gap), "gap");
                    close(&place["angle_deg"], vertex.angle_deg, "angle");
                    close(&place["curvature_percent"], percent(vertex.difference()), "curvature");
                    close(&place["growth"], vertex.growth, "growth");
                    assert_eq!(place["faces"], vertex.faces);
                    assert_eq!(place["rings"].as_array().map(Vec::len), Some(vertex.rings.len()));
                }
            }
            let at = &place["at"];
            let [face, u, v] = ["face", "u", "v"].map(|key| at[key].as_f64().expect("a number"));
            let (_, jet) = surface.evaluate_ptex(face as u32, [u, v]).expect("no hole");
            for axis in 0..3 {
                close(&at["position"][axis], Some(jet.position[axis]), "position");
            }
        }
        close(&json["smooth_joints"]["gap"], Some(10.0 * quality.smooth.gap), "smooth gap");
        assert_eq!(json["smooth_joints"]["joints"], quality.smooth_joints);
    }
}

/// However small the limits, only what has no tangent plane is infinitely many times above them; numbers are short, and smooth lines have
/// their names in the JSON too.
#[test]
fn tiny_limits_are_exceeded_by_finite_multiples() {
    let tiny = ["--gap", "1e-12", "--angle", "1e-12", "--curvature", "1e-12", "--mm-per-unit", "1e30"];
    let (code, out, json) = run("ngon_at_crease", &tiny);
    assert_eq!(code, Some(1));
    let mut lines = 0;
    for place in places(&json) {
        assert!(place["severity"].is_number() || place["tangent_plane"] == false, "{place}");
        if place["kind"] == "smooth" {
            let on = place["lies_on"].as_object().expect("a line");
            assert!(on.len() == 1 && ["edge", "spoke", "inside_ptex_face"].iter().any(|key| on.contains_key(*key)));
            lines += 1;
        }
    }
    assert!(lines > 2 && !out.contains("no plane"), "{out}");
    assert!(out.lines().all(|line| line.len() < 160), "{out}");
    assert!(out.contains("limits: gap 1e-12 mm, angle 1e-12 degrees, curvature 1e-12 %"), "{out}");
}

/// Edges without surfaces on both sides, edges that are not manifold and vertices that are not are told apart.
#[test]
fn what_is_not_judged_is_said() {
    let (_, out, json) = run("boundary_none", &[]);
    let count = |json: &Value, key: &str| json["unjudged"][key].as_array().map(Vec::len);
    assert!(out.contains("\n12 edges not judged: without surfaces on two sides (boundary rule none)\n"), "{out}");
    assert_eq!((count(&json, "edges_without_surface"), count(&json, "nonmanifold_edges")), (Some(12), Some(0)));
    let (_, out, json) = run("bow_tie", &[]);
    assert!(out.contains("\n1 vertex not judged: not manifold: sheets that share no edge meet there\n"), "{out}");
    assert_eq!(json["unjudged"]["nonmanifold_vertices"], serde_json::json!([8]));
}

/// Rows are as many as asked for, and columns stand under one another.
#[test]
fn the_list_is_a_table() {
    let (_, out, json) = run("corner", &["--count", "4"]);
    let lines: Vec<&str> = out.lines().collect();
    let header = lines.iter().position(|line| line.starts_with("rank kind")).expect("a header");
    let end = lines[header].find("worst").expect("a column") + "worst".len();
    for (i, row) in lines[header + 1..header + 5].iter().enumerate() {
        assert!(row.trim_start().starts_with(&format!("{} ", i + 1)) && row.len() <= 120, "{row}");
        // Multiples are aligned to the right.
        assert!(row.len() <= end, "{out}");
    }
    let rest = places(&json).len() - 4;
    assert!(lines[header + 5] == format!("... and {rest} more (--count)"), "{out}");
    // The command that makes it again does.
    let made_by = json["made_by"].as_str().expect("a text");
    assert!(made_by.starts_with("catoptric quality corner.obj --size=1024x1024"), "{made_by}");
    let (_, again) = made_by.split_once("corner.obj ").expect("the mesh");
    let (flags, _) = again.split_once(" # ").expect("a digest");
    let flags: Vec<&str> = flags.split(' ').collect();
    let (_, _, second) = run("corner", &flags);
    assert_eq!(json, second);
}

#[test]
fn breaks_are_marked_in_the_picture() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let draw = |file: &str, args: &[&str]| {
        let output = quality(folder.path(), "three_creases", &[args, &["-o", file, "--size", "320x240"]].concat());
        let said = text(&output.stderr);
        assert!(said.starts_with(&format!("wrote {file}, 344x")) && said.lines().count() == 1, "{said}");
        image::open(folder.path().join(file)).expect("a picture").to_rgb8()
    };
    let marked = draw("a.png", &[]);
    let plain = draw("b.png", &["--count", "0"]);
    let nothing = draw("c.png", &["--count", "0", "--ignore", "creases,vertices"]);
    // The picture, a caption above and a legend below.
    assert_eq!(marked.width(), 320 + 24);
    assert!(marked.height() > 240 + 60);
    let differ = |a: &image::RgbImage, b: &image::RgbImage| {
        // Without the caption, which says something else.
        a.enumerate_pixels().filter(|(x, y, pixel)| *y > 34 && b.get_pixel(*x, *y) != *pixel).count()
    };
    let (numbers, colours) = (differ(&marked, &plain), differ(&plain, &nothing));
    assert!(numbers > 500 && colours > 500, "{numbers} {colours}");
    // The same again.
    assert!(differ(&marked, &draw("a.png", &[])) == 0);
    let made_by = catoptric::output::read_png_made_by(std::io::BufReader::new(
        fs::File::open(folder.path().join("a.png")).expect("it was written"),
    ));
    assert!(made_by.expect("a PNG").expect("a text").contains(" quality three_creases.obj --size=320x240"));
}

#[test]
fn bad_input_is_one_line_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (args, part) in [
        (&["--gap", "-0.1"][..], "--gap"),
        (&["--gap", "0"], "give a number, 1e-12 or above"),
        (&["--angle", "nan"], "give a number, 1e-12 or above"),
        (&["--angle", "1e-320"], "give a number, 1e-12 or above"),
        (&["--curvature", "inf"], "give a number, 1e-12 or above"),
        (&["--curvature", "x"], "--curvature"),
        (&["--mm-per-unit", "0"], "give a number of millimetres from 1e-30 to 1e30"),
        (&["--mm-per-unit", "1e308"], "give a number of millimetres from 1e-30 to 1e30"),
        (&["--ignore", "edges"], "give creases, semi-sharp, smooth, seams or vertices"),
        (&["--weld", "-1"], "give a distance, 0 or above"),
        (&["--weld", "nan"], "give a distance, 0 or above"),
        (&["--weld", "inf"], "give a distance, 0 or above"),
        (&["--count", "some"], "--count"),
        (&["-o", "q.jpg"], "choose a name that ends in .png"),
        (&["-o", "no/such/q.png"], "no/such/q.png: cannot write"),
        (&["--json", "no/such/q.json"], "no/such/q.json: cannot write"),
        (&["-o", "q.png", "--json", "q.png"], "--json would overwrite the picture"),
        (&["--field", "zebra"], "--field"),
        (&["--height", "2"], "--height applies to --projection orthographic only"),
    ] {
        let output = quality(folder.path(), "cube", args);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
        assert!(error.starts_with("catoptric: ") && error.contains(part) && error.lines().count() == 1, "{error}");
        assert!(output.stdout.is_empty());
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0, "{args:?}");
    }
    let output = quality(folder.path(), "no_such_mesh", &[]);
    assert_eq!((output.status.code(), text(&output.stderr).lines().count()), (Some(2), 1));
    // No face has a surface.
    let bare = folder.path().join("bare.obj");
    fs::write(&bare, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt interpolateboundary 1/0/0 0\n")
        .expect("it is written");
    let output = quality(folder.path(), bare.to_str().expect("a name"), &[]);
    let error = text(&output.stderr);
    assert!(output.status.code() == Some(2) && error.contains("nothing to measure"), "{error}");
}

/// Where nothing is judged, nothing passes.
#[test]
fn nothing_to_judge_is_no_pass() {
    let judged_nothing = |name: &str, args: &[&str], why: &str| {
        let (code, out, json) = run(name, args);
        assert_eq!(
            (code, &json["pass"], &json["verdict"]),
            (Some(0), &Value::Null, &"nothing to judge".into()),
            "{out}"
        );
        assert!(out.contains(&format!("\nnothing to judge: {why}")) && !out.contains("pass"), "{out}");
        (out, json)
    };
    let (out, json) =
        judged_nothing("torn/gap_strip", &[], "no two patches meet, and no boundary is within 0.002 units");
    let hint = "\na boundary runs 0.071 units beside another one, at 1.000,0.500,0.000: --weld 0.08 judges it\n";
    assert!(out.contains(hint), "{out}");
    let nearby = json["nearby_boundary"]["distance"].as_f64().expect("a distance");
    assert!((nearby - 0.05 * 2f64.sqrt()).abs() < 1e-12);
    judged_nothing("torn/gap_strip", &["--weld", "0.08", "--ignore", "seams"], "all that was found is ignored");
    judged_nothing("crease_sectors_1_3", &["--ignore", "creases,vertices,smooth"], "all that was found is ignored");
    judged_nothing("boundary_none", &[], "what there is stands above as not judged");
    // A single face without a neighbour.
    judged_nothing("torn/gap_strip", &["--weld", "0"], "no two patches meet");
    let (_, out, json) = run("lathe_c2", &[]);
    assert!(out.contains("\npass: the smooth joints (408) are within their limits\n"), "{out}");
    assert_eq!((&json["pass"], &json["verdict"]), (&true.into(), &"pass".into()));
}

/// What the hint says to do, does it.
#[test]
fn boundaries_within_the_weld_distance_are_judged() {
    let (code, out, json) = run("torn/gap_strip", &["--weld", "0.08"]);
    assert_eq!((code, &json["pass"], &json["verdict"]), (Some(1), &false.into(), &"fail".into()), "{out}");
    assert!(out.contains("\nFAIL: 1 of 1 over their limits\n") && out.contains(" 1 seam (1 over)"), "{out}");
    let [seam] = places(&json) else { panic!("one seam: {out}") };
    assert_eq!((&seam["kind"], &seam["worst"], &seam["reversed"]), (&"seam".into(), &"gap".into(), &false.into()));
    assert_eq!(
        (&seam["vertices"], &seam["beside"][0]["vertices"]),
        (&serde_json::json!([1, 2]), &serde_json::json!([4, 7]))
    );
    assert!((seam["gap"].as_f64().expect("a gap") - 0.05 * 2f64.sqrt()).abs() < 1e-12);
    let unwelded = &json["unwelded_vertices"];
    assert_eq!((&unwelded["count"], &unwelded["first"]), (&2.into(), &serde_json::json!([1, 4])));
    let sentence =
        "2 control vertices on boundaries lie within 0.080 units of another one, unwelded: the first are 1 and 4";
    assert!(out.contains(sentence), "{out}");
    assert!(json["made_by"].as_str().is_some_and(|command| command.contains(" --weld=0.08 ")), "{}", json["made_by"]);
    // In millimetres, as gaps are.
    let (_, _, json) = run("torn/gap_strip", &["--weld", "80", "--mm-per-unit", "1000"]);
    assert!((places(&json)[0]["gap"].as_f64().expect("a gap") - 50.0 * 2f64.sqrt()).abs() < 1e-9);
    assert_eq!(json["weld"], 80.0);
    let (code, out, _) =
        run("torn/gap_strip", &["--weld", "79.9", "--mm-per-unit", "1000", "--gap", "71", "--angle", "30"]);
    assert_eq!(code, Some(0), "{out}");
}

#[test]
fn faces_that_run_against_their_neighbours_are_named() {
    let (code, out, json) = run("torn/one_face_flipped", &[]);
    assert_eq!(code, Some(1));
    assert!(out.contains("\n1 face runs against its neighbours, face 1 (line 10): "), "{out}");
    assert!(out.contains("\n1 seam joins faces that run against each other; "), "{out}");
    let first = serde_json::json!({ "count": 1, "first": { "face": 1, "line": 10, "prim": null } });
    assert_eq!(json["reversed_faces"], first);
    assert_eq!(json["one_sided_components"], serde_json::json!({ "count": 0, "first": null }));
    let seam = places(&json).iter().find(|place| place["kind"] == "seam").expect("a seam");
    assert_eq!((&seam["reversed"], &seam["closed"]), (&true.into(), &true.into()));
    assert!(seam["gap"].as_f64().is_some_and(|gap| gap < 1e-14), "{seam}");
    assert_eq!(json["unjudged"]["nonmanifold_edges"], serde_json::json!([]));
}

#[test]
fn a_surface_without_area_is_said() {
    let (code, out, json) = run("torn/all_points_equal", &[]);
    assert_eq!(code, Some(1), "{out}");
    assert!(out.contains("\nthe surface has no area: all of it lies at one point; "), "{out}");
    assert!(json["without_area"].is_string() && !out.to_lowercase().contains("nan"));
}
