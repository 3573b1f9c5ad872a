//! The ray caster against closed forms and brute force, before it judges anything.

mod caster;
mod caster_brute;
mod common;
#[allow(dead_code, reason = "each test program uses its part")]
mod gpu_support;

use caster::{Caster, Hit, Ray};
use caster_brute::Brute;
use catoptric::mesh::{self, Boundary, SubdivMesh};
use catoptric::patch::PatchKind;
use catoptric::stam::LimitSurface;
use common::on_edge;
use glam::{DVec3, dvec3};
use gpu_support::{Random, mesh};
use rayon::prelude::*;
use std::time::Instant;

fn surface(mesh: &SubdivMesh) -> LimitSurface {
    LimitSurface::new(mesh).expect("it has a surface")
}

/// A sheet of n x n vertices, of which only the faces that do not touch the boundary have a surface: no phantom points, so
/// each coordinate is the bicubic spline of its control values.
fn sheet(n: i32, point: impl Fn(f64, f64) -> DVec3) -> SubdivMesh {
    let at = |i: i32, j: i32| (j * n + i) as u32;
    let middle = f64::from(n - 1) * 0.5;
    let faces: Vec<(i32, i32)> = (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (i, j))).collect();
    SubdivMesh {
        name: "sheet".into(),
        points: (0..n * n).map(|k| point(f64::from(k % n) - middle, f64::from(k / n) - middle)).collect(),
        face_sizes: vec![4; faces.len()],
        face_vertices: faces
            .iter()
            .flat_map(|&(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
            .collect(),
        boundary: Boundary::None,
        ..SubdivMesh::default()
    }
}

/// A point on the sphere.
fn direction(random: &mut Random) -> DVec3 {
    loop {
        let p = dvec3(random.next(), random.next(), random.next()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&p.length()) {
            return p.normalize();
        }
    }
}

/// A ray from outside through a random point of the box.
fn random_ray(random: &mut Random, [low, high]: [DVec3; 2]) -> Ray {
    let through = low + (high - low) * dvec3(random.next(), random.next(), random.next());
    let origin = (low + high) * 0.5 + direction(random) * (high - low).length() * (0.6 + random.next());
    Ray::new(origin, through - origin)
}

/// Hits at the roots of a function along the ray, where they lie inside the sheet; `near_edge` where that is in doubt.
fn expect_roots(caster: &Caster, ray: &Ray, roots: &[f64], inside: impl Fn(DVec3) -> f64) -> bool {
    // Hits on an edge count or not; within rounding of one, either is right.
    if roots.iter().any(|&t| inside(ray.at(t)).abs() < 1e-9) {
        return false;
    }
    let mut expected: Vec<f64> = roots.iter().copied().filter(|&t| t >= ray.start && inside(ray.at(t)) > 0.0).collect();
    expected.sort_by(f64::total_cmp);
    let hits = caster.all_hits(ray);
    let found: Vec<f64> = hits.iter().map(|hit| hit.t).collect();
    assert_eq!(found.len(), expected.len(), "{ray:?}: {found:?} {expected:?}");
    let first = caster.first_hit(ray).map(|hit| hit.t);
    assert_eq!(first, found.first().copied(), "{ray:?}: the first of {found:?}");
    for (found, expected) in found.iter().zip(&expected) {
        // Coordinates below 10, so rounding of 1e-14; roots are off by that over the slope, which is the square root of
        // their distance to a double root: 1e-7 for those that are 1e-14 apart, but no two of these are nearer than 1e-4.
        assert!((found - expected).abs() < 1e-9, "{ray:?}: {found} {expected}");
    }
    true
}

fn real_roots_of_quadratic(a: f64, b: f64, c: f64) -> Vec<f64> {
    let root = (b * b - 4.0 * a * c).sqrt();
    // NaN where there is none: no comparison holds.
    let q = -0.5 * (b + root.copysign(b));
    if root.is_nan() { Vec::new() } else { vec![q / a, c / q] }
}

#[test]
fn a_flat_sheet_is_a_plane() {
    // x and y are linear in the parameters, so 5 x 5 faces from -2.5 to 2.5.
    let surface = surface(&sheet(8, |x, y| dvec3(x, y, 0.25 * x - 0.5 * y + 1.0)));
    let caster = Caster::new(&surface);
    let (mut random, mut hits) = (Random::new(1), 0);
    let normal = dvec3(-0.25, 0.5, 1.0);
    for _ in 0..5000 {
        let ray = random_ray(&mut random, [dvec3(-3.0, -3.0, -1.0), dvec3(3.0, 3.0, 3.0)]);
        let t = (1.0 - normal.dot(ray.origin)) / normal.dot(ray.direction);
        let roots = if t >= 0.0 { vec![t] } else { vec![] };
        expect_roots(&caster, &ray, &roots, |p| 2.5 - p.x.abs().max(p.y.abs()));
        if let Some(hit) = caster.first_hit(&ray) {
            hits += 1;
            assert!(common::angle_deg(hit.normal, normal) < 1e-12, "{}", hit.normal);
            assert!(hit.position.distance(ray.at(hit.t)) < 1e-13, "{hit:?}");
        }
    }
    assert!(hits > 2000, "{hits}");
}

/// The spline with control values i^2 is x^2 + 1/3.
#[test]
fn a_paraboloid_is_met_where_the_quadratic_says() {
    let surface = surface(&sheet(8, |x, y| dvec3(x, y, 0.3 * (x * x + y * y))));
    let caster = Caster::new(&surface);
    let (mut random, mut twice, mut tested) = (Random::new(2), 0, 0);
    for _ in 0..20_000 {
        let ray = random_ray(&mut random, [dvec3(-2.6, -2.6, 0.0), dvec3(2.6, 2.6, 4.0)]);
        let (o, d) = (ray.origin, ray.direction);
        let a = 0.3 * (d.x * d.x + d.y * d.y);
        let b = 0.6 * (o.x * d.x + o.y * d.y) - d.z;
        let c = 0.3 * (o.x * o.x + o.y * o.y) + 0.2 - o.z;
        let roots = real_roots_of_quadratic(a, b, c);
        if roots.len() == 2 && (roots[0] - roots[1]).abs() < 1e-4 {
            continue;
        }
        tested += usize::from(expect_roots(&caster, &ray, &roots, |p| 2.5 - p.x.abs().max(p.y.abs())));
        twice += usize::from(caster.all_hits(&ray).len() == 2);
    }
    assert!(tested > 19_000 && twice > 1000, "{tested} {twice}");
}

/// Near the silhouette: rays that pass a paraboloid's side at a given distance on either side.
#[test]
fn silhouettes_are_where_they_are() {
    let surface = surface(&sheet(8, |x, y| dvec3(x, y, 0.3 * (x * x + y * y))));
    let caster = Caster::new(&surface);
    let mut random = Random::new(3);
    for _ in 0..500 {
        let [x, y, angle] = [3.0, 3.0, std::f64::consts::TAU].map(|size| size * (random.next() - 0.5));
        let point = dvec3(x, y, 0.3 * (x * x + y * y) + 0.2);
        let tangent = dvec3(angle.cos(), angle.sin(), 0.6 * (x * angle.cos() + y * angle.sin()));
        let normal = dvec3(0.6 * x, 0.6 * y, -1.0).normalize();
        // The tolerance is 1e-12 of a net's size, 5, in two directions: 7e-12.
        for offset in [1e-3, 1e-6, 1e-9, 1e-11] {
            let ray = |side: f64| Ray::new(point + side * offset * normal - 2.0 * tangent, tangent);
            // The normal points outwards, away from the hollow; lines at the hollow's side pass through it.
            assert!(caster.first_hit(&ray(1.0)).is_none(), "{offset:e} outside {point}");
            assert!(caster.first_hit(&ray(-1.0)).is_some(), "{offset:e} inside {point}");
        }
    }
}

/// x = s^3 - s, z = s: every line along x meets it once, lines along z up to three times, with both folds inside patches.
/// The spline with control values i^3 is s^3 + s.
#[test]
fn folds_have_all_their_layers() {
    let surface = surface(&sheet(8, |s, y| dvec3(s * s * s - 2.0 * s, y, s)));
    let caster = Caster::new(&surface);
    let (mut random, mut thrice) = (Random::new(4), 0);
    for _ in 0..20_000 {
        let mut ray = random_ray(&mut random, [dvec3(-1.0, -2.4, -1.5), dvec3(1.0, 2.4, 1.5)]);
        ray.start = f64::NEG_INFINITY;
        let (o, d) = (ray.origin, ray.direction);
        // f(s) = s^3 - s - x(s), x along the ray as a function of z = s.
        let slope = d.x / d.z;
        let f = |s: f64| s * s * s - s - (o.x + slope * (s - o.z));
        let turn = ((1.0 + slope) / 3.0).max(0.0).sqrt();
        if (f(turn).abs().min(f(-turn).abs())) < 1e-6 || slope.abs() > 1e3 {
            continue;
        }
        // Beyond 2 + |c| + |slope| + 1 the cube is larger than the rest.
        let end = 4.0 + o.x.abs() + slope.abs() * (1.0 + o.z.abs());
        let ends = [-end, -turn, turn, end];
        let roots: Vec<f64> =
            ends.windows(2).filter(|w| f(w[0]) * f(w[1]) < 0.0).map(|w| (bisect(f, w[0], w[1]) - o.z) / d.z).collect();
        expect_roots(&caster, &ray, &roots, |p| 2.5 - p.y.abs().max(p.z.abs()));
        thrice += usize::from(caster.all_hits(&ray).len() == 3);
    }
    assert!(thrice > 1000, "{thrice}");
}

fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = low.midpoint(high);
        if f(low) * f(middle) <= 0.0 { high = middle } else { low = middle }
    }
    low.midpoint(high)
}

/// Closed meshes: rays from outside meet them an even number of times, those that aim at points on edges and corners of
/// patches included, and these meet them at that point.
#[test]
fn closed_surfaces_are_watertight() {
    for mesh in [mesh("cube.obj"), mesh("corner.obj"), mesh("n_gons.obj"), mesh("groups_two_components.obj")] {
        let surface = surface(&mesh);
        let caster = Caster::new(&surface);
        let bounds = surface.bounds().expect("it has patches");
        let mut random = Random::new(5);
        let mut rays: Vec<(Ray, Option<DVec3>)> =
            (0..20_000).map(|_| (random_ray(&mut random, bounds), None)).collect();
        for (patch, edge) in (0..surface.patches().len()).flat_map(|patch| (0..4).map(move |edge| (patch, edge))) {
            for t in [0.0, 0.0, 0.5, 0.25, random.next(), random.next()] {
                let point = surface.evaluate(patch, on_edge(edge, t)).position;
                let origin = random_ray(&mut random, bounds).origin;
                rays.push((Ray::new(origin, point - origin), Some(point)));
            }
        }
        let diagonal = surface.diagonal();
        // A line may touch a corner or pass in through it; both are one hit there.
        let is_corner = |point: &DVec3| {
            let mut corners = (0..surface.patches().len()).filter(|&patch| surface.kind(patch) == PatchKind::Corner);
            corners.any(|patch| surface.evaluate(patch, [0.0; 2]).position.distance(*point) < 1e-9)
        };
        let parity = |(ray, point): &&(Ray, Option<DVec3>)| {
            !caster.all_hits(ray).len().is_multiple_of(2) && !point.as_ref().is_some_and(is_corner)
        };
        let odd: Vec<_> = rays.par_iter().filter(parity).collect();
        println!("{}: {} of {} rays meet the surface an odd number of times", mesh.name, odd.len(), rays.len());
        for (ray, point) in &rays {
            let Some(point) = point else { continue };
            let hits = caster.all_hits(ray);
            let off = hits.iter().map(|hit| hit.position.distance(*point)).fold(f64::INFINITY, f64::min);
            // The ray passes the point at 1e-15; along it the hit is off by CLOSED over the sine of the angle between ray
            // and surface, which is above 1e-3 for all but one in a million.
            assert!(off < 1e-9 * diagonal, "{}: {off:e} from {point}", mesh.name);
            let first = caster.first_hit(ray).expect("there are hits");
            let apart = first.position.distance(hits[0].position);
            assert!(apart < 1e-9 * diagonal && first.t <= 1.0 + 1e-9, "{}: {first:?} {:?}", mesh.name, hits[0]);
        }
        // Tangents from outside, where two hits are one, are too rare for 20,000 rays.
        assert!(odd.is_empty(), "{}: {odd:?}", mesh.name);
    }
}

/// Rays that aim at extraordinary vertices of every kind, or pass them as near as doubles can tell.
#[test]
fn extraordinary_vertices_are_met() {
    for mesh in common::meshes() {
        let surface = surface(&mesh);
        let caster = Caster::new(&surface);
        let begin = Instant::now();
        let mut random = Random::new(6);
        let mut aimed = 0;
        for patch in (0..surface.patches().len()).filter(|&patch| surface.kind(patch) != PatchKind::Regular) {
            let tip = surface.evaluate(patch, [0.0; 2]).position;
            for k in [5, 20, 45, 60] {
                let uv = [random.next(), random.next()].map(|x| x * 0.5f64.powi(k));
                let target = if k == 60 { tip } else { surface.evaluate(patch, uv).position };
                let origin = target + direction(&mut random) * surface.diagonal();
                let ray = Ray::new(origin, target - origin);
                let near = |hit: &Hit| hit.position.distance(target);
                let off = caster.all_hits(&ray).iter().map(near).fold(f64::INFINITY, f64::min);
                // As above; for slow classes the tip is 3e-10 of the patch.
                assert!(off < 2e-9 * surface.diagonal(), "{} patch {patch} {uv:?}: {off:e}", mesh.name);
                aimed += 1;
            }
        }
        println!("{}: {aimed} rays in {:.1?}", mesh.name, begin.elapsed());
    }
}

/// First hits against triangles, on three surfaces; where they differ, the triangles themselves say that an edge is near.
#[test]
fn triangles_agree_within_their_error() {
    for mesh in [mesh("pole_5.obj"), mesh("n_gons.obj"), mesh("dart_8.obj")] {
        let surface = surface(&mesh);
        let (caster, brute) = (Caster::new(&surface), Brute::new(&surface, 64));
        let bounds = surface.bounds().expect("it has patches");
        let mut random = Random::new(7);
        let rays: Vec<Ray> = (0..3000).map(|_| random_ray(&mut random, bounds)).collect();
        let results: Vec<_> = rays.par_iter().map(|ray| (caster.first_hit(ray), brute.first_hit(ray))).collect();
        let (mut compared, mut excused, mut farthest) = (0, 0, 0.0f64);
        for (ray, (hit, reference)) in rays.iter().zip(&results) {
            let unit = ray.direction.length();
            // Where two surfaces are at most `error` apart, a ray at this angle meets them so far apart.
            let off = match (hit, reference) {
                (Some(hit), Some((t, normal))) => {
                    (hit.t - t).abs() * unit * normal.dot(ray.direction / unit).abs() / brute.error
                }
                (None, None) => continue,
                _ => f64::INFINITY,
            };
            if off <= 1.5 {
                compared += 1;
                farthest = farthest.max(off);
            } else {
                excused += 1;
                let (x, y) = (ray.direction / unit).any_orthonormal_pair();
                let around: Vec<_> = (0..16)
                    .map(|k| {
                        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 16.0).sin_cos();
                        let shift = 2.0 * brute.error * (cos * x + sin * y);
                        brute.first_hit(&Ray { origin: ray.origin + shift, ..*ray })
                    })
                    .collect();
                let edge = around.iter().any(|h| h.is_none() != reference.is_none())
                    || around.iter().flatten().any(|(_, n)| n.dot(ray.direction / unit).abs() < 0.1);
                assert!(edge, "{}: {ray:?}: {hit:?} {reference:?}", mesh.name);
            }
        }
        println!(
            "{}: {compared} hits within {farthest:.2} of the triangles' error of {:.1e}, {excused} at edges",
            mesh.name, brute.error
        );
        assert!(compared > 1000 && excused < compared / 50, "{}: {compared} {excused}", mesh.name);
    }
}

/// Prints how long a ray takes.
#[test]
fn rays_are_cheap() {
    for mesh in [mesh::sample(), mesh("pole_40.obj"), mesh("cube.obj")] {
        let surface = surface(&mesh);
        let start = Instant::now();
        let caster = Caster::new(&surface);
        let built = start.elapsed();
        let bounds = surface.bounds().expect("it has patches");
        let mut random = Random::new(8);
        let rays: Vec<Ray> = (0..20_000).map(|_| random_ray(&mut random, bounds)).collect();
        let start = Instant::now();
        let hits = rays.iter().filter_map(|ray| caster.first_hit(ray)).count();
        let each = start.elapsed().as_secs_f64() * 1e6 / rays.len() as f64;
        println!("{}: built in {built:.1?}, {each:.1} us a ray, {hits} of {} hit", mesh.name, rays.len());
        assert!(hits > 1000, "{hits}");
    }
}
