//! Torn and degenerate meshes, changed at random: every answer is an error in one line, or finite.

use catoptric::curves;
use catoptric::field::{Method, Scout};
use catoptric::gpu::{Gpu, View};
use catoptric::mesh;
use catoptric::quality::{Limits, Quality, Reading};
use catoptric::stam::LimitSurface;
use glam::DVec3;
use std::path::Path;

use crate::rng::Rng;

const COPIES: u64 = 100;

/// One change of a text: a number, a byte, or a line.
fn change(text: &mut Vec<u8>, rng: &mut Rng) {
    const NUMBERS: [&str; 12] =
        ["0", "1", "-1", "2", "1e18", "-1e18", "1e-30", "5e-324", "nan", "0.05", "1.0000001", "8"];
    let mut lines: Vec<String> = String::from_utf8_lossy(text).lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return;
    }
    let line = rng.below(lines.len());
    match rng.below(6) {
        0..3 => {
            let mut words: Vec<&str> = lines[line].split(' ').collect();
            let word = rng.below(words.len());
            words[word] = NUMBERS[rng.below(NUMBERS.len())];
            lines[line] = words.join(" ");
        }
        3 => {
            let copy = lines[rng.below(lines.len())].clone();
            lines[line] = copy;
        }
        4 => {
            lines.remove(line);
        }
        _ => {
            let mut words: Vec<&str> = lines[line].split(' ').collect();
            words[1..].reverse();
            lines[line] = words.join(" ");
        }
    }
    *text = (lines.join("\n") + "\n").into_bytes();
}

/// What a mesh gives to `quality`, `lines` and `render`. Whether there was a surface.
fn run(gpu: &Gpu, text: &[u8], weld: Option<f64>) -> bool {
    let mesh = match mesh::parse_obj(text, "mutated") {
        Ok(mesh) => mesh,
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
            return false;
        }
    };
    let orientation = mesh.orientation();
    assert!(orientation.reversed.len() * 2 <= mesh.face_count());
    let surface = LimitSurface::new(&mesh).expect("a valid mesh has a surface");
    let Some(scout) = Scout::new(&surface) else { return false };
    let camera = scout.camera([64, 64], DVec3::Z);
    let field = scout.field(&Method::Reflection, &camera);
    let limits = Limits { weld, ..Limits::default() };
    let quality = Quality::measure(&mesh, &surface, Some(Reading { field: &field, camera: &camera }), &limits);
    for ranked in quality.ranked(&limits) {
        assert!(!ranked.severity().is_nan(), "{ranked:?}");
        assert!(ranked.spot().is_some_and(|(_, position)| position.is_finite()));
    }
    for feature in &quality.features {
        assert!(feature.extremes.gap.is_finite() && !feature.extremes.angle_deg.is_some_and(f64::is_nan));
    }
    assert!(quality.unwelded.is_none_or(|unwelded| unwelded.count > 0 && unwelded.distance.is_finite()));
    assert!(quality.nearby.is_none_or(|nearby| nearby.distance.is_finite() && nearby.distance > quality.weld));
    if scout.without_area().is_none() {
        let values: Vec<(i32, f64)> = (-3..=3).map(|k| (k, f64::from(k) * field.light.spacing)).collect();
        let tolerance = (1e-4 * surface.diagonal()).max(f64::MIN_POSITIVE);
        for curve in curves::trace(&surface, &field, &camera, &values, tolerance) {
            assert!(curve.points.iter().all(|point| point.is_finite()));
        }
    }
    let tables = gpu.upload(&surface).expect("tables");
    let view = View { field: field.clone(), samples: 1, ..View::new(camera, field.light) };
    let frame = gpu.render_linear(&tables, &view).expect("a picture");
    assert!(frame.rgba.as_flattened().iter().all(|x| x.is_finite()));
    true
}

#[test]
fn a_hundred_copies_of_each_torn_mesh() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter");
    for (seed, name) in (1..).zip(["gap_strip", "all_points_equal", "one_face_flipped"]) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/torn").join(name).with_extension("obj");
        let text = std::fs::read(&path).expect("a test mesh");
        assert!(run(&gpu, &text, None), "{name}");
        let mut rng = Rng::new(seed);
        let mut with_surface = 0;
        for copy in 0..COPIES {
            let mut changed = text.clone();
            for _ in 0..1 + rng.below(3) {
                change(&mut changed, &mut rng);
            }
            // A panic names the copy.
            println!("{name}, copy {copy}:\n{}", String::from_utf8_lossy(&changed));
            with_surface += u32::from(run(&gpu, &changed, [None, Some(0.1), Some(1e18)][copy as usize % 3]));
        }
        println!("{name}: {with_surface} of {COPIES} have a surface");
        assert!(with_surface >= 20, "{name}: {with_surface}");
    }
}
