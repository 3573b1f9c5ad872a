//! Highlight lines and bands: Beier & Chen 1994.

use crate::scene::{ANGLE, close, everywhere};
use catoptric::field::{HighlightKind, Method};
use glam::{DVec2, DVec3};

/// (B x N).(A - Q) of eq. 15, and |B x N|.
fn pseudo(a: DVec3, b: DVec3, n: DVec3, q: DVec3) -> (f64, f64) {
    (b.cross(n).dot(a - q), b.cross(n).length())
}

/// Eq. 7, 15 and 17, written out.
#[test]
fn distances_are_equations_7_15_and_17() {
    const RADIUS: f64 = 0.35;
    let kinds = [HighlightKind::Signed, HighlightKind::Pseudo, HighlightKind::Alternative(RADIUS)];
    for kind in kinds {
        let values = everywhere(&Method::Highlight(kind), |_, light, sample, found| {
            let (d_ps, length) = pseudo(light.center, light.axes[1], sample.n, sample.r);
            let away = light.center.distance(sample.r);
            // d_ps has the error of the normal times |A - Q|; d_s that over |B x N|.
            let (expected, tolerance) = match kind {
                HighlightKind::Signed => (d_ps / length, 2.0 * ANGLE * away / length),
                HighlightKind::Pseudo => (d_ps, ANGLE * away),
                _ => (d_ps - RADIUS * length, ANGLE * (away + RADIUS)),
            };
            close(found, DVec2::new(expected, 0.0), tolerance);
        });
        assert_eq!(values, 4000);
    }
}

/// Definition 1 for an array of lights, colour plate 2: the light whose distance (eq. 3) from the normal is 0 goes through A + c i. So
/// (B x N).(A + c i - Q) = 0 gives c, and with i for B the other coordinate.
#[test]
fn arrays_are_the_lights_that_normals_meet() {
    let values = everywhere(&Method::Highlight(HighlightKind::Array), |_, light, sample, found| {
        let [i, j] = light.axes;
        let coordinate = |b: DVec3, along: DVec3| {
            let (d_ps, _) = pseudo(light.center, b, sample.n, sample.r);
            (-d_ps / b.cross(sample.n).dot(along), b.cross(sample.n).dot(along).abs())
        };
        let ((x, slope), (y, _)) = (coordinate(j, i), coordinate(i, j));
        let away = light.center.distance(sample.r) + x.abs() + y.abs();
        close(found, DVec2::new(x, y), 2.0 * ANGLE * away / slope);
        // Definition 1 itself, eq. 3, for the light that it names.
        let moved = light.center + i * x;
        let (d_ps, length) = pseudo(moved, j, sample.n, sample.r);
        assert!(d_ps.abs() / length <= 1e-14 * away / slope);
    });
    assert!(values > 3900, "{values}");
}

/// Least of the distances from many lights.
#[test]
fn nearest_is_the_least_distance() {
    let values = everywhere(&Method::Highlight(HighlightKind::Nearest), |_, light, sample, found| {
        let found = found.expect("no normal is parallel to the lines");
        let distance = |k: f64| {
            let a = light.center + light.axes[0] * (k * light.spacing);
            let (d_ps, length) = pseudo(a, light.axes[1], sample.n, sample.r);
            // The field has Ulmet's order, s x c where Beier & Chen have B x N.
            -d_ps / length
        };
        let away = light.center.distance(sample.r) + found.y.abs() * light.spacing;
        let (_, length) = pseudo(light.center, light.axes[1], sample.n, sample.r);
        let tolerance = 4.0 * ANGLE * away / length;
        assert!((found.x - distance(found.y)).abs() <= tolerance, "{found} {}", distance(found.y));
        for k in -60..=60 {
            assert!(found.x.abs() <= distance(found.y + f64::from(k)).abs() + tolerance);
        }
    });
    assert_eq!(values, 4000);
}

/// The three functions vanish together on real surfaces (eq. 13 to 17): the signs of d_s and d_ps agree everywhere, and that of d_a is the
/// sign of d_s - r.
#[test]
fn zero_sets_are_the_same() {
    const RADIUS: f64 = 0.35;
    let of = |kind| {
        let mut values = Vec::new();
        // One seed for all: by the method that the lights are drawn for.
        everywhere(&Method::Highlight(HighlightKind::Signed), |graph, light, sample, _| {
            let field = catoptric::field::Field { light: *light, method: Method::Highlight(kind) };
            let point = catoptric::field::Point {
                position: graph.position(sample.x, sample.y),
                normal: sample.n,
                sight: -sample.to_eye,
                curvature: None,
            };
            values.push(field.value(&point).expect("no normal is parallel to the light").x);
        });
        values
    };
    let [signed, pseudo, alternative] =
        [HighlightKind::Signed, HighlightKind::Pseudo, HighlightKind::Alternative(RADIUS)].map(of);
    let mut positive = 0;
    for ((s, p), a) in signed.iter().zip(&pseudo).zip(&alternative) {
        assert_eq!(s > &0.0, p > &0.0);
        assert_eq!(s > &RADIUS, a > &0.0);
        positive += usize::from(s > &0.0);
    }
    assert!(positive > 500 && positive < 3500, "{positive}");
}
