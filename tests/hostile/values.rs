//! Arguments that no one should give.

use super::{Folder, mesh};
use std::ffi::OsString;

/// Numbers where there are none.
const NUMBERS: [&str; 14] =
    ["nan", "inf", "-inf", "-0", "0", "-1", "1e308", "-1e308", "5e-324", "1e400", "", " ", "1,2", "0x10"];

/// Flags of each command that take a number or several, with what they need beside them.
const NUMERIC: &[(&str, &[&str])] = &[
    (
        "render MESH --size=24x24 -o v.png",
        &[
            "--fov",
            "--eye",
            "--target",
            "--up",
            "--size",
            "--samples",
            "--light-spacing",
            "--light-width",
            "--light-size",
            "--light-center",
            "--light-normal",
            "--light-lines",
            "--frames",
            "--orbit",
            "--sweep-light",
            "--proxy-level",
            "--height",
            "--enlarge",
            "--patches",
            "--range",
        ],
    ),
    ("render MESH --size=24x24 -o v.png --projection orthographic", &["--height", "--eye", "--target", "--up"]),
    ("render MESH --size=24x24 -o v.png --frames 2", &["--orbit", "--sweep-light"]),
    ("render MESH --size=24x24 -o v.png --field curvature:mean", &["--range", "--light-spacing"]),
    ("lines MESH -o l.json", &["--count", "--values", "--tolerance", "--eye", "--light-spacing", "--size"]),
    ("quality MESH", &["--size", "--eye", "--gap", "--angle", "--curvature", "--weld", "--top"]),
    ("verify MESH --size=16x16", &["--size", "--only", "--plant"]),
    ("glints MESH --eye=3.5,-2.5,4", &["--light-point"]),
    ("glints MESH --light-point=1,4,5", &["--eye", "--eye-direction"]),
    ("info MESH", &["--levels"]),
];

/// Whatever the number: it is done, or refused in one line; nothing panics, nothing takes for ever.
#[test]
fn numbers_that_are_none() {
    let folder = Folder::new();
    let cube = mesh("cube");
    let (mut done, mut refused) = (0, 0);
    for (line, flags) in NUMERIC {
        let words: Vec<String> = line.split(' ').map(|word| word.replace("MESH", &cube)).collect();
        for flag in *flags {
            for number in NUMBERS {
                let triple = format!("{number},{number},1");
                let values = [number, triple.as_str()];
                for value in values.into_iter().take(if number.is_empty() { 1 } else { 2 }) {
                    let last = format!("{flag}={value}");
                    let args: Vec<&str> = words.iter().map(String::as_str).chain([last.as_str()]).collect();
                    let output = folder.run(&args);
                    let message = String::from_utf8_lossy(&output.stderr);
                    match output.status.code() {
                        Some(0 | 1) => done += 1,
                        Some(2) => {
                            assert_eq!(message.lines().count(), 1, "{args:?}: {message}");
                            refused += 1;
                        }
                        code => panic!("{args:?}: exit code {code:?}: {message}"),
                    }
                    assert!(!message.contains("panicked"), "{args:?}: {message}");
                }
            }
        }
    }
    println!("{done} done, {refused} refused");
    assert!(done > 20 && refused > 500, "{done} done, {refused} refused");
}

/// Names that are no text, have line breaks, look like flags, or are folders.
#[test]
fn names_that_are_odd() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.obj")).expect("a folder");
    std::fs::create_dir(folder.path("folder.usda")).expect("a folder");
    let cube = std::fs::read(mesh("cube")).expect("a mesh");
    for name in ["two\nlines.obj", "-o.obj", "\u{2028}.obj", "a b'c\"d.obj", "caf\u{e9}.obj", "%d.obj", "[a].obj"] {
        folder.write(name, &cube);
        let output = folder.run(&["info", "--", name]);
        assert!(output.status.success(), "{name:?}: {}", String::from_utf8_lossy(&output.stderr));
        folder.write(name, "v 0 0 0\nf 1 2 3\n");
        let message = folder.refused(&["info", "--", name]);
        assert!(message.contains(":2: "), "{message}");
    }
    for name in ["folder.obj", "folder.usda", ".", "/", "", "folder.obj/x.obj", "no-such.obj", "/dev/null"] {
        let message = folder.refused(&["info", "--", name]);
        assert!(message.len() > "catoptric: ".len() + 10, "{message}");
    }
}

#[cfg(unix)]
#[test]
fn names_that_are_not_text() {
    use std::os::unix::ffi::OsStringExt;
    let folder = Folder::new();
    let name = OsString::from_vec(b"m\xff.obj".to_vec());
    std::fs::copy(mesh("cube"), folder.0.path().join(&name)).expect("a writable folder");
    let run = |args: &[&str]| {
        let args = args.iter().map(OsString::from).chain([name.clone()]);
        let mut command = folder.command(&[]);
        command.args(args).output().expect("the program starts")
    };
    for args in [&["info"][..], &["render", "--size=16x16", "-o", "v.png"], &["render", "--size=16x16", "-o", "v.exr"]]
    {
        let output = run(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let out = OsString::from_vec(b"v\xff.png".to_vec());
    let mut command = folder.command(&["render", &mesh("cube"), "--size=16x16", "-o"]);
    let output = command.arg(&out).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(folder.0.path().join(&out).exists());
}
