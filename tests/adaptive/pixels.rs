//! Pictures of OpenSubdiv's patches: the exact pipeline must see them where the rays meet them.

use crate::common::meshes;
use crate::gpu_support::{gpu, mesh};
use catoptric::adaptive::AdaptivePatches;
use catoptric::field::{Camera, Scout};
use catoptric::gpu::{NO_PATCH, Pipeline, SurfaceImage, View};
use catoptric::mesh::SubdivMesh;
use catoptric::osd::{EndCap, Isolation};
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3};

const SIZE: [u32; 2] = [160, 120];

fn fitted(mesh: &SubdivMesh) -> Option<View> {
    let scout = Scout::new(&LimitSurface::new(mesh).expect("the mesh is valid"))?;
    let camera = scout.camera(SIZE, DVec3::Z);
    Some(View { samples: 1, ..View::new(camera, scout.light(&camera)) })
}

fn inspect(patches: &AdaptivePatches, view: &View) -> SurfaceImage {
    let tables = gpu().upload_patches(patches).expect("they fit");
    gpu().inspect(&tables, view).expect("the adapter works")
}

/// Pixels between each centre and the point that it shows, in f64.
fn residuals<'a>(
    patches: &'a AdaptivePatches,
    camera: &'a Camera,
    image: &'a SurfaceImage,
) -> impl Iterator<Item = f64> + 'a {
    (0..image.patch.len()).filter(|&i| image.patch[i] != NO_PATCH).map(|i| {
        let point = patches.evaluate(image.patch[i] as usize, image.uv[i].map(f64::from)).position;
        let width = SIZE[0] as usize;
        let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        camera.project(point).map_or(f64::NAN, |pixel| DVec2::from_array(pixel).distance(centre))
    })
}

/// What the exact pipeline is held to: borders overlap by 2e-4 pixels, bicubics through Gregory patches are a quarter of that off,
/// and the rounding of (u,v) and f32 in charts takes the rest.
const RESIDUAL: f64 = 5e-4;

#[test]
fn every_pixel_lies_on_its_ray() {
    let (mut pixels, mut worst) = (0, 0.0f64);
    for mesh in meshes() {
        let Some(view) = fitted(&mesh) else { continue };
        for (level, end_cap) in [(1, EndCap::Gregory), (2, EndCap::Gregory), (1, EndCap::BSpline)] {
            let patches = AdaptivePatches::new(&mesh, Isolation::uniform(level), end_cap).expect("the mesh is valid");
            let image = inspect(&patches, &view);
            assert_eq!(image.summary().unconverged, 0, "{} {end_cap} {level}", mesh.name);
            for residual in residuals(&patches, &view.camera, &image) {
                assert!(residual <= RESIDUAL, "{} {end_cap} {level}: {residual:e} pixels", mesh.name);
                (pixels, worst) = (pixels + 1, worst.max(residual));
            }
        }
    }
    println!("{pixels} pixels, at most {worst:.1e} off");
    assert!(pixels > 500_000, "{pixels}");
}

/// A thousand times nearer, at the corner of Gregory patches, where they are least smooth.
#[test]
fn close_ups_of_end_caps_lie_on_their_rays() {
    for name in ["cube.obj", "pole_7.obj"] {
        let mesh = mesh(name);
        let patches = AdaptivePatches::new(&mesh, Isolation::uniform(1), EndCap::Gregory).expect("the mesh is valid");
        let mut view = fitted(&mesh).expect("it has a surface");
        let cap = patches.patches().iter().position(|patch| patch.is_end_cap).expect("an end cap");
        let jet = patches.evaluate(cap, [0.0, 0.0]);
        let normal = jet.normal;
        view.camera.target = jet.position;
        view.camera.eye = jet.position + (normal + 0.3 * normal.any_orthonormal_vector()) * 2e-3 * mesh.diagonal();
        let image = inspect(&patches, &view);
        let (count, worst) =
            residuals(&patches, &view.camera, &image).fold((0, 0.0f64), |(n, worst), r| (n + 1, worst.max(r)));
        println!("{name}: {count} pixels, at most {worst:.1e} off");
        // (u,v) in f32 alone is some 6e-8 of a patch that is ten thousand pixels wide.
        assert!(count == SIZE[0] * SIZE[1] && worst <= 2e-3, "{name}: {count} {worst:e}");
    }
}

/// A closed surface has no holes, whatever side and level; and the nearest layer is what a fine proxy shows there.
#[test]
fn the_first_layer_is_seen_without_gaps() {
    for name in ["cube.obj", "pole_3.obj", "n_gons.obj", "semi_sharp_pole_5.obj"] {
        let mesh = mesh(name);
        let Some(mut view) = fitted(&mesh) else { panic!("{name} has a surface") };
        for end_cap in [EndCap::Gregory, EndCap::BSpline] {
            let patches = AdaptivePatches::new(&mesh, Isolation::uniform(2), end_cap).expect("the mesh is valid");
            view.pipeline = Pipeline::Exact;
            let exact = inspect(&patches, &view);
            view.pipeline = Pipeline::Limit;
            view.proxy_level = Some(7);
            let proxy = inspect(&patches, &view);
            view.proxy_level = None;
            let width = SIZE[0] as usize;
            let near_background = |image: &SurfaceImage, i: usize| {
                let (x, y) = (i % width, i / width);
                let around = (0..9).map(|k| [(x + k % 3).wrapping_sub(1), (y + k / 3).wrapping_sub(1)]);
                around
                    .into_iter()
                    .any(|[x, y]| x >= width || y >= SIZE[1] as usize || image.patch[y * width + x] == NO_PATCH)
            };
            let (mut inside, mut other) = (0, 0);
            for i in (0..proxy.patch.len()).filter(|&i| !near_background(&proxy, i)) {
                assert_ne!(exact.patch[i], NO_PATCH, "{name} {end_cap}: a hole at pixel {i}");
                inside += 1;
                // A pixel's width, seen at a slant of up to 10.
                let pixel = mesh.diagonal() / f64::from(SIZE[0]);
                other += usize::from(exact.position[i].distance(proxy.position[i]) > pixel);
            }
            println!("{name} {end_cap}: {inside} pixels inside, {other} of another layer");
            // Beside a contour inside the picture the proxy errs by a pixel.
            assert!(inside > 2000 && other * 200 <= inside, "{name} {end_cap}: {other} of {inside}");
        }
    }
}
