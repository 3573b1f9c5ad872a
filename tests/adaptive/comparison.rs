//! `compare`: angles and displacements where they are known.

use crate::gpu_support::{gpu, mesh};
use catoptric::adaptive::AdaptivePatches;
use catoptric::compare::{Comparison, Exact};
use catoptric::field::Scout;
use catoptric::gpu::{SurfaceImage, View};
use catoptric::mesh::SubdivMesh;
use catoptric::osd::{EndCap, Isolation};
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3};

/// A mesh, its surface, a view of it, and what that shows.
struct Scene {
    mesh: SubdivMesh,
    surface: LimitSurface,
    view: View,
    image: SurfaceImage,
}

impl Scene {
    fn new(name: &str, size: [u32; 2]) -> Scene {
        let mesh = mesh(name);
        let surface = LimitSurface::new(&mesh).expect("the mesh is valid");
        let scout = Scout::new(&surface).expect("it has faces");
        let camera = scout.camera(size, DVec3::Z);
        let view = View { samples: 1, ..View::new(camera, scout.light(&camera)) };
        let tables = gpu().upload(&surface).expect("they fit");
        let image = gpu().inspect(&tables, &view).expect("the adapter works");
        Scene { mesh, surface, view, image }
    }

    fn compare(&self, image: &SurfaceImage) -> Comparison {
        self.exact().compare(&self.surface, image)
    }

    fn exact(&self) -> Exact<'_> {
        Exact { surface: &self.surface, view: &self.view, image: &self.image }
    }

    fn with_osd(&self, level: u32) -> Comparison {
        let patches =
            AdaptivePatches::new(&self.mesh, Isolation::uniform(level), EndCap::Gregory).expect("the mesh is valid");
        let tables = gpu().upload_patches(&patches).expect("they fit");
        self.exact().compare(&patches, &gpu().inspect(&tables, &self.view).expect("the adapter works"))
    }
}

/// The exact picture differs from itself by the rounding of f32 alone: 6e-8 of the normal is 3e-6 degrees, 20 roundings.
#[test]
fn the_exact_picture_is_exact() {
    for name in ["cube.obj", "pole_5.obj"] {
        let scene = Scene::new(name, [160, 120]);
        let same = scene.compare(&scene.image);
        println!("{name}: normals {:?}, lines {:?}", same.normal, same.lines);
        assert!(same.normal.count > 3000 && same.only_one == [0, 0]);
        assert!(same.normal.p99 < 6e-5 && same.lines.p99 < 1e-3, "{name}: {same:?}");
    }
}

/// Turned normals are so many degrees off, and moved lights move the lines as the picture itself says: the same light moved by so
/// much changes the field everywhere by as much, so a line is where the neighbouring pixel was.
#[test]
fn known_differences_are_measured() {
    let [width, height] = [640, 480];
    let scene = Scene::new("pole_5.obj", [width as u32, height as u32]);
    let mut turned = scene.image.clone();
    for normal in &mut turned.normal {
        let n = DVec3::from_array(normal.map(f64::from));
        let t = n + n.any_orthonormal_vector() * 0.25f64.to_radians().tan();
        *normal = t.normalize_or_zero().as_vec3().to_array();
    }
    let found = scene.compare(&turned).normal;
    assert!((found.mean - 0.25).abs() < 1e-4 && (found.max - 0.25).abs() < 1e-3, "{found:?}");

    // Each pixel is given the value of its right neighbour: where the field changes along the row, lines move by a pixel
    // times the cosine between the row and the gradient.
    let mut moved = scene.image.clone();
    for i in 0..moved.field.len() - 1 {
        moved.field[i] = scene.image.field[i + 1];
    }
    let displaced = scene.compare(&moved);
    let mut checked = 0;
    for i in 0..moved.field.len() {
        let (x, y) = (i % width, i / width);
        if !(2..width - 2).contains(&x) || !(2..height - 2).contains(&y) {
            continue;
        }
        let value = |dx: isize, dy: isize| scene.image.field[(i as isize + dx + dy * width as isize) as usize];
        let around: Option<Vec<DVec2>> =
            [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1), (2, 0), (-2, 0)].map(|(x, y)| value(x, y)).into_iter().collect();
        let Some(f) = around else { continue };
        let gradient = 0.5 * DVec2::new(f[2].x - f[1].x, f[4].x - f[3].x);
        // Where the picture is smooth at this scale.
        let change = (f[2].x - 2.0 * f[0].x + f[1].x).abs() + (f[5].x - 2.0 * f[0].x + f[6].x).abs();
        if change > 0.02 * gradient.length() || gradient.x.abs() < 0.5 * gradient.length() {
            continue;
        }
        let expected = (f[2].x - f[0].x).abs() / gradient.length();
        let found = f64::from(displaced.lines_px[i]);
        assert!((found - expected).abs() < 0.05 * expected, "pixel {x} {y}: {found} {expected}");
        checked += 1;
    }
    assert!(checked > 300, "{checked} pixels are smooth enough");
}

/// Deeper isolation moves the end caps into a smaller part of the picture; what is regular is exact.
#[test]
fn end_caps_come_closer_with_their_level() {
    let scene = Scene::new("pole_5.obj", [160, 120]);
    let at: Vec<Comparison> = (1..=4).map(|level| scene.with_osd(level)).collect();
    for pair in at.windows(2) {
        assert!(pair[1].normal.mean < pair[0].normal.mean, "{:?} {:?}", pair[0].normal, pair[1].normal);
        assert!(pair[1].lines.mean < pair[0].lines.mean, "{:?} {:?}", pair[0].lines, pair[1].lines);
    }
    println!("{:?}", at.iter().map(|c| c.normal).collect::<Vec<_>>());
    assert!(at[0].normal.max > 0.01, "end caps of level 1 are off: {:?}", at[0].normal);
}

/// Sharpness 2.3 is resolved at level 3: at level 1 the regular patches beside the crease approximate, though none is an end cap.
#[test]
fn regular_patches_over_unresolved_creases_count_as_approximate() {
    let at = |name: &str, level: u32| {
        let mesh = mesh(name);
        let patches = AdaptivePatches::new(&mesh, Isolation::uniform(level), EndCap::Gregory).expect("it is valid");
        let surface = LimitSurface::new(&mesh).expect("the mesh is valid");
        (patches.end_caps(), patches.accuracy(&surface, 10_000))
    };
    let (caps, early) = at("semi_sharp_crease.obj", 1);
    assert!(caps == 0 && early.patches > 0 && early.normal_deg.p99 > 1.0 && early.area > 0.0, "{early:?}");
    let (caps, late) = at("semi_sharp_crease.obj", 5);
    assert_eq!((caps, late.patches, late.area, late.normal_deg.count), (0, 0, 0.0, 0));
    // Every face of a cube has four extraordinary vertices: all of it is end caps at level 1, a quarter at level 2.
    let (caps, cube) = at("cube.obj", 1);
    assert_eq!((caps, cube.patches, cube.area), (24, 24, 1.0));
    let (caps, cube) = at("cube.obj", 2);
    assert_eq!((caps, cube.patches, cube.area), (24, 24, 0.25));
    assert!(cube.normal_deg.count == 24 * (10_000 / 24) && cube.position.max > 1e-6, "{cube:?}");
}
