//! Errors of one tier, reference and patch kind.

use super::difference::{Check, Difference, Normal, Place, Sample, larger};
use super::histogram::Histogram;
use super::key::{Against, Key, TierName};
use super::references::ReferenceError;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The largest error of a bin, the most that any of its samples was allowed, and how the errors are spread.
#[derive(Debug, Clone, Default)]
pub(super) struct Column {
    pub largest: Option<f64>,
    pub allowed: Option<f64>,
    pub histogram: Histogram,
}

impl Column {
    fn add(&mut self, check: Check) {
        self.largest = Some(self.largest.map_or(check.error, |largest| larger(largest, check.error)));
        if check.allowed.is_finite() {
            self.allowed = Some(self.allowed.map_or(check.allowed, |allowed| allowed.max(check.allowed)));
        }
        self.histogram.add(check.error);
    }

    fn merge(&mut self, other: Self) {
        let largest = |a: Option<f64>, b| a.into_iter().chain(b).reduce(larger);
        self.largest = largest(self.largest, other.largest);
        self.allowed = largest(self.allowed, other.allowed);
        self.histogram.merge(&other.histogram);
    }
}

/// Samples that use most of what they may, or more.
#[derive(Debug, Clone, Copy)]
pub(super) struct Worst {
    pub sample: Sample,
    /// Error over what is allowed; where nothing is demanded, the angle.
    pub share: f64,
}

/// The failed samples of a patch: how many, and the worst.
#[derive(Debug, Clone, Copy)]
pub(super) struct Failed {
    pub samples: usize,
    pub worst: Worst,
}

/// Failed samples by ptex face and patch; no patch where we have no surface.
pub(super) type FailedPatches = BTreeMap<(u32, Option<u32>), Failed>;

/// Adds failed samples to those of a patch that were found before.
pub(super) fn note(failed: &mut FailedPatches, patch: (u32, Option<u32>), more: Failed) {
    let known = failed.entry(patch).or_insert(Failed { samples: 0, ..more });
    known.samples += more.samples;
    if more.worst.share > known.worst.share {
        known.worst = more.worst;
    }
}

#[derive(Debug, Default)]
pub(super) struct Bin {
    pub samples: usize,
    /// Samples with an error beyond what they may have.
    pub failed: usize,
    pub failed_patches: FailedPatches,
    pub position: Column,
    pub normal: Column,
    pub derivative: Column,
    /// All angles, each with its share of what is allowed.
    pub normals: Vec<[f64; 2]>,
    pub normals_skipped: usize,
    pub worst: Option<Worst>,
}

/// Rows that judge their normals by a percentile cap the largest by this many times as much.
pub(super) const CAP: f64 = 100.0;

/// Samples that are compared at a time, each time on one thread: some milliseconds of work.
const CHUNK: usize = 4096;

#[derive(Debug, Default)]
pub(super) struct Bins {
    pub bins: BTreeMap<Key, Bin>,
    /// Samples that a reference was not asked, because it corrupts memory there.
    pub not_asked: usize,
    /// Samples at vertices of many faces that a reference was not asked, because it would take too long.
    pub too_slow: usize,
    /// Patches without a sample that was judged inside: OpenSubdiv has an end cap all over them.
    pub unjudged: usize,
    /// Vertices of the refined level that limit masks have no room for; they are not asked then.
    pub crowded: usize,
    /// References that did not answer, in the order in which they were asked.
    pub unanswered: Vec<Unanswered>,
}

/// A tier whose reference did not answer.
#[derive(Debug, Clone)]
pub(super) struct Unanswered {
    pub tier: TierName,
    pub against: Against,
    pub why: ReferenceError,
}

impl Bin {
    fn add(&mut self, cap: f64, Place { sample, patch }: Place, difference: Difference) {
        let Difference { position, normal, derivative } = difference;
        self.samples += 1;
        let mut share = position.share();
        let mut failed = share > 1.0;
        self.position.add(position);
        if let Some(check) = derivative {
            self.derivative.add(check);
            failed |= check.share() > 1.0;
            share = share.max(check.share());
        }
        let mut angle = 0.0;
        match normal {
            Normal::Unknown => {}
            Normal::Skipped => self.normals_skipped += 1,
            Normal::Judged(check) => {
                self.normal.add(check);
                self.normals.push([check.error, check.share()]);
                failed |= check.share() > cap;
                share = share.max(check.share());
                angle = check.error;
            }
        }
        // Worst by the share of what is allowed; where nothing is demanded, by angle.
        let share = if position.allowed.is_finite() { share } else { angle };
        let here = Worst { sample, share };
        if failed {
            self.failed += 1;
            note(&mut self.failed_patches, (sample.face, patch), Failed { samples: 1, worst: here });
        }
        if self.worst.is_none_or(|worst| share > worst.share) {
            self.worst = Some(here);
        }
    }

    /// Adds what samples that come after ours found.
    fn merge(&mut self, other: Self) {
        self.samples += other.samples;
        self.failed += other.failed;
        other.failed_patches.into_iter().for_each(|(patch, failed)| note(&mut self.failed_patches, patch, failed));
        self.position.merge(other.position);
        self.normal.merge(other.normal);
        self.derivative.merge(other.derivative);
        self.normals.extend(other.normals);
        self.normals_skipped += other.normals_skipped;
        let worst = |worst: Worst, other: Worst| if other.share > worst.share { other } else { worst };
        self.worst = self.worst.into_iter().chain(other.worst).reduce(worst);
    }
}

impl Bins {
    pub fn add(&mut self, key: Key, place: Place, difference: Difference) {
        let cap = if key.judges_percentile() { CAP } else { 1.0 };
        self.bins.entry(key).or_default().add(cap, place, difference);
    }

    /// A sample that fails because one side has a surface where the other has none.
    pub fn mismatch(&mut self, key: Key, place: Place) {
        let position = Check { error: f64::NAN, allowed: 0.0 };
        self.add(key, place, Difference { position, normal: Normal::Unknown, derivative: None });
    }

    /// The answers of a reference; one that does not answer becomes a row, and the other references are asked all the same.
    pub fn answered<T>(&mut self, tier: TierName, against: Against, answers: Result<T, ReferenceError>) -> Option<T> {
        let why = match answers {
            Ok(answers) => return Some(answers),
            Err(why) => why,
        };
        // A tier that asks in portions has one row all the same.
        if !self.unanswered.iter().any(|known| (known.tier, known.against) == (tier, against)) {
            self.unanswered.push(Unanswered { tier, against, why });
        }
        None
    }

    /// A row without samples, which fails.
    pub fn nothing(&mut self, key: Key) {
        self.bins.entry(key).or_default();
    }

    /// Compares items 0 to `count` on all threads; the result does not depend on how many there are.
    pub fn fill(&mut self, count: usize, compare: impl Fn(&mut Self, usize) + Sync) {
        let chunk = |first: usize| {
            let mut bins = Self::default();
            (first..count.min(first + CHUNK)).for_each(|item| compare(&mut bins, item));
            bins
        };
        let chunks: Vec<Self> = (0..count.div_ceil(CHUNK)).into_par_iter().map(|i| chunk(i * CHUNK)).collect();
        for bins in chunks {
            self.not_asked += bins.not_asked;
            for (key, bin) in bins.bins {
                self.bins.entry(key).or_default().merge(bin);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: Key = Key { tier: TierName::Regular, against: Against::Far, kind: None, known_wrong: None };

    fn sample(i: usize) -> Place {
        Place { sample: Sample { face: i as u32, u: 0.0, v: 0.0 }, patch: Some(i as u32) }
    }

    fn bin(checks: &[(f64, f64)]) -> Bin {
        let mut bins = Bins::default();
        bins.fill(checks.len(), |bins, i| {
            let (error, allowed) = checks[i];
            let position = Check { error, allowed };
            bins.add(KEY, sample(i), Difference { position, normal: Normal::Unknown, derivative: None });
        });
        bins.bins.remove(&KEY).expect("it was filled")
    }

    #[test]
    fn the_worst_sample_uses_most_of_what_it_may_and_nan_is_worst() {
        let worst = |bin: Bin| bin.worst.map(|worst| worst.sample.face);
        assert_eq!(worst(bin(&[(1.0, 10.0), (0.5, 1.0), (2.0, 10.0)])), Some(1));
        assert_eq!(worst(bin(&[(0.5, 1.0), (f64::NAN, 1.0), (100.0, 1.0), (f64::NAN, 1.0)])), Some(1));
        assert_eq!(worst(bin(&[(f64::NAN, 1.0), (0.5, 1.0)])), Some(0));
    }

    #[test]
    fn samples_beyond_their_allowance_are_counted_where_they_are() {
        let bin_of_five = bin(&[(1.0, 1.0), (0.0, 0.0), (1.5, 1.0), (-f64::NAN, 1.0), (1e-300, 0.0)]);
        assert_eq!(bin_of_five.failed, 3);
        let places: Vec<_> = bin_of_five.failed_patches.iter().map(|(&(face, _), f)| (face, f.worst.share)).collect();
        assert_eq!(places, [(2, 1.5), (3, f64::INFINITY), (4, f64::INFINITY)]);
        // Nothing is demanded: nothing fails.
        assert_eq!(bin(&[(1e9, f64::INFINITY), (f64::NAN, f64::INFINITY)]).failed, 0);
        assert!(bin(&[(1.0, 1.0), (f64::NAN, 1.0), (2.0, 1.0)]).position.largest.is_some_and(f64::is_nan));
    }

    #[test]
    fn chunks_add_up() {
        let checks: Vec<_> = (0..3 * CHUNK + 5).map(|i| ((i * 7919 % 10_007) as f64, 10_000.0)).collect();
        let bin = bin(&checks);
        let errors = || checks.iter().map(|check| check.0);
        let first = errors().position(|error| error == 10_006.0).expect("the largest is there");
        assert_eq!(bin.worst.map(|worst| worst.sample.face), Some(first as u32));
        assert_eq!(bin.failed, errors().filter(|&error| error > 10_000.0).count());
        assert_eq!((bin.samples, bin.position.histogram.total()), (checks.len(), checks.len() as u64));
    }

    #[test]
    fn percentiles_cap_the_largest() {
        let key = Key { tier: TierName::Fragment, ..KEY };
        let mut bins = Bins::default();
        for (error, failed) in [(50.0, 0), (101.0, 1), (f64::NAN, 2)] {
            let normal = Normal::Judged(Check { error, allowed: 1.0 });
            let position = Check { error: 0.0, allowed: 1.0 };
            bins.add(key, sample(0), Difference { position, normal, derivative: None });
            assert_eq!(bins.bins[&key].failed, failed);
        }
    }
}
