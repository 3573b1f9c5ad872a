//! Tier `endcap`: how far OpenSubdiv's default end caps are from the exact limit. It reports, and never fails.

use super::bin::Bins;
use super::difference::{Check, Difference, Normal, Sample};
use super::key::{Against, Key, TierName};
use super::references::References;
use super::regular::scattered;
use super::{NORMAL_LIMIT, Subject, rounding};
use crate::osd::{Answer, Bfr};

const PER_FACE: usize = 64;
const BUDGET: usize = 400_000;

pub(super) fn run(subject: &Subject<'_>, references: &References<'_>, bins: &mut Bins) {
    let scattered = scattered(subject, PER_FACE, BUDGET);
    let samples = references.expense.for_bfr(&scattered);
    bins.too_slow += scattered.len() - samples.len();
    let answers = references.bfr(Bfr::DEFAULT_LEVELS, &samples);
    let Some(answers) = bins.answered(TierName::EndCap, Against::BfrEndCaps, answers) else { return };
    bins.not_asked += answers.iter().filter(|a| a.answer == Answer::NotAsked).count();
    bins.fill(samples.len(), |bins, i| {
        let (answer, (face, u, v)) = (&answers[i], samples[i]);
        let sample = Sample { face, u, v };
        let (Answer::EndCap, Some((patch, jet))) = (answer.answer, subject.evaluate(sample)) else { return };
        let error = jet.position.distance(answer.position) / subject.rounding.unit;
        let turn = rounding::turn_deg(answer.du, answer.dv, subject.rounding.derivative(answer.cell));
        let reference = answer.du.cross(answer.dv);
        let difference = Difference {
            position: Check { error, allowed: f64::INFINITY },
            normal: Normal::judge(jet.normal, reference, turn, NORMAL_LIMIT, f64::INFINITY),
            derivative: None,
        };
        let key = Key::new(TierName::EndCap, Against::BfrEndCaps, subject.kind(patch));
        bins.add(key, subject.place(sample, Some(patch)), difference);
    });
}
