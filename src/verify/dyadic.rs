//! Tier `dyadic`: points i/2^k, where OpenSubdiv's adaptive patches are exact whatever their end caps.

use super::bin::{Bins, Difference, Key, Sample, Tolerance, angle_deg};
use super::{Subject, VerifyError};
use crate::osd::{Answer, Far, MAX_ISOLATION, Reference};
use crate::patch::PatchKind;

/// Position: 1e-11 leaves room for coordinates some thousand diagonals from the origin. Normals: OpenSubdiv subtracts
/// world coordinates in cells of 2^-10, so 1e-16 * 2^10 / (edge / diagonal) radians, some 1e-8 degrees and more.
const TOLERANCE: Tolerance = Tolerance { position: Some(1e-11), normal_deg: Some(1e-6), derivative: Some(1e-10) };

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
        let Some((patch, jet)) = subject.surface.evaluate_ptex(face, [u, v]) else { continue };
        let kind = subject.surface.kind(patch);
        // An end cap meets the limit at its corners, but for the normal at an extraordinary vertex (3.5.0: off by up to
        // 1e-2 degrees at isolation 10, converging to ours), and for darts altogether.
        let (_, local) = subject.surface.locate(face, [u, v]).expect("it was evaluated");
        let exact = reference.answer == Answer::Regular;
        let at_vertex = kind != PatchKind::Regular && local == [0.0, 0.0];
        let dart = kind == PatchKind::Dart && at_vertex && !exact;
        let known_wrong = dart.then_some("end cap at infinitely sharp darts");
        let difference = Difference {
            position: jet.position.distance(reference.position),
            normal_deg: if exact { angle_deg(jet.normal, reference.du.cross(reference.dv)) } else { None },
            derivative: (exact && kind == PatchKind::Regular)
                .then(|| jet.du.distance(reference.du).max(jet.dv.distance(reference.dv))),
        };
        let key = Key { tier: "dyadic", reference: "Far level 10", kind, known_wrong };
        bins.add(key, TOLERANCE, Sample { face, u, v }, difference);
    }
    Ok(())
}
