//! Highlight lines and bands (Beier & Chen 1994).

use super::{Light, distance::ray_distance};
use glam::{DVec2, DVec3, dvec2};

/// What is measured between the surface normal, as a line, and the light. With A the light's centre, B the direction of its lines,
/// N the normal and Q the point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HighlightKind {
    /// Where the normal line meets the light plane, as coordinates: the highlight line of the light x = c is where the first one is c.
    /// So one field shows an array of parallel lights (colour plate 2), in place of a distance function a light.
    Array,
    /// Signed distance d_s (eq. 7) from the light x = 0: the line at 0, bands within a radius, families of radii.
    Signed,
    /// Signed distance from the nearest light x = k spacing, and k: bands round every light of an array.
    Nearest,
    /// Pseudo signed distance d_ps (eq. 15), world units: zero where d_s is, and where the normal is parallel to the light.
    Pseudo,
    /// Alternative function d_a (eq. 17) for the band boundary at this distance, world units, with its sign: zero there.
    Alternative(f64),
}

/// The value at a point; of unit length `normal`.
pub fn highlight(light: &Light, kind: HighlightKind, position: DVec3, normal: DVec3) -> Option<DVec2> {
    let across = light.axes[1].cross(normal);
    let pseudo = across.dot(light.center - position);
    match kind {
        HighlightKind::Array => {
            let plane = light.normal();
            let to_center = light.center - position;
            let t = to_center.dot(plane) / normal.dot(plane);
            let hit = normal * t - to_center;
            t.is_finite().then(|| dvec2(hit.dot(light.axes[0]), hit.dot(light.axes[1])))
        }
        HighlightKind::Signed => (across != DVec3::ZERO).then(|| dvec2(pseudo / across.length(), 0.0)),
        HighlightKind::Nearest => ray_distance(light, position, normal),
        HighlightKind::Pseudo => Some(dvec2(pseudo, 0.0)),
        HighlightKind::Alternative(radius) => Some(dvec2(pseudo - radius * across.length(), 0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    fn light() -> Light {
        Light::new(dvec3(0.5, 0.3, 4.0), dvec3(0.1, 0.2, -1.0), dvec3(0.3, 1.0, 0.1), 0.5)
    }

    /// Array, signed, pseudo and alternative functions vanish together (Beier & Chen 1994, eq. 13 to 17).
    #[test]
    fn zero_sets_are_the_same() {
        let light = light();
        for k in 0..50 {
            let angle = f64::from(k);
            // A normal whose line meets the light x = 0 somewhere, and one that passes it at a distance r.
            let on = light.center + light.axes[1] * (0.1 * angle - 2.0);
            let position = dvec3(angle.cos(), angle.sin(), 0.1 * (3.0 * angle).sin());
            let normal = (on - position).normalize();
            let value = |kind, normal| highlight(&light, kind, position, normal).expect("it is defined").x;
            for kind in [HighlightKind::Array, HighlightKind::Signed, HighlightKind::Nearest, HighlightKind::Pseudo] {
                assert!(value(kind, normal).abs() < 1e-14, "{kind:?}");
            }
            let other = (normal + 0.2 * light.axes[0]).normalize();
            let radius = value(HighlightKind::Signed, other);
            assert!(radius.abs() > 1e-3);
            assert!(value(HighlightKind::Alternative(radius), other).abs() < 1e-14);
            assert!(value(HighlightKind::Alternative(-radius), other).abs() > 1e-4);
            // An array light at the place where the normal meets the plane: the signed distance of that one is zero.
            let c = value(HighlightKind::Array, other);
            let moved = Light { center: light.center + light.axes[0] * c, ..light };
            assert!(highlight(&moved, HighlightKind::Signed, position, other).expect("defined").x.abs() < 1e-13);
        }
    }

    /// Where the normal is parallel to the light, d_s is undefined, and d_ps is 0 (p. 272).
    #[test]
    fn parallel_normals_are_the_pseudo_functions_other_zeros() {
        let light = light();
        let of = |kind| highlight(&light, kind, DVec3::ONE, light.axes[1]);
        assert_eq!(of(HighlightKind::Signed), None);
        assert_eq!(of(HighlightKind::Nearest), None);
        // Far away, or nowhere, as rounding has it.
        assert!(of(HighlightKind::Array).is_none_or(|value| value.length() > 1e12));
        assert_eq!(of(HighlightKind::Pseudo), Some(DVec2::ZERO));
    }
}
