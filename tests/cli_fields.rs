//! Methods and patterns as a user meets them: flags, fits, false colours, and what pictures say of themselves.

use catoptric::output::read_png_made_by;
use std::io::Cursor;
use std::path::Path;
use std::process::{Command, Output};

fn render(folder: &Path, args: &[&str]) -> Output {
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/pole_5.obj");
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.arg("render").arg(mesh).args(["--size", "96x80", "-o", "view.png"]).args(args).current_dir(folder);
    command.output().expect("the program starts")
}

/// What the picture says of itself, and its pixels.
fn drawn(folder: &Path, args: &[&str]) -> (String, Vec<u8>) {
    let output = render(folder, args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    let bytes = std::fs::read(folder.join("view.png")).expect("a picture");
    let text = read_png_made_by(Cursor::new(&bytes)).expect("a PNG").expect("a text");
    (text, image::load_from_memory(&bytes).expect("a PNG").to_rgba8().into_raw())
}

/// Every method draws a picture of its own, which says how to draw it again.
#[test]
fn every_method_draws_and_says_how() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let methods = [
        "reflection",
        "curve:circle",
        "curve:ellipse=0.5",
        "curve:x^2 - y^2",
        "distance",
        "highlight:array",
        "highlight:signed",
        "highlight:pseudo",
        "highlight:alternative=0.1",
        "sphere:reflection",
        "sphere:normal",
        "isophote",
        "curvature:mean",
        "curvature:gaussian",
        "curvature:largest",
        "curvature:smallest",
        "section",
    ];
    let mut pictures: Vec<(&str, Vec<u8>)> = Vec::new();
    for method in methods {
        let (text, pixels) = drawn(folder.path(), &["--field", method]);
        let quote = if method.contains(' ') { "'" } else { "" };
        assert!(text.contains(&format!(" {quote}--field={method}{quote} ")), "{text}");
        for (other, same) in &pictures {
            assert!(*same != pixels, "{method} draws what {other} draws");
        }
        // With all that was fitted in it; expressions have spaces, so only the others are split at them.
        if !method.contains(' ') {
            let (command, _) = text.split_once(" # ").expect("a digest");
            let (_, flags) = command.split_once("--size=96x80 ").expect("the size");
            assert!(drawn(folder.path(), &flags.split(' ').collect::<Vec<_>>()).1 == pixels, "{text}");
        }
        pictures.push((method, pixels));
    }
}

/// False colours: the ends that are asked for are those that are used, and the fit is neither empty nor infinite.
#[test]
fn false_colours_have_ends() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (text, fitted) = drawn(folder.path(), &["--field", "isophote", "--pattern", "heat"]);
    let (_, range) = text.split_once("--pattern=heat:").expect("a range");
    let ends: Vec<f64> = range.split([',', ' ']).take(2).map(|end| end.parse().expect("a number")).collect();
    assert!(ends[0] >= 0.0 && ends[0] < ends[1] && ends[1] <= 180.0, "{ends:?}");
    let (text, wide) = drawn(folder.path(), &["--field", "isophote", "--pattern", "heat:-90,90"]);
    assert!(text.contains("--pattern=heat:-90,90 ") && wide != fitted, "{text}");
}

#[test]
fn nonsense_is_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cases: [(&[&str], &str); 8] = [
        (&["--field", "zebra"], "curvature"),
        (&["--field", "curve:x +"], "missing at the end"),
        (&["--field", "curve:sin(z)"], "z is not known"),
        (&["--field", "curve:ellipse=0"], "above 0"),
        (&["--field", "highlight:alternative=far"], "alternative=RADIUS"),
        (&["--pattern", "heat:3,1"], "the smaller first"),
        (&["--pattern", "nothing.png"], "nothing.png"),
        (&["--field", "curvature", "--tables", "compact"], "expanded"),
    ];
    for (args, expected) in cases {
        let output = render(folder.path(), args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.lines().count() == 1 && message.contains(expected), "{args:?}: {message}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0, "{args:?} left a file");
    }
}
