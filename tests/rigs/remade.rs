//! What files say of themselves makes them again, bit for bit, and so does the rig that is saved beside them.

use super::{Folder, flags, mesh};

/// A red and a green half.
fn write_picture(folder: &Folder, name: &str) {
    let colour = |x: u32| if x < 2 { image::Rgba([255, 0, 0, 255]) } else { image::Rgba([0, 200, 0, 255]) };
    image::RgbaImage::from_fn(4, 2, |x, _| colour(x)).save(folder.path(name)).expect("a writable folder");
}

const CASES: [&[&str]; 12] = [
    &[],
    &["--rig", "tunnel"],
    &["--rig", "showroom"],
    &["--rig", "zebra", "--paint", "0.1,0.2,0.3"],
    &["--rig", "lattice", "--light-attached", "camera"],
    &["--rig", "circles", "--projection", "orthographic", "--light-attached", "camera"],
    &["--rig", "highlight", "--background-top", "#102030", "--background-bottom", "#ffffff"],
    &["--light-attached", "camera", "--light-center", "1,2,-3", "--light-spacing", "0.37"],
    &[
        "--light-normal",
        "0.1,0.7,0.3",
        "--light-lines",
        "1,1,0.3",
        "--light-size",
        "3.3,4.7",
        "--light-colour",
        "#ffcc88",
    ],
    &["--field", "curvature:gaussian"],
    &["--field", "curve:x^2 - y^2", "--pattern", "band", "--light-width", "0.3"],
    &["--pattern", "halves.png", "--eye", "3.1,-4.7,2.3"],
];

#[test]
fn the_recorded_command_makes_the_picture_again() {
    let folder = Folder::new();
    write_picture(&folder, "halves.png");
    for case in CASES {
        let first = folder.drawn(case);
        let made_by = folder.made_by("view.png");
        let flags = flags(&made_by);
        let again = folder.drawn(&flags.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(first == again, "{made_by} draws another picture");
        // It says the same of itself: nothing drifts.
        assert_eq!(folder.made_by("view.png"), made_by);
    }
}

#[test]
fn the_saved_rig_makes_the_picture_again() {
    let folder = Folder::new();
    write_picture(&folder, "halves.png");
    for (i, case) in CASES.into_iter().enumerate() {
        let first = folder.drawn(&[case, &["--save-rig", "a.toml"]].concat());
        let made_by = folder.made_by("view.png");
        folder.drawn(&[case, &["--save-rig", "a.json"]].concat());
        for name in ["a.toml", "a.json"] {
            // Size and all.
            let output = format!("again{i}.png");
            folder.done(&["render", &mesh(), "--rig", name, "-o", &output, "--save-rig", "b.toml"]);
            assert!(first == folder.pixels(&output), "{case:?}: {name} draws another picture");
            assert_eq!(folder.made_by(&output), made_by);
            assert_eq!(folder.text("b.toml"), folder.text("a.toml"), "{case:?}");
        }
    }
}

/// Curves and all that is beside them, to the byte; a rig that was saved by one command is read by the other.
#[test]
fn lines_are_made_again_too() {
    let folder = Folder::new();
    let mesh = mesh();
    for case in [
        &["--rig", "tunnel"][..],
        &["--rig", "showroom"],
        &["--rig", "highlight", "--light-attached", "camera"],
        &["--rig", "zebra", "--light-size", "120,60"],
        &["--light-attached", "camera", "--count", "9"],
    ] {
        folder.done(&[&["lines", &mesh, "--size", "200x150", "-o", "a.json", "--save-rig", "r.toml"], case].concat());
        let first = folder.text("a.json");
        let json: serde_json::Value = serde_json::from_str(&first).expect("JSON");
        let curves = json["curves"].as_array().expect("curves").len();
        assert!(curves > 0, "{case:?} has no line");
        let flags = flags(json["made_by"].as_str().expect("a text"));
        let mut again = vec!["lines", &mesh, "-o", "a.json"];
        again.extend(flags.iter().map(String::as_str));
        folder.done(&again);
        assert!(folder.text("a.json") == first, "{again:?}");
        // Which lines there are is no part of a rig.
        if !case.contains(&"--count") {
            folder.done(&["lines", &mesh, "-o", "b.json", "--rig", "r.toml"]);
            assert!(folder.text("b.json") == first, "{case:?}");
            folder.done(&["render", &mesh, "-o", "b.png", "--rig", "r.toml"]);
        }
    }
}

/// A frame of a series alone, wherever the light is attached.
#[test]
fn any_frame_is_drawn_again_alone() {
    let folder = Folder::new();
    for series in [&["--orbit", "100"][..], &["--orbit=-360", "--light-attached=camera"], &["--sweep-light=0.7"]] {
        let mesh = mesh();
        let mut args = vec!["render", &mesh, "--rig=showroom", "--frames=3", "--size=64x48", "-o", "f.png"];
        args.extend(series);
        folder.done(&args);
        for frame in ["f_0001.png", "f_0002.png", "f_0003.png"] {
            let flags = flags(&folder.made_by(frame));
            let mut args = vec!["render", &mesh, "-o", "again.png"];
            args.extend(flags.iter().map(String::as_str));
            folder.done(&args);
            assert!(folder.pixels("again.png") == folder.pixels(frame), "{series:?} {frame}");
        }
    }
}

/// EXR pictures say the same as PNG pictures.
#[test]
fn exr_pictures_say_so_too() {
    let folder = Folder::new();
    let mesh = mesh();
    let flags = ["--rig=tunnel", "--paint=#123456", "--light-attached=camera", "--size=48x40"];
    let said = ["v.png", "v.exr"].map(|name| {
        folder.done(&[&["render", &mesh, "-o", name][..], &flags].concat());
        let file = std::io::BufReader::new(std::fs::File::open(folder.path(name)).expect(name));
        match name {
            "v.png" => catoptric::output::read_png_made_by(file),
            _ => catoptric::output::read_exr_made_by(file),
        }
    });
    let [png, exr] = said.map(|said| said.expect("it is whole").expect("it says so"));
    assert_eq!(png, exr);
    assert!(exr.contains(" '--paint=#123456' ") && exr.contains(" --light-attached=camera "), "{exr}");
}

/// Another picture of the same name is not the same pattern.
#[test]
fn patterns_are_told_apart() {
    let folder = Folder::new();
    write_picture(&folder, "halves.png");
    folder.drawn(&["--pattern", "halves.png"]);
    let first = folder.made_by("view.png");
    image::RgbaImage::new(4, 2).save(folder.path("halves.png")).expect("a writable folder");
    folder.drawn(&["--pattern", "halves.png"]);
    let second = folder.made_by("view.png");
    let digest = |text: &str| text.split_once(", pattern ").expect("a digest").1.to_owned();
    assert_ne!(digest(&first), digest(&second));
    assert_eq!(flags(&first), flags(&second));
}
