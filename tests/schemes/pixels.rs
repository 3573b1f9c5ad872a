//! Every pixel of a picture of a Loop surface sees the point that its ray meets first.

use super::named;
use crate::common::angle_deg;
use catoptric::field::{Ray, Scout};
use catoptric::gpu::{Gpu, NO_PATCH, Sample, SurfaceImage, View};
use catoptric::mesh::SubdivMesh;
use catoptric::patch::PatchKind;
use catoptric::stam::LimitSurface;
use glam::DVec3;

const SIDE: usize = 64;
/// Parts of a triangle's side in the polygons that rays are cast at.
const PARTS: usize = 24;

/// The surface as triangles: corners, ptex face.
fn polygons(surface: &LimitSurface) -> Vec<[DVec3; 3]> {
    let mut all = Vec::new();
    for ptex in 0..surface.ptex_count() as u32 {
        let at = |i: usize, j: usize| {
            let uv = [i, j].map(|k| k as f64 / PARTS as f64);
            surface.evaluate_ptex(ptex, uv).map(|(_, jet)| jet.position)
        };
        for (i, j) in (0..PARTS).flat_map(|i| (0..PARTS - i).map(move |j| (i, j))) {
            let Some(corner) = at(i, j) else { continue };
            let [Some(right), Some(up)] = [at(i + 1, j), at(i, j + 1)] else { continue };
            all.push([corner, right, up]);
            if i + j + 1 < PARTS {
                all.push([right, at(i + 1, j + 1).expect("inside"), up]);
            }
        }
    }
    all
}

/// Distance along a ray to a triangle (Moller & Trumbore 1997), with a margin round its edges.
fn hit(origin: DVec3, direction: DVec3, [a, b, c]: &[DVec3; 3], margin: f64) -> Option<f64> {
    let (ab, ac) = (*b - *a, *c - *a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let from = origin - *a;
    let u = from.dot(p) / determinant;
    let q = from.cross(ab);
    let v = direction.dot(q) / determinant;
    let t = ac.dot(q) / determinant;
    (u >= -margin && v >= -margin && u + v <= 1.0 + margin && t > 0.0).then_some(t)
}

struct Compared {
    seen: usize,
    irregular: usize,
}

fn compare(mesh: &SubdivMesh, gpu: &Gpu) -> Compared {
    let surface = LimitSurface::new(mesh).expect("it has a surface");
    let scout = Scout::new(&surface).expect("it has patches");
    let camera = scout.camera([SIDE as u32; 2], DVec3::Z);
    let tables = gpu.upload(&surface).expect("tables");
    let view = View::new(camera, scout.light(&camera));
    let image: SurfaceImage = gpu.inspect(&tables, &view).expect("a picture");
    let polygons = polygons(&surface);
    let (mut seen, mut irregular, mut beside) = (0, 0, 0);
    for index in 0..SIDE * SIDE {
        let [x, y] = [index % SIDE, index / SIDE].map(|k| k as f64 + 0.5);
        let Ray { origin, direction } = camera.pixel_ray(x, y);
        let nearest = |margin: f64| {
            polygons
                .iter()
                .filter_map(|triangle| hit(origin, direction, triangle, margin))
                .fold(f64::INFINITY, f64::min)
        };
        // Polygons with and without a margin differ at silhouettes and boundaries, where they say nothing.
        let [inner, outer] = [nearest(0.0), nearest(2.0)];
        let depth = (image.position[index] - origin).dot(direction);
        if image.patch[index] == NO_PATCH {
            beside += usize::from(inner.is_finite());
            continue;
        }
        seen += 1;
        let patch = image.patch[index] as usize;
        irregular += usize::from(surface.kind(patch) != PatchKind::Regular);
        // The point lies on the ray, and on the surface.
        let on_ray = origin + depth * direction;
        assert!(on_ray.distance(image.position[index]) < 1e-5 * mesh.diagonal(), "{} {index}", mesh.name);
        let jet = surface.evaluate(patch, image.uv[index].map(f64::from));
        assert!(jet.position.distance(image.position[index]) < 1e-6 * mesh.diagonal(), "{} {index}", mesh.name);
        let [u, v] = image.uv[index];
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-4, "{} {index}: {u} {v}", mesh.name);
        // The first one: chords are off by the square of 1/24 of a face.
        let off = (depth - inner).abs() / mesh.diagonal();
        if (inner - outer).abs() < 1e-3 * mesh.diagonal() {
            beside += usize::from(off > 2e-3);
        }
    }
    assert!(seen > SIDE * SIDE / 10, "{}: {seen} pixels", mesh.name);
    assert!(beside <= seen / 200 + 2, "{}: {beside} of {seen} pixels are not what the polygons show", mesh.name);
    Compared { seen, irregular }
}

#[test]
fn pixels_see_what_rays_meet() {
    let gpu = Gpu::new().expect("an adapter");
    let names = [
        "loop_icosahedron",
        "loop_pole_7",
        "loop_sectors_1_4",
        "loop_semi_sharp_dart",
        "loop_hole",
        "loop_tetrahedron",
    ];
    for name in names {
        let Compared { seen, irregular } = compare(&named(name), &gpu);
        println!("{name}: {seen} pixels, {irregular} of them on irregular patches");
        assert!(irregular > 0 || name == "loop_hole");
    }
}

/// The shader against f64, on every patch, deep in its corners too.
#[test]
fn the_shader_is_the_twin_of_f64() {
    let gpu = Gpu::new().expect("an adapter");
    let mut worst = [0.0f64; 2];
    for mesh in super::loop_meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        if surface.patches().is_empty() {
            continue;
        }
        let places =
            [[0.3f32, 0.4], [0.6, 0.2], [0.2, 0.7], [0.05, 0.1], [1e-4, 3e-5], [0.0, 0.0], [0.5, 0.5], [1.0, 0.0]];
        let samples: Vec<Sample> =
            (0..surface.patches().len() as u32).flat_map(|patch| places.map(|uv| Sample { patch, uv })).collect();
        let tables = gpu.upload(&surface).expect("tables");
        for (sample, jet) in samples.iter().zip(gpu.evaluate(&tables, &samples).expect("it evaluates")) {
            let exact = surface.evaluate(sample.patch as usize, sample.uv.map(f64::from));
            let off = [
                jet.position.distance(exact.position) / mesh.diagonal(),
                if exact.normal == DVec3::ZERO { 0.0 } else { angle_deg(jet.normal, exact.normal) },
            ];
            // Twenty roundings of f32 of a net that is three cells wide turn derivatives that are nearly parallel, or of which one is far
            // shorter, by more.
            let longest = exact.du.length().max(exact.dv.length());
            let sine = exact.du.normalize_or_zero().cross(exact.dv.normalize_or_zero()).length();
            let turn = 60.0 / 16_777_216.0 * longest * (1.0 / exact.du.length() + 1.0 / exact.dv.length()) / sine;
            let allowed = turn.to_degrees().max(1e-3);
            assert!(off[0] < 1e-6 && off[1] <= allowed, "{} {sample:?}: {off:?} {allowed}", mesh.name);
            worst[0] = worst[0].max(off[0]);
            worst[1] = worst[1].max(off[1] / allowed);
        }
    }
    println!("position at most {:e} of the diagonal, normal {} of what rounding allows", worst[0], worst[1]);
}
