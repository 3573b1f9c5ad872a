//! Files cut off at every hundredth: what is left is read as what it says, or refused in one line.

use super::{Folder, mesh, refusal};
use catoptric::cli::{parse_answers, parse_samples};
use catoptric::mesh::{self as meshes, SubdivMesh};
use catoptric::rig::{Rig, RigFormat};
use std::path::Path;

/// The first so many hundredths of a file, for each of 0 to 99.
fn cuts(whole: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    (0..100).map(|percent| (percent, &whole[..whole.len() * percent / 100]))
}

fn check_line(message: &str, name: &str) {
    assert!(message.starts_with(name) && !message.chars().any(char::is_control), "{message:?}");
}

/// Whether the faces of a mesh that was cut off are the first of the whole one; the last of them may be cut itself.
fn is_part(part: &SubdivMesh, whole: &SubdivMesh) -> bool {
    let (last, others) = part.face_sizes.split_last().expect("a face");
    let vertices: u32 = others.iter().sum();
    whole.face_sizes.starts_with(others)
        && whole.face_vertices.starts_with(&part.face_vertices[..vertices as usize])
        && *last <= whole.face_sizes[others.len()]
}

/// The text of an OBJ has no end of its own: cut off it may be a smaller mesh.
#[test]
fn obj_and_tags() {
    for name in ["cube", "hole", "chaikin_crease", "semi_sharp_corner", "n_gons", "lathe_c1"] {
        let whole = std::fs::read(mesh(name)).expect("a mesh of the tests");
        let (mut read, mut refused) = (0, 0);
        let all = meshes::parse_obj(&whole, "whole").expect("a mesh");
        for (percent, part) in cuts(&whole) {
            match meshes::parse_obj(part, "mesh.obj") {
                Ok(part) => {
                    assert!(is_part(&part, &all), "{name} at {percent} %");
                    read += 1;
                }
                Err(error) => {
                    check_line(&error.to_string(), "mesh.obj");
                    refused += 1;
                }
            }
        }
        println!("{name}: {read} read, {refused} refused");
        assert!(refused > 20, "{name}: {refused} refused");
    }
}

const PREFIX: &str = "#usda 1.0\n(\n    upAxis = \"Z\"\n)\ndef Xform \"x\"\n{\n    double3 xformOp:translate = (1, 2, 3)\n    \
    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n    def Mesh \"m\"\n    {\n";

/// A mesh of the tests as a USD stage.
fn usda(mesh: &SubdivMesh) -> String {
    let list = |values: &mut dyn Iterator<Item = String>| values.collect::<Vec<_>>().join(", ");
    let points = list(&mut mesh.points.iter().map(|p| format!("({}, {}, {})", p.x, p.y, p.z)));
    let sizes = list(&mut mesh.face_sizes.iter().map(u32::to_string));
    let vertices = list(&mut mesh.face_vertices.iter().map(u32::to_string));
    let ends = list(&mut mesh.creases.iter().flat_map(|crease| crease.vertices).map(|v| v.to_string()));
    let lengths = list(&mut mesh.creases.iter().map(|_| "2".to_owned()));
    let sharpness = list(&mut mesh.creases.iter().map(|crease| crease.sharpness.to_string()));
    format!(
        "{PREFIX}point3f[] points = [{points}]\nint[] faceVertexCounts = [{sizes}]\nint[] faceVertexIndices = [{vertices}]\n\
         int[] creaseIndices = [{ends}]\nint[] creaseLengths = [{lengths}]\nfloat[] creaseSharpnesses = [{sharpness}]\n    }}\n}}\n"
    )
}

/// The text ends with a brace, the other two with tables: no part of them is a stage.
#[test]
fn usd() {
    let folder = Folder::new();
    for name in ["semi_sharp_crease", "pole_5"] {
        let source = meshes::read(Path::new(&mesh(name))).expect("a mesh of the tests");
        let text = folder.write("whole.usda", usda(&source));
        let [crate_file, package] = ["usdc", "usdz"].map(|extension| text.with_extension(extension));
        let layer = openusd::sdf::Layer::open(text.to_str().expect("UTF-8")).expect("a layer");
        layer.export(crate_file.to_str().expect("UTF-8")).expect("written as usdc");
        let mut archive = openusd::usdz::ArchiveWriter::create(&package).expect("a package");
        archive.add_layer("mesh.usdc", &std::fs::read(&crate_file).expect("usdc")).expect("a layer in it");
        archive.finish().expect("a whole package");
        for path in [text, crate_file, package] {
            let whole = std::fs::read(&path).expect("a file");
            assert_eq!(meshes::read(&path).expect("a mesh").face_sizes, source.face_sizes);
            for (percent, part) in cuts(&whole) {
                std::fs::write(&path, part).expect("a writable folder");
                let message = meshes::read(&path).err().map(|error| error.to_string());
                let message = message.unwrap_or_else(|| panic!("{percent} % of {} are read", path.display()));
                check_line(&message, path.to_str().expect("UTF-8"));
            }
        }
    }
}

/// TOML has no end: cut at a line it says less. JSON ends with its brace.
#[test]
fn rigs() {
    let rig = "preset = \"zebra\"\nfield = \"curve:circle\"\n[camera]\neye = [3, -4, 2.5]\ntarget = [0, 0, 0.5]\nfov = 26\nsize = [96, 80]\n\
        [light]\nattached = \"camera\"\nnormal = [0, 0, 1]\nlines = [0, 1, 0]\nspacing = 0.25\nsize = [4, 3]\n\
        [pattern]\nname = \"band\"\nwidth = 0.5\n[colours]\npaint = \"#102030\"\ntop = \"#ffffff\"\n";
    let rig = Rig::parse(rig, RigFormat::Toml, Path::new("rig.toml")).expect("a rig");
    for (format, name) in [(RigFormat::Toml, "rig.toml"), (RigFormat::Json, "rig.json")] {
        let whole = rig.write(format, Path::new(".")).expect("a text");
        assert_eq!(Rig::parse(&whole, format, Path::new(name)).expect("a rig"), rig);
        let mut refused = 0;
        for (_, part) in cuts(whole.as_bytes()) {
            let part = std::str::from_utf8(part).expect("ASCII");
            if let Err(error) = Rig::parse(part, format, Path::new(name)) {
                check_line(&error.to_string(), name);
                refused += 1;
            }
        }
        assert!(refused >= if format == RigFormat::Json { 100 } else { 50 }, "{name}: {refused} refused");
    }
}

#[test]
fn samples_and_answers() {
    let mut samples = "face,u,v\n".to_owned();
    let mut answers = "face,u,v,x,y,z,nx,ny,nz\n".to_owned();
    for i in 0..40 {
        let place = format!("{},{},{}", i % 6, f64::from(i) / 40.0, 0.125);
        samples += &format!("{place}\n");
        answers += &format!("{place},{},2.5e-3,-1.25,0,0,1\n", f64::from(i).sin());
    }
    let (name, mut refused) = (Path::new("file.csv"), [0; 2]);
    for (_, part) in cuts(samples.as_bytes()) {
        match parse_samples(part, name, 6, false) {
            Ok(rows) => assert_eq!(rows.len() + 1, part.split(|&b| b == b'\n').filter(|line| !line.is_empty()).count()),
            Err(message) => {
                check_line(&message, "file.csv");
                refused[0] += 1;
            }
        }
    }
    for (_, part) in cuts(answers.as_bytes()) {
        if let Err(message) = parse_answers(part, name, 6) {
            check_line(&message, "file.csv");
            refused[1] += 1;
        }
    }
    assert!(refused.iter().all(|&count| count > 40), "{refused:?}");
}

/// Pictures that a rig names, frames that `--resume` finds, and the report of an earlier run, by the program.
#[test]
fn pictures_and_reports() {
    let folder = Folder::new();
    let cube = mesh("cube");
    let noise = |x: u32, y: u32| image::Luma([(x.wrapping_mul(2_654_435_761).wrapping_add(y * 40_503) >> 7) as u8]);
    image::GrayImage::from_fn(40, 30, noise).save(folder.path("whole.png")).expect("a picture");
    let picture = std::fs::read(folder.path("whole.png")).expect("a picture");
    for args in [
        ["render", &cube, "--size=24x24", "--pattern=cut.png"],
        ["render", &cube, "--size=24x24", "--field=curve:cut.png"],
        ["lines", &cube, "--count=3", "--field=curve:cut.png"],
        ["render", &cube, "--size=24x24", "--rig=cut.toml"],
    ] {
        folder.write("cut.toml", "[pattern]\nname = \"cut.png\"\n");
        for (percent, part) in cuts(&picture).step_by(7) {
            folder.write("cut.png", part);
            let message = folder.refused(&args);
            assert!(message.contains("cut.png"), "{percent} %: {message}");
        }
    }
    let series = |name: &'static str| ["render", "--size=24x24", "--frames=2", "--orbit=90", "-o", name, "--resume"];
    for extension in ["png", "exr"] {
        let (name, frame) = if extension == "png" { ("v.png", "v_0001.png") } else { ("v.exr", "v_0001.exr") };
        let args: Vec<&str> = series(name).into_iter().chain([cube.as_str()]).collect();
        assert!(folder.run(&args).status.success());
        let whole = std::fs::read(folder.path(frame)).expect("a frame");
        for (percent, part) in cuts(&whole).step_by(7) {
            folder.write(frame, part);
            let output = folder.run(&args);
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(message.contains(frame), "{percent} %: {message}");
            let found = std::fs::read(folder.path(frame)).expect("a frame");
            // What still says that it is the frame is drawn again; what may be somebody else's file is refused.
            if output.status.success() {
                assert!(message.contains("not whole") && found == whole, "{percent} %: {message}");
            } else {
                refusal(&output);
                assert!(found == part && percent < 50, "{percent} % of {frame}: {message}");
            }
        }
    }
    let report = folder.run(&["verify", &cube, "--size=16x16", "--json=whole.json"]);
    assert!(report.status.success(), "{}", String::from_utf8_lossy(&report.stderr));
    let whole = std::fs::read(folder.path("whole.json")).expect("a report");
    for (percent, part) in cuts(&whole).step_by(7) {
        folder.write("cut.json", part);
        let message = folder.refused(&["verify", &cube, "--size=16x16", "--baseline=cut.json"]);
        assert!(message.contains("cut.json"), "{percent} %: {message}");
    }
}
