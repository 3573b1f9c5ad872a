//! Regression against OpenSubdiv: the exact limit, on CPU and GPU, compared with evaluators that we did not write, tier
//! by tier (design.md section 6).
//!
//! Every tier bins its samples by patch kind and names the worst one. Where the reference itself is known to be wrong,
//! the samples are kept apart with the reason ([`KnownWrong`]): they are neither a pass nor a failure.

mod bin;
mod dyadic;
mod endcap;
mod fragment;
mod regular;
mod report;
mod vertex;

pub use bin::Sample;
pub use report::{KnownWrong, MeshReport, Report, Tier};

use crate::gpu::{Gpu, GpuError};
use crate::mesh::SubdivMesh;
use crate::patch::PatchError;
use crate::stam::LimitSurface;
use bin::Bins;

/// Why a mesh was not verified.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// The mesh has no limit surface to verify.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// A reference evaluator failed.
    #[error(transparent)]
    Osd(#[from] crate::osd::Error),
    /// The fragment tier needs an adapter.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Everything a tier may look at.
struct Subject<'a> {
    mesh: &'a SubdivMesh,
    surface: &'a LimitSurface,
}

impl Subject<'_> {
    /// Ptex faces to sample: all of them, or evenly spread ones so that `per_face` samples each stay below `budget`.
    fn faces(&self, per_face: usize, budget: usize) -> impl Iterator<Item = u32> + use<> {
        let count = self.surface.ptex_count();
        let stride = (count * per_face).div_ceil(budget).max(1);
        (0..count as u32).step_by(stride)
    }
}

/// Runs all tiers on a mesh; the fragment tier renders at `size`.
///
/// # Errors
/// The mesh is refused, a reference evaluator fails, or the GPU does.
pub fn verify(mesh: &SubdivMesh, gpu: &Gpu, size: [u32; 2]) -> Result<MeshReport, VerifyError> {
    let surface = LimitSurface::new(mesh)?;
    let subject = Subject { mesh, surface: &surface };
    let mut bins = Bins::new(surface.diagonal());
    vertex::run(&subject, &mut bins)?;
    let mut far = dyadic::reference(&subject)?;
    dyadic::run(&subject, &mut far, &mut bins)?;
    regular::run(&subject, &mut far, &mut bins)?;
    fragment::run(&subject, &mut far, gpu, size, &mut bins)?;
    endcap::run(&subject, &mut bins)?;
    Ok(MeshReport::new(mesh, &surface, bins))
}
