//! What files say, and who wins.

use super::{Folder, flags, mesh};
use catoptric::rig::{Preset, Rig, RigFormat};
use std::path::Path;

/// The example of docs/RIGS.md is read as it stands there, both ways of writing it.
#[test]
fn the_documented_example_is_a_rig() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/RIGS.md");
    let docs = std::fs::read_to_string(docs).expect("the documentation");
    let (_, rest) = docs.split_once("```toml\n").expect("an example");
    let (toml, rest) = rest.split_once("```").expect("its end");
    let (_, rest) = rest.split_once("```json\n").expect("the same as JSON");
    let (json, _) = rest.split_once("```").expect("its end");
    let folder = Folder::new();
    folder.write("a.toml", toml);
    folder.write("a.json", json);
    let [a, b] = ["a.toml", "a.json"].map(|name| Rig::read(&folder.path(name)).expect("it is a rig"));
    assert_eq!(a, b);
    // It says all there is to say.
    let whole = a.camera.eye.is_some() && a.camera.target.is_some() && a.camera.up.is_some() && a.camera.fov.is_some();
    let light = &a.light;
    let lit = light.center.is_some() && light.normal.is_some() && light.lines.is_some() && light.size.is_some();
    assert!(whole && lit && light.spacing.is_some() && light.attached.is_some() && a.colours.bottom.is_some());
    folder.drawn(&["--rig", "a.toml"]);
}

/// Flags win over the file, the file over its preset, and all of them over what is fitted.
#[test]
fn flags_win_over_files_and_files_over_presets() {
    let folder = Folder::new();
    folder.write("rig.toml", "preset = \"zebra\"\n[light]\nspacing = 5\n[colours]\npaint = \"#204060\"");
    let said = |args: &[&str]| {
        folder.drawn(args);
        flags(&folder.made_by("view.png"))
    };
    let has = |flags: &[String], flag: &str| flags.iter().any(|one| one == flag);
    let zebra = said(&["--rig", "zebra"]);
    assert!(has(&zebra, "--light-spacing=8") && has(&zebra, "--light-width=0.5"), "{zebra:?}");
    let file = said(&["--rig", "rig.toml"]);
    assert!(has(&file, "--light-spacing=5") && has(&file, "--paint=#204060"), "{file:?}");
    assert!(has(&file, "--light-width=0.5") && has(&file, "--light-colour=#ffffff"), "{file:?}");
    let flags = said(&["--rig", "rig.toml", "--light-spacing", "3", "--pattern", "lattice", "--paint", "#000000"]);
    assert!(has(&flags, "--light-spacing=3") && has(&flags, "--paint=#000000"), "{flags:?}");
    // Another pattern has its own usual width.
    assert!(has(&flags, "--pattern=lattice") && has(&flags, "--light-width=0.2"), "{flags:?}");
    // Degrees are nothing to a field of lengths.
    let other = said(&["--rig", "zebra", "--field", "section"]);
    assert!(!has(&other, "--light-spacing=8") && has(&other, "--field=section"), "{other:?}");

    folder.write("flat.json", "{\"camera\": {\"projection\": \"orthographic\", \"height\": 3, \"size\": [50, 40]}}");
    let flat = said(&["--rig", "flat.json"]);
    assert!(has(&flat, "--height=3") && has(&flat, "--size=96x80"), "{flat:?}");
    let perspective = said(&["--rig", "flat.json", "--projection", "perspective"]);
    assert!(has(&perspective, "--fov=26"), "{perspective:?}");
    folder.done(&["render", &mesh(), "--rig", "flat.json", "-o", "small.png"]);
    assert_eq!(image::open(folder.path("small.png")).expect("a picture").to_rgba8().dimensions(), (50, 40));
}

/// A picture is looked for beside the file that names it, and named so that it is found again.
#[test]
fn pictures_are_beside_their_rig() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("rigs")).expect("a writable folder");
    image::RgbaImage::from_pixel(2, 2, image::Rgba([0, 90, 255, 255])).save(folder.path("rigs/blue.png")).expect("it");
    folder.write("rigs/blue.toml", "[pattern]\nname = \"blue.png\"");
    let first = folder.drawn(&["--rig", "rigs/blue.toml", "--save-rig", "rigs/saved.toml"]);
    assert!(folder.text("rigs/saved.toml").contains("name = \"blue.png\""), "{}", folder.text("rigs/saved.toml"));
    assert!(folder.drawn(&["--rig", "rigs/saved.toml"]) == first);
    assert!(folder.drawn(&["--rig", "rigs/blue.toml", "--save-rig", "elsewhere.json"]) == first);
    assert!(folder.drawn(&["--rig", "elsewhere.json"]) == first);
}

/// As a library: what is written is read again, the same.
#[test]
fn rigs_survive_both_formats() {
    let folder = Folder::new();
    let text = "preset = \"tunnel\"\nfield = \"curve:x^2 - y\"\n[camera]\neye = [0.1, -2e-17, 3]\n[pattern]\nname = \"heat\"\n\
                range = [-1.5, 2]\n[colours]\ntop = [0.1, 0.2, 0.7]\nlight = \"#ff8800\"\n";
    folder.write("a.toml", text);
    let rig = Rig::read(&folder.path("a.toml")).expect("it is a rig");
    assert_eq!(rig.preset, Some(Preset::Tunnel));
    for (format, name) in [(RigFormat::Toml, "b.toml"), (RigFormat::Json, "b.json")] {
        folder.write(name, &rig.write(format, &folder.path("")).expect("it is written"));
        assert_eq!(Rig::read(&folder.path(name)).expect("it is a rig"), rig, "{}", folder.text(name));
    }
}
