//! Tier `regular`: anywhere in regular patches, against both of OpenSubdiv's evaluators.

use super::bin::{Bins, Difference, Key, Sample, Tolerance, angle_deg};
use super::{Subject, VerifyError};
use crate::osd::{Answer, Bfr, Far, Reference};
use crate::patch::PatchKind;

/// Position as at vertices; a derivative may lose five times as much, OpenSubdiv's own rule for its regressions.
const TOLERANCE: Tolerance = Tolerance { position: Some(1e-12), normal_deg: Some(1e-6), derivative: Some(5e-12) };

const PER_FACE: usize = 16;
const BUDGET: usize = 200_000;

/// Point `i` of a sequence that fills the unit square evenly (Roberts' R2: multiples of the plastic number's powers).
pub(super) fn scatter(i: u32) -> [f64; 2] {
    [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (0.5 + f64::from(i) * step).fract())
}

pub(super) fn run(subject: &Subject<'_>, far: &mut Far, bins: &mut Bins) -> Result<(), VerifyError> {
    let per_face = PER_FACE as u32;
    let faces = subject.faces(PER_FACE, BUDGET);
    let samples: Vec<_> = faces
        .flat_map(|face| (0..per_face).map(move |i| scatter(face.wrapping_mul(per_face).wrapping_add(i))).map(move |[u, v]| (face, u, v)))
        .filter(|&(face, u, v)| {
            let located = subject.surface.locate(face, [u, v]);
            located.is_some_and(|(patch, _)| subject.surface.kind(patch) == PatchKind::Regular)
        })
        .collect();
    let mut bfr = Bfr::new(subject.mesh, Bfr::DEFAULT_LEVELS)?;
    let evaluators: [(&str, &mut dyn Reference); 2] = [("Far level 10", far), ("Bfr", &mut bfr)];
    for (reference, evaluator) in evaluators {
        let answers = evaluator.evaluate(&samples)?;
        for (&(face, u, v), answer) in samples.iter().zip(&answers).filter(|(_, a)| a.answer == Answer::Regular) {
            let Some((_, jet)) = subject.surface.evaluate_ptex(face, [u, v]) else { continue };
            let difference = Difference {
                position: jet.position.distance(answer.position),
                normal_deg: angle_deg(jet.normal, answer.du.cross(answer.dv)),
                derivative: Some(jet.du.distance(answer.du).max(jet.dv.distance(answer.dv))),
            };
            let key = Key { tier: "regular", reference, kind: PatchKind::Regular, known_wrong: None };
            bins.add(key, TOLERANCE, Sample { face, u, v }, difference);
        }
    }
    Ok(())
}
