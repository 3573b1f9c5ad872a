//! How two surfaces meet at a point: gap, angle, difference in curvature.

use super::form::{Form, axes};
use crate::stam::Jet2;
use crate::statistics::angle_deg;
use glam::DVec3;

/// How the two sides of a joint meet at one of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Continuity {
    /// G0: distance between the two positions, model units.
    pub gap: f64,
    /// G1: angle between the two normals, degrees, 0 to 180; `None` where a side has none.
    pub angle_deg: Option<f64>,
    /// Normal curvature of each side in the plane that is perpendicular to the joint's tangent, one over model units, positive
    /// where the side bends towards its normal; `None` where a side has no tangent plane.
    pub curvature: Option<[f64; 2]>,
    /// G2: 2 |k1 - k2| / (|k1| + |k2|) of these, 0 to 2; 0 where k1 - k2 is rounding.
    pub difference: Option<f64>,
    /// The curvature changes its sign across the joint, by more than rounding.
    pub concave: bool,
}

impl Continuity {
    /// Compares two sides. `along`: tangent of the joint, of any length; normals are on the same side of the surface.
    /// `rounding`: how far the curvature of each side may be off, one over model units. Below it, there is none: a flat
    /// joint is no break, though its relative difference is noise over noise.
    pub fn new(sides: [&Jet2; 2], along: DVec3, rounding: [f64; 2]) -> Continuity {
        let [own, other] = sides.map(|side| side.first);
        let angle = angle_deg(own.normal, other.normal);
        let across = |side: &Jet2| Some(Form::of(side, axes(side, along)?)?.second);
        let curvature = across(sides[0]).zip(across(sides[1])).map(|(a, b)| [a, b]);
        let difference = curvature.map(|[a, b]| {
            let apart = (a - b).abs();
            if apart <= rounding[0] + rounding[1] { 0.0 } else { 2.0 * apart / (a.abs() + b.abs()) }
        });
        let concave = curvature.is_some_and(|[a, b]| a * b < 0.0 && a.abs() > rounding[0] && b.abs() > rounding[1]);
        Continuity {
            gap: own.position.distance(other.position),
            angle_deg: Some(angle).filter(|angle| !angle.is_nan()),
            curvature,
            difference,
            concave,
        }
    }
}
