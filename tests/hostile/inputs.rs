//! Meshes as people have them: with bad faces, with what is not read, packed, or by standard input. A line says what
//! was left out.

use super::{Folder, mesh, refusal};
use std::io::Write;
use std::process::{Output, Stdio};

/// A mesh of `tests/meshes/trials`.
fn trial(name: &str) -> String {
    mesh(&format!("trials/{name}"))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Commands that read a mesh, each with what it needs.
fn readers() -> [&'static [&'static str]; 8] {
    [
        &["info"],
        &["render", "--size=64x64", "-o", "v.png"],
        &["lines", "-o", "l.json"],
        &["quality"],
        &["eval", "--samples", "samples.csv", "-o", "o.csv"],
        &["verify", "--size=16x16", "--json", "v.json"],
        &["glints", "--light-point=1,4,5", "--eye=3.5,-2.5,4"],
        &["bench", "--quick", "--only=tables"],
    ]
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("samples.csv", "face,u,v\n0,0.5,0.5\n1,0.5,0.5\n6,0.25,0.5\n");
    folder
}

/// Every command leaves them out with one line, and refuses them with another under `--strict`.
#[test]
fn bad_faces_are_left_out_by_every_command() {
    let folder = folder();
    let bad = trial("bad_faces");
    for command in readers().into_iter().filter(|command| command[0] != "bench") {
        let args: Vec<&str> = [command, &[bad.as_str()][..]].concat();
        let output = folder.run(&args);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{args:?}: {}", text(&output.stderr));
        let told = text(&output.stderr);
        let told: Vec<&str> = told.lines().filter(|line| line.starts_with("catoptric: ")).collect();
        let [line] = told[..] else { panic!("{args:?}: {told:?}") };
        assert!(line.contains("3 of 8 faces are left out of the surface, as holes, with 1 crease "), "{line}");
        assert!(line.contains("bad_faces.obj:10: a face with vertex 3 twice"), "{line}");
    }
    for command in readers() {
        let args: Vec<&str> = [command, &[bad.as_str(), "--strict"][..]].concat();
        let message = folder.refused(&args);
        assert!(message.contains("bad_faces.obj:10: a face with vertex 3 twice; name each"), "{message}");
    }
}

/// Numbers of faces are the file's.
#[test]
fn bad_faces_are_holes_in_answers() {
    let folder = folder();
    let bad = trial("bad_faces");
    for backend in ["cpu", "gpu", "osd"] {
        let args = ["eval", bad.as_str(), "--samples", "samples.csv", "--backend", backend];
        let output = folder.run(&args);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let kinds: Vec<bool> = text(&output.stdout).lines().skip(1).map(|row| row.ends_with(",hole")).collect();
        assert_eq!(kinds, [true, false, true], "{backend}");
    }
    folder.write(
        "open.obj",
        std::fs::read_to_string(&bad)
            .expect("a mesh")
            .lines()
            .filter(|line| !["f 4 3 3 1", "f 7 8 5 6", "f 1 7", "t crease 2/1/0 2 0 3"].contains(line))
            .collect::<Vec<_>>()
            .join("\n"),
    );
    let info = |mesh: &str| -> serde_json::Value {
        let output = folder.run(&["info", mesh, "--json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let [with, without] = [info(&bad), info("open.obj")];
    assert_eq!([&with["faces"], &with["holes"], &with["bad_faces"]], [8, 3, 3]);
    for key in [
        "vertices",
        "isolated_vertices",
        "edges",
        "boundary_edges",
        "non_manifold_edges",
        "semi_sharp_edges",
        "interior_valences",
        "boundary_valences",
        "rules",
        "patches",
        "largest_finite_sharpness",
    ] {
        assert_eq!(with[key], without[key], "{key}");
    }
    let said = text(&folder.run(&["info", &bad]).stdout);
    assert!(said.contains("8 (holes: 3, of which bad faces: 3; ptex faces: 10)"), "{said}");
    let quality = |mesh: &str| text(&folder.run(&["quality", mesh]).stdout);
    let joints = |mesh: &str| quality(mesh).lines().nth(1).expect("a second line").to_owned();
    assert_eq!(joints(&bad), joints("open.obj"));
    let verified = folder.run(&["verify", &bad, "--size=64x64"]);
    assert!(verified.status.success(), "{}", text(&verified.stdout));
}

#[test]
fn what_is_not_read_is_told_once() {
    let folder = folder();
    let output = folder.run(&["info", &trial("mesh_and_surf")]);
    assert!(output.status.success());
    let told = text(&output.stderr);
    let found = "passed over: free-form geometry (1 cstype, 1 deg, 1 vp, 1 surf, 2 parm, 1 end)\n";
    assert!(told.ends_with(found) && told.lines().count() == 1, "{told}");
    let message = folder.refused(&["info", &trial("bspline_only")]);
    assert!(
        message
            .contains("the mesh has no faces, but free-form geometry (1 cstype, 1 deg, 1 surf, 2 parm, 1 end), which is not read; give")
    );
    let message = folder.refused(&["info", &trial("minus_ind")]);
    assert!(
        message
            .contains("minus_ind.obj:1: coordinate '-1.#IND' is not a number, the program that wrote it computed 0/0")
    );
}

fn fed(folder: &Folder, args: &[&str], content: &[u8]) -> Output {
    let mut command = folder.command(args);
    let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.expect("the program starts");
    // Whoever refuses its arguments reads nothing.
    let _ = child.stdin.take().expect("a pipe").write_all(content);
    child.wait_with_output().expect("it ends")
}

const USDA: &str = "#usda 1.0\ndef Mesh \"m\"\n{\n    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n    \
    int[] faceVertexCounts = [4]\n    int[] faceVertexIndices = [0, 1, 2, 3]\n}\n";

#[test]
fn standard_input_is_a_mesh() {
    let folder = folder();
    let cube = std::fs::read(mesh("cube")).expect("a mesh");
    let plain = folder.run(&["info", &mesh("cube")]);
    for flags in [&["info", "-"][..], &["info", "-", "--format", "obj"]] {
        let output = fed(&folder, flags, &cube);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert_eq!(text(&output.stdout).replace("stdin", "cube").lines().nth(1), text(&plain.stdout).lines().nth(1));
        assert!(output.stderr.is_empty());
    }
    for flags in [&["info", "-"][..], &["info", "-", "--format=usda"], &["info", "-", "--format=usd", "--prim=/m"]] {
        let output = fed(&folder, flags, USDA.as_bytes());
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    for command in readers().into_iter().filter(|command| command[0] != "bench") {
        let args: Vec<&str> = [command, &["-"][..]].concat();
        let output = fed(&folder, &args, &std::fs::read(trial("bad_faces")).expect("a mesh"));
        assert!(matches!(output.status.code(), Some(0 | 1)), "{args:?}: {}", text(&output.stderr));
        assert!(text(&output.stderr).contains("catoptric: standard input: 3 of 8 faces are left out"), "{args:?}");
    }
    let refused = |args: &[&str], content: &[u8]| refusal(&fed(&folder, args, content));
    let message = refused(&["info", "-", "--strict"], b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\n");
    assert_eq!(message, "catoptric: standard input:5: the same face as line 4; delete one of the two\n");
    assert!(refused(&["info", "-"], b"").contains("standard input: the file is empty"));
    assert!(refused(&["info", "-", "--format=usdc"], b"v 0 0 0\n").contains("standard input: not readable as USD"));
    assert!(refused(&["info", "-", "--format=fbx"], b"").contains("give obj, usd, usda, usdc or usdz"));
    assert!(refused(&["info", &mesh("cube"), "--format=obj"], b"").contains("--format is for standard input; leave"));
    assert!(refused(&["info", "--format=obj"], b"").contains("--format is for standard input; leave"));
    assert!(refused(&["info", "-", "--time=1"], &cube).contains("standard input: an OBJ has no time"));
}

/// Packed meshes, also in folders.
#[test]
fn packed_meshes_are_found_and_read() {
    let folder = folder();
    std::fs::create_dir(folder.path("m")).expect("a folder");
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(&std::fs::read(mesh("cube")).expect("a mesh")).expect("packed");
    folder.write("m/cube.obj.gz", encoder.finish().expect("packed"));
    let told = text(&folder.run(&["info", "m/cube.obj.gz"]).stdout);
    assert_eq!(told.split_whitespace().take(2).collect::<Vec<_>>(), ["mesh", "cube"], "{told}");
    let output = folder.run(&["verify", "m", "--size=16x16"]);
    assert!(output.status.success() && text(&output.stdout).starts_with("cube: pass"), "{}", text(&output.stdout));
}
