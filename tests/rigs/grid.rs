//! Grid pictures as light curves: what they draw and trace is what closed forms say.

use super::{Folder, flags, mesh};

const SIDE: u32 = 96;

/// A gray picture of 16 bits, by its texels' places from the middle, in texels, y up.
fn write_grid(folder: &Folder, name: &str, value: impl Fn(i64, i64) -> i64) {
    let place = |k: u32| 2 * i64::from(k) - i64::from(SIDE - 1);
    let texel = |x: u32, y: u32| image::Luma([u16::try_from(value(place(x), -place(y))).expect("16 bits")]);
    image::ImageBuffer::<image::Luma<u16>, Vec<u16>>::from_fn(SIDE, SIDE, texel).save(folder.path(name)).expect("it");
}

/// Two families are the same curves: both are within the tolerance, 1e-4 of the diagonal (some 4), of them.
fn assert_same(ours: &[serde_json::Value], theirs: &[serde_json::Value]) {
    let (a, b) = (points(ours), points(theirs));
    assert!(a.len() > 100 && b.len() > 100, "{} {}", a.len(), b.len());
    for (points, curves) in [(&a, theirs), (&b, ours)] {
        let off = farthest(points, curves);
        assert!(off < 1e-3, "{off}");
    }
}

fn curves(folder: &Folder, args: &[&str]) -> Vec<serde_json::Value> {
    let mesh = mesh();
    folder.done(&[&["lines", &mesh, "--size=64x64", "-o", "a.json"], args].concat());
    let json: serde_json::Value = serde_json::from_str(&folder.text("a.json")).expect("JSON");
    json["curves"].as_array().expect("curves").clone()
}

fn points(curves: &[serde_json::Value]) -> Vec<[f64; 3]> {
    let all = curves.iter().flat_map(|curve| curve["points"].as_array().expect("points").clone());
    all.map(|point| serde_json::from_value(point).expect("three numbers")).collect()
}

/// Distance of points from the chords of curves.
fn farthest(points: &[[f64; 3]], curves: &[serde_json::Value]) -> f64 {
    use glam::DVec3;
    let line = |curve: &serde_json::Value| {
        let mut line: Vec<DVec3> = self::points(std::slice::from_ref(curve)).into_iter().map(DVec3::from).collect();
        line.extend(line.first().copied().filter(|_| curve["closed"] == true));
        line
    };
    let lines: Vec<Vec<DVec3>> = curves.iter().map(line).collect();
    let off = |p: DVec3| {
        let chords = lines.iter().flat_map(|line| line.windows(2));
        let distance = |ends: &[DVec3]| {
            let along = ends[1] - ends[0];
            let t = ((p - ends[0]).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            p.distance(ends[0] + along * t)
        };
        chords.map(distance).fold(f64::INFINITY, f64::min)
    };
    points.iter().map(|&p| off(DVec3::from(p))).fold(0.0, f64::max)
}

const LIGHT: [&str; 4] =
    ["--light-center=0.3,0.2,9", "--light-normal=0.1,0.1,-1", "--light-lines=0.2,1,0", "--eye=4,-5,4"];

/// Control values on a plane make a plane: its contours are reflection lines.
#[test]
fn ramps_make_reflection_lines() {
    let folder = Folder::new();
    // 480 world units wide, 5 a texel, of which all but a margin of 1.5 texels counts: g = (32768 + 300 x 2 / 5) / 65535.
    write_grid(&folder, "ramp.png", |x, _| 32_768 + 300 * x);
    let world = [-6.0, -2.0, 0.0, 3.0, 7.0];
    let g = world.map(|x: f64| ((32_768.0 + 600.0 * x / 5.0) / 65_535.0).to_string()).join(",");
    let values = world.map(|x| x.to_string()).join(",");
    let ours = curves(&folder, &[&LIGHT[..], &["--field=curve:ramp.png=480", &format!("--values={g}")]].concat());
    let theirs = curves(&folder, &[&LIGHT[..], &["--light-size=465,465", &format!("--values={values}")]].concat());
    assert_same(&ours, &theirs);
}

/// Squares of distances make circles: those of `curve:circle`, in lines and in pictures.
#[test]
fn bowls_make_circles() {
    let folder = Folder::new();
    // Places are in half texels: 16-bit values of (x^2 + y^2) 3 / 4, texels a quarter world unit apart.
    write_grid(&folder, "bowl.png", |x, y| 3 * (x * x + y * y));
    let radii = [2.0, 4.0, 6.0, 9.0];
    // The spline adds a third of the squared pitch each way to x^2 + y^2.
    let g = |r: f64| 12.0 * ((r / 0.25).powi(2) + 2.0 / 3.0) / 65_535.0;
    let list = |of: &dyn Fn(f64) -> f64| radii.map(|r| of(r).to_string()).join(",");
    let ours =
        curves(&folder, &[&LIGHT[..], &["--field=curve:bowl.png=24", &format!("--values={}", list(&g))]].concat());
    let theirs =
        curves(&folder, &[&LIGHT[..], &["--field=curve:circle", &format!("--values={}", list(&|r| r))]].concat());
    assert_same(&ours, &theirs);
}

/// A width is fitted where none is given, recorded with the rest, and digests tell grids apart.
#[test]
fn grids_are_fitted_and_recorded() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("rigs")).expect("a writable folder");
    write_grid(&folder, "rigs/bowl.png", |x, y| 3 * (x * x + y * y));
    let first = folder.drawn(&["--field=curve:rigs/bowl.png", "--save-rig=rigs/saved.toml"]);
    let made_by = folder.made_by("view.png");
    let recorded = flags(&made_by);
    let field = recorded.iter().find(|flag| flag.starts_with("--field=curve:bowl.png=")).expect("without its folder");
    let width: f64 = field.rsplit_once('=').expect("a width").1.parse().expect("a number");
    assert!(width > 0.0 && made_by.contains(", field "), "{made_by}");
    assert!(folder.text("rigs/saved.toml").contains("field = \"curve:bowl.png="), "{}", folder.text("rigs/saved.toml"));
    assert!(folder.drawn(&["--rig=rigs/saved.toml"]) == first);
    std::fs::copy(folder.path("rigs/bowl.png"), folder.path("bowl.png")).expect("a copy");
    assert!(folder.drawn(&recorded.iter().map(String::as_str).collect::<Vec<_>>()) == first);
    write_grid(&folder, "bowl.png", |x, y| 3 * (x * x + y * y) + 1);
    folder.drawn(&recorded.iter().map(String::as_str).collect::<Vec<_>>());
    assert_ne!(folder.made_by("view.png"), made_by);
}

#[test]
fn bad_grids_are_refused() {
    let folder = Folder::new();
    image::GrayImage::new(3, 9).save(folder.path("thin.png")).expect("it");
    folder.write("text.png", "no picture");
    folder.write("rig.toml", "\nfield = \"curve:nothing.png\"");
    for (args, expected) in [
        (&["--field=curve:nothing.png"][..], "nothing.png: cannot read the grid"),
        (&["--field=curve:text.png"], "text.png: not a picture"),
        (&["--field=curve:thin.png"], "3x9 texels"),
        (&["--field=curve:thin.png=0"], "a number above 0"),
        (&["--rig=rig.toml"], "rig.toml:2: "),
    ] {
        let mesh = mesh();
        let message = folder.refused(&[&["render", &mesh, "-o", "v.png"], args].concat());
        assert!(message.contains(expected), "{args:?}: {message}");
    }
}
