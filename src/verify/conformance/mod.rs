//! Conformance: any program's answers at (ptex face, u, v), compared with the exact limit and with OpenSubdiv.
//!
//! [`sample_set`] says where to ask, [`conformance`] judges the answers: position, first derivatives and normal, by patch kind,
//! and names the [usual mistakes](Finding) where one of them explains what fails, or the [program](Finding) whose answers they are.

mod diagnosis;
mod excerpt;
mod likeness;
mod program;
mod report;
mod samples;
mod search;

pub use diagnosis::{Finding, Nearest};
pub use report::{Quantity, Results};
pub use samples::{DEFAULT_PER_FACE, sample_set};

use super::bin::{Bins, CAP};
use super::difference::{Check, Difference, Normal, larger};
use super::key::{Against, Key, TierName};
use super::{MeshReport, Sample, Subject, VerifyError, judgeable, rounding};
use crate::mesh::SubdivMesh;
use crate::osd::{Answer as FarAnswer, Far, MAX_ISOLATION};
use crate::stam::{Jet, Window};
use glam::DVec3;
use rayon::prelude::*;
use report::Collected;
use serde::Serialize;

/// What a program says about one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// The point.
    pub at: Sample,
    /// Position; `None` says that there is no surface.
    pub position: Option<DVec3>,
    /// Derivatives by the u and v of the ptex face; `None` where the program does not claim any, not finite where it has none
    /// for this point.
    pub derivatives: Option<[DVec3; 2]>,
    /// Normal, of any length; `None` and not finite as above.
    pub normal: Option<DVec3>,
}

/// What the answers may be off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tolerances {
    /// Distance, in parts of the bounding box's diagonal.
    pub position: f64,
    /// Angle in degrees where the derivatives are perpendicular and equally long. Elsewhere as much more as the same errors of the
    /// derivatives turn the normal.
    pub normal_deg: f64,
    /// Length of a derivative's error, in parts of the longer of the two derivatives.
    pub derivative: f64,
}

impl Default for Tolerances {
    /// The budget of the fragment tier: what 32-bit floats can do that count from an origin near the patch, and what reflection lines
    /// ask for.
    fn default() -> Self {
        use super::fragment::{DERIVATIVE, NORMAL_DEG, POSITION};
        Self { position: POSITION, normal_deg: NORMAL_DEG, derivative: DERIVATIVE }
    }
}

/// How answers are judged.
#[derive(Debug, Clone, Copy)]
pub struct Terms {
    /// What they may be off.
    pub tolerances: Tolerances,
    /// Points of each face that must be answered.
    pub per_face: usize,
    /// Any part of them will do.
    pub partial: bool,
}

impl Default for Terms {
    fn default() -> Self {
        Self { tolerances: Tolerances::default(), per_face: DEFAULT_PER_FACE, partial: false }
    }
}

/// Judges a program's answers. The report has the rows of tier `results`, and says more in [`MeshReport::results`].
///
/// It passes if every answer is within its tolerance, no answer is given in a hole, none is refused elsewhere, and all of the
/// [`sample_set`] was answered, unless the terms ask for a part alone.
///
/// # Errors
/// The mesh is refused, has no surface or is too small to judge; OpenSubdiv fails.
///
/// # Panics
/// An answer names a ptex face that the mesh does not have.
pub fn conformance(mesh: &SubdivMesh, answers: &[Answer], terms: &Terms) -> Result<MeshReport, VerifyError> {
    let surface = judgeable(mesh, None)?;
    let subject = Subject::new(mesh, &surface);
    let exact: Vec<Option<(usize, Jet)>> =
        answers.par_iter().map(|a| surface.evaluate_ptex(a.at.face, [a.at.u, a.at.v])).collect();
    let places: Vec<_> = answers.iter().map(|a| (a.at.face, a.at.u, a.at.v)).collect();
    let far = Far::new(mesh, MAX_ISOLATION)?.evaluate(&places)?;

    let judge = Judge { subject: &subject, tolerances: terms.tolerances };
    let (mut bins, mut collected) = (Bins::default(), Collected::default());
    let mut failing = Vec::new();
    for ((answer, exact), far) in answers.iter().zip(&exact).zip(&far) {
        let kind = exact.map(|(patch, _)| surface.kind(patch));
        let key = |against| Key::new(TierName::Results, against, kind);
        let place = subject.place(answer.at, exact.map(|(patch, _)| patch));
        let (Some((patch, jet)), Some(_)) = (exact, answer.position) else {
            if exact.is_some() != answer.position.is_some() {
                bins.mismatch(key(Against::Limit), place);
                collected.mismatch(key(Against::Limit));
                failing.extend(answer.position.map(|_| (*answer, None)));
            }
            continue;
        };
        let mut compare = |against, jet: &Jet, cell: f64| {
            let difference = judge.difference(answer, *patch, jet, cell);
            bins.add(key(against), place, difference);
            collected.add(key(against), answer.at, &difference);
            difference
        };
        let difference = compare(Against::Limit, jet, 1.0);
        failing.push((*answer, Some((*jet, difference))));
        if far.answer == FarAnswer::Regular {
            let normal = far.du.cross(far.dv);
            compare(Against::Far, &Jet { position: far.position, du: far.du, dv: far.dv, normal }, far.cell);
        }
    }
    let diagnosis = diagnosis::find(&judge, terms.per_face, &failing);
    let results = collected.finish(&surface, answers, terms, diagnosis);
    let mut report = MeshReport::new(mesh, &surface, bins, Vec::new());
    report.timings = None;
    report.pass &= results.complete && results.answered > 0;
    report.results = Some(results);
    Ok(report)
}

/// Compares single answers.
struct Judge<'a> {
    subject: &'a Subject<'a>,
    tolerances: Tolerances,
}

impl Judge<'_> {
    /// Compares an answer with a reference that was differentiated in cells of the side `cell`.
    fn difference(&self, answer: &Answer, index: usize, reference: &Jet, cell: f64) -> Difference {
        let Tolerances { position, normal_deg, derivative } = self.tolerances;
        let rounding = &self.subject.rounding;
        let surface = self.subject.surface;
        let patch = &surface.patches()[index];
        let [u, v] = patch.scale();
        let rounded = rounding.derivative(cell.min(1.0 / u.max(v)));
        let longest = reference.du.length().max(reference.dv.length());
        // Local (0,0) of an irregular patch: derivatives have no finite limit there, and normals need a tangent plane.
        let at_vertex = Window::at(patch.to_local([answer.at.u, answer.at.v])).at_vertex;
        let class = surface.class(index).filter(|_| at_vertex);
        let vertex = class.map(|class| surface.classes()[class]);
        let normal = |ours: DVec3| {
            if vertex.is_some_and(|class| !class.has_tangent_plane()) {
                return Normal::Skipped;
            }
            // Half of the angle for each derivative where they are perpendicular and equally long.
            let error = normal_deg.to_radians() / 2.0 * longest + rounded;
            let allowed = rounding::turn_deg(reference.du, reference.dv, error);
            Normal::judge(ours, reference.normal, allowed, CAP * normal_deg, allowed)
        };
        let derivatives = answer.derivatives.filter(|_| vertex.is_none());
        Difference {
            position: Check {
                error: answer.position.map_or(f64::NAN, |p| p.distance(reference.position)) / rounding.unit,
                allowed: position + rounding.position(),
            },
            normal: answer.normal.map_or(Normal::Unknown, normal),
            derivative: derivatives.map(|[du, dv]| Check {
                error: larger(du.distance(reference.du), dv.distance(reference.dv)) / rounding.unit,
                allowed: (derivative * longest + rounded) / rounding.unit,
            }),
        }
    }
}
