//! `catoptric lines` as a user meets it.

use catoptric::field::{Field, HighlightKind, Light, Method, Point};
use catoptric::mesh;
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

const EXTENSIONS: [&str; 5] = ["json", "svg", "dxf", "obj", "usda"];
/// A mesh of another name than a shell likes.
const NAME: &str = "it's a \"car\" <&> \u{fc}.obj";

fn pole() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/pole_5.obj")
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::copy(pole(), folder.path().join(NAME)).expect("it is copied");
    folder
}

fn lines(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.args(["lines", NAME]).args(args).current_dir(folder);
    command.output().expect("the program starts")
}

fn json(folder: &Path, args: &[&str]) -> Value {
    let output = lines(folder, args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON on standard output")
}

/// A point, and its place.
type Placed = (DVec3, u32, [f64; 2]);

/// The curves' lights, values and points.
fn curves(json: &Value) -> Vec<(i64, f64, Vec<Placed>)> {
    let numbers = |list: &Value| -> [f64; 3] {
        let numbers: Vec<f64> = list.as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
        numbers.try_into().expect("three numbers")
    };
    let curve = |curve: &Value| {
        let list = |name: &str| curve[name].as_array().expect("a list").iter().map(numbers).collect::<Vec<_>>();
        let pair = |(point, [face, u, v]): ([f64; 3], [f64; 3])| (DVec3::from_array(point), face as u32, [u, v]);
        let points = list("points").into_iter().zip(list("params")).map(pair).collect();
        (curve["light"].as_i64().expect("a number"), curve["value"].as_f64().expect("a number"), points)
    };
    json["curves"].as_array().expect("a list").iter().map(curve).collect()
}

/// What a file says of how it was made, by the rules of its format.
fn made_by(text: &str, extension: &str) -> String {
    match extension {
        "json" => serde_json::from_str::<Value>(text).expect("JSON")["made_by"].as_str().expect("a text").to_owned(),
        "svg" => {
            let document = roxmltree::Document::parse(text).expect("XML");
            let desc = document.descendants().find(|node| node.has_tag_name("desc"));
            desc.and_then(|node| node.text()).expect("a description").to_owned()
        }
        "dxf" => {
            let lines: Vec<&str> = text.lines().collect();
            let comments = lines.chunks(2).filter(|pair| pair[0].trim() == "999").map(|pair| pair[1].trim());
            comments.collect::<String>().replace("\\U+00FC", "\u{fc}")
        }
        "obj" => text.lines().next().and_then(|line| line.strip_prefix("# ")).expect("a comment").to_owned(),
        _ => {
            let line = text.lines().find_map(|line| line.trim().strip_prefix("string catoptric = \""));
            let literal = line.and_then(|line| line.strip_suffix('"')).expect("a string");
            literal.replace("\\\"", "\"").replace("\\\\", "\\")
        }
    }
}

/// The recorded command, run by a shell, gives the same file again.
#[cfg(unix)]
#[test]
fn files_say_how_to_make_them_again() {
    let folder = folder();
    let folder = folder.path();
    let cases: [&[&str]; 9] = [
        &[],
        &["--field", "curve:x^2 - y^2"],
        &["--projection", "orthographic", "--mm-per-unit", "250"],
        &["--unit", "mm", "--hidden"],
        &["--light-size", "3.5,2.25", "--visible"],
        &["--field", "highlight", "--count", "7"],
        &["--field", "isophote", "--values", "10,22.5,1e-3"],
        &["--field", "distance", "--radius", "0.05", "--lights", "-2,1"],
        &["--field", "highlight:signed", "--radius", "0.05,0.1", "--tolerance", "2e-3"],
    ];
    let mut compared = 0;
    for case in cases {
        for extension in EXTENSIONS {
            let of_svg = ["--unit", "--mm-per-unit"].iter().any(|flag| case.contains(flag));
            if of_svg && extension != "svg" {
                continue;
            }
            let name = format!("lines.{extension}");
            let args = [case, &["--size", "200x150", "-o", &name]].concat();
            let output = lines(folder, &args);
            assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
            let first = std::fs::read_to_string(folder.join(&name)).expect("a file");
            let command = made_by(&first, extension);
            let words = command.strip_prefix("catoptric ").expect("it begins with the program");
            std::fs::remove_file(folder.join(&name)).expect("it is removed");
            let version = format!(" # catoptric {}, mesh ", env!("CARGO_PKG_VERSION"));
            let (words, digest) = words.split_once(&version).expect("version and digest");
            assert_eq!(digest.len(), 16, "{digest}");
            let script = format!("\"$0\" {words} -o {name}");
            let mut shell = Command::new("sh");
            shell.args(["-c", &script, env!("CARGO_BIN_EXE_catoptric")]).current_dir(folder);
            let output = shell.output().expect("a shell");
            assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
            let second = std::fs::read_to_string(folder.join(&name)).expect("a file");
            assert!(first == second, "{script} makes another file");
            compared += 1;
        }
    }
    assert_eq!(compared, 7 * 5 + 2);
}

/// Lights that have ends are chosen from those within them.
#[test]
fn lights_are_chosen_within_the_extents() {
    let folder = folder();
    let folder = folder.path();
    assert!(!curves(&json(folder, &["--rig", "showroom"])).is_empty());
    std::fs::copy(pole().with_file_name("cube.obj"), folder.join(NAME)).expect("it is copied");
    let flags = [
        "--light-spacing=0.2",
        "--light-size=3,40",
        "--light-center=0,12,6",
        "--light-normal=0,0,-1",
        "--light-lines=1,0,0",
    ];
    let [chosen, all] = [&[][..], &["--lights=-7,7"]].map(|more| curves(&json(folder, &[&flags[..], more].concat())));
    let lights = |curves: &[(i64, f64, Vec<Placed>)]| curves.iter().map(|curve| curve.0).collect::<Vec<_>>();
    assert!(!all.is_empty() && lights(&chosen) == lights(&all), "{:?} {:?}", lights(&chosen), lights(&all));
}

/// A length of nothing is 0.
#[test]
fn no_curves_are_no_length() {
    let folder = folder();
    let output = lines(folder.path(), &["--field", "section", "--values", "1e6"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("lines: 0 curves of 0 lights") && said.contains(" 0.000000 world units long"), "{said}");
}

#[test]
fn there_are_curves_and_a_summary_of_them() {
    let folder = folder();
    let output = lines(folder.path(), &["--field", "section", "--timings"]);
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON on standard output");
    let curves = curves(&json);
    assert_eq!(json["field"], "section");
    assert!(curves.len() >= 5);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let points: usize = curves.iter().map(|(.., points)| points.len()).sum();
    let expected = format!("lines: {} curves of ", curves.len());
    let summary = said.lines().find(|line| line.starts_with(&expected)).expect("a summary");
    assert!(summary.contains(&format!(" {points} points, ")), "{summary}");
    assert!(said.contains("trace ") && said.contains(" ms"), "{said}");
}

const LIGHT: [&str; 8] = [
    "--light-center=0.1,0.2,4",
    "--light-normal=0,0,-1",
    "--light-lines=0.2,1,0",
    "--light-spacing=0.31",
    "--field=highlight",
    "--tolerance=1e-3",
    "--size=64x64",
    "--lights=-40,40",
];

fn highlight(kind: HighlightKind) -> Field {
    let light = Light::new(DVec3::new(0.1, 0.2, 4.0), DVec3::NEG_Z, DVec3::new(0.2, 1.0, 0.0), 0.31);
    Field { light, method: Method::Highlight(kind) }
}

/// Value of a highlight field at a ptex place; it depends on no camera.
fn value(surface: &LimitSurface, field: &Field, face: u32, uv: [f64; 2]) -> DVec2 {
    let (_, jet) = surface.evaluate_ptex(face, uv).expect("it is no hole");
    let point = Point { position: jet.position, normal: jet.normal, sight: DVec3::Z, curvature: None };
    field.value(&point).expect("it is defined")
}

/// Every point has the value that its curve says, at the place that it says; of the light that it says.
#[test]
fn values_and_places_are_true() {
    let folder = folder();
    let surface = LimitSurface::new(&mesh::read(&pole()).expect("valid")).expect("valid");
    let field = highlight(HighlightKind::Array);
    let found = curves(&json(folder.path(), &LIGHT));
    assert!(found.len() >= 5);
    for (light, c, points) in &found {
        assert_eq!(*c, *light as f64 * 0.31);
        for &(position, face, uv) in points {
            let (_, jet) = surface.evaluate_ptex(face, uv).expect("it is no hole");
            assert!(jet.position.distance(position) < 1e-12 * surface.diagonal());
            // 512 roundings of values of some units, and the slope of the field.
            assert!((value(&surface, &field, face, uv).x - c).abs() < 1e-11, "{light}");
        }
    }
    // Bands on both sides of each light.
    let banded = curves(&json(folder.path(), &[&LIGHT[..], &["--radius=0.02,0.05"]].concat()));
    let of_light = |k: i64| {
        let mut values: Vec<f64> =
            banded.iter().filter(|(light, ..)| *light == k).map(|(_, value, _)| *value).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let light = found[found.len() / 2].0;
    let middle = light as f64 * 0.31;
    assert_eq!(of_light(light), [middle - 0.05, middle - 0.02, middle + 0.02, middle + 0.05]);
}

/// Bands of the distance from the nearest light have its number.
#[test]
fn nearest_lights_are_told_apart() {
    let folder = folder();
    let surface = LimitSurface::new(&mesh::read(&pole()).expect("valid")).expect("valid");
    let field = highlight(HighlightKind::Nearest);
    let args: Vec<&str> = LIGHT.iter().copied().filter(|arg| !arg.starts_with("--field")).collect();
    let found = curves(&json(folder.path(), &[&args[..], &["--field=highlight:nearest", "--radius=0.03"]].concat()));
    let mut lights: Vec<i64> = found.iter().map(|(light, ..)| *light).collect();
    lights.sort_unstable();
    lights.dedup();
    assert!(lights.len() >= 4, "{lights:?}");
    for (light, c, points) in &found {
        assert_eq!(c.abs(), 0.03);
        for &(_, face, uv) in points {
            let found = value(&surface, &field, face, uv);
            assert!((found.x - c).abs() < 1e-11 && found.y == *light as f64, "{found} {light} {c}");
        }
    }
}

/// A light that ends cuts its lines: at its very end, and nothing else.
#[test]
fn lights_end() {
    let folder = folder();
    let surface = LimitSurface::new(&mesh::read(&pole()).expect("valid")).expect("valid");
    let field = highlight(HighlightKind::Array);
    let whole = curves(&json(folder.path(), &LIGHT));
    let half = [0.9, 0.55];
    let cut = curves(&json(folder.path(), &[&LIGHT[..], &["--light-size=1.8,1.1"]].concat()));
    let second = |&(_, face, uv): &Placed| value(&surface, &field, face, uv).y;
    let mut ends = 0;
    for (_, c, points) in &cut {
        assert!(c.abs() <= half[0]);
        for point in points {
            assert!(second(point).abs() <= half[1] + 1e-12, "{}", second(point));
            assert!((value(&surface, &field, point.1, point.2).x - c).abs() < 1e-11);
        }
        ends += [&points[0], &points[points.len() - 1]].iter().filter(|p| second(p).abs() > half[1] - 1e-11).count();
    }
    assert!(ends >= 4, "{ends} ends are cut");
    // All that is within is there: every point of the whole curves within the extent is a point of what is left.
    let mut kept = 0;
    for (_, c, points) in whole.iter().filter(|(_, c, _)| c.abs() <= half[0]) {
        for point in points.iter().filter(|point| second(point).abs() < half[1]) {
            let same = cut.iter().any(|(_, d, points)| d == c && points.iter().any(|p| p.0 == point.0));
            assert!(same, "{point:?} is lost");
            kept += 1;
        }
    }
    let total: usize = whole.iter().map(|(.., points)| points.len()).sum();
    assert!(kept > 20 && kept < total, "{kept} of {total}");
}

/// A number of lights is asked for, and there are so many.
#[test]
fn counts_are_counts() {
    let folder = folder();
    for field in ["reflection", "highlight", "section", "distance"] {
        for count in [1, 6, 40] {
            let args = ["--field", field, "--count", &count.to_string(), "--tolerance=1e-2"];
            let mut lights: Vec<i64> = curves(&json(folder.path(), &args)).iter().map(|(light, ..)| *light).collect();
            lights.sort_unstable();
            lights.dedup();
            assert_eq!(lights.len(), count, "{field}: {lights:?}");
        }
    }
}

#[test]
fn nonsense_is_refused_in_one_line() {
    let folder = folder();
    let cases: [(&[&str], &str); 22] = [
        (&["-o", "lines.png"], ".svg"),
        (&["-o", "lines"], ".svg"),
        (&["-o", "lines.usdc"], ".usda"),
        (&["-o", "no/such/folder.svg"], "does not exist"),
        (&["--tolerance", "0"], "above 0"),
        (&["--tolerance", "-1"], "above 0"),
        (&["--tolerance", "nan"], "above 0"),
        (&["--tolerance", "inf"], "above 0"),
        (&["--tolerance", "1e-300"], "rounding"),
        (&["--values", "1,nan"], "finite"),
        (&["--values", ""], "finite"),
        (&["--values", "1", "--count", "3"], "--count"),
        (&["--lights", "3,1"], "first"),
        (&["--lights", "0,100000"], "10000"),
        (&["--count", "0"], "1"),
        (&["--count", "3", "--light-spacing", "1"], "--light-spacing"),
        (&["--radius", "0.1,-0.1"], "above 0"),
        (&["--field", "distance", "--values", "0"], "--radius"),
        (&["--field", "highlight:pseudo", "--lights", "0,1"], "one light"),
        (&["-o", "lines.svg", "--mm-per-unit", "10"], "orthographic"),
        (&["-o", "lines.obj", "--unit", "mm"], ".svg"),
        (&["--hidden", "--visible"], "--visible"),
    ];
    for (args, expected) in cases {
        let output = lines(folder.path(), args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.lines().count() == 1 && message.contains(expected), "{args:?}: {message}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "{args:?} left a file");
    }
}
