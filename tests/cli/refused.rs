//! Bad meshes, flags and samples: one line, exit code 2, and nothing left behind.

use super::{Folder, QUAD};

#[test]
fn bad_meshes_are_refused_by_every_command_with_the_line() {
    let folder = Folder::new();
    let cases = [
        ("empty", String::new(), "empty"),
        ("index_too_large", format!("{QUAD}f 1 2 3 9\n"), ":5: "),
        ("index_zero", format!("{QUAD}f 0 1 2\n"), ":5: "),
        ("two_gon", format!("{QUAD}f 1 2\n"), ":5: "),
        ("repeated_vertex", format!("{QUAD}f 1 2 2 3\n"), ":5: "),
        ("nan", format!("v nan 0 0\n{QUAD}f 2 3 4 5\n"), ":1: "),
        ("crease_out_of_range", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 99 3\n"), ":6: "),
        ("crease_no_edge", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 2 3\n"), ":6: "),
        ("crease_nan", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 1 nan\n"), ":6: "),
        ("crease_negative", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 1 -1\n"), ":6: "),
        ("corner_out_of_range", format!("{QUAD}f 1 2 3 4\nt corner 1/1/0 7 3\n"), ":6: "),
        ("hole_out_of_range", format!("{QUAD}f 1 2 3 4\nt hole 1/0/0 7\n"), ":6: "),
        ("tag_truncated", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0\n"), ":6: "),
        ("tag_unknown", format!("{QUAD}f 1 2 3 4\nt wrinkle 0/0/0\n"), ":6: "),
        ("not_text", "\0\u{1}\u{2}".repeat(500), "NUL"),
    ];
    for (name, text, expected) in &cases {
        let path = folder.file(&format!("{name}.obj"), text);
        let path = path.to_str().expect("a UTF-8 path");
        folder.file("samples.csv", "face,u,v\n0,0.5,0.5\n");
        for command in [
            &["render", path, "-o", "out.png"][..],
            &["verify", path, "--json", "out.json"],
            &["info", path],
            &["eval", path, "--samples", "samples.csv", "-o", "out.csv"],
        ] {
            let message = folder.refused(command);
            assert!(message.contains(expected) && message.contains(name), "{name}: {message}");
        }
    }
}

#[test]
fn bad_usage_is_refused() {
    let folder = Folder::new();
    for (args, expected) in [
        (&["no-such-command"][..], "no-such-command"),
        (&["render", "/no/such/file.obj"], "no such file"),
        (&["render", "--size", "0x0"], "WIDTHxHEIGHT"),
        (&["render", "--size", "99999x10"], "WIDTHxHEIGHT"),
        (&["render", "--fov", "180"], "field of view"),
        (&["render", "--fov", "0"], "field of view"),
        (&["render", "--projection", "orthographic", "--height", "1e-30"], "a pixel would span"),
        (&["render", "--projection", "orthographic", "--height", "-1"], "above 0"),
        (&["render", "--show", "magic"], "magic"),
        (&["render", "--show", "steps", "-o", "a.exr"], "--show colours a .png"),
        (&["render", "--stage", "vertex"], "vertex"),
        (&["render", "-o", "a.png", "--json", "a.png"], "--json would overwrite the picture"),
        (&["render", "--json", "no-such-folder/a.json"], "no-such-folder"),
        (&["render", "--frames", "2", "--orbit", "1e300"], "at most 1e6"),
        (&["render", "--fov", "nan"], "field of view"),
        (&["render", "--projection", "isometric"], "isometric"),
        (&["render", "--projection", "orthographic", "--fov", "30"], "--fov does not apply"),
        (&["render", "--projection", "orthographic", "--height", "0"], "above 0"),
        (&["render", "--projection", "orthographic", "--height", "inf"], "above 0"),
        (&["render", "--height", "2"], "--projection orthographic"),
        (&["render", "--light-normal", "0,0,0"], "--light-normal"),
        (&["render", "--light-lines", "0,0,0"], "--light-lines"),
        (&["render", "--light-normal", "0,0,2", "--light-lines", "0,0,-3"], "parallel"),
        (&["eval", "--samples", "."], "folder"),
        // Where to write is checked before there is work: these meshes do not even exist.
        (&["verify", "no-such.obj", "--json", "no-such-folder/v.json"], "no-such-folder"),
        (&["verify", "no-such.obj", "--json", "."], "it is a folder"),
        (&["eval", "no-such.obj", "--samples", "no-such.csv", "-o", "no-such-folder/o.csv"], "no-such-folder"),
        (&["render", "--eye", "1,2"], "X,Y,Z"),
        (&["render", "--eye", "1,2,nan"], "X,Y,Z"),
        (&["render", "--pipeline", "magic"], "magic"),
        (&["render", "--pipeline", "points", "--enlarge", "0.5"], "from 1 to 8"),
        (&["render", "--pipeline", "points", "--enlarge", "nan"], "from 1 to 8"),
        (&["render", "--pipeline", "polygon", "--enlarge", "1"], "--pipeline points"),
        (&["render", "--enlarge", "1.7"], "--pipeline points"),
        (&["render", "--pipeline", "points", "--size", "4097x8"], "samples a side"),
        (&["render", "--pattern", "no-such.png"], "no-such.png"),
        (&["render", "-o", "no-such-folder/out.png"], "no-such-folder"),
        (
            &["render", "-o", "out.tiff"],
            "out.tiff: not a picture that we write; choose a name that ends in .png or .exr",
        ),
        (&["eval", "--samples", "no-such.csv"], "no-such.csv"),
        (&["render", "--up", "0,0,0"], "--up has no direction"),
        (&["render", "--light-spacing", "0"], "above 0"),
        (&["eval"], "--samples"),
        (&[], "no command"),
    ] {
        let message = folder.refused(args);
        assert!(message.contains(expected), "{args:?}: {message}");
    }
}

#[test]
fn bad_samples_are_refused_with_their_line() {
    let folder = Folder::new();
    for (text, expected) in [
        ("", "header"),
        ("u,v,face\n0.5,0.5,0\n", "header"),
        ("face,u,v\n0,0.5,1.5\n", ":2: v = 1.5"),
        ("face,u,v\n0,0.5,0.5\n0,-0.1,0\n", ":3: u = -0.1"),
        ("face,u,v\n0,nan,0\n", ":2: u = NaN"),
        ("face,u,v\n0,0.5,0.5\n99999,0.5,0.5\n", ":3: ptex face 99999"),
        ("face,u,v\n0,0.5\n", ":2: "),
        ("face,u,v\n-1,0.5,0.5\n", ":2: "),
        ("face,u,v\nzero,0.5,0.5\n", ":2: "),
        ("face,u,v\n\n0,.5,.5\n\n\n0,2,0", ":6: u = 2"),
        ("face,u,v\r\n\r\n0,.5,.5\r\n\r\n0,2,0\r\n", ":5: u = 2"),
        ("\n\nface,u,v\n\n99999,0,0\n", ":5: ptex face"),
        ("face,u,v\n\"0\",\"0.5\n\",0.5\n\n0,2\n", ":5: "),
    ] {
        let path = folder.file("samples.csv", text);
        let message = folder.refused(&["eval", "--samples", path.to_str().expect("UTF-8"), "-o", "out.csv"]);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

#[test]
fn a_header_that_is_not_text_is_named() {
    let folder = Folder::new();
    std::fs::write(folder.path("samples.csv"), b"face,u,\xff\n0,0,0\n").expect("a writable folder");
    let message = folder.refused(&["eval", "--samples", "samples.csv", "-o", "out.csv"]);
    assert!(message.contains("samples.csv:1: the header is not face,u,v"), "{message}");
}

/// The process file system takes no files from anybody, root included.
#[cfg(target_os = "linux")]
#[test]
fn a_locked_folder_is_told_without_the_temporary_name() {
    let folder = Folder::new();
    let message = folder.refused(&["verify", "--json", "/proc/v.json"]);
    assert!(message.contains("/proc/v.json") && !message.contains(".part"), "{message}");
}

#[test]
fn meshes_without_a_surface_are_no_pass() {
    let folder = Folder::new();
    folder.file("holes.obj", &format!("{QUAD}f 1 2 3 4\nt hole 1/0/0 0\n"));
    folder.file("no_interior.obj", &format!("{QUAD}f 1 2 3 4\nt interpolateboundary 1/0/0 0\n"));
    for mesh in ["holes.obj", "no_interior.obj"] {
        let message = folder.refused(&["verify", mesh, "--json", "v.json"]);
        assert!(message.contains("no face has a limit surface"), "{message}");
    }
    folder.file("tiny.obj", &format!("{}f 1 2 3 4\n", QUAD.replace('1', "1e-300")));
    assert!(folder.refused(&["verify", "tiny.obj"]).contains("underflow"));
}

#[test]
fn faces_of_thousands_of_corners_are_described() {
    let folder = Folder::new();
    let points: String = (0..5000).map(|i| format!("v {i} {} 0\n", i * i)).collect();
    let face: String = (1..=5000).map(|i| format!(" {i}")).collect();
    folder.file("n_gon.obj", &format!("{points}f{face}\n"));
    let output = folder.run(["info", "n_gon.obj"]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("5000: 1"), "{said}");
}

/// What takes more memory than it may is refused before it is taken: files, refinement, tables.
#[test]
fn memory_is_forecast() {
    let folder = Folder::new();
    // Random sharpness along all edges: refined to level 10 everywhere along them.
    let side = 60;
    let mut text = String::new();
    for k in 0..=side {
        (0..=side).for_each(|i| text += &format!("v {i} {k} {}\n", (i * k) % 7));
    }
    let vertex = |i: usize, j: usize| j * (side + 1) + i;
    for (i, j) in (0..side * side).map(|k| (k % side, k / side)) {
        let corners = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)].map(|v| v + 1);
        text += &format!("f {} {} {} {}\n", corners[0], corners[1], corners[2], corners[3]);
        for (k, end) in [vertex(i + 1, j), vertex(i, j + 1)].into_iter().enumerate() {
            let sharpness = 9.0 + ((i * 31 + j * 17 + k * 7) % 90) as f64 / 100.0;
            text += &format!("t crease 2/1/0 {} {end} {sharpness}\n", vertex(i, j));
        }
    }
    folder.file("sharp.obj", &text);
    for (limit, what) in [("100KiB", "to be read"), ("200MiB", "to be refined"), ("0", "nothing fits")] {
        let message = folder.refused(&["info", "sharp.obj", "--memory-limit", limit]);
        assert!(message.contains(what), "{limit}: {message}");
    }
    let message = folder.refused(&["render", "--memory-limit", "300MiB"]);
    assert!(message.contains("sample: to be drawn"), "{message}");
    folder.refused(&["info", "--memory-limit", "much"]);
    assert!(folder.run(["info", "--memory-limit", "1GiB"]).status.success());
}
