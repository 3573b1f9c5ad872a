//! Tier `regular`: anywhere in OpenSubdiv's regular patches. At isolation 10 they cover all but 2^-20 of the area of an
//! irregular face, so irregular patches are checked here too, away from dyadic points.

use super::bin::{Bins, Key, Sample};
use super::{Subject, VerifyError};
use crate::osd::{Answer, Bfr, Far, Reference};

/// Position as at vertices; a derivative may lose five times as much, OpenSubdiv's own rule for its regressions.
/// Rounding of world coordinates comes on top ([`Rounding`](super::rounding::Rounding)).
const TOLERANCES: [f64; 3] = [1e-12, 1e-6, 5e-12];

const PER_FACE: usize = 32;
const BUDGET: usize = 200_000;

/// Point `i` of a sequence that fills the unit square evenly (Roberts' R2: multiples of the plastic number's powers).
pub(super) fn scatter(i: u32) -> [f64; 2] {
    [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (0.5 + f64::from(i) * step).fract())
}

/// `per_face` scattered samples on each of the subject's faces, other ones on every face.
pub(super) fn scattered(subject: &Subject<'_>, per_face: usize, budget: usize) -> Vec<(u32, f64, f64)> {
    let on_face = |face: u32| {
        let first = face.wrapping_mul(per_face as u32) % (1 << 20);
        (first..first + per_face as u32).map(move |i| {
            let [u, v] = scatter(i);
            (face, u, v)
        })
    };
    subject.faces(per_face, budget).flat_map(on_face).collect()
}

pub(super) fn run(subject: &Subject<'_>, far: &mut Far, bins: &mut Bins) -> Result<(), VerifyError> {
    let samples = scattered(subject, PER_FACE, BUDGET);
    let mut bfr = Bfr::new(subject.mesh, Bfr::DEFAULT_LEVELS)?;
    let evaluators: [(&str, &mut dyn Reference); 2] = [("Far level 10", far), ("Bfr", &mut bfr)];
    for (reference, evaluator) in evaluators {
        let answers = evaluator.evaluate(&samples)?;
        bins.not_asked += answers.iter().filter(|a| a.answer == Answer::NotAsked).count();
        for (&(face, u, v), answer) in samples.iter().zip(&answers).filter(|(_, a)| a.answer == Answer::Regular) {
            let sample = Sample { face, u, v };
            let ours = subject.evaluate(sample);
            let kind = ours.map(|(patch, _)| subject.surface.kind(patch));
            let key = Key { tier: "regular", reference, kind, known_wrong: None };
            match ours {
                Some((patch, jet)) => bins.add(key, sample, subject.difference(patch, &jet, answer, TOLERANCES)),
                None => bins.mismatch(key, sample),
            }
        }
    }
    Ok(())
}
