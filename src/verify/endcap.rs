//! Tier `endcap`: how far OpenSubdiv's default end caps are from the exact limit. It reports, and never fails.

use super::bin::{Bins, Difference, Key, Sample, Tolerance, angle_deg};
use super::regular::scattered;
use super::{Subject, VerifyError};
use crate::osd::{Answer, Bfr, Reference};

const PER_FACE: usize = 64;
const BUDGET: usize = 400_000;

pub(super) fn run(subject: &Subject<'_>, bins: &mut Bins) -> Result<(), VerifyError> {
    let samples = scattered(subject, PER_FACE, BUDGET);
    let answers = Bfr::new(subject.mesh, Bfr::DEFAULT_LEVELS)?.evaluate(&samples)?;
    bins.not_asked += answers.iter().filter(|a| a.answer == Answer::NotAsked).count();
    for (&(face, u, v), answer) in samples.iter().zip(&answers).filter(|(_, a)| a.answer == Answer::EndCap) {
        let Some((patch, jet)) = subject.surface.evaluate_ptex(face, [u, v]) else { continue };
        let difference = Difference {
            position: jet.position.distance(answer.position),
            normal_deg: angle_deg(jet.normal, answer.du.cross(answer.dv)),
            derivative: None,
        };
        let key = Key { tier: "endcap", reference: "Bfr 2/6", kind: subject.surface.kind(patch), known_wrong: None };
        bins.add(key, Tolerance::default(), Sample { face, u, v }, difference);
    }
    Ok(())
}
