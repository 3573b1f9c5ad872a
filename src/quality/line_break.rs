//! What a joint does to the lines of a field that cross it.

use super::form::axes;
use super::slope::{difference, slope, turn_deg, value};
use crate::field::{Camera, Field};
use crate::stam::Jet2;
use glam::DVec3;

/// How the contours of a field break at a point of a joint (Beier & Chen 1994, Property 2: a break of the surface of some order is a break
/// of the line one order lower; Ulmet 2003, section 6). A break of the tangent plane is a jump, a break of curvature a
/// kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineBreak {
    /// Difference of the field's first coordinate across the joint, in its units: of reflection lines, world units on the light plane.
    pub jump: f64,
    /// The same in distances between lines ([`Light::spacing`](crate::field::Light::spacing)).
    pub lines: f64,
    /// How far apart along the joint a line arrives and goes on, model units, to first order; `None` where the slope is unknown or
    /// the field does not change along the joint.
    pub along: Option<f64>,
    /// Angle between a line's tangents on the two sides, degrees, 0 to 180, the sides laid flat into one plane; `None` where the
    /// slope is unknown.
    pub turn_deg: Option<f64>,
}

impl LineBreak {
    /// Compares a field on the two sides of a joint, as [`Continuity::new`](super::Continuity::new) compares the sides. `None` where the field
    /// is undefined on one of them. `rounding` as there.
    pub fn new(
        field: &Field,
        camera: &Camera,
        sides: [&Jet2; 2],
        along: DVec3,
        rounding: [f64; 2],
    ) -> Option<LineBreak> {
        let [own, other] = sides.map(|side| value(field, camera, side));
        let jump = difference(&field.method, own?, other?)?.abs();
        let slope = |i: usize| slope(field, camera, sides[i], axes(sides[i], along)?, rounding[i]);
        let slopes = slope(0).zip(slope(1));
        // The contour runs across the gradient; its two directions on the two sides go the same way along the joint.
        let shift = slopes.and_then(|(a, b)| {
            let rate = 0.5 * (a.x + b.x).abs();
            // Slopes are known to a thousandth: below it, the field is constant along the joint for all we know.
            (rate > 1e-3 * 0.5 * (a.length() + b.length())).then_some(jump / rate)
        });
        Some(LineBreak {
            jump,
            lines: jump / field.light.spacing,
            along: shift,
            turn_deg: slopes.map(|(a, b)| turn_deg(a, b)),
        })
    }
}
