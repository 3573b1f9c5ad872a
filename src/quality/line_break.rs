//! What a joint does to the lines of a field that cross it.

use super::form::axes;
use super::slope::{blur, difference, slope, turn_deg, value};
use crate::field::{Camera, Field};
use crate::stam::Jet2;
use glam::{DVec2, DVec3};

/// How the contours of a field break at a point of a joint (Beier & Chen 1994, Property 2: a break of the surface of some order is a break
/// of the line one order lower; Ulmet 2003, section 6). A break of the tangent plane is a jump, a break of curvature a
/// kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineBreak {
    /// Difference of the field's first coordinate across the joint, in its units: of reflection lines, world units on the light plane.
    /// 0 where rounding of the two sides explains it, which near the horizon of the light plane is much.
    pub jump: f64,
    /// The same in distances between lines ([`Light::spacing`](crate::field::Light::spacing)).
    pub lines: f64,
    /// How far apart along the joint a line arrives and goes on, half of it on each side of the point; model units, to first order.
    /// `None` where the slope is unknown, or no line does: the field does not change along the joint on one of the sides, or it changes
    /// in opposite directions.
    pub along: Option<f64>,
    /// Angle by which a line that crosses the joint turns, degrees, 0 to 180, the sides laid flat into one plane; `None` where the
    /// slope is unknown. Where the values run in opposite directions on the two sides, it is another line that goes on.
    pub turn_deg: Option<f64>,
}

/// Part of a slope that it is known to: less of it along the joint is none.
const KNOWN: f64 = 1e-3;

impl LineBreak {
    /// Compares a field on the two sides of a joint, as [`Continuity::new`](super::Continuity::new) compares the sides. `None` where the field
    /// is undefined on one of them, or would be but for rounding. `rounding` as there.
    pub fn new(
        field: &Field,
        camera: &Camera,
        sides: [&Jet2; 2],
        along: DVec3,
        rounding: [f64; 2],
    ) -> Option<LineBreak> {
        let [own, other] = sides.map(|side| value(field, camera, side));
        let apart = difference(&field.method, own?, other?)?.abs();
        let [own, other] = [0, 1].map(|i| blur(field, camera, sides[i], rounding[i]));
        let jump = if apart <= own? + other? { 0.0 } else { apart };
        let slope = |i: usize| slope(field, camera, sides[i], axes(sides[i], along)?, rounding[i]);
        let slopes = slope(0).zip(slope(1));
        // Across the joint in the direction in which values grow along it, if they do.
        let across = |slope: DVec2| if slope.x.abs() > KNOWN * slope.length() { slope.x.signum() } else { 0.0 };
        let shift = slopes.filter(|&(a, b)| across(a) * across(b) > 0.0).map(|(a, b)| jump / (0.5 * (a.x + b.x).abs()));
        // Contours run across the gradients. Both cross the joint from the first side to the second.
        let turn = slopes.map(|(a, b)| turn_deg(a, if across(a) * across(b) < 0.0 { -b } else { b }));
        Some(LineBreak { jump, lines: jump / field.light.spacing, along: shift, turn_deg: turn })
    }
}
