//! Files and folders that are not there, or are something else: the line says which, whatever their extension.

use super::{Folder, mesh};

#[test]
fn what_is_missing_is_said() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder")).expect("a writable folder");
    std::fs::copy(mesh("cube"), folder.path("cube.obj")).expect("a writable folder");
    folder.file("notes.txt", "no mesh");
    folder.file("samples.csv", "face,u,v\n0,0.5,0.5\n");
    #[cfg(unix)]
    std::os::unix::fs::symlink("nowhere.obj", folder.path("link.obj")).expect("a writable folder");
    for (args, line) in [
        ("verify none/", "none/: no such folder; check the path"),
        ("verify none", "none: no such file or folder; check the path"),
        ("verify none/*.obj", "none/*.obj: the folder none does not exist; check the path"),
        ("render none.xyz", "none.xyz: no such file; check the path"),
        ("info none.usda", "none.usda: no such file; check the path"),
        ("render none/cube.obj", "none/cube.obj: no such file: the folder none does not exist; check the path"),
        ("render cube.obj/x.obj", "cube.obj/x.obj: no such file: cube.obj is a file, not a folder; check the path"),
        #[cfg(unix)]
        ("render link.obj", "link.obj: it is a link that leads nowhere; check the path"),
        ("render folder", "folder: it is a folder, and one mesh is wanted; name a file in it"),
        (
            "render notes.txt",
            "notes.txt: only .obj, .usd, .usda, .usdc and .usdz are read, also with .gz behind; export the mesh as one of these",
        ),
        ("eval none.xyz --samples samples.csv", "none.xyz: no such file; check the path"),
        (
            "eval cube.obj --samples none.csv",
            "none.csv: cannot read the samples: no such file; give a CSV file with the header face,u,v",
        ),
        (
            "eval cube.obj --samples folder",
            "folder: cannot read the samples: it is a folder, where a file is wanted; give a CSV file",
        ),
        (
            "render cube.obj --rig none.toml",
            "none.toml: cannot read the light rig: no such file; give a TOML or JSON file",
        ),
        ("render cube.obj --rig folder", "--rig folder: it is a folder; name a file in it"),
        ("render cube.obj --pattern none.png", "none.png: cannot read the pattern: no such file; give stripes,"),
        (
            "render cube.obj --field curve:none.png",
            "none.png: cannot read the grid: no such file; give a gray PNG file",
        ),
        ("verify cube.obj --baseline none.json", "none.json: cannot be read: no such file; give an earlier report"),
        (
            "verify cube.obj --baseline folder",
            "folder: cannot be read: it is a folder, where a file is wanted; give an earlier report",
        ),
        ("verify cube.obj --results none.csv", "none.csv: cannot read the answers: no such file; give a CSV file"),
        (
            "render cube.obj -o none/x.png",
            "none/x.png: cannot write: the folder none does not exist; choose a writable path",
        ),
        (
            "render cube.obj -o cube.obj/x.png",
            "cube.obj/x.png: cannot write: cube.obj is a file, not a folder; choose a writable path",
        ),
        ("render cube.obj -o folder", "folder: it is a folder; name a file in it, such as folder/view.png"),
        ("lines cube.obj -o folder", "folder: it is a folder; name a file in it, such as folder/view.svg"),
        ("verify cube.obj --json folder", "folder: cannot write: it is a folder; choose a writable path"),
    ] {
        let words: Vec<&str> = args.split_whitespace().collect();
        let message = folder.refused(&words);
        assert!(message.contains(&format!("catoptric: {line}")) || message.contains(line), "{args}: {message}");
    }
}
