//! How far chords are from the contour between their ends: points of the contour, many a chord, found on the true surface, are within the
//! tolerance, and no curve has a point twice in a row.

use crate::bodies::{bumpy_ball, torus};
use crate::common::meshes;
use crate::theorem::{METHODS, family};
use catoptric::curves::{Curve, Place, trace};
use catoptric::field::{Camera, Contour, Field, Light, Method, Point, Scout};
use catoptric::mesh;
use catoptric::patch::Adjacency;
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3};
use std::path::Path;

/// What is looked at.
struct Scene<'a> {
    surface: &'a LimitSurface,
    adjacency: Adjacency,
    field: &'a Field,
    camera: &'a Camera,
}

/// What was found of chords.
#[derive(Default)]
struct Found {
    chords: usize,
    looks: usize,
    /// Places where no point of the contour was found: the field is undefined, or too steep there.
    lost: usize,
    /// Farthest point, in tolerances.
    farthest: f64,
}

impl Scene<'_> {
    /// F of a contour at a place, and the position there.
    fn zero(&self, contour: &Contour, face: u32, at: DVec2) -> Option<(f64, DVec3)> {
        let at = at.clamp(DVec2::ZERO, DVec2::ONE);
        let (patch, uv) = self.surface.locate(face, at.to_array())?;
        let (jet, curvature) = match self.field.method.reads_curvature() {
            true => {
                let jet = self.surface.evaluate_second(patch, uv);
                (jet.first, jet.curvature())
            }
            false => (self.surface.evaluate(patch, uv), None),
        };
        let sight = self.camera.sight(jet.position);
        let point = Point { position: jet.position, normal: jet.normal, sight, curvature };
        let functions = self.field.functions(&point)?;
        Some(((0..4).map(|k| contour.zero[k] * functions[k]).sum(), jet.position))
    }

    /// Two neighbouring places of a curve on one face: one of them may be on the edge to the other's.
    fn on_one_face(&self, a: Place, b: Place) -> Option<(u32, [DVec2; 2])> {
        let at = |place: Place| DVec2::new(place.u, place.v);
        if a.face == b.face {
            return Some((a.face, [at(a), at(b)]));
        }
        let carried = |place: Place, face: u32| {
            let (patch, [u, v]) = self.surface.locate(place.face, [place.u, place.v])?;
            let edges = [(v == 0.0, u), (u == 1.0, v), (v == 1.0, 1.0 - u), (u == 0.0, 1.0 - v)];
            (0..4u8).zip(edges).filter(|(_, (is_on, _))| *is_on).find_map(|(edge, (_, t))| {
                let neighbour = self.adjacency.at(patch, edge, t)?;
                let other = &self.surface.patches()[neighbour.patch as usize];
                (other.ptex == face).then(|| DVec2::from_array(other.to_ptex(neighbour.carry(edge, [u, v]))))
            })
        };
        let first = carried(a, b.face).map(|a| (b.face, [a, at(b)]));
        first.or_else(|| carried(b, a.face).map(|b| (a.face, [at(a), b])))
    }

    /// The point of the contour beside a place of the chord of the parameters, by secants across it.
    fn beside(&self, contour: &Contour, face: u32, at: DVec2, along: DVec2) -> Option<DVec3> {
        let zero = |aside: f64| self.zero(contour, face, at + along.perp() * aside);
        let (mut x, mut y) = (0.0, 1e-3);
        let ((mut fx, _), (mut fy, _)) = (zero(x)?, zero(y)?);
        for _ in 0..40 {
            let next = y - fy * (y - x) / (fy - fx);
            // Not on another branch of it.
            if !next.is_finite() || next.abs() > 0.7 {
                return None;
            }
            let step = (next - y).abs();
            (x, fx) = (y, fy);
            y = next;
            let position;
            (fy, position) = zero(y)?;
            if step < 1e-9 {
                return Some(position);
            }
            if fy == fx {
                return None;
            }
        }
        None
    }

    /// Looks at so many places of chords, of at most about `most` of them.
    fn measure(&self, curves: &[Curve], tolerance: f64, (most, looks): (usize, usize), found: &mut Found) {
        let all: usize = curves.iter().map(|curve| curve.points.len()).sum();
        let (stride, mut number) = (all.div_ceil(most).max(1), 0);
        for curve in curves {
            let contour = self.field.contour(curve.light, curve.value).expect("it was traced");
            let count = curve.points.len();
            for k in 0..if curve.closed { count } else { count - 1 } {
                let [a, b] = [k, (k + 1) % count];
                number += 1;
                if number % stride != 0 {
                    continue;
                }
                let Some((face, [from, to])) = self.on_one_face(curve.places[a], curve.places[b]) else { continue };
                let ends = [curve.points[a], curve.points[b]];
                found.chords += 1;
                for look in 1..looks {
                    found.looks += 1;
                    let at = from.lerp(to, look as f64 / looks as f64);
                    match self.beside(&contour, face, at, to - from) {
                        Some(point) => found.farthest = found.farthest.max(distance(point, ends) / tolerance),
                        None => found.lost += 1,
                    }
                }
            }
        }
    }
}

fn distance(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let d = b - a;
    let t = ((point - a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    point.distance(a + t * d)
}

/// No point, and no place, comes twice in a row; a closed curve does not come back to its first one.
fn assert_no_repeats(curves: &[Curve], what: &str) {
    for curve in curves {
        let count = curve.points.len();
        for k in 0..if curve.closed { count } else { count - 1 } {
            let next = (k + 1) % count;
            assert!(curve.points[k] != curve.points[next], "{what}: {} twice", curve.points[k]);
            assert!(curve.places[k] != curve.places[next], "{what}: {:?} twice", curve.places[k]);
        }
    }
}

/// A section that bends both ways between two points: the middle of its chord is on it.
#[test]
fn bends_to_both_sides_are_seen() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/contours/chord_s_curve.obj");
    let surface = LimitSurface::new(&mesh::read(&path).expect("a mesh")).expect("it has a surface");
    let camera = Scout::new(&surface).expect("it has patches").camera([256; 2], DVec3::Z);
    let field = Field { light: Light::new(DVec3::ZERO, DVec3::Y, DVec3::X, 1.0), method: Method::Section };
    let scene = Scene { surface: &surface, adjacency: surface.adjacency(), field: &field, camera: &camera };
    for z in [-0.9550459458, -0.955, -0.95, -0.9, -0.5, 0.0, 0.3] {
        for part in [1e-2, 1e-3, 1e-4, 1e-5] {
            let tolerance = part * surface.diagonal();
            let curves = trace(&surface, &field, &camera, &[(0, z)], tolerance);
            let mut found = Found::default();
            scene.measure(&curves, tolerance, (usize::MAX, 400), &mut found);
            println!("z = {z}, tolerance {part:e}: {} chords, {:.3} tolerances", found.chords, found.farthest);
            assert!(found.farthest <= 1.0, "z = {z}, tolerance {part:e}: {}", found.farthest);
            assert!(found.chords == 0 || found.lost * 100 < found.looks, "{} of {}", found.lost, found.looks);
            assert_no_repeats(&curves, "section");
        }
    }
}

/// Every method, on bodies that bend every way, at coarse and fine tolerances.
#[test]
fn chords_are_within_the_tolerance_on_all_of_their_length() {
    let own = meshes().into_iter().filter(|mesh| ["pole_5", "crease_2_7", "dart", "sample"].contains(&&*mesh.name));
    let bodies = own.chain([bumpy_ball(7, 3, 0.35), torus(7, 5, [1.0, 0.4])]);
    let mut all = Found::default();
    for mesh in bodies {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let scout = Scout::new(&surface).expect("it has patches");
        let camera = scout.camera([256; 2], DVec3::Z);
        for name in METHODS {
            let method: Method = name.parse().expect("a method");
            let field = scout.field(&method, &camera);
            let scene = Scene { surface: &surface, adjacency: surface.adjacency(), field: &field, camera: &camera };
            let mut values = family(&scout, &field, &camera);
            values.truncate(3);
            let mut found = Found::default();
            for part in [1e-2, 1e-3, 1e-4] {
                let tolerance = part * surface.diagonal();
                let curves = trace(&surface, &field, &camera, &values, tolerance);
                scene.measure(&curves, tolerance, (400, 25), &mut found);
                assert_no_repeats(&curves, &format!("{} {name}", mesh.name));
            }
            assert!(found.farthest <= 1.0, "{} {name}: {} tolerances", mesh.name, found.farthest);
            all.chords += found.chords;
            all.looks += found.looks;
            all.lost += found.lost;
            all.farthest = all.farthest.max(found.farthest);
        }
    }
    println!("{} chords, {} looks, {} lost; {:.3} tolerances", all.chords, all.looks, all.lost, all.farthest);
    assert!(all.chords > 10_000 && all.lost * 50 < all.looks, "{} of {} lost", all.lost, all.looks);
    // It is no bound that divides everything.
    assert!(all.farthest > 0.8, "{}", all.farthest);
}
