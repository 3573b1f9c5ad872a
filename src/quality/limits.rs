//! What counts as a break.

use super::Continuity;

/// The largest gap, angle and difference in curvature that are no break, and what counts as a seam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// G0, model units.
    pub gap: f64,
    /// G1, degrees.
    pub angle_deg: f64,
    /// G2, 2 |k1 - k2| / (|k1| + |k2|): 0.02 is 2 %.
    pub difference: f64,
    /// How far apart two boundaries may be to be a joint, model units; 0: none is. `None`: [`WELD`] times the diagonal.
    pub weld: Option<f64>,
}

/// Part of the diagonal of the control points within which boundaries are a joint where nothing else is said.
pub const WELD: f64 = 1e-3;

impl Default for Limits {
    /// The defaults of CATIA's connect checker, with millimetres as the unit: 0.001 mm, 0.5 degrees, 2 %.
    fn default() -> Limits {
        Limits { gap: 0.001, angle_deg: 0.5, difference: 0.02, weld: None }
    }
}

/// One of the things that are limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Break {
    /// The gap.
    Gap,
    /// The angle, or there is no tangent plane.
    Angle,
    /// The difference in curvature.
    Curvature,
}

impl Break {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Break::Gap => "gap",
            Break::Angle => "angle",
            Break::Curvature => "curvature",
        }
    }
}

impl Limits {
    /// How many times its limit each figure is, at most [`f64::MAX`]. Only without a tangent plane the angle is infinitely many times its
    /// limit, and there is no curvature to compare.
    pub fn ratios(&self, gap: f64, angle_deg: Option<f64>, difference: Option<f64>) -> [(Break, f64); 3] {
        // A limit of 0 allows 0.
        let ratio = |value: f64, limit: f64| if value == 0.0 { 0.0 } else { (value / limit).min(f64::MAX) };
        [
            (Break::Gap, ratio(gap, self.gap)),
            (Break::Angle, angle_deg.map_or(f64::INFINITY, |angle| ratio(angle, self.angle_deg))),
            (Break::Curvature, difference.map_or(0.0, |difference| ratio(difference, self.difference))),
        ]
    }

    /// The worst of these.
    pub fn severity(&self, continuity: &Continuity) -> f64 {
        let Continuity { gap, angle_deg, difference, .. } = *continuity;
        self.ratios(gap, angle_deg, difference).into_iter().fold(0.0, |most, (_, ratio)| most.max(ratio))
    }
}
