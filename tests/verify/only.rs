//! One point as every evaluator sees it.

use super::{folder, gpu, json, own, run, text};
use catoptric::mesh;
use catoptric::stam::LimitSurface;
use catoptric::verify::{Only, Plant, Sample, Settings, only};

fn planted(plant: Plant) -> Settings {
    Settings { plant: Some(plant), ..Settings::default() }
}

/// Largest difference of a control point's weights in position and, over `scale`, in the derivatives.
fn weights_off(shown: &Only, scale: f64) -> f64 {
    let off = shown.control_points.iter().map(|point| {
        let ours = point.ours.expect("no hole");
        (0..3).map(|k| (ours[k] - point.stencil[k]).abs() / if k == 0 { 1.0 } else { scale }).fold(0.0, f64::max)
    });
    off.fold(0.0, f64::max)
}

#[test]
fn our_weights_are_those_of_the_limit_stencils() {
    let meshes = ["n_gons", "dart_5", "crease_2_7", "boundary_pole_3", "chaikin_crossing", "pole_12"].map(own);
    for mesh in meshes.iter().chain([&mesh::sample()]) {
        let surface = LimitSurface::new(mesh).expect("the mesh is valid");
        for face in (0..surface.ptex_count() as u32).step_by(surface.ptex_count().div_ceil(6)) {
            let sample = Sample { face, u: 0.31, v: 0.77 };
            let shown = only(mesh, None, sample, &Settings::default()).expect("it is shown");
            let Some(patch) = &shown.patch else { continue };
            // Weights are a few sums of numbers below 1; derivatives are over the side of the patch.
            let side = f64::from(1u32 << patch.depth[0].max(patch.depth[1]));
            let off = weights_off(&shown, side);
            assert!(off < 100.0 * f64::EPSILON, "{} {face}: {off:e}", mesh.name);
            assert!(shown.weights_miss.expect("no hole") < 100.0 * f64::EPSILON, "{} {face}", mesh.name);
            let stencil = &shown.evaluations[1];
            assert!(stencil.evaluator.starts_with("limit stencils") && stencil.position_off < Some(1e-14));
        }
    }
}

#[test]
fn the_control_point_that_disagrees_is_seen() {
    let mesh = own("pole_5");
    let sample = Sample { face: 3, u: 0.25, v: 0.5 };
    // A moved point: the weights agree, and the points do not make our position.
    let plant = Plant::Point { patch: 3, point: None };
    let moved = only(&mesh, Some(&gpu()), sample, &planted(plant)).expect("it is shown");
    assert!(weights_off(&moved, 1.0) < 1e-14 && moved.weights_miss > Some(1e-8), "{moved}");
    let shader = moved.evaluations.last().expect("several");
    assert!(shader.evaluator.contains("shader") && shader.position_off < Some(2e-6), "{moved}");
    // A limit mask lies at vertices, of level 2 here.
    assert!(moved.evaluations.iter().any(|e| e.evaluator == "limit mask" && e.position_off > Some(1e-8)));
    // A wrong rule: the weights disagree.
    let creased = own("infinitely_sharp_crease");
    let [a, _] = creased.creases[0].vertices;
    let face = creased.faces().position(|(_, face)| face.contains(&a)).expect("it has a face") as u32;
    let sample = Sample { face, u: 0.4, v: 0.6 };
    let wrong = only(&creased, None, sample, &planted(Plant::Crease(0))).expect("it is shown");
    assert!(weights_off(&wrong, 1.0) > 1e-4 && wrong.weights_miss < Some(1e-14), "{wrong}");
}

#[test]
fn the_command_shows_a_point_and_refuses_what_is_none() {
    let folder = folder(&["hole", "cube"]);
    let shown = run(folder.path(), &["cube.obj", "--only", "2,0.25,1", "--json", "only.json"]);
    assert!(shown.status.success());
    let stdout = text(&shown.stdout);
    for part in [
        "limit stencils level 10 (exact)",
        "Far level 10",
        "Bfr 2/6 (end cap)",
        "limit mask (exact)",
        "control points:",
    ] {
        assert!(stdout.contains(part), "{part}: {stdout}");
    }
    let report = json(&folder.path().join("only.json"));
    assert_eq!(report["sample"], serde_json::json!({"face": 2, "u": 0.25, "v": 1.0}));
    assert_eq!(report["control_points"].as_array().map(Vec::len), Some(8));
    // A hole has no answer, on either side.
    let surface = LimitSurface::new(&own("hole")).expect("the mesh is valid");
    let hole = (0..surface.ptex_count() as u32).find(|&f| surface.locate(f, [0.5; 2]).is_none()).expect("a hole");
    let shown = run(folder.path(), &["hole.obj", "--only", &format!("{hole},0.5,0.5")]);
    assert!(
        shown.status.success() && text(&shown.stdout).contains("no patch of ours: a hole"),
        "{}",
        text(&shown.stdout)
    );
    for (words, message) in [
        (vec!["cube.obj", "--only", "6,0,0"], "ptex face 6 does not exist; the mesh has 6"),
        (vec!["cube.obj", "--only", "0,0,1.5"], "u and v in 0 to 1"),
        (vec!["cube.obj", "--only", "0,nan,0"], "u and v in 0 to 1"),
        (vec!["cube.obj", "hole.obj", "--only", "0,0,0"], "--only takes one mesh, not 2"),
        (vec!["cube.obj", "--only", "0,0,0", "--junit", "v.xml"], "--only does not go with --junit"),
    ] {
        let output = run(folder.path(), &words);
        let stderr = text(&output.stderr);
        assert!(output.status.code() == Some(2) && stderr.lines().count() == 1, "{stderr}");
        assert!(stderr.contains(message), "{stderr}");
    }
}
