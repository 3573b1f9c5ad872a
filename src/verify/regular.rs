//! Tier `regular`: anywhere in OpenSubdiv's regular patches. At isolation 10 they cover all but 2^-20 of the area of an
//! irregular face, so irregular patches are checked here too, away from dyadic points.

use super::Subject;
use super::bin::Bins;
use super::difference::Sample;
use super::key::{Against, Key, TierName};
use super::references::References;
use crate::osd::{Answer, Bfr, Location, ReferenceJet};
use crate::stam::Jet;
use crate::statistics::scatter;

/// Position as at vertices; a derivative may lose five times as much, OpenSubdiv's own rule for its regressions.
/// Rounding of world coordinates comes on top ([`Rounding`](super::rounding::Rounding)).
pub(super) const TOLERANCES: [f64; 3] = [1e-12, 1e-6, 5e-12];

const PER_FACE: usize = 32;
const BUDGET: usize = 200_000;

/// Samples inside every patch, and inside those of which none of these was judged.
const PER_PATCH: u32 = 3;
const MORE_PER_PATCH: u32 = 16;

/// `per_face` scattered samples on each of the subject's faces, other ones on every face.
pub(super) fn scattered(subject: &Subject<'_>, per_face: usize, budget: usize) -> Vec<Location> {
    let on_face = |face: u32| {
        let first = face.wrapping_mul(per_face as u32) % (1 << 20);
        (first..first + per_face as u32).map(move |i| {
            let [u, v] = subject.surface.folded(scatter(i));
            (face, u, v)
        })
    };
    subject.faces(per_face, budget).flat_map(on_face).collect()
}

/// Scattered samples inside each of some patches.
fn inside(subject: &Subject<'_>, patches: &[usize], each: u32) -> Vec<Location> {
    let in_patch = |&index: &usize| {
        let patch = &subject.surface.patches()[index];
        let first = (index as u32).wrapping_mul(each) % (1 << 20);
        (first..first + each).map(move |i| {
            let [u, v] = patch.to_ptex(subject.surface.folded(scatter(i)));
            (patch.ptex, u, v)
        })
    };
    patches.iter().flat_map(in_patch).collect()
}

pub(super) fn run(subject: &Subject<'_>, references: &References<'_>, bins: &mut Bins) {
    let scattered = scattered(subject, PER_FACE, BUDGET);
    let samples = references.expense.for_bfr(&scattered);
    bins.too_slow += scattered.len() - samples.len();
    // A small patch may have been missed: none is, whatever the size of the mesh.
    let every: Vec<usize> = (0..subject.surface.patches().len()).collect();
    let mut all = [&*scattered, &inside(subject, &every, PER_PATCH)].concat();
    all.sort_by_key(|sample| sample.0);
    let asked = references.for_stencils(&all);
    bins.too_slow += asked.left_out;
    // Bfr, which has one thread, answers while limit stencils are made.
    let (bfr, stencils) = both(|| references.bfr(Bfr::DEFAULT_LEVELS, &samples), || references.stencils(&asked));
    if let Some(answers) = bins.answered(TierName::Regular, Against::Bfr, bfr) {
        bins.not_asked += answers.iter().filter(|a| a.answer == Answer::NotAsked).count();
        compare(subject, Against::Bfr, &samples, &subject.evaluate_all(&samples), &answers, bins);
    }
    if let Some(answers) = bins.answered(TierName::Regular, Against::LimitStencils, stencils) {
        let kept = &asked.samples;
        compare(subject, Against::LimitStencils, kept, &subject.evaluate_all(kept), &answers, bins);
    }

    let mut judged = vec![false; every.len()];
    ask_far(subject, references, &all, &mut judged, bins);
    // A second round for patches where OpenSubdiv's end cap took the first samples.
    let missed: Vec<usize> = every.into_iter().filter(|&patch| !judged[patch]).collect();
    ask_far(subject, references, &inside(subject, &missed, MORE_PER_PATCH), &mut judged, bins);
    bins.unjudged = judged.iter().filter(|judged| !**judged).count();
}

/// Asks two references at a time. These are threads of their own, because both wait for other processes meanwhile.
fn both<A, B: Send>(first: impl FnOnce() -> A, second: impl FnOnce() -> B + Send) -> (A, B) {
    std::thread::scope(|scope| {
        let second = scope.spawn(second);
        let first = first();
        (first, second.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// Compares with Far, and marks the patches that have a sample that was judged.
fn ask_far(
    subject: &Subject<'_>,
    references: &References<'_>,
    samples: &[Location],
    judged: &mut [bool],
    bins: &mut Bins,
) {
    // Portions bound the memory of the answers.
    for samples in samples.chunks(BUDGET) {
        let ours = subject.evaluate_all(samples);
        let Some(answers) = bins.answered(TierName::Regular, Against::Far, references.far(samples)) else { return };
        compare(subject, Against::Far, samples, &ours, &answers, bins);
        let regular = ours.iter().zip(&answers).filter(|(_, answer)| answer.answer == Answer::Regular);
        regular.filter_map(|(ours, _)| *ours).for_each(|(patch, _)| judged[patch] = true);
    }
}

fn compare(
    subject: &Subject<'_>,
    against: Against,
    samples: &[Location],
    ours: &[Option<(usize, Jet)>],
    answers: &[ReferenceJet],
    bins: &mut Bins,
) {
    bins.fill(samples.len(), |bins, i| {
        let ((face, u, v), answer) = (samples[i], &answers[i]);
        if answer.answer != Answer::Regular {
            return;
        }
        let patch = ours[i].map(|(patch, _)| patch);
        let key = Key::new(TierName::Regular, against, patch.and_then(|patch| subject.kind(patch)));
        let place = subject.place(Sample { face, u, v }, patch);
        match ours[i] {
            Some((patch, jet)) => bins.add(key, place, subject.difference(patch, &jet, answer, TOLERANCES)),
            None => bins.mismatch(key, place),
        }
    });
}
