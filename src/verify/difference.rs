//! What one sample's errors are, and what they may be.

use glam::DVec3;
use serde::Serialize;

/// A point of the surface, by ptex face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// Ptex face.
    pub face: u32,
    /// Parameter along the face's first edge, 0 to 1.
    pub u: f64,
    /// Parameter along the face's last edge, 0 to 1.
    pub v: f64,
}

/// A sample and the patch of ours that answers there, if one does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub sample: Sample,
    pub patch: Option<u32>,
}

/// An error and what it may be, both in the units of the report; infinite where nothing is demanded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Check {
    pub error: f64,
    pub allowed: f64,
}

impl Check {
    /// Part of what is allowed that is used; infinite for NaN, which nothing allows.
    pub fn share(self) -> f64 {
        let Self { error, allowed } = self;
        match error <= allowed {
            _ if allowed.is_infinite() => 0.0,
            true if error > 0.0 => error / allowed,
            true => 0.0,
            false if error.is_nan() => f64::INFINITY,
            false => error / allowed,
        }
    }
}

/// What a sample says about normals.
#[derive(Debug, Clone, Copy)]
pub(super) enum Normal {
    /// The reference knows none here.
    Unknown,
    /// The reference has none that rounding would not turn too far.
    Skipped,
    Judged(Check),
}

impl Normal {
    /// Compares ours with the reference's direction, which rounding may turn by `turn` degrees; skipped where that is
    /// more than `limit`.
    pub fn judge(ours: DVec3, reference: DVec3, turn: f64, limit: f64, allowed: f64) -> Self {
        if turn > limit {
            return Self::Skipped;
        }
        Self::Judged(Check { error: angle_deg(ours, reference), allowed })
    }
}

/// Errors of one sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Difference {
    pub position: Check,
    pub normal: Normal,
    pub derivative: Option<Check>,
}

/// The larger of two errors; NaN, which nothing allows, is the largest.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Angle between two directions in degrees, 0 to 180, and 180 where either is none. Exact for small angles, where the
/// arc cosine is not.
pub(super) fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    match (a.try_normalize(), b.try_normalize()) {
        (Some(a), Some(b)) => a.cross(b).length().atan2(a.dot(b)).to_degrees(),
        _ => 180.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_normal_is_as_wrong_as_the_opposite_one() {
        for ours in [DVec3::ZERO, DVec3::NAN, DVec3::NEG_Z] {
            assert_eq!(angle_deg(ours, DVec3::Z), 180.0);
        }
    }
}
