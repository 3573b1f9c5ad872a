//! Views and shapes that ask too much of a pixel-exact pipeline: it must end, stay finite and vouch for every pixel.

#[allow(dead_code, reason = "each test program uses its part")]
mod gpu_support;

use catoptric::field::{Camera, Light, Projection};
use catoptric::gpu::{NO_PATCH, SurfaceImage, View};
use catoptric::mesh::{Crease, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};
use gpu_support::{gpu, meshes};

/// Odd, so that rows and columns of pixel centres pass through the middle, where symmetric shapes are seen edge on.
const SIZE: [u32; 2] = [61, 61];

/// What the pipeline sees; checks what must hold of any picture. Returns how many pixels it covers.
fn look(surface: &LimitSurface, name: &str, camera: Camera) -> usize {
    let tables = gpu().upload(surface).expect("it fits");
    let light = Light::new(camera.eye + DVec3::Z, DVec3::NEG_Z, DVec3::X, 1.0);
    let view = View { samples: 1, ..View::new(camera, light) };
    let image = gpu().inspect(&tables, &view).expect("the adapter works");
    check(&image, camera, name)
}

fn check(image: &SurfaceImage, camera: Camera, name: &str) -> usize {
    assert_eq!(image.summary().unconverged, 0, "{name}: {camera:?}");
    let covered: Vec<usize> = (0..image.patch.len()).filter(|&i| image.patch[i] != NO_PATCH).collect();
    for &i in &covered {
        let (uv, position, normal) = (image.uv[i], image.position[i], image.normal[i]);
        assert!(uv.iter().all(|x| (0.0..=1.0).contains(x)), "{name}: {camera:?}: pixel {i} at {uv:?}");
        assert!(position.is_finite() && normal.iter().all(|x| x.is_finite()), "{name}: {camera:?}: pixel {i}");
    }
    covered.len()
}

/// Views that meet symmetric shapes edge on, along both parameters at once, from inside, and from a point of the surface.
fn cameras(surface: &LimitSurface) -> Vec<Camera> {
    let [low, high] = surface.bounds().expect("it has patches");
    let (middle, size) = ((low + high) * 0.5, (high - low).length().max(1e-3));
    let up = |d: DVec3| if d.z.abs() > 0.9 * d.length() { DVec3::Y } else { DVec3::Z };
    let orthographic = |d: DVec3, up: DVec3| Camera {
        eye: middle + d.normalize() * size,
        target: middle,
        up,
        projection: Projection::Orthographic { height: size },
        size: SIZE,
    };
    let perspective = |eye: DVec3, target: DVec3, fov: f64| Camera {
        eye,
        target,
        up: dvec3(0.1, 0.9, 0.3),
        projection: Projection::Perspective { fov },
        size: SIZE,
    };
    let on = surface.evaluate(0, [0.5, 0.5]).position;
    let diagonals = [DVec3::X, DVec3::Y, DVec3::Z, dvec3(1.0, 1.0, 0.0), dvec3(1.0, 0.0, 1.0), dvec3(0.0, 1.0, -1.0)];
    let along = diagonals.iter().map(|&d| orthographic(d, up(d)));
    // Rolled by 45 degrees: lines through the middle pass through the centres of pixels all the same.
    let rolled = [DVec3::X, dvec3(1.0, 1.0, 0.0)].map(|d| orthographic(d, up(d) + up(d).cross(d.normalize())));
    let others = [
        perspective(middle, middle + dvec3(0.3, 0.8, 0.5), 100.0),
        perspective(on, on + dvec3(1.0, 0.0, 0.0) * size, 60.0),
        perspective(middle + DVec3::X * size, middle, 40.0),
    ];
    along.chain(rolled).chain(others).collect()
}

fn surface(mesh: &SubdivMesh) -> Option<LimitSurface> {
    let surface = LimitSurface::new(mesh).expect("a valid mesh");
    (!surface.patches().is_empty()).then_some(surface)
}

#[test]
fn hostile_views_end() {
    let (mut looks, mut covered) = (0, 0);
    for mesh in meshes() {
        let Some(surface) = surface(&mesh) else { continue };
        for camera in cameras(&surface) {
            covered += look(&surface, &mesh.name, camera);
            looks += 1;
        }
    }
    println!("{looks} views, {covered} pixels covered");
    assert!(looks > 600 && covered > 200 * looks, "{looks} views, {covered} pixels");
}

/// Flat, on a line, in a point, tiny, huge, far away.
#[test]
fn degenerate_shapes_end() {
    type Deform = fn(DVec3) -> DVec3;
    let deform: [(&str, Deform); 6] = [
        ("flat", |p| dvec3(p.x, p.y, 0.0)),
        ("on a line", |p| DVec3::splat(p.x + 0.3 * p.y)),
        ("in a point", |_| DVec3::ONE),
        ("tiny", |p| p * 1e-9),
        ("huge", |p| p * 1e9),
        ("far", |p| p + dvec3(1e6, -2e6, 3e6)),
    ];
    let mut looks = 0;
    for mesh in meshes().iter().step_by(7) {
        for (name, deform) in deform {
            let mut mesh = mesh.clone();
            mesh.points.iter_mut().for_each(|p| *p = deform(*p));
            let Some(surface) = surface(&mesh) else { continue };
            for camera in cameras(&surface) {
                look(&surface, &format!("{} {name}", mesh.name), camera);
                looks += 1;
            }
        }
    }
    assert!(looks > 400, "{looks}");
}

/// A flat grid of unit faces at height z, `side` a side, creased along all its rows.
fn grid(side: u32, z: f64, sharpness: f32) -> SubdivMesh {
    let at = |i: u32, j: u32| j * (side + 1) + i;
    let cells = || (0..side).flat_map(|j| (0..side).map(move |i| (i, j)));
    SubdivMesh {
        name: format!("grid, sharpness {sharpness}"),
        points: (0..=side).flat_map(|j| (0..=side).map(move |i| dvec3(f64::from(i), f64::from(j), z))).collect(),
        face_sizes: vec![4; (side * side) as usize],
        face_vertices: cells().flat_map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).collect(),
        creases: cells()
            .filter(|_| sharpness > 0.0)
            .map(|(i, j)| Crease { vertices: [at(i, j), at(i + 1, j)], sharpness })
            .collect(),
        ..SubdivMesh::default()
    }
}

/// Strips along creases are thinner than the grid that rasterisers move corners to; pixels must not fall in between.
#[test]
fn thin_strips_have_no_holes() {
    for sharpness in [2.5, 5.5, 9.5] {
        let surface = surface(&grid(30, 0.0, sharpness)).expect("it has patches");
        let target = dvec3(15.0, 15.0, 0.0);
        for (roll, height) in [(0.3, 10.0), (0.5, 12.0), (1.0, 7.0), (0.02, 11.0)] {
            let projection = Projection::Orthographic { height };
            let size = [400, 400];
            let camera = Camera { eye: target + 20.0 * DVec3::Z, target, up: dvec3(roll, 1.0, 0.0), projection, size };
            let covered = look(&surface, "strips", camera);
            assert_eq!(covered, 160_000, "sharpness {sharpness}, roll {roll}");
        }
    }
}

/// However far the eye, the nearer of two layers is seen.
#[test]
fn far_eyes_see_the_nearer_layer() {
    let [mut both, above] = [grid(4, 0.0, 0.0), grid(4, 0.01, 0.0)];
    let count = both.points.len() as u32;
    both.points.extend(above.points);
    both.face_sizes.extend(above.face_sizes);
    both.face_vertices.extend(above.face_vertices.iter().map(|v| v + count));
    let surface = surface(&both).expect("it has patches");
    let tables = gpu().upload(&surface).expect("it fits");
    let target = dvec3(2.0, 2.0, 0.0);
    for distance in [10.0, 1e3, 1e5, 1e7] {
        let eye = target + distance * DVec3::Z;
        let fov = 2.0 * (1.0f64 / distance).atan().to_degrees();
        for projection in [Projection::Orthographic { height: 2.0 }, Projection::Perspective { fov }] {
            let camera = Camera { eye, target, up: DVec3::Y, projection, size: SIZE };
            let light = Light::new(eye, DVec3::NEG_Z, DVec3::X, 1.0);
            let view = View { samples: 1, ..View::new(camera, light) };
            let image = gpu().inspect(&tables, &view).expect("the adapter works");
            let nearer = image.position.iter().filter(|p| (p.z - 0.01).abs() < 1e-5).count();
            assert_eq!(nearer, image.patch.len(), "{projection:?} from {distance}");
        }
    }
}
