//! Yasui & Kanai's own pipeline: exact points, drawn where they project to.

mod gpu_support;

use catoptric::field::{Camera, Light, Projection};
use catoptric::gpu::{Gpu, GpuError, MAX_POINTS_SIDE, NO_PATCH, Pipeline, SurfaceImage, Tables, View};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};
use gpu_support::{Random, gpu, mesh, meshes};

const SIZE: [u32; 2] = [220, 200];

fn upload(surface: &LimitSurface) -> Tables {
    gpu().upload(surface).expect("it fits")
}

/// A view that the object fills, by points at a proxy level and an enlargement.
fn view(surface: &LimitSurface, level: u32, enlarge: f64) -> View {
    let [low, high] = surface.bounds().expect("it has patches");
    let (middle, diagonal) = ((low + high) * 0.5, (high - low).length());
    let eye = middle + dvec3(1.0, 2.0, 1.5).normalize() * diagonal * 1.6;
    let camera =
        Camera { eye, target: middle, up: DVec3::Z, projection: Projection::Perspective { fov: 40.0 }, size: SIZE };
    let light = Light::new(middle + diagonal * 1.5 * DVec3::Z, DVec3::NEG_Z, DVec3::Y, 0.8 * diagonal);
    View { pipeline: Pipeline::Points, proxy_level: Some(level), enlarge, samples: 1, ..View::new(camera, light) }
}

fn inspect(tables: &Tables, view: &View) -> SurfaceImage {
    gpu().inspect(tables, view).expect("the adapter works")
}

/// What landed on a pixel is a point of the limit surface that projects into that pixel: on all meshes, from anywhere, in
/// perspective and orthographic views, near the origin and far away.
#[test]
fn points_are_exact_and_on_their_pixels() {
    let mut random = Random::new(3);
    let [mut count, mut off_ray] = [0, 0];
    for mesh in meshes() {
        let offset = 1000.0 * dvec3(random.next(), random.next(), random.next()).round();
        let surface = LimitSurface::new(&mesh.translated(offset)).expect("it has a surface");
        if surface.patches().is_empty() {
            continue;
        }
        let mut view = view(&surface, 2, 1.3);
        let side = dvec3(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5).normalize();
        view.camera.eye = view.camera.target + side * view.camera.eye.distance(view.camera.target);
        if random.next() < 0.5 {
            view.camera.projection = Projection::Orthographic { height: surface.diagonal() };
        }
        let image = inspect(&upload(&surface), &view);
        for (i, &patch) in image.patch.iter().enumerate().filter(|(_, patch)| **patch != NO_PATCH) {
            let jet = surface.evaluate(patch as usize, image.uv[i].map(f64::from));
            let error = image.position[i].distance(jet.position) / surface.diagonal();
            assert!(error < 2e-6, "{}: pixel {i}: {error:e} of the diagonal off the surface", mesh.name);
            // Half a pixel, and what rounding in f32 and the rasteriser's grid of 1/256 pixel take.
            let centre = [i % SIZE[0] as usize, i / SIZE[0] as usize].map(|n| n as f64 + 0.5);
            let [x, y] = view.camera.project(jet.position).expect("before the eye");
            let reach = (x - centre[0]).abs().max((y - centre[1]).abs());
            assert!(reach < 0.5 + 0.01, "{}: the point of pixel {i} projects {reach} pixels away", mesh.name);
            count += 1;
            off_ray += usize::from(reach > 0.1);
        }
    }
    println!("{count} pixels, {off_ray} more than 0.1 pixel off their rays");
    assert!(count > 50_000 && off_ray > count / 10, "{count} pixels, {off_ray} off their rays");
}

/// Pixels that the limit at a fine proxy covers and the points do not, away from the silhouette: gaps proper.
fn gaps(points: &SurfaceImage, full: &SurfaceImage) -> usize {
    let width = SIZE[0] as usize;
    let inside = |i: usize| {
        let (x, y) = (i % width, i / width);
        let around = |k: usize| full.patch[(y + k / 7 - 3) * width + x + k % 7 - 3] != NO_PATCH;
        (3..width - 3).contains(&x) && (3..SIZE[1] as usize - 3).contains(&y) && (0..49).all(around)
    };
    (0..full.patch.len()).filter(|&i| inside(i) && points.patch[i] == NO_PATCH).count()
}

/// Yasui & Kanai 2004, sec. 5: coarse polygons leave gaps, larger viewports close them.
#[test]
fn gaps_shrink_with_level_and_enlargement() {
    for name in ["cube.obj", "n_gons.obj"] {
        let surface = LimitSurface::new(&mesh(name)).expect("it has a surface");
        let tables = upload(&surface);
        let full = inspect(&tables, &View { pipeline: Pipeline::Limit, ..view(&surface, 6, 1.0) });
        let count = |level, enlarge| gaps(&inspect(&tables, &view(&surface, level, enlarge)), &full);
        let level_1 = [1.0, 1.3, 1.7, 3.0].map(|enlarge| count(1, enlarge));
        let plain = [1, 2, 3, 5].map(|level| count(level, 1.0));
        println!("{name}: gaps at level 1 by enlargement 1, 1.3, 1.7, 3: {level_1:?}; at levels 1, 2, 3, 5: {plain:?}");

        assert!(level_1[0] > 500, "{level_1:?}");
        assert!(level_1.windows(2).all(|pair| pair[1] <= pair[0] / 2), "{level_1:?}");
        assert!(plain.windows(2).all(|pair| pair[1] < pair[0] || pair[1] == 0), "{plain:?}");
    }
}

/// Several tiles of fragments, several samples, another device: the same bytes.
#[test]
fn pictures_are_the_same_every_time() {
    let surface = LimitSurface::new(&mesh("semi_sharp_crease.obj")).expect("it has a surface");
    let tables = upload(&surface);
    let mut view = View { samples: 4, ..view(&surface, 2, 3.0) };
    view.camera.size = [300, 280];
    let first = gpu().render(&tables, &view).expect("the adapter works").rgba8;
    assert!(first == gpu().render(&tables, &view).expect("the adapter works").rgba8, "two renders differ");
    let other = Gpu::new().expect("an adapter");
    let again = other.render(&other.upload(&surface).expect("it fits"), &view).expect("the adapter works");
    assert!(first == again.rgba8, "a new device draws another picture");
}

/// On a fine proxy the points' picture is that of the limit pipeline, but for single samples.
#[test]
fn fine_proxies_draw_the_limits_picture() {
    let surface = LimitSurface::new(&mesh("pole_5.obj")).expect("it has a surface");
    let tables = upload(&surface);
    let points = View { samples: 2, ..view(&surface, 7, 2.0) };
    let limit = View { pipeline: Pipeline::Limit, enlarge: 1.0, ..points.clone() };
    let [a, b] = [&points, &limit].map(|view| gpu().render(&tables, view).expect("the adapter works").rgba8);
    let far = a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > 24).count();
    println!("{far} of {} bytes differ by more than 24", a.len());
    assert!(far < a.len() / 50, "{far} of {} bytes differ by more than 24", a.len());
}

#[test]
fn views_that_cannot_be_drawn_are_refused() {
    let surface = LimitSurface::new(&mesh("cube.obj")).expect("it has a surface");
    let tables = upload(&surface);
    let good = view(&surface, 2, 1.3);
    type Change = fn(&mut View);
    let bad: [(Change, &str); 5] = [
        (|v| v.enlarge = 0.9, "enlargement 0.9"),
        (|v| v.enlarge = f64::NAN, "enlargement NaN"),
        (|v| v.enlarge = 8.5, "enlargement 8.5"),
        (|v| v.pipeline = Pipeline::Polygon, "only the points pipeline"),
        (|v| v.camera.size = [MAX_POINTS_SIDE + 1, 10], "4096 samples a side"),
    ];
    for (change, expected) in bad {
        let mut view = good.clone();
        change(&mut view);
        match gpu().render(&tables, &view) {
            Err(GpuError::View(message)) => assert!(message.contains(expected), "{message}"),
            other => panic!("{expected}: {other:?}"),
        }
        assert!(gpu().inspect(&tables, &view).is_err(), "{expected}");
    }
    // Nothing in sight is no error.
    let mut away = good.clone();
    away.camera.target = away.camera.eye * 2.0 - away.camera.target;
    assert!(inspect(&tables, &away).patch.iter().all(|&p| p == NO_PATCH));
    assert!(gpu().render(&tables, &away).is_ok());
}
