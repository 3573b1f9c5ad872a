//! Isophotes: where light from far away falls at the same angle (Poeschl 1984).

use super::Light;
use glam::{DVec2, DVec3, dvec2};

/// Angle between the normal and the direction to a light infinitely far away, which is against the light's normal, 0 to 180
/// degrees; the silhouette as the light sees it is at 90.
pub fn angle(light: &Light, normal: DVec3) -> Option<DVec2> {
    let to_light = -light.normal();
    // The arc tangent: exact near 0 and 180, where the arc cosine is not.
    (normal != DVec3::ZERO)
        .then(|| dvec2(normal.cross(to_light).length().atan2(normal.dot(to_light)).to_degrees(), 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_between_normal_and_light() {
        let light = Light::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 10.0);
        for (degrees, normal) in [(0.0, DVec3::Z), (90.0, DVec3::X), (180.0, DVec3::NEG_Z), (45.0, DVec3::Y + DVec3::Z)]
        {
            let found = angle(&light, normal.normalize()).expect("a normal").x;
            assert!((found - degrees).abs() < 1e-12, "{found}");
        }
        assert_eq!(angle(&light, DVec3::ZERO), None);
    }
}
