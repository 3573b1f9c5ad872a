//! A pattern on a sphere round the scene, infinitely large.

use super::{Light, reflection_direction};
use glam::{DVec2, DVec3, dvec2};

/// What looks up the pattern on the sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mirrored {
    /// The mirrored line of sight: an environment map.
    Reflection,
    /// The surface normal, which no camera changes.
    Normal,
}

impl Mirrored {
    /// The direction.
    pub fn direction(self, normal: DVec3, sight: DVec3) -> DVec3 {
        match self {
            Mirrored::Reflection => reflection_direction(normal, sight),
            Mirrored::Normal => normal,
        }
    }
}

/// Longitude, -180 to 180, and latitude, -90 to 90, of a direction in degrees. Stripes of longitude are the great circles through
/// the poles that Ulmet 2003, sec. 6 maps. `None` at the poles, where all of them meet, and for no direction.
pub fn longitude_latitude(light: &Light, direction: DVec3) -> Option<DVec2> {
    let d = direction.try_normalize()?;
    let (x, y, z) = (d.dot(light.axes[0]), d.dot(light.axes[1]), -d.dot(light.normal()));
    let across = x.hypot(y);
    (across > 0.0).then(|| dvec2(y.atan2(x).to_degrees(), z.atan2(across).to_degrees()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn directions_are_where_they_belong() {
        // Facing down: its normal points to the south pole.
        let light = Light::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 10.0);
        let [i, j] = light.axes;
        let at = |d: DVec3| longitude_latitude(&light, d);
        let close = |a: Option<DVec2>, b: DVec2| assert!(a.is_some_and(|a| a.distance(b) < 1e-12), "{a:?} {b}");
        close(at(i), dvec2(0.0, 0.0));
        close(at(j * 3.0), dvec2(90.0, 0.0));
        close(at(-j + DVec3::Z), dvec2(-90.0, 45.0));
        close(at(i - j - 2f64.sqrt() * DVec3::Z), dvec2(-45.0, -45.0));
        assert_eq!(at(DVec3::Z), None);
        assert_eq!(at(DVec3::ZERO), None);
        let (n, sight) = (dvec3(0.0, 0.0, 1.0), dvec3(1.0, 0.0, -1.0));
        assert_eq!(Mirrored::Reflection.direction(n, sight), dvec3(1.0, 0.0, 1.0));
        assert_eq!(Mirrored::Normal.direction(n, sight), n);
    }
}
