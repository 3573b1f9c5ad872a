//! Errors of one tier, reference and patch kind.

use crate::patch::PatchKind;
use glam::DVec3;
use serde::Serialize;
use std::collections::BTreeMap;

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

/// Identifies a bin: one row of the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    pub tier: &'static str,
    pub reference: &'static str,
    /// `None` where we have no surface.
    pub kind: Option<PatchKind>,
    /// Why the reference is wrong here.
    pub known_wrong: Option<&'static str>,
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

/// The largest error of a bin, and the most that any of its samples was allowed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Column {
    pub largest: Option<f64>,
    pub allowed: Option<f64>,
}

impl Column {
    fn add(&mut self, check: Check) {
        self.largest = Some(self.largest.map_or(check.error, |largest| larger(largest, check.error)));
        if check.allowed.is_finite() {
            self.allowed = Some(self.allowed.map_or(check.allowed, |allowed| allowed.max(check.allowed)));
        }
    }
}

#[derive(Debug, Default)]
pub(super) struct Bin {
    pub samples: usize,
    /// Samples with an error beyond what they may have.
    pub failed: usize,
    pub position: Column,
    pub normal: Column,
    pub derivative: Column,
    /// All angles, each with its share of what is allowed.
    pub normals: Vec<[f64; 2]>,
    pub normals_skipped: usize,
    pub worst: Option<Sample>,
    worst_share: f64,
}

/// Rows that judge their normals by a percentile cap the largest by this many times as much.
pub(super) const CAP: f64 = 100.0;

#[derive(Debug, Default)]
pub(super) struct Bins {
    pub bins: BTreeMap<Key, Bin>,
    /// Samples that a reference was not asked, because it corrupts memory there.
    pub not_asked: usize,
}

impl Key {
    /// The 99.99th percentile of the normals is judged, and the largest only capped: a budget of the picture, not a
    /// rounding error.
    pub fn judges_percentile(&self) -> bool {
        self.tier == "fragment"
    }
}

impl Bins {
    pub fn add(&mut self, key: Key, sample: Sample, difference: Difference) {
        let bin = self.bins.entry(key).or_default();
        bin.samples += 1;
        let mut shares = vec![difference.position.share()];
        let mut failed = shares[0] > 1.0;
        bin.position.add(difference.position);
        if let Some(check) = difference.derivative {
            bin.derivative.add(check);
            failed |= check.share() > 1.0;
            shares.push(check.share());
        }
        let mut angle = 0.0;
        match difference.normal {
            Normal::Unknown => {}
            Normal::Skipped => bin.normals_skipped += 1,
            Normal::Judged(check) => {
                bin.normal.add(check);
                bin.normals.push([check.error, check.share()]);
                failed |= check.share() > if key.judges_percentile() { CAP } else { 1.0 };
                shares.push(check.share());
                angle = check.error;
            }
        }
        bin.failed += usize::from(failed);
        // Worst by the share of what is allowed; where nothing is demanded, by angle.
        let demanded = difference.position.allowed.is_finite();
        let share = if demanded { shares.into_iter().fold(0.0, f64::max) } else { angle };
        if bin.worst.is_none() || share > bin.worst_share {
            bin.worst_share = share;
            bin.worst = Some(sample);
        }
    }

    /// A sample that fails because one side has a surface where the other has none.
    pub fn mismatch(&mut self, key: Key, sample: Sample) {
        let position = Check { error: f64::NAN, allowed: 0.0 };
        self.add(key, sample, Difference { position, normal: Normal::Unknown, derivative: None });
    }

    /// A row without samples, which fails.
    pub fn nothing(&mut self, key: Key) {
        self.bins.entry(key).or_default();
    }
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

    const KEY: Key = Key { tier: "regular", reference: "test", kind: None, known_wrong: None };

    fn bin(checks: &[(f64, f64)]) -> Bin {
        let mut bins = Bins::default();
        for (i, &(error, allowed)) in checks.iter().enumerate() {
            let sample = Sample { face: i as u32, u: 0.0, v: 0.0 };
            let position = Check { error, allowed };
            bins.add(KEY, sample, Difference { position, normal: Normal::Unknown, derivative: None });
        }
        bins.bins.remove(&KEY).expect("it was filled")
    }

    #[test]
    fn the_worst_sample_uses_most_of_what_it_may_and_nan_is_worst() {
        let worst = |bin: Bin| bin.worst.map(|sample| sample.face);
        assert_eq!(worst(bin(&[(1.0, 10.0), (0.5, 1.0), (2.0, 10.0)])), Some(1));
        assert_eq!(worst(bin(&[(0.5, 1.0), (f64::NAN, 1.0), (100.0, 1.0), (f64::NAN, 1.0)])), Some(1));
        assert_eq!(worst(bin(&[(f64::NAN, 1.0), (0.5, 1.0)])), Some(0));
    }

    #[test]
    fn samples_beyond_their_allowance_are_counted() {
        assert_eq!(bin(&[(1.0, 1.0), (0.0, 0.0), (1.5, 1.0), (-f64::NAN, 1.0), (1e-300, 0.0)]).failed, 3);
        // Nothing is demanded: nothing fails.
        assert_eq!(bin(&[(1e9, f64::INFINITY), (f64::NAN, f64::INFINITY)]).failed, 0);
        assert!(bin(&[(1.0, 1.0), (f64::NAN, 1.0), (2.0, 1.0)]).position.largest.is_some_and(f64::is_nan));
    }

    #[test]
    fn percentiles_cap_the_largest() {
        let key = Key { tier: "fragment", ..KEY };
        let mut bins = Bins::default();
        for (error, failed) in [(50.0, 0), (101.0, 1), (f64::NAN, 2)] {
            let normal = Normal::Judged(Check { error, allowed: 1.0 });
            let position = Check { error: 0.0, allowed: 1.0 };
            let sample = Sample { face: 0, u: 0.0, v: 0.0 };
            bins.add(key, sample, Difference { position, normal, derivative: None });
            assert_eq!(bins.bins[&key].failed, failed);
        }
    }

    #[test]
    fn no_normal_is_as_wrong_as_the_opposite_one() {
        for ours in [DVec3::ZERO, DVec3::NAN, DVec3::NEG_Z] {
            assert_eq!(angle_deg(ours, DVec3::Z), 180.0);
        }
    }
}
