//! No output replaces another one, or what is read, however it is spelled.

use super::Folder;

#[test]
fn outputs_that_meet_are_refused() {
    let folder = Folder::new();
    std::fs::copy(super::mesh(), folder.path("mesh.obj")).expect("it is copied");
    std::fs::create_dir(folder.path("sub")).expect("a writable folder");
    let png = [[0u8, 80, 160, 240]; 4].concat();
    let png = image::GrayImage::from_raw(4, 4, png).expect("a picture");
    png.save(folder.path("gray.png")).expect("a writable folder");
    folder.write("rig.toml", "[light]\nspacing = 1");
    for (command, args, expected) in [
        ("render", "-o z.png --json ./z.png", "--json would overwrite the picture"),
        ("render", "-o sub/../z.png --json sub/.././z.png", "--json would overwrite the picture"),
        ("render", "-o z.png --json a.json --save-rig sub/../a.json", "--save-rig would overwrite the certificates"),
        ("render", "--frames 2 --orbit 90 -o z#.png --json sub/../z2.png", "--json would overwrite the picture"),
        ("render", "-o z.png --json ./mesh.obj", "--json would overwrite the mesh"),
        ("render", "-o sub/../gray.png --pattern gray.png", "-o would overwrite the pattern"),
        ("render", "-o ./gray.png --field curve:gray.png", "-o would overwrite the field"),
        ("render", "-o z.png --rig rig.toml --json sub/../rig.toml", "--json would overwrite the light rig"),
        ("render", "-o z.png --rig rig.toml --save-rig ./rig.toml", "--save-rig would overwrite the light rig"),
        ("lines", "-o ./mesh.obj", "-o would overwrite the mesh"),
        ("lines", "-o a.json --save-rig ./a.json", "--save-rig would overwrite the curves"),
        ("quality", "-o z.png --json ./z.png", "--json would overwrite the picture"),
        ("quality", "--json a.json --save-rig sub/../a.json", "--save-rig would overwrite the measurements"),
        ("quality", "--json sub/../mesh.obj", "--json would overwrite the mesh"),
    ] {
        let args: Vec<&str> = [command, "mesh.obj"].into_iter().chain(args.split(' ')).collect();
        let message = folder.refused(&args);
        assert!(message.contains(expected), "{args:?}: {message}");
    }
}

/// A link is replaced, what it leads to is not; a mesh that is read through one would be.
#[cfg(unix)]
#[test]
fn links_are_followed_where_files_are_read() {
    let folder = Folder::new();
    std::fs::copy(super::mesh(), folder.path("mesh.obj")).expect("it is copied");
    std::os::unix::fs::symlink("mesh.obj", folder.path("link.obj")).expect("a link");
    let message = folder.refused(&["lines", "link.obj", "-o", "mesh.obj"]);
    assert!(message.contains("-o would overwrite the mesh"), "{message}");
    let message = folder.refused(&["lines", "link.obj", "-o", "./link.obj"]);
    assert!(message.contains("-o would overwrite the mesh"), "{message}");
}
