//! The plane light source.

use super::camera::horizontal_axes;
use glam::DVec3;

/// A plane light source anywhere in space (Yasui & Kanai 2004, sec. 3.1, fig. 2; Ulmet 2003, eq. 5.1).
///
/// Its points have coordinates (x, y) = ((p - center) . axes[0], (p - center) . axes[1]). Light lines are x = const: they
/// run along `axes[1]`, `spacing` apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Point with coordinates (0, 0), world space.
    pub center: DVec3,
    /// In-plane axes of unit length, perpendicular to each other.
    pub axes: [DVec3; 2],
    /// Half extents along the two axes in world units; infinite where the light has no edge.
    pub half: [f64; 2],
    /// Period of the pattern in world units, greater than 0.
    pub spacing: f64,
}

impl Light {
    /// A light at `center` whose plane faces `facing` and whose lines run along the part of `lines` that lies in it.
    /// Infinite; both directions may have any length but must not be parallel (any line direction is taken then).
    pub fn new(center: DVec3, facing: DVec3, lines: DVec3, spacing: f64) -> Light {
        let facing = facing.try_normalize().unwrap_or(DVec3::NEG_Z);
        let along =
            (lines - facing * lines.dot(facing)).try_normalize().unwrap_or_else(|| facing.any_orthonormal_vector());
        Light { center, axes: [along.cross(facing), along], half: [f64::INFINITY; 2], spacing }
    }

    /// A ceiling of tubes for an object inside `bounds` seen from `eye`: above the object and a little behind it, so that
    /// level tops mirror it into the eye as well as shoulders that face the eye, its tubes along the object's longest side (on a car they flow from bonnet to
    /// boot). It ends where an endless one would crowd its lines below what a picture resolves. The constants are
    /// empirical, chosen by looking at bodies of many shapes.
    pub fn fit(bounds: [DVec3; 2], eye: DVec3, up: DVec3) -> Light {
        /// Distance from the middle of the object, in diagonals.
        const HEIGHT: f64 = 1.5;
        /// From the vertical, away from the eye.
        const TILT_DEGREES: f64 = 18.0;
        /// Degrees between neighbouring tubes, seen from the object straight below.
        const SPACING_DEGREES: f64 = 11.0;
        /// Tubes on each side of the middle.
        const TUBES: f64 = 11.0;
        /// Half length of a tube, in diagonals.
        const LENGTH: f64 = 4.0;
        let up = up.try_normalize().unwrap_or(DVec3::Z);
        let middle = (bounds[0] + bounds[1]) * 0.5;
        let diagonal = (bounds[1] - bounds[0]).length().max(f64::MIN_POSITIVE);
        let away = middle - eye;
        let away = (away - up * away.dot(up)).try_normalize().unwrap_or(DVec3::ZERO);
        let (sin, cos) = TILT_DEGREES.to_radians().sin_cos();
        let direction = (up * cos + away * sin).normalize();
        let [long, _] = horizontal_axes(bounds, up);
        let spacing = diagonal * HEIGHT * SPACING_DEGREES.to_radians().tan();
        let half = [(TUBES + 0.5) * spacing, LENGTH * diagonal];
        Light { half, ..Light::new(middle + direction * (diagonal * HEIGHT), -direction, long, spacing) }
    }

    /// Unit normal of the plane.
    pub fn normal(&self) -> DVec3 {
        self.axes[0].cross(self.axes[1])
    }

    /// Whether the light's plane coordinates (world units) lie within its extents.
    pub fn contains(&self, point: glam::DVec2) -> bool {
        point.x.abs() <= self.half[0] && point.y.abs() <= self.half[1]
    }
}
