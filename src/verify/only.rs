//! One point of the surface as every evaluator sees it, and the control points that it depends on.

use super::difference::{Sample, angle_deg};
use super::failures::control_faces;
use super::flaw::Flaw;
use super::plant::Plant;
use super::references::{Asked, ReferenceError, References};
use super::rounding::Rounding;
use super::{Settings, Subject, VerifyError, judgeable, vertex};
use crate::gpu::{self, Gpu};
use crate::mesh::SubdivMesh;
use crate::osd::{Answer, Bfr, MAX_ISOLATION, ReferenceJet, Stencil};
use crate::patch::Patches;
use crate::stam::{Jet, LimitSurface};
use glam::DVec3;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeSet;

/// All evaluations of one point.
#[derive(Debug, Clone, Serialize)]
pub struct Only {
    /// Name of the mesh.
    pub mesh: String,
    /// The point.
    pub sample: Sample,
    /// Face of the control mesh, counted from 0.
    pub control_face: u32,
    /// Length that position and derivative errors are divided by: the diagonal of the control points, if there is one.
    pub unit: f64,
    /// The patch of ours that answers; absent in a hole.
    pub patch: Option<OnlyPatch>,
    /// What each evaluator answers: ours in f64 first.
    pub evaluations: Vec<Evaluation>,
    /// The control points that ours or the limit stencil weighs.
    pub control_points: Vec<Influence>,
    /// Distance / unit of our position from the sum of the control points by our weights; more than rounding means that our
    /// tables hold other points than the mesh. Absent in a hole.
    pub weights_miss: Option<f64>,
}

/// The patch that answers.
#[derive(Debug, Clone, Serialize)]
pub struct OnlyPatch {
    /// Index among all patches.
    pub index: usize,
    /// Patch kind.
    pub kind: &'static str,
    /// Parameters of the point in the patch.
    pub local: [f64; 2],
    /// Depth in u and in v: the patch spans 2^-depth of the ptex face.
    pub depth: [u8; 2],
}

/// One evaluator's answer.
#[derive(Debug, Clone, Serialize)]
pub struct Evaluation {
    /// Who answers.
    pub evaluator: &'static str,
    /// `exact`, `end cap` (approximate but at dyadic points), `hole`, `not asked`, why it is known to be wrong, or why there is none.
    pub answer: Cow<'static, str>,
    /// Position.
    pub position: Option<[f64; 3]>,
    /// Derivative by the u of the ptex face.
    pub du: Option<[f64; 3]>,
    /// Derivative by the v of the ptex face.
    pub dv: Option<[f64; 3]>,
    /// Unit normal.
    pub normal: Option<[f64; 3]>,
    /// Distance / unit from our position in f64.
    pub position_off: Option<f64>,
    /// The larger difference of the two derivatives / unit.
    pub derivative_off: Option<f64>,
    /// Angle between the normals, degrees.
    pub normal_off_deg: Option<f64>,
}

/// A control point and what it weighs in position, d/du and d/dv.
#[derive(Debug, Clone, Serialize)]
pub struct Influence {
    /// Index of the control point, counted from 0.
    pub vertex: u32,
    /// The point.
    pub point: [f64; 3],
    /// Weights of OpenSubdiv's limit stencil; 0 where it leaves the point out.
    pub stencil: [f64; 3],
    /// Our weights; absent where we have no surface.
    pub ours: Option<[f64; 3]>,
}

/// Evaluates one point by all means; the shader too if there is a GPU. Of the settings, what is planted and where OpenSubdiv
/// runs counts.
///
/// # Errors
/// As [`verify`](super::verify); the face is out of range.
pub fn only(mesh: &SubdivMesh, gpu: Option<&Gpu>, sample: Sample, settings: &Settings) -> Result<Only, VerifyError> {
    let plant = settings.plant;
    let surface = judgeable(mesh, plant)?;
    let count = surface.ptex_count();
    if sample.face as usize >= count {
        return Err(VerifyError::NoFace { face: sample.face, last: count - 1 });
    }
    let subject = Subject { swapped: plant == Some(Plant::Swap), ..Subject::new(mesh, &surface) };
    let ours = subject.evaluate(sample);
    let place = surface.locate(sample.face, [sample.u, sample.v]);
    let compare = Compare { unit: subject.rounding.unit, ours: ours.map(|(_, jet)| jet) };
    let references = References::new(mesh, &settings.process, plant.and_then(Plant::crash));
    let evaluations = evaluations(&subject, gpu, sample, place, &references, &compare)?;
    // Without a stencil its weights are 0; the evaluation says why there is none.
    let stencil = references.stencil((sample.face, sample.u, sample.v)).ok();
    let control_points = influences(&subject, sample, plant, stencil.as_ref())?;
    let sum = |points: &[Influence]| -> Option<DVec3> {
        points.iter().map(|p| Some(p.ours?[0] * DVec3::from_array(p.point))).sum()
    };
    let weights_miss =
        compare.ours.zip(sum(&control_points)).map(|(jet, sum)| jet.position.distance(sum) / compare.unit);
    Ok(Only {
        mesh: mesh.name.clone(),
        sample,
        control_face: control_faces(mesh)[sample.face as usize],
        unit: compare.unit,
        patch: place.map(|(index, local)| {
            let patch = &surface.patches()[index];
            OnlyPatch { index, kind: patch.kind.name(), local, depth: patch.depth }
        }),
        evaluations,
        control_points,
        weights_miss,
    })
}

/// What answers are compared with.
struct Compare {
    unit: f64,
    ours: Option<Jet>,
}

impl Compare {
    fn evaluation(
        &self,
        evaluator: &'static str,
        answer: impl Into<Cow<'static, str>>,
        jet: Option<Jet>,
    ) -> Evaluation {
        let pair = jet.zip(self.ours);
        let finite = |d: DVec3| d.is_finite().then(|| d.to_array());
        Evaluation {
            evaluator,
            answer: answer.into(),
            position: jet.map(|jet| jet.position.to_array()),
            du: jet.and_then(|jet| finite(jet.du)),
            dv: jet.and_then(|jet| finite(jet.dv)),
            normal: jet.and_then(|jet| finite(jet.normal)),
            position_off: pair.map(|(a, b)| a.position.distance(b.position) / self.unit),
            derivative_off: pair
                .map(|(a, b)| a.du.distance(b.du).max(a.dv.distance(b.dv)) / self.unit)
                .filter(|off| off.is_finite()),
            normal_off_deg: pair.filter(|(a, _)| a.normal.is_finite()).map(|(a, b)| angle_deg(a.normal, b.normal)),
        }
    }

    fn reference(&self, evaluator: &'static str, answers: Result<Vec<ReferenceJet>, ReferenceError>) -> Evaluation {
        let answer = match answers {
            Ok(answers) => answers[0],
            Err(error) => return self.evaluation(evaluator, error.to_string(), None),
        };
        let ReferenceJet { position, du, dv, .. } = answer;
        let jet = Jet { position, du, dv, normal: du.cross(dv).normalize_or_zero() };
        match answer.answer {
            Answer::Regular => self.evaluation(evaluator, "exact", Some(jet)),
            Answer::EndCap => self.evaluation(evaluator, "end cap", Some(jet)),
            Answer::NotAsked => self.evaluation(evaluator, "not asked: it reads out of bounds here", None),
            Answer::None => self.evaluation(evaluator, "hole", None),
        }
    }
}

fn evaluations(
    subject: &Subject<'_>,
    gpu: Option<&Gpu>,
    at: Sample,
    place: Option<(usize, [f64; 2])>,
    references: &References<'_>,
    compare: &Compare,
) -> Result<Vec<Evaluation>, VerifyError> {
    let (mesh, samples) = (subject.mesh, [(at.face, at.u, at.v)]);
    let answer = if compare.ours.is_some() { "exact" } else { "hole" };
    let mut all = vec![compare.evaluation("ours, f64", answer, compare.ours)];
    all.extend([
        compare.reference("limit stencils level 10", references.stencils(&Asked::all(&samples))),
        compare.reference("Far level 10", references.far(&samples)),
        compare.reference("Bfr 10/10", references.bfr((MAX_ISOLATION, MAX_ISOLATION), &samples)),
        compare.reference("Bfr 2/6", references.bfr(Bfr::DEFAULT_LEVELS, &samples)),
    ]);
    match vertex::mask(mesh, references, at) {
        Ok(Some(mask)) => {
            let [first, second] = mask.tangents;
            let none = DVec3::splat(f64::NAN); // its tangents have directions of their own, and no length
            let normal = first.cross(second).normalize_or_zero();
            let jet = Jet { position: mask.position, du: none, dv: none, normal };
            all.push(compare.evaluation("limit mask", mask.known_wrong.map_or("exact", Flaw::reason), Some(jet)));
        }
        Ok(None) => {}
        Err(error) => all.push(compare.evaluation("limit mask", error.to_string(), None)),
    }
    if let Some((gpu, (patch, local))) = gpu.zip(place) {
        let tables = gpu.upload(subject.surface)?;
        let sample = gpu::Sample { patch: patch as u32, uv: local.map(|x| x as f32) };
        let jet = subject.surface.patches()[patch].jet_to_ptex(gpu.evaluate(&tables, &[sample])?[0]);
        all.push(compare.evaluation("ours, shader (f32)", "exact", Some(jet)));
    }
    Ok(all)
}

/// The control points round the face, with the weights that are not 0.
fn influences(
    subject: &Subject<'_>,
    at: Sample,
    plant: Option<Plant>,
    stencil: Option<&Stencil>,
) -> Result<Vec<Influence>, VerifyError> {
    let mesh = subject.mesh;
    let vertices: Vec<u32> = around(mesh, control_faces(mesh)[at.face as usize])
        .into_iter()
        .chain(stencil.into_iter().flat_map(|stencil| stencil.vertices.iter().copied()))
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    let ours = our_weights(subject, at, plant, &vertices)?;
    let of_stencil = |vertex: u32| {
        let weights = |stencil: &Stencil| {
            let index = stencil.vertices.iter().position(|&v| v == vertex);
            index.map(|index| stencil.weights[index])
        };
        stencil.and_then(weights).unwrap_or_default()
    };
    let influence = |(i, &vertex): (usize, &u32)| Influence {
        vertex,
        point: mesh.points[vertex as usize].to_array(),
        stencil: of_stencil(vertex),
        ours: ours.as_ref().map(|ours| ours[i]),
    };
    let weighs = |p: &Influence| p.stencil != [0.0; 3] || p.ours.is_some_and(|ours| ours != [0.0; 3]);
    Ok(vertices.iter().enumerate().map(influence).filter(weighs).collect())
}

/// The vertices of all faces that share a vertex with a face: all that its limit depends on.
fn around(mesh: &SubdivMesh, face: u32) -> BTreeSet<u32> {
    let own: BTreeSet<u32> = mesh.faces().nth(face as usize).into_iter().flat_map(|(_, f)| f.to_vec()).collect();
    let touching = mesh.faces().filter(|(_, face)| face.iter().any(|vertex| own.contains(vertex)));
    touching.flat_map(|(_, face)| face.to_vec()).collect()
}

/// What each of some control points weighs in our position, d/du and d/dv, which are linear in them: three at a time are
/// set to the unit vectors, all others to 0.
fn our_weights(
    subject: &Subject<'_>,
    at: Sample,
    plant: Option<Plant>,
    vertices: &[u32],
) -> Result<Option<Vec<[f64; 3]>>, VerifyError> {
    let mesh = plant.map_or_else(|| Ok(subject.mesh.clone()), |plant| plant.mesh(subject.mesh))?;
    let (_, mut refinement) = Patches::new(&mesh)?;
    let base = LimitSurface::flat(&mesh, &|_, _| ())?;
    let mut weights = Vec::new();
    for three in vertices.chunks(3) {
        let mut points = vec![DVec3::ZERO; mesh.points.len()];
        for (&vertex, unit) in three.iter().zip(DVec3::AXES) {
            points[vertex as usize] = unit;
        }
        let surface = base.with_refined(refinement.interpolate(&points)?);
        let surface = plant.map_or(Ok(surface.clone()), |plant| plant.linear(surface))?;
        let unit = Subject { surface: &surface, rounding: Rounding::of(&mesh), ..*subject };
        let Some((_, jet)) = unit.evaluate(at) else { return Ok(None) };
        weights.extend((0..three.len()).map(|k| [jet.position[k], jet.du[k], jet.dv[k]]));
    }
    Ok(Some(weights))
}
