//! Errors of one tier and patch kind.

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
    pub kind: PatchKind,
    /// Why the reference is wrong here.
    pub known_wrong: Option<&'static str>,
}

/// What the errors of a bin may be: position / diagonal, angle in degrees, derivative / diagonal.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Tolerance {
    pub position: Option<f64>,
    pub normal_deg: Option<f64>,
    pub derivative: Option<f64>,
}

/// Errors of one sample, in model units; what a reference does not know stays `None`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Difference {
    pub position: f64,
    pub normal_deg: Option<f64>,
    pub derivative: Option<f64>,
}

#[derive(Debug, Default)]
pub(super) struct Bin {
    pub tolerance: Tolerance,
    pub samples: usize,
    pub position: f64,
    pub derivative: Option<f64>,
    /// All angles: the report takes the largest and a percentile.
    pub normals: Vec<f64>,
    pub worst: Option<Sample>,
    worst_share: f64,
}

pub(super) struct Bins {
    diagonal: f64,
    pub bins: BTreeMap<Key, Bin>,
    /// Samples that a reference was not asked, because it corrupts memory there.
    pub not_asked: usize,
}

impl Bins {
    pub fn new(diagonal: f64) -> Self {
        Self { diagonal, bins: BTreeMap::new(), not_asked: 0 }
    }

    pub fn add(&mut self, key: Key, tolerance: Tolerance, sample: Sample, difference: Difference) {
        // A surface without extent has no unit: then the error itself is compared.
        let unit = if self.diagonal > 0.0 { self.diagonal } else { 1.0 };
        let bin = self.bins.entry(key).or_default();
        bin.tolerance = tolerance;
        bin.samples += 1;
        let position = difference.position / unit;
        let derivative = difference.derivative.map(|d| d / unit);
        bin.position = larger(bin.position, position);
        bin.derivative = match (bin.derivative, derivative) {
            (Some(a), Some(b)) => Some(larger(a, b)),
            (a, b) => a.or(b),
        };
        bin.normals.extend(difference.normal_deg);
        // Worst by the share of the tolerance that is used; without a tolerance, by angle.
        let share = |error: Option<f64>, limit: Option<f64>| error.zip(limit).map_or(0.0, |(e, l)| e / l);
        let used = [
            share(Some(position), tolerance.position),
            share(difference.normal_deg, tolerance.normal_deg),
            share(derivative, tolerance.derivative),
        ];
        let share = match tolerance.position {
            Some(_) => used.into_iter().fold(0.0, larger),
            None => difference.normal_deg.unwrap_or(position),
        };
        if bin.worst.is_none() || larger(bin.worst_share, share) != bin.worst_share {
            bin.worst_share = share;
            bin.worst = Some(sample);
        }
    }
}

/// The larger of two errors; NaN, which no tolerance allows, is the largest.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Angle between two directions in degrees, 0 to 180; `None` if either vanishes. Exact for small angles, where the
/// arc cosine is not.
pub(super) fn angle_deg(a: DVec3, b: DVec3) -> Option<f64> {
    let (a, b) = (a.try_normalize()?, b.try_normalize()?);
    Some(a.cross(b).length().atan2(a.dot(b)).to_degrees())
}
