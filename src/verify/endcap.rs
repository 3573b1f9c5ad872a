//! Tier `endcap`: how far OpenSubdiv's default end caps are from the exact limit. It reports, and never fails.

use super::bin::{Bins, Check, Difference, Key, Normal, Sample};
use super::regular::scattered;
use super::{NORMAL_LIMIT, Subject, VerifyError, rounding};
use crate::osd::{Answer, Bfr, Reference};

const PER_FACE: usize = 64;
const BUDGET: usize = 400_000;

pub(super) fn run(subject: &Subject<'_>, bins: &mut Bins) -> Result<(), VerifyError> {
    let samples = scattered(subject, PER_FACE, BUDGET);
    let answers = Bfr::new(subject.mesh, Bfr::DEFAULT_LEVELS)?.evaluate(&samples)?;
    bins.not_asked += answers.iter().filter(|a| a.answer == Answer::NotAsked).count();
    for (&(face, u, v), answer) in samples.iter().zip(&answers).filter(|(_, a)| a.answer == Answer::EndCap) {
        let sample = Sample { face, u, v };
        let Some((patch, jet)) = subject.evaluate(sample) else { continue };
        let error = jet.position.distance(answer.position) / subject.rounding.unit;
        let turn = rounding::turn_deg(answer.du, answer.dv, subject.rounding.derivative(answer.cell));
        let reference = answer.du.cross(answer.dv);
        let difference = Difference {
            position: Check { error, allowed: f64::INFINITY },
            normal: Normal::judge(jet.normal, reference, turn, NORMAL_LIMIT, f64::INFINITY),
            derivative: None,
        };
        let kind = Some(subject.surface.kind(patch));
        bins.add(Key { tier: "endcap", reference: "Bfr 2/6", kind, known_wrong: None }, sample, difference);
    }
    Ok(())
}
