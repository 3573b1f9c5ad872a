//! The plane light source.

use glam::DVec3;

/// A plane light source anywhere in space (Yasui & Kanai 2004, sec. 3.1, fig. 2; Ulmet 2003, eq. 5.1).
///
/// Its points have coordinates (x, y) = `((p - center) . axes[0], (p - center) . axes[1])`. Light lines are x = const: they
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

    /// Unit normal of the plane.
    pub fn normal(&self) -> DVec3 {
        self.axes[0].cross(self.axes[1])
    }

    /// Coordinates of a point, or of its foot on the plane.
    pub fn coordinates(&self, point: DVec3) -> glam::DVec2 {
        let d = point - self.center;
        glam::DVec2::new(d.dot(self.axes[0]), d.dot(self.axes[1]))
    }

    /// Whether the light's plane coordinates (world units) lie within its extents.
    pub fn contains(&self, point: glam::DVec2) -> bool {
        point.x.abs() <= self.half[0] && point.y.abs() <= self.half[1]
    }
}
