//! Sharp edges along which tangent planes agree and curvature does not.
//!
//! Catmull-Clark's rules make a surface straight across an infinitely sharp edge on both sides: its second derivative across is 0. So
//! collinear control edges break nothing, curvature included. But lines across that run askew are straight in another direction: left of
//! the edge below is a parabolic cylinder, right of it a saddle, both exactly.

use crate::common::on_edge;
use crate::revolution::ROUNDING;
use crate::surfaces::grid;
use catoptric::field::{Camera, Field, Light, Point};
use catoptric::mesh::{Crease, SubdivMesh};
use catoptric::quality::{Continuity, FeatureKind, Limits, LineBreak, Quality, Reading};
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3, dvec3};

/// Curvature of the edge.
const K: f64 = 0.12;
/// Column of the sharp edge.
const EDGE: u32 = 3;
const SIZE: [u32; 2] = [7, 8];
/// Where the middle of the edge is.
const MIDDLE: f64 = 3.5;

/// The edge is c(v) = (v, 0, -K v^2 / 2), left of it c(v) + u (0, 1, 0), right of it c(v) + u ((0, a, 0) + b c'(v)). Splines have
/// quadratics with v^2 - 1/3 as the control value of v^2.
fn askew(a: f64, b: f64) -> SubdivMesh {
    let mut mesh = grid(SIZE, |i, j| {
        let (u, v) = (i - f64::from(EDGE), j - MIDDLE);
        let edge = dvec3(v, 0.0, -0.5 * K * (v * v - 1.0 / 3.0));
        let across = if u <= 0.0 { DVec3::Y } else { dvec3(b, a, -b * K * v) };
        edge + u * across
    });
    let [width, height] = SIZE;
    mesh.creases = (0..height - 1)
        .map(|j| Crease { vertices: [EDGE + width * j, EDGE + width * (j + 1)], sharpness: 10.0 })
        .collect();
    mesh
}

/// The right side is z = -K (x^2 - m^2 y^2) / 2 with m = b / a, the left one is that with m = 0.
fn graph(m: f64, at: DVec2) -> (DVec3, DVec3) {
    let DVec2 { x, y } = at;
    let position = dvec3(x, y, -0.5 * K * (x * x - m * m * y * y));
    (position, dvec3(K * x, -K * m * m * y, 1.0).normalize())
}

fn scene() -> (Camera, Field) {
    let points = [dvec3(-4.0, -3.0, -1.0), dvec3(4.0, 3.0, 0.5)];
    let camera = Camera::fit(&points, [640, 480], DVec3::Z, dvec3(0.4, -0.8, 1.3), 26.0);
    let light = Light::new(dvec3(1.0, 4.0, 9.0), dvec3(0.1, 0.2, -1.0), dvec3(0.7, 1.0, 0.2), 0.5);
    (camera, Field::reflection(light))
}

/// Angle by which the reflection line through (x, 0) turns, by differences of values on the two graphs.
fn turn(camera: &Camera, field: &Field, m: f64, x: f64) -> f64 {
    let value = |m: f64, at: DVec2| {
        let (position, normal) = graph(m, at);
        let sight = camera.sight(position);
        field.value(&Point { position, normal, sight, curvature: None }).expect("it mirrors the light").x
    };
    let (at, step) = (DVec2::new(x, 0.0), 1e-3);
    let along = |m: f64, axis: DVec2| {
        let apart = |step: f64| (value(m, at + step * axis) - value(m, at - step * axis)) / (2.0 * step);
        (4.0 * apart(step) - apart(2.0 * step)) / 3.0
    };
    // The tangent plane at (x, 0): along the edge a step is longer than along x.
    let length = (1.0 + (K * x).powi(2)).sqrt();
    let [a, b] = [0.0, m].map(|m| DVec2::new(along(m, DVec2::X) / length, along(m, DVec2::Y)));
    a.perp_dot(b).abs().atan2(a.dot(b)).to_degrees()
}

#[test]
fn tangent_planes_agree_and_curvature_does_not() {
    let (camera, field) = scene();
    for (a, b) in [(1.0, 0.6), (1.4, -0.5), (0.8, 1.1)] {
        let m = b / a;
        let mesh = askew(a, b);
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let reading = Some(Reading { field: &field, camera: &camera });
        let quality = Quality::measure(&mesh, &surface, reading, &Limits::default());
        let [crease] = &quality.features[..] else { panic!("one crease: {:?}", quality.features) };
        assert_eq!(crease.kind, FeatureKind::Crease);
        let adjacency = surface.adjacency();
        let mut compared = 0;
        for patch in 0..surface.patches().len() {
            for n in adjacency.across(patch, 1).iter().filter(|n| n.sharp) {
                for t in [0.1, 0.5, 0.8] {
                    let own = surface.evaluate_second(patch, on_edge(1, t));
                    let other = surface.evaluate_second(n.patch as usize, n.carry(1, on_edge(1, t)));
                    let x = own.first.position.x;
                    // Phantom points reach the ends of the edge: there it is no parabola.
                    if x.abs() > MIDDLE - 1.0 {
                        continue;
                    }
                    let joint = Continuity::new([&own, &other], own.first.dv, ROUNDING);
                    // Coordinates below 10 in a handful of sums.
                    assert!(joint.angle_deg.expect("normals") < 1e-12 && joint.gap < 1e-14, "{joint:?}");
                    // |0 - k| over |0| + |k|; 0 has no sign that could change.
                    assert_eq!((joint.difference, joint.concave), (Some(2.0), false));
                    // z_yy over the length of the normal, which points down: v runs along x.
                    let expected = -K * m * m / (1.0 + (K * x).powi(2)).sqrt();
                    let [left, right] = joint.curvature.expect("tangent planes");
                    assert!(left.abs() < 1e-14 && (right - expected).abs() < 1e-13, "{joint:?} {expected}");
                    let line = LineBreak::new(&field, &camera, [&own, &other], own.first.dv, ROUNDING).expect("values");
                    let expected = turn(&camera, &field, m, x);
                    let found = line.turn_deg.expect("slopes");
                    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
                    assert!(found > 0.5 && line.jump < 1e-12, "{line:?}");
                    compared += 1;
                }
            }
        }
        assert_eq!(compared, 3 * 5);
        assert_eq!(crease.extremes.difference, Some(2.0));
        assert!(quality.smooth.difference == Some(0.0));
    }
}

/// Straight on, whatever the lengths: nothing breaks, and no line turns.
#[test]
fn collinear_edges_across_a_sharp_one_break_nothing() {
    let (camera, field) = scene();
    for a in [1.0, 0.3, 2.5] {
        let mesh = askew(a, 0.0);
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let reading = Some(Reading { field: &field, camera: &camera });
        let quality = Quality::measure(&mesh, &surface, reading, &Limits::default());
        let [crease] = &quality.features[..] else { panic!("one crease: {:?}", quality.features) };
        assert_eq!(crease.kind, FeatureKind::Crease);
        assert!(crease.extremes.severity() < 1e-9 && crease.extremes.difference == Some(0.0), "{:?}", crease.extremes);
        assert!(crease.extremes.line.and_then(|line| line.turn_deg).expect("slopes") < 1e-6);
    }
}
