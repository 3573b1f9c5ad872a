//! Lines across joints (Beier & Chen 1994, property 2; Ulmet 2003, figures 6.1 and 6.2): where the normal breaks, lines break off; where
//! only the curvature breaks, they have kinks; on a smooth surface they have none.
//!
//! Catmull-Clark surfaces are C2 but at extraordinary vertices and sharp edges. A sharp edge leaves each side its own bicubics, with a second
//! derivative of zero across it. So a joint that is C1 and not C2 is one whose sides have rulings in different directions of one tangent
//! plane: rows y <= 0 of a parabolic cylinder z = a x^2 / 2, and rows y >= 0 sheared by b. The sheared ones have the points
//! (x + b y, y, a x^2 / 2 + a b x y), which are z = a (X^2 - b^2 y^2) / 2 with X = x + b y: the same plane at y = 0, but a curvature of -a b^2
//! across instead of 0. Both are exact, as are all quadratics. (The paper's surfaces of revolution have circles, which no cubic spline has.)

use crate::bodies::bicubics;
use catoptric::curves::{Curve, trace};
use catoptric::field::{Camera, Field, HighlightKind, Light, Method, Mirrored, Point, Projection};
use catoptric::mesh::Crease;
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3, dvec3};

/// Curvature of the cylinder, and shear.
const A: f64 = 0.8;
const B: f64 = 0.7;

/// Two sheets that meet at y = 0.
#[derive(Debug, Clone, Copy)]
struct Joint {
    /// How much the second one rises.
    slope: f64,
    /// They meet in a sharp edge: otherwise the rules round them off.
    sharp: bool,
}

impl Joint {
    const SIZE: usize = 6;

    fn surface(&self) -> LimitSurface {
        let step = 2.0 / Self::SIZE as f64;
        let mut mesh = bicubics("joint", Self::SIZE, |i, j| {
            let [x, y] = [i, j].map(|k| k * step - 1.0);
            // No rounding may come over to the first sheet.
            let beyond = if j > 0.5 * Self::SIZE as f64 { y } else { 0.0 };
            let square = 0.5 * A * (x * x - step * step / 3.0);
            dvec3(x + B * beyond, y, square + A * B * x * beyond + self.slope * beyond)
        });
        if self.sharp {
            let row = (Self::SIZE / 2 + 1) * (Self::SIZE + 3);
            let edge = |k: usize| Crease { vertices: [k as u32, k as u32 + 1], sharpness: 10.0 };
            mesh.creases = (row..row + Self::SIZE + 2).map(edge).collect();
        }
        LimitSurface::new(&mesh).expect("it has a surface")
    }

    /// Position and normal of a sheet, or of what continues it.
    fn sheet(&self, second: bool, x: f64, y: f64) -> (DVec3, DVec3) {
        let (across, slope) = if second { (-A * B * B, self.slope) } else { (0.0, 0.0) };
        let position = dvec3(x, y, 0.5 * (A * x * x + across * y * y) + slope * y);
        (position, dvec3(-A * x, -across * y - slope, 1.0).normalize())
    }

    fn value(&self, field: &Field, second: bool, x: f64, y: f64) -> f64 {
        let (position, normal) = self.sheet(second, x, y);
        let sight = camera().sight(position);
        field.value(&Point { position, normal, sight, curvature: None }).expect("it has a value").x
    }

    /// Direction of the line through (x, 0) on a sheet, towards y > 0: along the surface, across the gradient.
    fn direction(&self, field: &Field, second: bool, x: f64) -> DVec3 {
        const STEP: f64 = 1e-5;
        let at = |x: f64, y: f64| self.value(field, second, x, y);
        let gradient = DVec2::new(at(x + STEP, 0.0) - at(x - STEP, 0.0), at(x, STEP) - at(x, -STEP));
        let across = gradient.perp();
        let slope = if second { self.slope } else { 0.0 };
        let direction = dvec3(across.x, across.y, A * x * across.x + slope * across.y);
        direction.normalize() * across.y.signum()
    }
}

fn camera() -> Camera {
    Camera {
        eye: dvec3(0.4, -2.5, 2.0),
        target: DVec3::ZERO,
        up: DVec3::Z,
        projection: Projection::Perspective { fov: 40.0 },
        size: [64; 2],
    }
}

/// Reflection lines, texture reflection lines as in Ulmet's figures, and highlight lines; askew, so that they cross the joint at angles.
fn fields() -> [Field; 3] {
    let light = Light::new(dvec3(0.3, 0.4, 3.0), dvec3(0.1, 0.2, -1.0), dvec3(0.6, 1.0, 0.0), 0.5);
    let methods = [Method::Reflection, Method::Sphere(Mirrored::Reflection), Method::Highlight(HighlightKind::Array)];
    methods.map(|method| {
        let facing = if matches!(method, Method::Sphere(_)) {
            dvec3(-0.8, -0.3, -0.4)
        } else {
            -light.axes[0].cross(light.axes[1])
        };
        let light =
            if matches!(method, Method::Sphere(_)) { Light::new(DVec3::ZERO, facing, DVec3::X, 10.0) } else { light };
        Field { light, method }
    })
}

/// Directions towards y > 0 in which lines arrive at (x, 0) and leave it, as chords.
fn chords(curves: &[Curve], x: f64) -> [Vec<DVec3>; 2] {
    let mut sides = [Vec::new(), Vec::new()];
    for curve in curves {
        for (k, point) in curve.points.iter().enumerate() {
            if point.y.abs() > 1e-9 || (point.x - x).abs() > 1e-7 {
                continue;
            }
            let next = [k.checked_sub(1), Some(k + 1)];
            for other in next.into_iter().flatten().filter_map(|k| curve.points.get(k)) {
                let chord = *other - *point;
                // A line that ends here and one that begins may both hold the point.
                if chord.length() > 1e-9 {
                    sides[usize::from(chord.y > 0.0)].push(chord.normalize() * chord.y.signum());
                }
            }
        }
    }
    sides
}

/// Largest angle between two chords that follow each other.
fn largest_turn(curves: &[Curve]) -> f64 {
    let turns = curves.iter().flat_map(|curve| {
        curve.points.windows(3).map(|p| (p[1] - p[0]).angle_between(p[2] - p[1])).filter(|turn| turn.is_finite())
    });
    turns.fold(0.0, f64::max)
}

/// The sheets are what they are said to be, and the joint is C1.
#[test]
fn joints_are_exact() {
    for slope in [0.0, 0.3] {
        let joint = Joint { slope, sharp: true };
        let surface = joint.surface();
        for face in 0..surface.ptex_count() as u32 {
            for uv in [[0.0, 0.0], [0.3, 0.8], [1.0, 1.0], [0.5, 0.1]] {
                let Some((_, jet)) = surface.evaluate_ptex(face, uv) else { continue };
                let (_, inside) = surface.evaluate_ptex(face, [0.5; 2]).expect("no hole");
                let (position, normal) = joint.sheet(inside.position.y > 0.0, jet.position.x, jet.position.y);
                assert!(jet.position.distance(position) < 1e-14 && jet.normal.distance(normal) < 1e-13);
            }
        }
        let [a, b] = [false, true].map(|second| joint.sheet(second, 0.3, 0.0).1);
        assert_eq!(a == b, slope == 0.0);
    }
}

/// Chord error: chords differ from tangents by (2 k 1e-9)^(1/2), 1e-4 where the curvature k is some units.
const FINE: f64 = 1e-9;

/// Curvature breaks across the joint, and lines have a kink: that which the two sheets' equations say.
#[test]
fn c1_joints_have_kinks() {
    let joint = Joint { slope: 0.0, sharp: true };
    let surface = joint.surface();
    let mut kinks = 0;
    for field in fields() {
        for x in [-0.55, -0.2, 0.15, 0.5] {
            let c = joint.value(&field, false, x, 0.0);
            assert!((joint.value(&field, true, x, 0.0) - c).abs() < 1e-12);
            let curves = trace(&surface, &field, &camera(), &[(0, c)], FINE);
            let [before, after] = chords(&curves, x);
            let expected = [false, true].map(|second| joint.direction(&field, second, x));
            for (found, expected) in [(&before, expected[0]), (&after, expected[1])] {
                assert!(!found.is_empty(), "{} {x}: no line", field.method);
                for chord in found {
                    assert!(chord.angle_between(expected) < 1e-3, "{} {x}: {chord} {expected}", field.method);
                }
            }
            let kink = before[0].angle_between(after[0]).to_degrees();
            println!("{} at x = {x}: kink of {kink:.3} degrees", field.method);
            kinks += usize::from(kink > 2.0);
        }
    }
    assert!(kinks >= 9, "{kinks}");
}

/// The same control points without the sharp edge: a C2 surface. Lines turn less and less from chord to chord as these get shorter.
#[test]
fn c2_joints_have_none() {
    let joint = Joint { slope: 0.0, sharp: false };
    let surface = joint.surface();
    for field in fields() {
        let values: Vec<_> =
            (0..4).map(|k| (k, joint.value(&field, false, 0.35 * f64::from(k) - 0.55, -0.5))).collect();
        let turns =
            [1e-5, 1e-7, 1e-9].map(|tolerance| largest_turn(&trace(&surface, &field, &camera(), &values, tolerance)));
        println!("{}: largest turns {turns:?}", field.method);
        // With the root of the tolerance: by ten a step; by more than three at least.
        assert!(turns[1] < turns[0] / 3.0 && turns[2] < turns[1] / 3.0 && turns[2] < 2e-3, "{turns:?}");
    }
}

/// The normal breaks across the joint, and lines with it: they end on both sides, where the two sheets' equations say.
#[test]
fn g0_joints_break_lines() {
    let joint = Joint { slope: 0.3, sharp: true };
    let surface = joint.surface();
    let mut jumps = 0;
    for field in fields() {
        for start in [-0.55, -0.2, 0.15, 0.5] {
            let c = joint.value(&field, false, start, 0.0);
            let curves = trace(&surface, &field, &camera(), &[(0, c)], 1e-5);
            let ends: Vec<DVec3> = curves
                .iter()
                .filter(|curve| !curve.closed)
                .flat_map(|curve| [curve.points[0], curve.points[curve.points.len() - 1]])
                .filter(|end| end.y.abs() < 1e-9)
                .collect();
            let mut expected = Vec::new();
            for second in [false, true] {
                const STEPS: i32 = 4000;
                let above = |x: f64| joint.value(&field, second, x, 0.0) > c;
                let at = |n: i32| 2.0 * f64::from(n) / f64::from(STEPS) - 1.0 + 1e-7;
                for n in 0..STEPS - 1 {
                    let (mut low, mut high) = (at(n), at(n + 1));
                    if above(low) != above(high) {
                        for _ in 0..60 {
                            let middle = 0.5 * (low + high);
                            if above(middle) == above(low) { low = middle } else { high = middle }
                        }
                        expected.push(low);
                    }
                }
            }
            assert_eq!(ends.len(), expected.len(), "{} {start}: {ends:?} {expected:?}", field.method);
            for x in &expected {
                assert!(
                    ends.iter().any(|end| (end.x - x).abs() < 1e-9),
                    "{} {start}: {ends:?} {expected:?}",
                    field.method
                );
            }
            let first = expected[0];
            jumps += usize::from(expected.iter().any(|x| (x - first).abs() > 0.01));
        }
    }
    assert!(jumps >= 9, "{jumps}");
}
