//! What was found at points of joints, and the worst of it.

use super::{Continuity, Limits, LineBreak};
use crate::curves::Place;
use glam::DVec3;

/// One point of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// Where it is, on one of the two sides.
    pub place: Place,
    /// The point there, world space.
    pub position: DVec3,
    /// How the sides meet.
    pub continuity: Continuity,
    /// What that does to the lines of the field; `None` without a field, or where it is undefined.
    pub line: Option<LineBreak>,
}

/// The worst of many points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extremes {
    /// Points.
    pub samples: usize,
    /// Those without a tangent plane on one side or both.
    pub undefined: usize,
    /// Largest gap, model units.
    pub gap: f64,
    /// Largest angle, degrees; `None` where no point has one.
    pub angle_deg: Option<f64>,
    /// Largest difference in curvature, 0 to 2; `None` where no point has one.
    pub difference: Option<f64>,
    /// The curvature changes its sign across the joint somewhere.
    pub concave: bool,
    /// Largest jump, shift along the joint and turn of the field's lines.
    pub line: Option<LineBreak>,
    /// The point that exceeds its limits most (of several, the first), and how many times.
    pub worst: Option<(f64, Finding)>,
}

fn most(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.max(b)),
        (a, b) => a.or(b),
    }
}

impl LineBreak {
    /// The larger of each figure.
    fn and(&self, other: &LineBreak) -> LineBreak {
        LineBreak {
            jump: self.jump.max(other.jump),
            lines: self.lines.max(other.lines),
            along: most(self.along, other.along),
            turn_deg: most(self.turn_deg, other.turn_deg),
        }
    }
}

impl Extremes {
    /// A single point.
    pub fn of(finding: Finding, limits: &Limits) -> Extremes {
        let Finding { continuity, line, .. } = finding;
        Extremes {
            samples: 1,
            undefined: usize::from(continuity.angle_deg.is_none()),
            gap: continuity.gap,
            angle_deg: continuity.angle_deg,
            difference: continuity.difference,
            concave: continuity.concave,
            line,
            worst: Some((limits.severity(&continuity), finding)),
        }
    }

    /// The worst of both.
    #[must_use]
    pub fn and(self, other: Extremes) -> Extremes {
        let line = match (self.line, other.line) {
            (Some(a), Some(b)) => Some(a.and(&b)),
            (a, b) => a.or(b),
        };
        let worst = match (self.worst, other.worst) {
            (Some(a), Some(b)) => Some(if b.0 > a.0 { b } else { a }),
            (a, b) => a.or(b),
        };
        Extremes {
            samples: self.samples + other.samples,
            undefined: self.undefined + other.undefined,
            gap: self.gap.max(other.gap),
            angle_deg: most(self.angle_deg, other.angle_deg),
            difference: most(self.difference, other.difference),
            concave: self.concave || other.concave,
            line,
            worst,
        }
    }

    /// How many times its limit the worst point exceeds it; 0 without points.
    pub fn severity(&self) -> f64 {
        self.worst.map_or(0.0, |(severity, _)| severity)
    }
}
