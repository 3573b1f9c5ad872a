//! Distance of a mirrored ray from light lines.

use super::Light;
use glam::{DVec2, DVec3, dvec2};

/// Signed distance of the line through `position` along `ray` from the nearest of the lines x = k spacing of the light plane, and
/// k: Ulmet 2003, eq. 4.2, d = (s x c) . b / |s x c|, without the absolute value, as Beier & Chen 1994, eq. 7 do. `None` where
/// the ray is parallel to the lines, which are at all distances then.
///
/// Along the plane d grows by (s x c) . i / |s x c| from line to line, i the light's first axis, so the nearest one is known
/// without trying. Light lines beyond the light's extent do not shine.
pub fn ray_distance(light: &Light, position: DVec3, ray: DVec3) -> Option<DVec2> {
    let across = ray.normalize_or_zero().cross(light.axes[1]);
    let length = across.length();
    if length == 0.0 {
        return None;
    }
    let first = across.dot(light.center - position) / length;
    let step = across.dot(light.axes[0]) / length * light.spacing;
    let last = (light.half[0] / light.spacing).floor();
    // Within the plane of the ray and the lines all of them are as far away.
    let nearest = if step == 0.0 { 0.0 } else { (-first / step).round().clamp(-last, last) };
    Some(dvec2(first + nearest * step, nearest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    /// Against the distance of two lines by minimising over both of them.
    #[test]
    fn distances_are_those_of_lines() {
        let light =
            Light { half: [3.4, f64::INFINITY], ..Light::new(dvec3(0.3, -0.2, 5.0), DVec3::NEG_Z, DVec3::Y, 1.0) };
        let position = dvec3(0.1, 0.2, 0.3);
        for k in 0..200 {
            let angle = f64::from(k) * 0.37;
            let ray = dvec3(angle.cos(), 0.4 * (1.3 * angle).sin(), 0.5 + 0.4 * (0.7 * angle).sin());
            let found = ray_distance(&light, position, ray).expect("it is not parallel");
            let of_line = |k: i32| {
                let a = light.center + light.axes[0] * f64::from(k) - position;
                let (d, e) = (ray.normalize(), light.axes[1]);
                let cos = d.dot(e);
                // The feet of the common perpendicular.
                let s = (a.dot(d) - a.dot(e) * cos) / (1.0 - cos * cos);
                let t = s * cos - a.dot(e);
                (s * d).distance(a + t * e)
            };
            let expected = (-3..=3).map(of_line).fold(f64::INFINITY, f64::min);
            assert!((found.x.abs() - expected).abs() < 1e-12, "{ray}: {found} {expected}");
            assert!((of_line(found.y as i32) - expected).abs() < 1e-12);
        }
        assert_eq!(ray_distance(&light, position, DVec3::Y), None);
    }
}
