//! Tier `dyadic`: points i/2^k, where OpenSubdiv's adaptive patches are exact whatever their end caps.

use super::bin::{Bins, Check, Key, Normal, Sample};
use super::{Subject, VerifyError};
use crate::osd::{Answer, Far, MAX_ISOLATION, Reference};
use crate::patch::PatchKind;

/// Ten levels of refinement, each summed anew on both sides: ten times tier `vertex`. Rounding of world coordinates comes
/// on top ([`Rounding`](super::rounding::Rounding)).
const POSITION: f64 = 1e-11;
const NORMAL_DEG: f64 = 1e-6;
const DERIVATIVE: f64 = 1e-10;

/// What a position may be off where the end cap is known to be wrong. Not derived: it tells gross errors of ours from
/// OpenSubdiv's, of which the largest found is 2.2e-5.
const KNOWN_WRONG: f64 = 1e-2;

const BUDGET: usize = 400_000;

pub(super) fn reference(subject: &Subject<'_>) -> Result<Far, VerifyError> {
    Ok(Far::new(subject.mesh, MAX_ISOLATION)?)
}

/// A 4 x 4 grid, and towards each corner the points at 2^-k, k up to `depth`, on both edges and the diagonal.
fn parameters(depth: u32) -> Vec<[f64; 2]> {
    let mut out: Vec<_> = (0..25).map(|i| [f64::from(i % 5) / 4.0, f64::from(i / 5) / 4.0]).collect();
    for k in 3..=depth as i32 {
        let near = 2f64.powi(-k);
        for [u, v] in [[near, 0.0], [0.0, near], [near, near]] {
            out.extend([[u, v], [1.0 - u, v], [1.0 - u, 1.0 - v], [u, 1.0 - v]]);
        }
    }
    out
}

pub(super) fn run(subject: &Subject<'_>, far: &mut Far, bins: &mut Bins) -> Result<(), VerifyError> {
    // The quadrants of an n-gon are quads of level 1 already: isolation 10 splits them 9 times.
    let [quad, quadrant] = [parameters(MAX_ISOLATION), parameters(MAX_ISOLATION - 1)];
    let sizes = subject.mesh.face_sizes.iter();
    let grids: Vec<_> = sizes.flat_map(|&n| if n == 4 { vec![&quad] } else { vec![&quadrant; n as usize] }).collect();
    let faces = subject.faces(quad.len(), BUDGET);
    let samples: Vec<_> = faces.flat_map(|face| grids[face as usize].iter().map(move |&[u, v]| (face, u, v))).collect();
    let references = far.evaluate(&samples)?;
    for (&(face, u, v), reference) in samples.iter().zip(&references) {
        let sample = Sample { face, u, v };
        let answered = reference.answer != Answer::None;
        let mut key = Key { tier: "dyadic", reference: "Far level 10", kind: None, known_wrong: None };
        let (patch, jet) = match subject.evaluate(sample) {
            Some(ours) if answered => ours,
            None if !answered => continue,
            ours => {
                // One side sees a hole.
                key.kind = ours.map(|(patch, _)| subject.surface.kind(patch));
                bins.mismatch(key, sample);
                continue;
            }
        };
        let kind = subject.surface.kind(patch);
        key.kind = Some(kind);
        // An end cap meets the limit at its corners, but for the normal at an extraordinary vertex (3.5.0: off by up to
        // 1e-2 degrees at isolation 10, converging to ours), and for darts altogether.
        let exact = reference.answer == Answer::Regular;
        let mut difference = subject.difference(patch, &jet, reference, [POSITION, NORMAL_DEG, DERIVATIVE]);
        if kind == PatchKind::Dart && !exact {
            key.known_wrong = Some("end cap at infinitely sharp darts");
            difference.position = Check { allowed: KNOWN_WRONG, ..difference.position };
        }
        if !exact {
            difference.normal = Normal::Unknown;
        }
        difference.derivative = difference.derivative.filter(|_| exact && kind == PatchKind::Regular);
        bins.add(key, sample, difference);
    }
    Ok(())
}
