//! Fields of the shape alone: isophotes (Poeschl 1984), curvature (do Carmo 1976), sections.

use crate::bodies::Graph;
use crate::scene::{ANGLE, Sample, close, everywhere};
use catoptric::field::{CurvatureKind, Method};
use glam::DVec2;

/// n . L = cos(angle), L to the light.
#[test]
fn isophotes_are_angles_between_normal_and_light() {
    let values = everywhere(&Method::Isophote, |_, light, sample, found| {
        let to_light = light.axes[1].cross(light.axes[0]);
        let expected = sample.n.dot(to_light).clamp(-1.0, 1.0).acos();
        // The arc cosine magnifies rounding where it is steep.
        let sine = sample.n.cross(to_light).length();
        close(found, DVec2::new(expected.to_degrees(), 0.0), (ANGLE + 1e-15 / sine).to_degrees());
    });
    assert_eq!(values, 4000);
}

/// Curvatures of a graph z(x,y) with slopes p, q: K = (r t - s^2) / (1 + p^2 + q^2)^2, H = ((1 + q^2) r - 2 p q s + (1 + p^2) t) /
/// (2 (1 + p^2 + q^2)^(3/2)), r, s, t the second derivatives (do Carmo 1976, sec. 3.3, example 5); the principal ones solve
/// k^2 - 2 H k + K = 0.
fn curvatures(graph: &Graph, sample: &Sample) -> [f64; 4] {
    let (r, s, t) = (graph.xx, graph.xy, graph.yy);
    let (p, q) = (r * sample.x + s * sample.y, s * sample.x + t * sample.y);
    let w = 1.0 + p * p + q * q;
    let gaussian = (r * t - s * s) / (w * w);
    let mean = ((1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t) / (2.0 * w * w.sqrt());
    let root = (mean * mean - gaussian).max(0.0).sqrt();
    [gaussian, mean, mean + root, mean - root]
}

#[test]
fn curvature_is_that_of_a_graph() {
    let kinds = [CurvatureKind::Gaussian, CurvatureKind::Mean, CurvatureKind::Largest, CurvatureKind::Smallest];
    for (k, kind) in kinds.into_iter().enumerate() {
        let values = everywhere(&Method::Curvature(kind), |graph, _, sample, found| {
            let all = curvatures(graph, sample);
            // Second differences of points 1/3 apart: rounding times 9.
            let tolerance = 10.0 * ANGLE + if k < 2 { 0.0 } else { root_rounding(all) };
            close(found, DVec2::new(all[k], 0.0), tolerance);
        });
        assert_eq!(values, 4000);
    }
}

/// Rounding of the root of H^2 - K: that of what is below it over twice the root, or its own root near umbilics.
fn root_rounding([_, _, largest, smallest]: [f64; 4]) -> f64 {
    let below = 20.0 * ANGLE;
    (below / (largest - smallest)).min(below.sqrt())
}

/// Coordinates of the foot on the plane.
#[test]
fn sections_are_coordinates() {
    let values = everywhere(&Method::Section, |_, light, sample, found| {
        // The foot of the point on the plane, by removing the part along the normal.
        let normal = light.axes[0].cross(light.axes[1]);
        let d = sample.r - light.center;
        let foot = d - normal * d.dot(normal);
        let x = foot.dot(light.axes[0]);
        let rest = foot - light.axes[0] * x;
        let y = rest.length() * rest.dot(light.axes[1]).signum();
        close(found, DVec2::new(x, y), 1e-14 + 1e-14 / (y.abs() + 1e-3));
    });
    assert_eq!(values, 4000);
}
