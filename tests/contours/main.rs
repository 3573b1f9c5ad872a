//! What the papers say of contours, on traced curves: Ulmet's theorem, Beier & Chen's properties, kinks at joints.

#[path = "../common/bodies.rs"]
mod bodies;
mod chords;
#[path = "../common/mod.rs"]
mod common;
mod joints;
mod physical;
mod theorem;
mod zero_sets;

use catoptric::curves::Curve;
use glam::DVec3;

/// Distance of a point from polylines.
fn distance(curves: &[Curve], point: DVec3) -> f64 {
    let of_segment = |a: DVec3, b: DVec3| {
        let d = b - a;
        let t = ((point - a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        point.distance(a + t * d)
    };
    let of_curve = |curve: &Curve| {
        let count = curve.points.len();
        let last = if curve.closed { count } else { count - 1 };
        (0..last).map(|k| of_segment(curve.points[k], curve.points[(k + 1) % count])).fold(f64::INFINITY, f64::min)
    };
    curves.iter().map(of_curve).fold(f64::INFINITY, f64::min)
}
