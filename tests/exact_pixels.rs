//! Every pixel of the pixel-exact pipeline against a ray caster that shares nothing with it.
//!
//! `cargo test --release --test exact_pixels -- --nocapture` prints the figures of every view.

mod caster;
mod common;
#[allow(dead_code, reason = "each test program uses its part")]
mod gpu_support;
mod pixels;
mod scenes;

use caster::{Caster, Ray};
use catoptric::gpu::Pipeline;
use gpu_support::gpu;
use pixels::{Judge, Limits, Pixels, Report};
use scenes::{Scene, corpus, inside, million_to_one, orthographic, slivers, thousandfold, views};

/// The pipeline that must be exact.
const PIPELINE: Pipeline = Pipeline::Exact;

/// What the pipeline saw.
fn seen(scene: &Scene, pipeline: Pipeline, level: Option<u32>) -> Pixels {
    let view = scene.view(pipeline, level);
    let tables = gpu().upload(&scene.surface).expect("it fits");
    let image = gpu().inspect(&tables, &view).expect("the adapter works");
    Pixels::from(&image)
}

/// Judges the pipeline at these proxy levels and prints the figures.
fn judge(scene: &Scene, pipeline: Pipeline, levels: &[Option<u32>]) -> Vec<Report> {
    let caster = Caster::new(&scene.surface);
    let judge = Judge::new(&caster, scene.camera);
    let one = |&level: &Option<u32>| {
        let name = level.map_or(scene.name.clone(), |level| format!("{}, level {level}", scene.name));
        let report = judge.judge(&name, &seen(scene, pipeline, level));
        println!("{report}");
        report
    };
    levels.iter().map(one).collect()
}

/// What falls short in these scenes.
fn failures(scenes: &[Scene], levels: &[Option<u32>]) -> Vec<String> {
    println!("{}", Report::header());
    let reports = scenes.iter().flat_map(|scene| judge(scene, PIPELINE, levels));
    reports.flat_map(|report| report.failures(&Limits::EXACT)).collect()
}

fn assert_exact(scenes: &[Scene], levels: &[Option<u32>]) {
    let failures = failures(scenes, levels);
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}

/// Fitted, grazing, and near to what is special in each mesh.
#[test]
fn views_are_exact() {
    assert_exact(&views(), &[None]);
}

/// The proxy decides where fragments are, not what they see.
#[test]
fn proxy_levels_do_not_matter() {
    let fitted: Vec<Scene> = views().into_iter().filter(|scene| scene.name.ends_with("fit")).collect();
    let levels = [0, 1, 2, 3, 5].map(Some);
    assert_exact(&fitted, &levels);
}

#[test]
fn an_eye_inside_is_exact() {
    assert_exact(&[inside("cube.obj"), inside("corner.obj")], &[Some(1), None]);
}

#[test]
fn close_ups_are_exact() {
    assert_exact(&thousandfold(), &[Some(3), None]);
}

#[test]
fn far_and_near_are_exact() {
    assert_exact(&[million_to_one()], &[Some(2), None]);
}

#[test]
fn orthographic_views_are_exact() {
    assert_exact(&orthographic(), &[None]);
}

#[test]
fn slivers_are_exact() {
    assert_exact(&slivers(), &[None]);
}

/// OpenSubdiv's regression shapes, where they lie beside the project.
#[test]
fn the_corpus_is_exact() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes/opensubdiv");
    if folder.is_dir() {
        let mut failures = failures(&corpus(&folder), &[None]);
        // Folded onto itself: two layers of opposite normals coincide, and rounding decides which is the first.
        failures.retain(|failure| !failure.starts_with("catmark_val2_foldover : normals"));
        assert_eq!(failures, Vec::<String>::new());
    }
}

/// The harness itself: a perfect picture passes, and each kind of fault is found and named.
#[test]
fn faults_are_found() {
    println!("{}", Report::header());
    for scene in views().iter().filter(|scene| scene.name.ends_with("fit")) {
        let caster = Caster::new(&scene.surface);
        let judge = Judge::new(&caster, scene.camera);
        let report = |name: &str, pixels: &Pixels| {
            let report = judge.judge(&format!("{}, {name}", scene.name), pixels);
            println!("{report}");
            report
        };
        let failures = |report: &Report| report.failures(&Limits::EXACT).join("; ");
        let perfect = judge.ideal([0.0; 2]);
        let ideal = report("ideal", &perfect);
        assert_eq!(failures(&ideal), "");
        // The hit is on the ray but for CLOSED, 1e-12 of a patch, which is at most 200 pixels, and for the rounding of the
        // projection, some 1e-15 of the picture.
        assert!(ideal.image[1] < 1e-9 && ideal.normal[1] == 0.0 && ideal.creases == 0, "{ideal}");

        // Shifted pictures are off by the shift; within the band, no pixel may be called wrongly covered.
        let slightly = report("0.005 px aside", &judge.ideal([0.004, 0.003]));
        assert!((slightly.image[1] - 0.005).abs() < 1e-6, "{slightly}");
        assert_eq!((slightly.coverage[0], slightly.layer[0]), (0, 0), "{slightly}");
        let shifted = report("0.02 px aside", &judge.ideal([0.016, -0.012]));
        assert!((shifted.image[1] - 0.02).abs() < 1e-6, "{shifted}");
        assert!(failures(&shifted).contains("pixels off"), "{shifted}");
        let far = report("0.5 px aside", &judge.ideal([0.4, 0.3]));
        assert!(far.coverage[0] > 10, "{far}");

        let middle = middle_of_cover(&perfect);
        let mut holed = perfect.clone();
        holed.points[middle] = None;
        assert_eq!(report("a hole", &holed).coverage, [1, 0]);

        let mut tilted = perfect.clone();
        for point in tilted.points.iter_mut().flatten() {
            let aside = point.normal.any_orthonormal_vector();
            point.normal = (point.normal + 2e-3f64.to_radians() * aside).normalize();
        }
        let tilted = report("tilted by 2e-3 degrees", &tilted);
        assert!((tilted.normal[0] - 2e-3).abs() < 1e-6 && tilted.creases == 0, "{tilted}");
        assert!(failures(&tilted).contains("degrees off"), "{tilted}");

        let mut unsure = perfect.clone();
        let mut residual = vec![1e-4; perfect.points.len()];
        residual[middle] = f32::NAN;
        unsure.residual = Some(residual);
        assert_eq!(report("one not converged", &unsure).unconverged, Some(1));
    }
}

/// A covered pixel far from any edge of the cover.
fn middle_of_cover(pixels: &Pixels) -> usize {
    let width = pixels.size[0] as usize;
    let deep = |i: &usize| {
        let around =
            [-5isize, -1, 0, 1, 5].into_iter().flat_map(|y| [-5isize, -1, 0, 1, 5].map(|x| y * width as isize + x));
        around
            .map(|step| i.checked_add_signed(step))
            .all(|i| i.and_then(|i| pixels.points.get(i)).is_some_and(|point| point.is_some()))
    };
    let middle = pixels.points.len() / 2 + width / 2;
    let inner = (0..pixels.points.len()).filter(deep);
    inner.min_by_key(|i| i.abs_diff(middle)).expect("a covered pixel")
}

/// Pixels that see a closed object's far side through its near one are found.
#[test]
fn hidden_layers_are_found() {
    let scene = views().into_iter().find(|scene| scene.name == "n_gons fit").expect("it is one of the views");
    let caster = Caster::new(&scene.surface);
    let judge = Judge::new(&caster, scene.camera);
    let mut pixels = judge.ideal([0.0; 2]);
    let middle = middle_of_cover(&pixels);
    let near = pixels.points[middle].expect("it is covered");
    let eye = scene.camera.eye;
    let hits = caster.all_hits(&Ray::new(eye, near.position - eye));
    let far = hits.last().expect("it is covered");
    pixels.points[middle] = Some(pixels::Point { patch: far.patch, position: far.position, normal: far.normal });
    let report = judge.judge("hidden", &pixels);
    assert_eq!(report.layer, [1, 0], "{report}");
    assert_eq!(report.failures(&Limits::EXACT).len(), 1, "{report}");
}

/// The pipeline of the proxy's own (u,v) is not exact, and the harness says by how much: fragments take parameters that
/// are interpolated between the corners of cells, which shrinks with the cells, and patches overlap by a fraction of a
/// pixel, which does not.
#[test]
fn interpolated_parameters_are_not_exact() {
    println!("{}", Report::header());
    for scene in views().iter().filter(|scene| scene.name.ends_with("fit")) {
        let reports = judge(scene, Pipeline::Limit, &[Some(2), Some(5)]);
        for report in &reports {
            assert!(!report.failures(&Limits::EXACT).is_empty(), "{report}");
            assert!(report.coverage[0] > 0 && report.image[1] > Limits::EXACT.image, "{report}");
        }
        // Cells of level 5 are about as large as pixels, a few times that at poles: a chord of length h is h^2 / (8 r) off
        // its arc of radius r, 0.1 pixels where r = h = 0.8; and as much for the overlap.
        assert!(
            reports[1].image[0] < 0.2 && reports[1].image[0] < reports[0].image[0],
            "{} {}",
            reports[0],
            reports[1]
        );
    }
}
