//! Pictures: what pixels see, how they are shaded, and that they come out the same every time.

mod gpu_support;

use catoptric::field::{Camera, Light, Pattern, Point, Projection, reflection_direction};
use catoptric::gpu::{
    Frame, Gpu, GpuError, NO_PATCH, Palette, Pipeline, Stage, State, SurfaceImage, TableLayout, Tables, View,
};
use catoptric::mesh::{Crease, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3, dvec3};
use gpu_support::{Random, gpu, mesh, meshes};

const SIZE: [u32; 2] = [220, 200];

fn upload(mesh: &SubdivMesh) -> (LimitSurface, Tables) {
    let surface = LimitSurface::new(mesh).expect("it has a surface");
    let tables = gpu().upload(&surface).expect("it fits");
    (surface, tables)
}

/// The same picture with parallel lines of sight: as high as the other is at the target.
fn orthographic(mut view: View) -> View {
    let Projection::Perspective { fov } = view.camera.projection else { return view };
    let height = 2.0 * (fov.to_radians() / 2.0).tan() * view.camera.eye.distance(view.camera.target);
    view.camera.projection = Projection::Orthographic { height };
    view
}

/// The object from a direction, under an endless ceiling of tubes.
fn view(surface: &LimitSurface, direction: DVec3) -> View {
    let [low, high] = surface.bounds().expect("it has patches");
    let (middle, diagonal) = ((low + high) * 0.5, (high - low).length());
    let eye = middle + direction.normalize() * diagonal * 1.6;
    let projection = Projection::Perspective { fov: 40.0 };
    let camera = Camera { eye, target: middle, up: DVec3::Z, projection, size: SIZE };
    let light = Light::new(middle + diagonal * 1.5 * DVec3::Z, DVec3::NEG_Z, DVec3::Y, 0.8 * diagonal);
    View { samples: 1, proxy_level: Some(4), ..View::new(camera, light) }
}

fn inspect(tables: &Tables, view: &View) -> SurfaceImage {
    gpu().inspect(tables, view).expect("the adapter works")
}

fn render(tables: &Tables, view: &View) -> Frame {
    gpu().render(tables, view).expect("the adapter works")
}

fn covered(image: &SurfaceImage) -> impl Iterator<Item = usize> {
    (0..image.patch.len()).filter(|&i| image.patch[i] != NO_PATCH)
}

/// Field values against f64 from the exact surface at the same (patch, u, v), for a mesh at the origin and far away, and
/// for parallel lines of sight from an eye that is farther still.
#[test]
fn reflection_agrees_with_f64() {
    for offset in [DVec3::ZERO, dvec3(1000.0, -500.0, 200.0)] {
        let (surface, tables) = upload(&mesh("pole_5.obj").translated(offset));
        let perspective = view(&surface, dvec3(1.0, 2.0, 1.5));
        let mut parallel = orthographic(perspective.clone());
        parallel.camera.eye = parallel.camera.target + (parallel.camera.eye - parallel.camera.target) * 1e4;
        for view in [perspective, parallel] {
            let light = view.field.light;
            let image = inspect(&tables, &view);
            let mut hits = 0;
            for i in covered(&image) {
                let jet = surface.evaluate(image.patch[i] as usize, image.uv[i].map(f64::from));
                let sight = view.camera.sight(jet.position);
                let point = Point { position: jet.position, normal: jet.normal, sight, curvature: None };
                let expected = view.field.value(&point);
                let ray = reflection_direction(jet.normal, sight).normalize();
                let elevation = ray.dot(light.normal()).abs();
                // The mirrored ray turns by the rounding of sight and twice that of the normal: 4e-6 radians is 12 times
                // the normals' 1e-5 degrees. On the plane that is as much times distance, over the sine of the elevation.
                let distance = (light.center - jet.position).dot(light.normal()).abs() / elevation;
                let tolerance = 4e-6 * distance / elevation;
                match (image.field[i], expected) {
                    (Some(found), Some(expected)) => {
                        hits += 1;
                        assert!(found.distance(expected) <= tolerance, "{found} {expected} {tolerance:e}");
                    }
                    (found, expected) => assert!(found == expected || elevation < 1e-5, "{found:?} {expected:?}"),
                }
            }
            assert!(hits > 3000, "only {hits} pixels mirror the light");
        }
    }
}

/// In both projections a pixel sees what lies on its line of sight, as near as the proxy is to the surface: its borders
/// are pushed out by 0.1 pixel along u and v; the sag of a chord of 1/64 face is 1e-4 of the face, less than 0.01 pixel.
#[test]
fn pixels_see_what_is_on_their_line_of_sight() {
    let (surface, tables) = upload(&mesh("pole_5.obj"));
    let perspective = View { proxy_level: Some(6), ..view(&surface, dvec3(1.0, 2.0, 1.5)) };
    for view in [orthographic(perspective.clone()), perspective] {
        let image = inspect(&tables, &view);
        let off = |i: usize| {
            let centre = DVec2::new((i % SIZE[0] as usize) as f64 + 0.5, (i / SIZE[0] as usize) as f64 + 0.5);
            DVec2::from_array(view.camera.project(image.position[i]).expect("before the eye")).distance(centre)
        };
        let errors: Vec<f64> = covered(&image).map(off).collect();
        let worst = errors.iter().copied().fold(0.0, f64::max);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        println!("{:?}: {} pixels off by {mean:.4}, at most {worst:.4}", view.camera.projection, errors.len());
        assert!(errors.len() > 3000 && mean < 0.01 && worst < 0.15, "{mean} {worst}");
    }
}

/// Of two sheets the nearer is seen, whichever is drawn first, and nothing behind the plane through the eye.
#[test]
fn orthographic_depth_is_in_order() {
    let cube = mesh("cube.obj");
    let (surface, tables) = upload(&cube);
    let view = orthographic(view(&surface, DVec3::X));
    for direction in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, dvec3(1.0, 2.0, 3.0)] {
        let mut view = view.clone();
        view.camera.eye = view.camera.target + direction * 10.0;
        let image = inspect(&tables, &view);
        // Pixels beside the silhouette may see just beyond the horizon.
        let inside = |i: &usize| !near_background(&image, *i);
        for i in covered(&image).filter(inside) {
            let normal = DVec3::from_array(image.normal[i].map(f64::from));
            assert!(normal.dot(view.camera.sight(image.position[i])) < 0.0, "from {direction} the far side is seen");
        }
        view.camera.eye = view.camera.target + direction.normalize() * 1e-3;
        let image = inspect(&tables, &view);
        assert!(covered(&image).count() > 1000);
        for i in covered(&image) {
            let depth = (image.position[i] - view.camera.eye).dot(view.camera.sight(image.position[i]));
            assert!(depth > -1e-2, "from {direction}: {depth} is behind the eye");
        }
    }
}

/// Pixels whose neighbourhood is all light or all dark are so in the picture.
#[test]
fn patterns_agree_with_f64() {
    let (surface, tables) = upload(&mesh("pole_5.obj"));
    let palette = Palette { paint: [0.0; 3], tube: [1.0; 3], top: [0.0; 3], bottom: [0.0; 3] };
    let view = View { palette, ..view(&surface, dvec3(1.0, 2.0, 2.5)) };
    let light = view.field.light;
    let image = inspect(&tables, &view);
    for pattern in [Pattern::Stripes { width: 0.4 }, Pattern::Lattice { width: 0.3 }, Pattern::Circles { radius: 0.35 }]
    {
        let frame = render(&tables, &View { pattern: pattern.clone(), ..view.clone() });
        let width = SIZE[0] as usize;
        let (mut light_pixels, mut dark_pixels) = (0, 0);
        for i in covered(&image) {
            let (x, y) = (i % width, i / width);
            if !(2..width - 2).contains(&x) || !(2..SIZE[1] as usize - 2).contains(&y) {
                continue;
            }
            let around = (0..25).map(|k| image.field[(y + k / 5 - 2) * width + x + k % 5 - 2]);
            let values: Option<Vec<DVec2>> = around.collect();
            let Some(values) = values else { continue };
            // Where lights are smaller than pixels both show the mean.
            if values.iter().any(|p| p.distance(values[12]) > 0.3 * light.spacing) {
                continue;
            }
            // Near the horizon tubes fade.
            let to_light = light.center - image.position[i];
            let elevation = to_light.dot(light.normal()).abs() / (to_light + in_plane(&light, values[12])).length();
            let sum: f64 = values.iter().map(|&p| pattern.radiance(&view.field, p).x).sum();
            match sum {
                25.0 if elevation > 0.3 => {
                    light_pixels += 1;
                    assert_eq!(frame.rgba8[4 * i..4 * i + 3], [255; 3], "{pattern:?}: pixel {x}, {y} is not light");
                }
                0.0 => {
                    dark_pixels += 1;
                    assert!(frame.rgba8[4 * i] < 4, "{pattern:?}: pixel {x}, {y} is not dark");
                }
                _ => (),
            }
        }
        assert!(light_pixels > 100 && dark_pixels > 100, "{pattern:?}: {light_pixels} light, {dark_pixels} dark");
    }
}

fn in_plane(light: &Light, point: DVec2) -> DVec3 {
    light.axes[0] * point.x + light.axes[1] * point.y
}

#[test]
fn pictures_are_the_same_every_time() {
    let mesh = mesh("semi_sharp_crease.obj");
    let (surface, tables) = upload(&mesh);
    let view = View { samples: 2, proxy_level: None, ..view(&surface, dvec3(2.0, 1.0, 1.0)) };
    let first = render(&tables, &view).rgba8;
    assert!(first == render(&tables, &view).rgba8, "two renders differ");
    let other = Gpu::new().expect("an adapter");
    let again = other.render(&other.upload(&surface).expect("it fits"), &view).expect("the adapter works");
    assert!(first == again.rgba8, "a new device draws another picture");
}

/// Fragment and compute passes run the same functions: on one adapter the same bits. `auto` may choose either.
#[test]
fn stages_draw_the_same_picture() {
    for name in ["semi_sharp_crease.obj", "pole_8.obj"] {
        let (surface, tables) = upload(&mesh(name));
        for pattern in [Pattern::Stripes { width: 0.4 }, Pattern::Circles { radius: 0.3 }] {
            let of = |stage, pipeline| {
                let view = View { stage, pipeline, pattern: pattern.clone(), ..view(&surface, dvec3(2.0, 1.0, 1.0)) };
                render(&tables, &view).rgba8
            };
            for pipeline in [Pipeline::Exact, Pipeline::Limit, Pipeline::Polygon] {
                let fragment = of(Stage::Fragment, pipeline);
                let differ = |stage| fragment.iter().zip(of(stage, pipeline)).filter(|&(&a, b)| a != b).count();
                let [compute, auto] = [Stage::Compute, Stage::Auto].map(differ);
                assert_eq!([compute, auto], [0, 0], "{name}, {pattern:?}, {pipeline:?}: bytes that differ");
            }
        }
    }
}

/// Targets are kept from one picture to the next, and nothing on them shows in it.
#[test]
fn pictures_show_nothing_of_those_before() {
    let (surface, tables) = upload(&mesh("pole_5.obj"));
    let close = |direction: DVec3| {
        let mut view = view(&surface, direction);
        view.camera.eye = view.camera.target + 0.4 * (view.camera.eye - view.camera.target);
        view
    };
    let fresh = Gpu::new().expect("an adapter");
    let of_fresh = fresh.upload(&surface).expect("it fits");
    for pipeline in [Pipeline::Exact, Pipeline::Limit, Pipeline::Polygon, Pipeline::Points] {
        for stage in [Stage::Fragment, Stage::Compute] {
            let kind = |view: View| View { pipeline, stage, ..view };
            let small = kind(View { samples: 2, ..view(&surface, dvec3(1.0, -1.0, 0.5)) });
            let alone = fresh.render(&of_fresh, &small).expect("the adapter works");
            let full = render(&tables, &kind(View { samples: 2, ..close(dvec3(1.0, 2.0, 1.5)) }));
            assert_ne!(full.rgba8, alone.rgba8);
            assert!(render(&tables, &small).rgba8 == alone.rgba8, "{pipeline:?}, {stage:?}");
        }
    }
}

/// What the exact pipeline says of its pixels: every one has a certificate, and the sum is that of the pixels.
#[test]
fn every_pixel_has_a_certificate() {
    let (surface, tables) = upload(&mesh("pole_5.obj"));
    let view = View { proxy_level: None, ..view(&surface, dvec3(2.0, 1.0, 1.0)) };
    let image = inspect(&tables, &view);
    let summary = image.summary();
    assert_eq!(summary.samples, image.patch.len() as u64);
    assert_eq!(summary.covered, covered(&image).count() as u64);
    assert_eq!(summary.unconverged, 0);
    assert!(summary.residual_max < 1e-3 && summary.solved < summary.covered / 10, "{summary:?}");
    for (certificate, &patch) in image.certificate.iter().zip(&image.patch) {
        assert_eq!(certificate.state == State::Background, patch == NO_PATCH);
        assert_eq!(certificate.steps > 0, certificate.state == State::Chart);
    }
    assert_eq!(
        render(&tables, &view).summary,
        Some(summary),
        "one sample a pixel: the picture sees what inspection sees"
    );
    let proxy = inspect(&tables, &View { pipeline: Pipeline::Limit, proxy_level: Some(1), ..view.clone() });
    assert!(proxy.certificate.iter().all(|c| matches!(c.state, State::Proxy | State::Background)));
    assert!(proxy.summary().residual_max > 0.1, "the proxy's parameters miss their rays");
    assert_eq!(render(&tables, &View { pipeline: Pipeline::Limit, ..view }).summary, None);
}

/// The layouts agree to f32 rounding, so pictures differ where a pixel lies on the edge of a patch, and by single steps
/// of 8-bit colour elsewhere.
#[test]
fn layouts_draw_the_same_picture() {
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        if surface.patches().is_empty() {
            continue;
        }
        let view = view(&surface, dvec3(1.0, 2.0, 1.5));
        let [first, others @ ..] =
            TableLayout::ALL.map(|layout| render(&gpu().upload_as(&surface, layout).expect("it fits"), &view).rgba8);
        for other in others {
            let steps = first.iter().zip(&other).map(|(&a, &b)| a.abs_diff(b));
            let [some, many] = [1, 8].map(|least| steps.clone().filter(|&step| step >= least).count());
            println!("{}: {some} bytes differ, {many} by 8 or more, of {}", mesh.name, first.len());
            assert!(some <= first.len() / 1000 && many <= first.len() / 10_000, "{}: {some} {many}", mesh.name);
        }
    }
}

/// A picture in several tiles is the same as each of its parts: tiles of 2048 samples, so 1100 pixels at 4 samples are 3.
#[test]
fn tiles_leave_no_seams() {
    let (surface, tables) = upload(&mesh("cube.obj"));
    let mut view = view(&surface, dvec3(2.0, 1.0, 1.0));
    (view.samples, view.camera.size) = (4, [1100, 16]);
    view.camera.projection = Projection::Perspective { fov: 0.6 };
    let wide = render(&tables, &view);
    // Columns on both sides of the seams at 512 and 1024 pixels differ no more than their neighbours do.
    let step = |x: usize| {
        (0..16)
            .map(|y| i32::from(wide.rgba8[4 * (y * 1100 + x)]) - i32::from(wide.rgba8[4 * (y * 1100 + x - 1)]))
            .map(i32::abs)
            .sum::<i32>()
    };
    for seam in [512, 1024] {
        let near = [seam - 2, seam - 1, seam + 1, seam + 2].map(step).into_iter().max().expect("four");
        assert!(step(seam) <= near + 32, "seam at {seam}: {} against {near}", step(seam));
    }
}

/// Cracks of a closed surface show the background or the far side's inside. From many sides, at many levels, with and
/// without transitions between patches of different depth, no pixel sees either.
#[test]
fn closed_surfaces_have_no_pinholes() {
    let mut random = Random::new(5);
    let mut creased = mesh("cube.obj");
    creased.name = "creased cube".into();
    creased.creases = [(0.7, 0, 1), (2.5, 1, 2), (4.0, 2, 3), (10.0, 4, 5)]
        .map(|(sharpness, a, b)| Crease { vertices: [a, b], sharpness })
        .to_vec();
    for mesh in [mesh("cube.obj"), mesh("corner.obj"), mesh("n_gons.obj"), creased] {
        let (name, (surface, tables)) = (&mesh.name, upload(&mesh));
        for level in (0..21).map(|k| k / 3) {
            let direction = dvec3(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
            let mut view = View { proxy_level: Some(level), ..view(&surface, direction) };
            view.camera.size = [400, 400];
            let image = inspect(&tables, &view);
            let holes = enclosed_background(&image);
            assert_eq!(holes, 0, "{name} at level {level} from {direction}: {holes} pixels of background inside");
            let back = covered(&image)
                .filter(|&i| {
                    let normal = DVec3::from_array(image.normal[i].map(f64::from));
                    normal.dot(image.position[i] - view.camera.eye) > 0.0 && !near_background(&image, i)
                })
                .count();
            assert_eq!(back, 0, "{name} at level {level} from {direction}: {back} pixels see the inside");
        }
    }
}

/// Whether the silhouette is near. There pixels see points just beyond the horizon: as far as the surface turns within a
/// proxy cell, which a few pixels cover where it is seen edge on.
fn near_background(image: &SurfaceImage, i: usize) -> bool {
    const REACH: usize = 12;
    let [width, height] = image.size.map(|n| n as usize);
    let (x, y) = (i % width, i / width);
    let range = |x: usize, n: usize| x.saturating_sub(REACH)..(x + REACH + 1).min(n);
    range(y, height).any(|y| range(x, width).any(|x| image.patch[y * width + x] == NO_PATCH))
}

/// Pixels of background that are not connected to the border of the picture.
fn enclosed_background(image: &SurfaceImage) -> usize {
    let [width, height] = image.size.map(|n| n as usize);
    let mut open = vec![false; width * height];
    let is_border = |i: usize| [0, width - 1].contains(&(i % width)) || [0, height - 1].contains(&(i / width));
    let is_background = |i: &usize| image.patch[*i] == NO_PATCH;
    let mut queue: Vec<usize> = (0..width * height).filter(|&i| is_border(i)).filter(is_background).collect();
    queue.iter().for_each(|&i| open[i] = true);
    while let Some(i) = queue.pop() {
        for next in [i.wrapping_sub(1), i + 1, i.wrapping_sub(width), i + width] {
            if next < open.len() && !open[next] && is_background(&next) {
                open[next] = true;
                queue.push(next);
            }
        }
    }
    (0..width * height).filter(is_background).filter(|&i| !open[i]).count()
}

/// Interpolated normals converge to the exact ones: with the square of the cell size (4 times better a level) where they are
/// twice differentiable in (u,v), slower round extraordinary vertices, where they are not; 2 is linear.
#[test]
fn polygons_converge_to_the_limit() {
    let (surface, tables) = upload(&mesh("pole_3.obj"));
    let base = view(&surface, dvec3(1.0, 2.0, 1.5));
    let error = |level| {
        let image = inspect(&tables, &View { pipeline: Pipeline::Polygon, proxy_level: Some(level), ..base.clone() });
        let angle = |i: usize| {
            let exact = surface.evaluate(image.patch[i] as usize, image.uv[i].map(f64::from)).normal;
            DVec3::from_array(image.normal[i].map(f64::from)).cross(exact).length()
        };
        let angles: Vec<f64> = covered(&image).map(angle).collect();
        angles.iter().sum::<f64>() / angles.len() as f64
    };
    let errors = [2, 3, 4, 5].map(error);
    println!("mean normal error of polygons, levels 2 to 5, radians: {errors:?}");
    for pair in errors.windows(2) {
        assert!(pair[1] < pair[0] / 2.2, "{errors:?}");
    }
    assert!(errors[0] > 1e-3, "the polygon pipeline interpolates: {errors:?}");
}

#[test]
fn views_that_cannot_be_drawn_are_refused() {
    let (surface, tables) = upload(&mesh("cube.obj"));
    let good = view(&surface, DVec3::X);
    let bad: [fn(&mut View); 9] = [
        |v| v.camera.size = [0, 10],
        |v| v.camera.size = [100_000, 10],
        |v| v.camera.target = v.camera.eye,
        |v| v.camera.up = v.camera.target - v.camera.eye,
        |v| v.camera.projection = Projection::Perspective { fov: 180.0 },
        |v| v.camera.projection = Projection::Orthographic { height: 0.0 },
        |v| v.camera.projection = Projection::Orthographic { height: f64::INFINITY },
        |v| v.samples = 0,
        |v| v.proxy_level = Some(99),
    ];
    for change in bad {
        let mut view = good.clone();
        change(&mut view);
        let error = gpu().render(&tables, &view).map(drop);
        assert!(matches!(error, Err(GpuError::View(_))), "{error:?}");
    }
    // Nothing in sight is no error.
    let mut away = good.clone();
    away.camera.target = away.camera.eye * 2.0 - away.camera.target;
    assert!(inspect(&tables, &away).patch.iter().all(|&p| p == NO_PATCH));
}
