//! Bad rigs: one line that says which file and line, what is wrong and what to do; exit code 2, no file.

use super::{Folder, mesh};

#[test]
fn bad_toml_is_refused_with_its_line() {
    let folder = Folder::new();
    for (text, line, expected) in [
        ("field = ", 1, "rig.toml"),
        ("\nfield = \"zebra\"", 2, "curvature"),
        ("fild = \"reflection\"", 1, "unknown field `fild`"),
        ("[light]\nspacing = 1\nspaceing = 2", 3, "unknown field `spaceing`"),
        ("[light]\nspacing = 0", 2, "give a number above 0"),
        ("[light]\nspacing = inf", 2, "give a number above 0"),
        ("[light]\nspacing = \"wide\"", 2, "invalid type"),
        ("[light]\ncenter = [1, 2]", 2, "3"),
        ("[light]\ncenter = [1, 2, nan]", 2, "three finite numbers"),
        ("[light]\nsize = [1, -2]", 2, "two numbers above 0"),
        ("[light]\n\nnormal = [0, 0, 0]", 3, "light.normal has no direction"),
        ("[light]\nlines = [0, 0, 0.0]", 2, "light.lines has no direction"),
        ("[light]\nnormal = [0, 0, 2]\nlines = [0, 0, -3]", 3, "parallel to the normal"),
        ("[light]\nattached = \"moon\"", 2, "`object` or `camera`"),
        ("[camera]\nfov = 180", 2, "field of view above 0"),
        ("[camera]\nprojection = \"isometric\"", 2, "`perspective` or `orthographic`"),
        ("[camera]\nprojection = \"orthographic\"\nfov = 30", 3, "camera.fov does not apply"),
        ("[camera]\nheight = 3", 2, "camera.height applies"),
        ("[camera]\nheight = 0", 2, "give a number above 0"),
        ("[camera]\nsize = [0, 10]", 2, "each 1 to 8192"),
        ("[camera]\nsize = [10, 9000]", 2, "each 1 to 8192"),
        ("[pattern]\nwidth = 1.5", 2, "from 0 to 1"),
        ("[pattern]\nrange = [3, 1]", 2, "the smaller first"),
        ("[pattern]\nname = \"stripes\"\nrange = [1, 3]", 3, "pattern.range is for"),
        ("[pattern]\n# name = 1\nname = \"sttripes\"", 3, "no such picture"),
        ("[colours]\npaint = \"red\"", 2, "#rrggbb"),
        ("[colours]\npaint = [1, 2, 3]", 2, "from 0 to 1"),
        ("[colours]\ntop = 7", 2, "#rrggbb"),
        ("preset = \"tunel\"", 1, "`tunnel`"),
        ("preset = \"tunnel\"\n[pattern]\nrange = [1, 3]", 3, "pattern.range is for"),
        ("preset = \"zebra\"\n[light]\nlines = [0, 0, 1]", 3, "light.lines is parallel"),
        ("[camera]\nup = [0, 0, 0]", 2, "camera.up has no direction"),
        ("[light]\nnormal = [1e-200, 0, 0]", 2, "light.normal is too short or too long"),
        ("[light]\n[light]\n", 2, "duplicate key"),
    ] {
        folder.write("rig.toml", text);
        for command in ["render", "lines"] {
            let message = folder.refused(&[
                command,
                &mesh(),
                "--rig",
                "rig.toml",
                "-o",
                if command == "render" { "v.png" } else { "v.svg" },
            ]);
            assert!(message.contains(&format!("rig.toml:{line}: ")) && message.contains(expected), "{text}: {message}");
        }
    }
}

#[test]
fn bad_json_is_refused_with_its_line() {
    let folder = Folder::new();
    for (text, line, expected) in [
        ("", 1, "EOF"),
        ("{\n\"field\": \"zebra\"}", 2, "curvature"),
        ("{\"light\":\n{\"spacing\": -1}}", 2, "give a number above 0"),
        ("{\"light\":\n{\"normal\": [0, 0, 0]}}", 2, "light.normal has no direction"),
        (
            "{\"colours\": {\"paint\": \"#112233\"}, \"light\": {\"normal\": [0, 0, 0]}}",
            1,
            "light.normal has no direction",
        ),
        ("{\"colors\": {}}", 1, "unknown field `colors`"),
        ("[1, 2]", 1, "see docs/RIGS.md"),
        ("{\"camera\": {\"fov\": 20}} {}", 1, "trailing"),
    ] {
        folder.write("rig.json", text);
        let message = folder.refused(&["render", &mesh(), "--rig", "rig.json", "-o", "v.png"]);
        assert!(message.contains(&format!("rig.json:{line}: ")) && message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn files_and_flags_that_do_not_fit_are_refused() {
    let folder = Folder::new();
    folder.write("flat.toml", "[camera]\nprojection = \"orthographic\"");
    folder.write("pair.toml", "[light]\nnormal = [0, 0, 1]");
    std::fs::write(folder.path("bytes.toml"), [0xff, 0xfe, 0x00]).expect("a writable folder");
    for (args, expected) in [
        (&["--rig", "no-such-preset"][..], "give tunnel, showroom, zebra, lattice, circles, highlight, or a file"),
        (&["--rig", "no-such.toml"], "no-such.toml: cannot read"),
        (&["--rig", "."], "--rig .: it is a folder"),
        (&["--rig", "tunel"], "(did you mean tunnel?)"),
        (&["--rig", "bytes.toml"], "bytes.toml: cannot read"),
        (&["--rig", "rig.yaml"], "ends in .toml or .json"),
        (&["--rig", "flat.toml", "--fov", "30"], "--fov does not apply"),
        (&["--rig", "tunnel", "--height", "30"], "--height applies"),
        (&["--rig", "pair.toml", "--light-lines", "0,0,2"], "--light-lines is parallel"),
        (&["--light-normal", "1e-200,0,0"], "--light-normal is too short or too long"),
        (&["--light-lines", "0,1e200,0"], "--light-lines is too short or too long"),
        (&["--pattern", ""], "--pattern names nothing"),
        (&["--save-rig", "rig.yaml"], "rig.yaml: not a light rig that we write"),
        (&["--save-rig", "no-such-folder/rig.toml"], "no-such-folder"),
        (&["--light-attached", "moon"], "give object or camera"),
        (&["--paint", "red"], "#rrggbb"),
        (&["--light-colour", "1,2,3"], "#rrggbb"),
        (&["--background-top", "#fff"], "#rrggbb"),
    ] {
        let mesh = mesh();
        let mut all = vec!["render", &mesh, "-o", "v.png"];
        all.extend(args);
        let message = folder.refused(&all);
        assert!(message.contains(expected), "{args:?}: {message}");
    }
    let message = folder.refused(&["render", &mesh(), "-o", "v.png", "--json", "a.json", "--save-rig", "a.json"]);
    assert!(message.contains("--save-rig would overwrite"), "{message}");
    let message = folder.refused(&["lines", &mesh(), "-o", "a.json", "--save-rig", "a.json"]);
    assert!(message.contains("--save-rig would overwrite"), "{message}");
}

/// What `render` refuses of a camera, `lines` and `quality` refuse too, in the same words.
#[test]
fn cameras_without_a_picture_are_refused_by_all() {
    let folder = Folder::new();
    folder.write("steep.toml", "[camera]\nup = [0, 0, 2]\neye = [0, 0, 9]\ntarget = [0, 0, 0]");
    for (flags, expected) in [
        ("--up 0,0,0", "--up has no direction"),
        ("--up 1e-200,0,0", "--up is too short or too long"),
        ("--eye 1,2,3 --target 1,2,3", "two finite points"),
        ("--eye 0,0,9 --target 0,0,0 --up 0,0,-1", "parallel to the line of sight"),
        ("--eye 1e200,0,0", "too far to compute with"),
        ("--fov 1e-300", "a pixel would span"),
        ("--projection orthographic --height 1e-30", "a pixel would span"),
        ("--rig steep.toml", "steep.toml: the camera's up direction"),
    ] {
        let mesh = mesh();
        let messages = ["render", "lines", "quality"].map(|command| {
            let output = if command == "lines" { "v.svg" } else { "v.png" };
            let args = [command, &mesh, "-o", output].into_iter().chain(flags.split(' ')).collect::<Vec<_>>();
            folder.refused(&args)
        });
        assert!(messages[0].contains(expected), "{flags}: {}", messages[0]);
        assert!(messages.iter().all(|message| *message == messages[0]), "{messages:?}");
    }
}
