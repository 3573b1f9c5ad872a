//! What a scheme does not take is refused in one line.

use catoptric::mesh::{Scheme, SubdivMesh};
use glam::DVec3;
use std::process::{Command, Output};

/// A quad with one reflex corner if `dent`, in a plane.
fn quad(scheme: Scheme, dent: bool) -> SubdivMesh {
    let third = if dent { DVec3::new(0.3, 0.3, 0.0) } else { DVec3::new(1.0, 1.0, 0.0) };
    SubdivMesh {
        name: "quad".to_owned(),
        points: vec![DVec3::ZERO, DVec3::X, third, DVec3::Y],
        face_sizes: vec![4],
        face_vertices: vec![0, 1, 2, 3],
        scheme,
        ..SubdivMesh::default()
    }
}

fn refusal(mesh: &SubdivMesh) -> String {
    mesh.validate().expect_err("it is refused").to_string()
}

#[test]
fn faces_that_a_scheme_does_not_take_are_named() {
    assert_eq!(
        refusal(&quad(Scheme::Loop, false)),
        "quad, face 0: a face with 4 vertices, but the scheme loop takes triangles; triangulate it, or use catmullClark"
    );
    assert_eq!(
        refusal(&quad(Scheme::None, true)),
        "quad, face 0: a face that is concave under the scheme none; cut it into convex faces"
    );
    for (scheme, dent) in [(Scheme::None, false), (Scheme::Bilinear, true), (Scheme::CatmullClark, true)] {
        assert!(quad(scheme, dent).validate().is_ok(), "{scheme:?}");
    }
}

/// Runs the program on an OBJ of a square whose scheme is `scheme`.
fn run(command: &str, scheme: &str, faces: &str) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("square.obj");
    let text = format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{faces}\nt scheme 0/0/1 {scheme}\n");
    std::fs::write(&path, text).expect("a writable folder");
    let mut program = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    program.arg(command).arg(&path).current_dir(folder.path());
    match command {
        "render" => program.args(["-o", "out.png", "--size", "16x16"]),
        "lines" => program.args(["-o", "out.json"]),
        "glints" => program.args(["--light-point", "0,0,3"]),
        _ => &mut program,
    };
    program.output().expect("the program runs")
}

fn assert_refused(output: &Output, what: &str) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.lines().count() == 1 && message.contains(what), "{message}");
}

#[test]
fn unknown_schemes_and_faces_are_refused_with_their_line() {
    let square = "f 1 2 3 4";
    assert_refused(
        &run("info", "catmark", square),
        "square.obj:6: scheme 'catmark' is not supported; use catmullClark",
    );
    assert_refused(&run("info", "loop", square), "square.obj:5: a face with 4 vertices, but the scheme loop");
}

/// Commands that do not know triangles say so, and leave no file.
#[test]
fn commands_without_loop_say_so() {
    for command in ["lines", "quality", "glints"] {
        let output = run(command, "loop", "f 1 2 3\nf 1 3 4");
        assert_refused(&output, &format!("square: the scheme loop is not supported by {command}"));
    }
    assert!(run("info", "loop", "f 1 2 3\nf 1 3 4").status.success());
}
