//! Contours where they are known: straight lines, rulings and circles.

use crate::bodies::Graph;
use crate::scene::close;
use catoptric::curves::{Curve, trace};
use catoptric::field::{Camera, CurvatureKind, Field, HighlightKind, Light, Method, Projection};
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::TAU;

/// Chord error asked for.
const TOLERANCE: f64 = 1e-5;

/// How far points may be from the contour: `trace` moves values by 512 roundings of what they are computed from, coordinates up to 10.
const ON_CURVE: f64 = 2e-12;

fn camera(eye: DVec3) -> Camera {
    Camera { eye, target: DVec3::ZERO, up: DVec3::Y, projection: Projection::Perspective { fov: 40.0 }, size: [64; 2] }
}

fn curves(surface: &LimitSurface, field: &Field, value: f64) -> Vec<Curve> {
    // The number of the light: which one, where distances are from the nearest, and only a number elsewhere.
    let light = if field.method == Method::RayDistance { 0 } else { 3 };
    let curves = trace(surface, field, &camera(dvec3(0.3, -2.0, 1.5)), &[(light, value)], TOLERANCE);
    for curve in &curves {
        assert_eq!((curve.value, curve.light), (value, light));
        assert_eq!(curve.points.len(), curve.places.len());
        assert!(curve.points.len() > 1);
        for (point, place) in curve.points.iter().zip(&curve.places) {
            let (_, jet) = surface.evaluate_ptex(place.face, [place.u, place.v]).expect("no hole");
            assert!(jet.position.distance(*point) < 1e-13, "{place:?} {point}");
        }
    }
    curves
}

/// The part of the line p . i = d (i in the plane z = 0) that lies in the square round the origin; `None` where it passes it.
fn clipped(i: DVec2, d: f64, half: f64) -> Option<[DVec2; 2]> {
    let j = i.perp();
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..2 {
        let ends = [-half, half].map(|side| (side - i[axis] * d) / j[axis]);
        low = low.max(ends[0].min(ends[1]));
        high = high.min(ends[0].max(ends[1]));
    }
    (low < high).then(|| [low, high].map(|s| i * d + j * s))
}

/// One curve from one end of a line over the square to the other, in either direction.
#[track_caller]
fn is_segment(curves: &[Curve], i: DVec2, d: f64, half: f64) -> bool {
    let Some(ends) = clipped(i, d, half) else {
        assert!(curves.is_empty(), "{} curves, but the line passes the square", curves.len());
        return false;
    };
    let [curve] = curves else { panic!("{} curves for one line", curves.len()) };
    assert!(!curve.closed);
    let flat: Vec<DVec2> = curve.points.iter().map(|p| p.truncate()).collect();
    for p in &flat {
        assert!((p.dot(i) - d).abs() < ON_CURVE, "{p} is off the line");
    }
    let (first, last) = (flat[0], flat[flat.len() - 1]);
    let apart = |a: DVec2, b: DVec2| first.distance(a).max(last.distance(b));
    let off = apart(ends[0], ends[1]).min(apart(ends[1], ends[0]));
    assert!(off < 1e-9, "{first} to {last} instead of {ends:?}");
    true
}

/// A plane mirrors light lines in straight lines. With the eye E' mirrored in it, R is seen where the ray from E' reaches the light plane
/// z = h: E' + (R - E') m, m = (h + e) / e.
#[test]
fn planes_mirror_straight_lines() {
    let plane = Graph { xx: 0.0, xy: 0.0, yy: 0.0, half: 1.0 };
    let surface = plane.surface();
    let light = Light::new(dvec3(0.5, 0.2, 3.0), DVec3::NEG_Z, dvec3(0.3, 1.0, 0.0), 0.5);
    let (image, m) = (dvec3(0.3, -2.0, -1.5), 3.0);
    let i = light.axes[0];
    let mut lines = 0;
    for k in -20..=20 {
        let c = f64::from(k) * 0.37;
        let d = (c + (light.center - image).dot(i)) / m + image.dot(i);
        lines += usize::from(is_segment(&curves(&surface, &Field::reflection(light), c), i.truncate(), d, 1.0));
    }
    assert!(lines > 10, "{lines}");
}

/// Plane sections by planes that stand on z = 0: straight from above.
#[test]
fn sections_are_straight_from_above() {
    let graph = Graph { xx: 0.7, xy: 0.3, yy: -0.6, half: 1.2 };
    let surface = graph.surface();
    let light = Light::new(dvec3(0.1, 0.2, 5.0), DVec3::NEG_Z, dvec3(0.8, 1.0, 0.0), 0.5);
    let field = Field { light, method: Method::Section };
    let i = light.axes[0];
    let mut lines = 0;
    for k in -12..=12 {
        let c = f64::from(k) * 0.171;
        let d = c + light.center.dot(i);
        lines += usize::from(is_segment(&curves(&surface, &field, c), i.truncate(), d, 1.2));
    }
    assert!(lines > 10, "{lines}");
}

/// A closed curve round an axis: radius, length, chords.
#[track_caller]
fn is_circle(curves: &[Curve], center: DVec2, radius: f64) {
    let [curve] = curves else { panic!("{} curves for one circle", curves.len()) };
    assert!(curve.closed);
    let flat: Vec<DVec2> = curve.points.iter().map(|p| p.truncate() - center).collect();
    let mut length = 0.0;
    for (k, p) in flat.iter().enumerate() {
        assert!((p.length() - radius).abs() < 1e-10, "{p} is {} from the axis, not {radius}", p.length());
        let next = flat[(k + 1) % flat.len()];
        let sagitta = radius - (0.5 * (p + next)).length();
        assert!(sagitta <= TOLERANCE * 1.01, "{sagitta}");
        length += p.distance(next);
    }
    // Once round: a chord of the angle t has a sagitta of r t^2/8 and is shorter than its arc by t^2/24 of it.
    let shorter = 1.0 - length / (TAU * radius);
    assert!(shorter > 0.0 && shorter < 0.34 * TOLERANCE / radius, "{shorter:e}");
}

/// On a paraboloid of revolution z = a r^2 / 2 the slope is a r: the angle of the normal is its arc tangent.
#[test]
fn isophotes_of_a_paraboloid_are_circles() {
    let bowl = Graph { xx: 0.5, xy: 0.0, yy: 0.5, half: 1.5 };
    let surface = bowl.surface();
    let light = Light::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 10.0);
    let field = Field { light, method: Method::Isophote };
    for degrees in [1.0, 10.0, 20.0, 30.0, 36.8] {
        is_circle(&curves(&surface, &field, degrees), DVec2::ZERO, f64::to_radians(degrees).tan() / 0.5);
    }
    // Beyond the sides of the square, an arc is left in each corner; beyond the corners, nothing.
    let arcs = curves(&surface, &field, 40.0);
    assert_eq!(arcs.len(), 4);
    assert!(arcs.iter().all(|arc| !arc.closed));
    assert!(curves(&surface, &field, 47.0).is_empty());
    assert!(curves(&surface, &field, -1.0).is_empty());
}

/// K = a^2 / (1 + a^2 r^2)^2.
#[test]
fn curvature_of_a_paraboloid_is_constant_on_circles() {
    let bowl = Graph { xx: 0.8, xy: 0.0, yy: 0.8, half: 1.0 };
    let surface = bowl.surface();
    let light = Light::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 0.1);
    let field = Field { light, method: Method::Curvature(CurvatureKind::Gaussian) };
    for radius in [0.1f64, 0.5, 0.9] {
        let gaussian = (0.8 / (1.0 + 0.64 * radius * radius)).powi(2);
        is_circle(&curves(&surface, &field, gaussian), DVec2::ZERO, radius);
    }
}

/// Ulmet's example 5.2: the circle of radius c round the light's centre, in a plane mirror.
#[test]
fn planes_mirror_circles() {
    let plane = Graph { xx: 0.0, xy: 0.0, yy: 0.0, half: 1.0 };
    let surface = plane.surface();
    let light = Light::new(dvec3(0.5, 3.2, 3.0), DVec3::NEG_Z, dvec3(0.3, 1.0, 0.0), 0.5);
    let field = Field { light, method: "curve:circle".parse().expect("a method") };
    let (image, m) = (dvec3(0.3, -2.0, -1.5), 3.0);
    let center = (image + (light.center - image) / m).truncate();
    for c in [0.15, 0.9, 1.8] {
        is_circle(&curves(&surface, &field, c), center, c / m);
    }
}

/// Highlight lines of lights along a parabolic cylinder z = a x^2 / 2 are rulings: the normal at x, (-a x, 1), reaches the height h of the
/// lights at x - a x (h - a x^2 / 2). The cubic has one to three zeros.
#[test]
fn highlight_lines_of_a_cylinder_are_rulings() {
    let (a, h) = (1.5, 2.0);
    let cylinder = Graph { xx: a, xy: 0.0, yy: 0.0, half: 1.0 };
    let surface = cylinder.surface();
    let light = Light::new(dvec3(0.1, 0.0, h), DVec3::NEG_Z, DVec3::Y, 0.5);
    let field = Field { light, method: Method::Highlight(HighlightKind::Array) };
    let coordinate = |x: f64| (x - a * x * (h - 0.5 * a * x * x) - light.center.x) * light.axes[0].x;
    let mut by_count = [0; 4];
    for k in -15..=15 {
        let c = f64::from(k) * 0.0813;
        let mut zeros = Vec::new();
        const STEPS: i32 = 4000;
        let at = |n: i32| 2.0 * f64::from(n) / f64::from(STEPS) - 1.0;
        for n in 0..STEPS {
            let (mut low, mut high) = (at(n), at(n + 1));
            let sign = |x: f64| coordinate(x) > c;
            if sign(low) != sign(high) {
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if sign(middle) == sign(low) { low = middle } else { high = middle }
                }
                zeros.push(low);
            }
        }
        let mut found = curves(&surface, &field, c);
        assert_eq!(found.len(), zeros.len(), "light {c}: {zeros:?}");
        by_count[zeros.len()] += 1;
        found.sort_by(|p, q| p.points[0].x.total_cmp(&q.points[0].x));
        for (curve, zero) in found.iter().zip(&zeros) {
            assert!(curve.points.iter().all(|p| (p.x - zero).abs() < 1e-10), "light {c}: {zero}");
            let (first, last) = (curve.points[0].y, curve.points[curve.points.len() - 1].y);
            assert!((first - last).abs() > 2.0 - 1e-9, "light {c}: from {first} to {last}");
        }
    }
    assert!(by_count[1] > 10 && by_count[2] > 2, "{by_count:?}");
}

/// Distance of a point from polylines.
fn distance(curves: &[Curve], point: DVec3) -> f64 {
    let of_segment = |a: DVec3, b: DVec3| {
        let d = b - a;
        let t = ((point - a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        point.distance(a + t * d)
    };
    let segments = curves.iter().flat_map(|curve| curve.points.windows(2));
    segments.map(|ends| of_segment(ends[0], ends[1])).fold(f64::INFINITY, f64::min)
}

/// The band of rays that pass a tube of radius eps (Ulmet, sec. 4) shrinks to the reflection line as eps does.
#[test]
fn bands_shrink_to_the_contour() {
    let graph = Graph { xx: 0.7, xy: 0.3, yy: -0.6, half: 1.2 };
    let surface = graph.surface();
    // One light line only.
    let light = Light::new(dvec3(0.4, 0.2, 4.0), dvec3(0.1, -0.1, -1.0), dvec3(0.4, 1.0, 0.0), 1.0);
    let light = Light { half: [0.4, f64::INFINITY], ..light };
    let line = curves(&surface, &Field::reflection(light), 0.0);
    assert!(!line.is_empty());
    let field = Field { light, method: Method::RayDistance };
    let mut ratios = Vec::new();
    for eps in [1e-1, 1e-2, 1e-3] {
        for side in [eps, -eps] {
            let band = curves(&surface, &field, side);
            assert!(!band.is_empty());
            // Near the rim a line may leave before its band does.
            let inner = |p: &&DVec3| p.x.abs().max(p.y.abs()) < 1.0;
            let points: Vec<_> = band.iter().flat_map(|curve| &curve.points).filter(inner).collect();
            assert!(!points.is_empty());
            ratios.push(points.iter().map(|p| distance(&line, **p)).fold(0.0, f64::max) / eps);
        }
    }
    println!("largest distances over eps: {ratios:?}");
    // Linearly: the ratio settles, up to the chord error over eps.
    for side in 0..2 {
        assert!((ratios[2 + side] / ratios[4 + side] - 1.0).abs() < 0.05, "{ratios:?}");
    }
    // At 0 it is the line.
    let zero = curves(&surface, &field, 0.0);
    for point in zero.iter().flat_map(|curve| &curve.points) {
        assert!(distance(&line, *point) <= TOLERANCE * 1.01);
    }
    close(
        field.value(&catoptric::field::Point {
            position: zero[0].points[0],
            normal: graph.normal(zero[0].points[0].x, zero[0].points[0].y),
            sight: zero[0].points[0] - dvec3(0.3, -2.0, 1.5),
            curvature: None,
        }),
        DVec2::ZERO,
        ON_CURVE,
    );
}
