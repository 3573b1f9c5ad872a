//! Contours of a field as exact curves on the limit surface.

use glam::DVec3;

/// A place of the limit surface: ptex face and its parameters, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Ptex face.
    pub face: u32,
    /// Parameter along the face's first edge.
    pub u: f64,
    /// Parameter along the face's last edge.
    pub v: f64,
}

/// A contour, or the part of one that is in one piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Value of the field's first coordinate on it.
    pub value: f64,
    /// Which light of the family: the number k of the value k spacing.
    pub light: i32,
    /// The last point is joined to the first, which is not repeated.
    pub closed: bool,
    /// Points on the surface, world space.
    pub points: Vec<DVec3>,
    /// Where these are, a place each.
    pub places: Vec<Place>,
}
