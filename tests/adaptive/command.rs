//! `render --patches osd` and `--compare` as a user meets them.

use crate::gpu_support::mesh;
use catoptric::osd::{EndCap, Far, Isolation};
use catoptric::output::{read_exr_made_by, read_png_made_by};
use exr::prelude::{FlatSamples, read_all_flat_layers_from_file};
use glam::DVec3;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name)
}

fn render(folder: &Path, name: &str, args: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.arg("render").arg(path(name)).args(args.split_whitespace()).current_dir(folder);
    command.output().expect("the program starts")
}

fn done(folder: &Path, name: &str, args: &str) -> String {
    let output = render(folder, name, args);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{args}: {message}");
    message
}

#[test]
fn end_caps_are_drawn_and_say_how() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let draw = |args: &str| {
        done(folder.path(), "cube.obj", args);
        let bytes = std::fs::read(folder.path().join("view.png")).expect("a picture");
        let text = read_png_made_by(Cursor::new(&bytes)).expect("a PNG").expect("a text");
        let pixels = image::load_from_memory(&bytes).expect("a PNG").to_rgba8().into_raw();
        (text, pixels)
    };
    let (text, exact) = draw("--size 64x48");
    assert!(text.contains(" --patches=stam "), "{text}");
    let mut pictures = vec![exact];
    for args in ["--size 64x48 --patches osd:1", "--size 64x48 --patches osd:1 --end-caps bspline"] {
        let (text, pixels) = draw(args);
        assert!(text.contains(" --patches=osd:1 "), "{text}");
        assert_eq!(text.contains(" --end-caps=bspline "), args.ends_with("bspline"), "{text}");
        assert!(pictures.iter().all(|other| *other != pixels), "{args} draws what another one draws");
        // What the picture says draws it again.
        let (command, _) = text.split_once(" # ").expect("a digest");
        let (_, flags) = command.split_once("cube.obj ").expect("the mesh");
        assert_eq!(draw(flags).1, pixels);
        pictures.push(pixels);
    }
}

/// P in the EXR is what `Far` evaluates at the channels' ptex coordinates.
#[test]
fn exr_channels_are_those_of_the_patches_that_were_drawn() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    done(folder.path(), "n_gons.obj", "--size 96x64 -o view.exr --patches osd:2");
    let path = folder.path().join("view.exr");
    let text = read_exr_made_by(std::io::Cursor::new(std::fs::read(&path).expect("a picture")))
        .expect("an EXR")
        .expect("a text");
    assert!(text.contains(" --patches=osd:2 "), "{text}");
    let file = read_all_flat_layers_from_file(&path).expect("an EXR");
    let channels = &file.layer_data[0].channel_data.list;
    let channel = |name: &str| &channels.iter().find(|channel| channel.name.eq(name)).expect(name).sample_data;
    let floats = |name: &str| match channel(name) {
        FlatSamples::F32(samples) => samples.as_slice(),
        other => panic!("{name} is {other:?}"),
    };
    let FlatSamples::U32(faces) = channel("ptex.face") else { panic!("faces are whole numbers") };
    let position = ["P.X", "P.Y", "P.Z"].map(floats);
    let [u, v] = ["ptex.u", "ptex.v"].map(floats);
    let seen: Vec<usize> = (0..faces.len()).filter(|&i| faces[i] != u32::MAX).collect();
    let samples: Vec<_> = seen.iter().map(|&i| (faces[i], f64::from(u[i]), f64::from(v[i]))).collect();
    let mesh = mesh("n_gons.obj");
    let far = Far::with(&mesh, Isolation::uniform(2), EndCap::Gregory).expect("it is valid");
    let mut caps = 0;
    for (&i, answer) in seen.iter().zip(far.evaluate(&samples).expect("the faces exist")) {
        let point = DVec3::from_array(position.map(|channel| f64::from(channel[i])));
        // (u,v) and P in f32, P from them in f32.
        assert!(point.distance(answer.position) < 2e-6 * mesh.diagonal(), "pixel {i}: {point} {answer:?}");
        caps += usize::from(answer.answer == catoptric::osd::Answer::EndCap);
    }
    assert!(seen.len() > 1000 && caps > 20, "{} pixels, {caps} on end caps", seen.len());
}

#[test]
fn comparisons_are_one_picture_and_figures() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let message = done(folder.path(), "cube.obj", "--size 80x60 --compare --patches osd:1 -o c.png --json c.json");
    assert!(message.starts_with("compare: OpenSubdiv level 1/1, 24 patches (24 gregory end caps)"), "{message}");
    let picture = image::open(folder.path().join("c.png")).expect("a PNG");
    assert_eq!([picture.width(), picture.height()], [2 * 92 + 12, 12 + 2 * (16 + 6 + 60 + 12) + 6 + 52]);
    let json = std::fs::read(folder.path().join("c.json")).expect("figures");
    let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    let found = &json["comparisons"][0];
    let number = |what: &str, which: &str| found[what][which].as_f64().expect("a number");
    assert_eq!([&found["level_smooth"], &found["patches_end_cap"]], [1, 24]);
    assert!(number("normal_deg", "p99") > 0.1 && number("normal_deg", "max") < 3.0, "{found}");
    assert!(number("lines_px", "p99") > 0.01 && number("lines_px", "mean") < 1.0, "{found}");
    // Without --patches, against OpenSubdiv's own choice of levels.
    let message = done(folder.path(), "cube.obj", "--size 80x60 --compare -o c.png");
    assert!(message.starts_with("compare: OpenSubdiv level 2/6"), "{message}");
}

#[test]
fn contradictions_are_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cases = [
        ("--patches osd:0", "from 1 to 10"),
        ("--patches osd:11", "from 1 to 10"),
        ("--patches opensubdiv", "stam, osd or osd:LEVEL"),
        ("--end-caps bspline", "--patches osd"),
        ("--compare -o c.exr", ".png"),
        ("--compare --show residual", "--show"),
    ];
    for (args, expected) in cases {
        let output = render(folder.path(), "cube.obj", args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args}: {message}");
        assert!(message.lines().count() == 1 && message.contains(expected), "{args}: {message}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0, "{args} left a file");
    }
}
