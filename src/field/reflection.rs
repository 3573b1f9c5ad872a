//! Reflection lines: which point of the light plane a surface point mirrors into the eye.

use super::Light;
use glam::{DVec2, DVec3, dvec2};

/// Direction of the mirrored line of sight, left side of eq. 1 of Yasui & Kanai 2004 without the division by |S - E|:
/// r = (S - E) - 2 ((S - E) . n) n. `sight` along the line of sight to the point, of any length ([`Camera::sight`]);
/// `normal` of unit length; its sign does not matter.
///
/// [`Camera::sight`]: super::Camera::sight
pub fn reflection_direction(normal: DVec3, sight: DVec3) -> DVec3 {
    sight - normal * (2.0 * sight.dot(normal))
}

/// Coordinates on the light plane, in world units, of the point x where the mirrored ray meets it: Yasui & Kanai 2004,
/// sec. 3.1 (f -> x), Ulmet 2003, eq. 5.7; the light line x = c is mirrored where the first coordinate is c (eq. 5.11).
/// `None` where the ray is parallel to the plane or leaves it behind. The extents of the light are not looked at.
/// The line of sight counts by its direction only, so that it may come from an eye or from infinitely far away.
pub fn reflection(light: &Light, position: DVec3, normal: DVec3, sight: DVec3) -> Option<DVec2> {
    let ray = reflection_direction(normal, sight);
    let plane = light.normal();
    let to_center = light.center - position;
    let t = to_center.dot(plane) / ray.dot(plane);
    let hit = ray * t - to_center;
    (t > 0.0 && t.is_finite()).then(|| dvec2(hit.dot(light.axes[0]), hit.dot(light.axes[1])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    /// The triple products [s r j] + z0 (s . i) over s . k of Ulmet, eq. 5.11 and 5.12, for the plane z = z0.
    #[test]
    fn agrees_with_ulmets_theorem() {
        let z0 = 7.0;
        let light = Light { axes: [DVec3::X, DVec3::Y], ..Light::new(dvec3(0.0, 0.0, z0), DVec3::Z, DVec3::Y, 1.0) };
        let (eye, r) = (dvec3(5.0, -3.0, 4.0), dvec3(0.3, 0.7, 0.2));
        let normal = dvec3(0.1, -0.2, 1.0).normalize();
        let s = reflection_direction(normal, r - eye);
        let expected = dvec2((s.cross(r).dot(DVec3::Y) + z0 * s.x) / s.z, (r.cross(s).dot(DVec3::X) + z0 * s.y) / s.z);
        let hit = reflection(&light, r, normal, r - eye).unwrap();
        assert!((hit - expected).length() < 1e-12, "{hit} {expected}");
        assert_eq!(reflection(&light, r, -normal, r - eye), Some(hit));
        // However far along the line of sight the eye is, up to rounding.
        let far = reflection(&light, r, normal, (r - eye) * 1e6).unwrap();
        assert!((far - hit).length() < 1e-12, "{far} {hit}");
    }

    #[test]
    fn rays_away_from_the_plane_have_no_value() {
        let light = Light::new(dvec3(0.0, 0.0, -7.0), DVec3::Z, DVec3::Y, 1.0);
        assert_eq!(reflection(&light, DVec3::ZERO, DVec3::Z, dvec3(0.0, -1.0, -1.0)), None);
        assert_eq!(reflection(&light, DVec3::ZERO, DVec3::Y, dvec3(-1.0, -1.0, 0.0)), None);
    }
}
