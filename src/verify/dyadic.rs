//! Tier `dyadic`: points i/2^k, where OpenSubdiv's adaptive patches are exact whatever their end caps.

use super::Subject;
use super::bin::Bins;
use super::difference::{Check, Normal, Sample};
use super::flaw::Flaw;
use super::key::{Against, Key, TierName};
use super::references::References;
use crate::osd::{Answer, Location, MAX_ISOLATION, ReferenceJet};
use crate::patch::PatchKind;
use crate::stam::Jet;
use std::collections::{HashMap, HashSet};

/// Ten levels of refinement, each summed anew on both sides: ten times tier `vertex`. Rounding of world coordinates comes
/// on top ([`Rounding`](super::rounding::Rounding)).
pub(super) const POSITION: f64 = 1e-11;
pub(super) const NORMAL_DEG: f64 = 1e-6;
pub(super) const DERIVATIVE: f64 = 1e-10;

/// What a position may be off where the end cap is known to be wrong. Not derived: it tells gross errors of ours from
/// OpenSubdiv's, of which the largest found is 2.2e-5.
const KNOWN_WRONG: f64 = 1e-2;

const BUDGET: usize = 400_000;

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

/// The same on a triangle.
fn triangle_parameters(depth: u32) -> Vec<[f64; 2]> {
    let quarters = (0..25).map(|i| [f64::from(i % 5) / 4.0, f64::from(i / 5) / 4.0]);
    let mut out: Vec<_> = quarters.filter(|[u, v]| u + v <= 1.0).collect();
    for k in 3..=depth as i32 {
        let near = 2f64.powi(-k);
        for [u, v] in [[near, 0.0], [0.0, near], [near, near]] {
            let w = 1.0 - u - v;
            out.extend([[u, v], [w, u], [v, w]]);
        }
    }
    out
}

pub(super) fn run(subject: &Subject<'_>, references: &References<'_>, bins: &mut Bins) {
    // The quadrants of an n-gon are quads of level 1 already: isolation 10 splits them 9 times.
    let [quad, quadrant] = [parameters(MAX_ISOLATION), parameters(MAX_ISOLATION - 1)];
    let triangle = triangle_parameters(MAX_ISOLATION);
    let grids_of = |&size: &u32| match (subject.surface.has_triangles(), size) {
        (true, _) => vec![&triangle],
        (false, 4) => vec![&quad],
        (false, size) => vec![&quadrant; size as usize],
    };
    let grids: Vec<_> = subject.mesh.face_sizes.iter().flat_map(grids_of).collect();
    let not_manifold = not_manifold(subject);
    let faces = subject.faces(quad.len(), BUDGET);
    let samples: Vec<Location> =
        faces.flat_map(|face| grids[face as usize].iter().map(move |&[u, v]| (face, u, v))).collect();
    let is_known_wrong = |sample: &Location| not_manifold.contains(&(sample.0, [sample.1, sample.2].map(f64::to_bits)));
    if let Some(answers) = bins.answered(TierName::Dyadic, Against::Far, references.far(&samples)) {
        compare(subject, Against::Far, &samples, &subject.evaluate_all(&samples), &answers, is_known_wrong, bins);
    }
    let asked = references.for_stencils(&samples);
    bins.too_slow += asked.left_out;
    if let Some(answers) = bins.answered(TierName::Dyadic, Against::LimitStencils, references.stencils(&asked)) {
        let samples = &asked.samples;
        compare(
            subject,
            Against::LimitStencils,
            samples,
            &subject.evaluate_all(samples),
            &answers,
            is_known_wrong,
            bins,
        );
    }
}

/// Ptex faces and parameters, as bits, of the control vertices at an edge of more than two faces. OpenSubdiv keeps them where they are,
/// as corners, and its limit masks say so; but its patches there can be those along a crease, a sixth of an edge of the last level off.
fn not_manifold(subject: &Subject<'_>) -> HashSet<(u32, [u64; 2])> {
    let mut faces_at: HashMap<[u32; 2], u32> = HashMap::new();
    let edges = |face: &[u32]| (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]).collect::<Vec<_>>();
    for [a, b] in subject.mesh.faces().flat_map(|(_, face)| edges(face)) {
        *faces_at.entry([a.min(b), a.max(b)]).or_default() += 1;
    }
    let many = faces_at.into_iter().filter(|&(_, faces)| faces > 2).flat_map(|(edge, _)| edge);
    let vertices: HashSet<u32> = many.collect();
    let mut out = HashSet::new();
    if vertices.is_empty() {
        return out;
    }
    let mut ptex = 0;
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|uv| uv.map(f64::to_bits));
    for (_, face) in subject.mesh.faces() {
        let triangles = subject.surface.has_triangles();
        for (k, _) in face.iter().enumerate().filter(|(_, vertex)| vertices.contains(vertex)) {
            out.insert(match (triangles, face.len()) {
                (true, _) => (ptex, corners[[0, 1, 3][k]]),
                (false, 4) => (ptex, corners[k]),
                (false, _) => (ptex + k as u32, corners[0]),
            });
        }
        ptex += if triangles || face.len() == 4 { 1 } else { face.len() as u32 };
    }
    out
}

fn compare(
    subject: &Subject<'_>,
    against: Against,
    samples: &[Location],
    ours: &[Option<(usize, Jet)>],
    answers: &[ReferenceJet],
    is_known_wrong: impl Fn(&Location) -> bool + Sync,
    bins: &mut Bins,
) {
    bins.fill(samples.len(), |bins, i| {
        let ((face, u, v), reference) = (samples[i], &answers[i]);
        let patch = ours[i].map(|(patch, _)| patch);
        let kind = patch.and_then(|patch| subject.kind(patch));
        let mut key = Key::new(TierName::Dyadic, against, kind);
        let place = subject.place(Sample { face, u, v }, patch);
        let (patch, jet) = match ours[i] {
            Some(ours) if reference.answer != Answer::None => ours,
            None if reference.answer == Answer::None => return,
            // One side sees a hole.
            _ => return bins.mismatch(key, place),
        };
        // An end cap meets the limit at its corners, but for the normal at an extraordinary vertex (3.5.0: off by up to
        // 1e-2 degrees at isolation 10, converging to ours), and for darts altogether.
        let exact = reference.answer == Answer::Regular;
        let mut difference = subject.difference(patch, &jet, reference, [POSITION, NORMAL_DEG, DERIVATIVE]);
        if kind == Some(PatchKind::Dart) && !exact && Flaw::DartEndCap.in_use().is_some() {
            key.known_wrong = Some(Flaw::DartEndCap);
            difference.position = Check { allowed: KNOWN_WRONG, ..difference.position };
        }
        if is_known_wrong(&samples[i]) && Flaw::PatchNotManifold.in_use().is_some() {
            key.known_wrong = Some(Flaw::PatchNotManifold);
            difference.position = Check { allowed: KNOWN_WRONG, ..difference.position };
            difference.normal = Normal::Unknown;
            difference.derivative = None;
        }
        if !exact {
            difference.normal = Normal::Unknown;
        }
        difference.derivative = difference.derivative.filter(|_| exact && kind == Some(PatchKind::Regular));
        bins.add(key, place, difference);
    });
}
