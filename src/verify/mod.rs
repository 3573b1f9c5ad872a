//! Regression against OpenSubdiv: the exact limit, on CPU and GPU, compared with evaluators that we did not write, tier
//! by tier.
//!
//! Every tier bins its samples by patch kind and names the worst one. Where the reference itself is known to be wrong,
//! the samples are kept apart with the reason ([`KnownWrong`]) and held to what any wrong reference can be off.

mod baseline;
mod bin;
mod clock;
pub mod conformance;
mod difference;
mod dyadic;
mod endcap;
mod expense;
mod failures;
mod flaw;
mod fragment;
mod histogram;
mod junit;
mod key;
mod only;
mod only_text;
mod plant;
mod references;
mod regular;
mod report;
mod rounding;
mod text;
mod vertex;

pub use baseline::{Baseline, BaselineError, Comparison, Regression};
pub use clock::Timing;
pub use difference::Sample;
pub use failures::{FailedPatch, Failures};
pub use histogram::Histogram;
pub use only::{Evaluation, Influence, Only, OnlyPatch, only};
pub use plant::{Crash, Plant};
pub use references::{Process, ReferenceError, serve};
pub use report::{Histograms, KnownWrong, MeshReport, Refused, Report, Tier, Unanswered};

use crate::gpu::{Gpu, GpuError};
use crate::mesh::SubdivMesh;
use crate::osd::{Location, ReferenceJet};
use crate::patch::{PatchError, PatchKind};
use crate::stam::{Jet, LimitSurface};
use bin::Bins;
use clock::Clock;
use difference::{Check, Difference, Normal, Place, larger};
use rayon::prelude::*;
use references::References;
use rounding::{LEAST_EXTENT, Rounding};

/// Why a mesh was not verified.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// The mesh has no limit surface to verify.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// There is nothing to check, which is not a pass.
    #[error("no face has a limit surface (holes, or boundary rule none); nothing to check")]
    NoSurface,
    /// Errors of such a mesh would underflow to 0, which is not a pass either.
    #[error("it spans {extent:e} units, too few to tell errors from underflow; scale it to {LEAST_EXTENT:e} or more")]
    TooSmall {
        /// Largest side of the bounding box.
        extent: f64,
    },
    /// OpenSubdiv reports an error where it runs in this process.
    #[error(transparent)]
    Osd(#[from] crate::osd::Error),
    /// A sample that is asked for lies nowhere.
    #[error("ptex face {face}, but the mesh has only 0 to {last}; a quad is one ptex face, an n-gon n of them")]
    NoFace {
        /// The ptex face.
        face: u32,
        /// The last there is.
        last: usize,
    },
    /// The mesh has not what an error was to be planted in.
    #[error("{what} {index} cannot be planted: the mesh has {count}")]
    Plant {
        /// What it lacks.
        what: &'static str,
        /// Which was asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// The fragment tier needs an adapter.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Degrees by which rounding may turn a reference's normal before it is skipped instead of judged: the accuracy that the
/// fragments are held to. Beyond it the sample says nothing that a picture could show.
const NORMAL_LIMIT: f64 = 1e-3;

/// Everything a tier may look at.
#[derive(Clone, Copy)]
struct Subject<'a> {
    mesh: &'a SubdivMesh,
    surface: &'a LimitSurface,
    rounding: Rounding,
    /// Every jet of ours passes through it before it is judged, those of the GPU too. The identity, but for the test
    /// that plants errors.
    ours: &'a (dyn Fn(Jet) -> Jet + Sync),
    /// [`Plant::Swap`].
    swapped: bool,
}

impl<'a> Subject<'a> {
    fn new(mesh: &'a SubdivMesh, surface: &'a LimitSurface) -> Self {
        Self { mesh, surface, rounding: Rounding::of(mesh), ours: &|jet| jet, swapped: false }
    }

    /// Parameters at which we evaluate.
    fn parameters(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        if self.swapped { [v, u] } else { [u, v] }
    }

    /// Ptex faces to sample: all of them, or evenly spread ones so that `per_face` samples each stay below `budget`.
    fn faces(&self, per_face: usize, budget: usize) -> impl Iterator<Item = u32> + use<> {
        let count = self.surface.ptex_count();
        let stride = (count * per_face).div_ceil(budget).max(1);
        (0..count as u32).step_by(stride)
    }

    /// Our patch and jet, derivatives by the ptex parameters; `None` in a hole.
    fn evaluate(&self, at: Sample) -> Option<(usize, Jet)> {
        let (patch, jet) = self.surface.evaluate_ptex(at.face, self.parameters([at.u, at.v]))?;
        // An error is to be found where it shows.
        let patch = if self.swapped { self.surface.locate(at.face, [at.u, at.v])?.0 } else { patch };
        Some((patch, (self.ours)(jet)))
    }

    /// The same for many samples, on all threads.
    fn evaluate_all(&self, samples: &[Location]) -> Vec<Option<(usize, Jet)>> {
        samples.par_iter().map(|&(face, u, v)| self.evaluate(Sample { face, u, v })).collect()
    }

    /// The f64 jet that a shader's is compared with, at parameters of the patch.
    fn evaluate_patch(&self, patch: usize, uv: [f32; 2]) -> Jet {
        self.surface.evaluate(patch, self.parameters(uv.map(f64::from)))
    }

    fn kind(&self, patch: usize) -> Option<PatchKind> {
        Some(self.surface.kind(patch))
    }

    fn place(&self, sample: Sample, patch: Option<usize>) -> Place {
        Place { sample, patch: patch.map(|patch| patch as u32) }
    }

    /// Compares our jet with a reference's. The tolerances of position, normal and derivative are what is allowed near
    /// the origin; rounding comes on top, as seen in the smaller of the two patches that answered.
    fn difference(&self, patch: usize, ours: &Jet, theirs: &ReferenceJet, tolerances: [f64; 3]) -> Difference {
        let [position, normal, derivative] = tolerances;
        let rounding = self.rounding.summing(theirs.terms);
        let [u, v] = self.surface.patches()[patch].scale();
        let derivative_error = rounding.derivative(theirs.cell.min(1.0 / u.max(v)));
        let turn = rounding::turn_deg(theirs.du, theirs.dv, derivative_error);
        let derivatives = [ours.du.distance(theirs.du), ours.dv.distance(theirs.dv)];
        Difference {
            position: Check {
                error: ours.position.distance(theirs.position) / rounding.unit,
                allowed: position + rounding.position(),
            },
            normal: Normal::judge(ours.normal, theirs.du.cross(theirs.dv), turn, NORMAL_LIMIT, normal + turn),
            derivative: Some(Check {
                error: larger(derivatives[0], derivatives[1]) / rounding.unit,
                allowed: derivative + derivative_error / rounding.unit,
            }),
        }
    }
}

/// How a mesh is verified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settings {
    /// Width and height of the view that the fragment tier checks, in pixels.
    pub size: [u32; 2],
    /// An error to be planted, which must be caught: a test of the checks.
    pub plant: Option<Plant>,
    /// Where OpenSubdiv's evaluators run.
    pub process: Process,
}

impl Default for Settings {
    fn default() -> Self {
        Self { size: [512, 512], plant: None, process: Process::Own }
    }
}

/// Runs all tiers on a mesh.
///
/// A reference evaluator that reports an error, or whose process ends, is a row of the report ([`Unanswered`]), which fails; the others
/// are asked all the same.
///
/// # Errors
/// The mesh is refused, has no surface or is too small to judge, or has not what an error is to be planted in; the GPU fails.
pub fn verify(mesh: &SubdivMesh, gpu: &Gpu, settings: &Settings) -> Result<MeshReport, VerifyError> {
    let Settings { size, plant, process } = settings;
    let surface = judgeable(mesh, *plant)?;
    let subject = Subject { swapped: *plant == Some(Plant::Swap), ..Subject::new(mesh, &surface) };
    let references = References::new(mesh, process, plant.and_then(Plant::crash));
    let mut clock = Clock::default();
    let bins = tiers(&subject, &references, gpu, *size, &mut clock)?;
    Ok(MeshReport::new(mesh, &surface, bins, clock.steps))
}

/// Our surface of a mesh, if there is something to judge.
fn judgeable(mesh: &SubdivMesh, plant: Option<Plant>) -> Result<LimitSurface, VerifyError> {
    let surface = plant.map_or_else(|| Ok(LimitSurface::new(mesh)?), |plant| plant.surface(mesh))?;
    if surface.patches().is_empty() {
        return Err(VerifyError::NoSurface);
    }
    let (low, high) = mesh.bounds().unwrap_or_default();
    let extent = (high - low).max_element();
    if extent > 0.0 && extent < LEAST_EXTENT {
        return Err(VerifyError::TooSmall { extent });
    }
    Ok(surface)
}

fn tiers(
    subject: &Subject<'_>,
    references: &References<'_>,
    gpu: &Gpu,
    size: [u32; 2],
    clock: &mut Clock,
) -> Result<Bins, VerifyError> {
    let mut bins = Bins::default();
    clock.time("vertex", || vertex::run(subject, references, &mut bins));
    clock.time("dyadic", || dyadic::run(subject, references, &mut bins));
    clock.time("regular", || regular::run(subject, references, &mut bins));
    fragment::run(subject, references, gpu, size, clock, &mut bins)?;
    clock.time("endcap", || endcap::run(subject, references, &mut bins));
    Ok(bins)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;
    use glam::DVec3;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// All tiers, with OpenSubdiv in this process.
    fn own_tiers(subject: &Subject<'_>, gpu: &Gpu, size: [u32; 2]) -> Bins {
        let references = References::new(subject.mesh, &Process::Own, None);
        tiers(subject, &references, gpu, size, &mut Clock::default()).expect("it runs")
    }

    /// The tiers that fail when our jets are changed.
    fn failing(mesh: &SubdivMesh, gpu: &Gpu, ours: &(dyn Fn(Jet) -> Jet + Sync)) -> Vec<&'static str> {
        let surface = LimitSurface::new(mesh).expect("the mesh is valid");
        let subject = Subject { ours, ..Subject::new(mesh, &surface) };
        let report = MeshReport::new(mesh, &surface, own_tiers(&subject, gpu, [64, 64]), Vec::new());
        let mut tiers: Vec<_> = report.tiers.iter().filter(|row| !row.pass).map(|row| row.tier).collect();
        tiers.dedup();
        assert_eq!(report.pass, tiers.is_empty() && report.reference_known_wrong.iter().all(|known| known.row.pass));
        tiers
    }

    /// Every check can fail: an error of 1e-7 of the diagonal turns up in every tier that judges f64, larger ones in the
    /// fragments, and so does a normal that is wrong, zero or not a number.
    #[test]
    fn planted_errors_are_caught_by_every_tier() {
        let mesh = mesh::sample();
        let gpu = Gpu::new().expect("the fragment tier needs an adapter");
        let unit = mesh.diagonal();
        let every = ["vertex", "dyadic", "regular", "fragment"];
        assert_eq!(failing(&mesh, &gpu, &|jet| jet), [""; 0]);
        let moved = |by: f64| move |jet: Jet| Jet { position: jet.position + DVec3::splat(by * unit), ..jet };
        assert_eq!(failing(&mesh, &gpu, &moved(1e-7)), every[..3]);
        assert_eq!(failing(&mesh, &gpu, &moved(1e-4)), every);
        assert_eq!(failing(&mesh, &gpu, &moved(f64::NAN)), every);
        let turned = |jet: Jet| Jet { normal: jet.normal + 1e-4 * jet.normal.any_orthonormal_vector(), ..jet };
        assert_eq!(failing(&mesh, &gpu, &turned), every);
        for normal in [DVec3::ZERO, DVec3::NAN] {
            assert_eq!(failing(&mesh, &gpu, &|jet| Jet { normal, ..jet }), every);
            // One in a hundred is enough.
            let count = AtomicUsize::new(0);
            let rare = |jet: Jet| match count.fetch_add(1, Ordering::Relaxed) % 100 {
                0 => Jet { normal, ..jet },
                _ => jet,
            };
            assert_eq!(failing(&mesh, &gpu, &rare), every);
        }
    }

    /// A face that one side calls a hole and the other does not fails, either way round.
    #[test]
    fn disagreement_about_holes_fails() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/cube.obj");
        let whole = mesh::read(&path).expect("a test mesh");
        let holed = SubdivMesh { holes: vec![2], ..whole.clone() };
        let gpu = Gpu::new().expect("the fragment tier needs an adapter");
        for (theirs, ours) in [(&whole, &holed), (&holed, &whole)] {
            let surface = LimitSurface::new(ours).expect("the mesh is valid");
            let subject = Subject::new(theirs, &surface);
            let report = MeshReport::new(theirs, &surface, own_tiers(&subject, &gpu, [16, 16]), Vec::new());
            let failed = |tier| report.tiers.iter().filter(|row| row.tier == tier).map(|row| row.failed).sum::<usize>();
            assert!(failed("dyadic") >= 25, "{report}");
            assert!(!report.pass);
        }
    }

    /// Where the reference is known to be wrong, ours is not free: a gross error fails there too.
    #[test]
    fn gross_errors_fail_where_the_reference_is_wrong() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/dart.obj");
        let mesh = mesh::read(&path).expect("a test mesh");
        let gpu = Gpu::new().expect("the fragment tier needs an adapter");
        let surface = LimitSurface::new(&mesh).expect("the mesh is valid");
        let by = DVec3::splat(mesh.diagonal());
        let ours = |jet: Jet| Jet { position: jet.position + by, ..jet };
        let subject = Subject { ours: &ours, ..Subject::new(&mesh, &surface) };
        let report = MeshReport::new(&mesh, &surface, own_tiers(&subject, &gpu, [16, 16]), Vec::new());
        assert!(!report.reference_known_wrong.is_empty());
        assert!(report.reference_known_wrong.iter().all(|known| !known.row.pass));
    }
}
