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
    let bins = tiers(&Subject { mesh, surface: &surface }, gpu, size)?;
    Ok(MeshReport::new(mesh, &surface, bins))
}

fn tiers(subject: &Subject<'_>, gpu: &Gpu, size: [u32; 2]) -> Result<Bins, VerifyError> {
    let mut bins = Bins::new(subject.surface.diagonal());
    vertex::run(subject, &mut bins)?;
    let mut far = dyadic::reference(subject)?;
    dyadic::run(subject, &mut far, &mut bins)?;
    regular::run(subject, &mut far, &mut bins)?;
    fragment::run(subject, &mut far, gpu, size, &mut bins)?;
    endcap::run(subject, &mut bins)?;
    Ok(bins)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;
    use glam::DVec3;

    /// Every check can fail: a control point moved by 1e-7 of the diagonal, in the surface but not in the reference,
    /// turns up in every tier that judges f64, and one of 1e-5 in the fragments.
    #[test]
    fn planted_errors_are_caught_by_every_tier() {
        let mesh = mesh::sample();
        let gpu = Gpu::new().expect("the fragment tier needs an adapter");
        for (shift, expected) in [(1e-7, &["vertex", "dyadic", "regular"][..]), (1e-4, &["fragment"][..])] {
            let mut moved = mesh.clone();
            moved.points.iter_mut().step_by(7).for_each(|p| *p += DVec3::splat(shift * mesh.diagonal()));
            let surface = LimitSurface::new(&moved).expect("the sample is valid");
            let bins = tiers(&Subject { mesh: &mesh, surface: &surface }, &gpu, [64, 64]).expect("it runs");
            let report = MeshReport::new(&mesh, &surface, bins);
            assert!(!report.pass);
            for tier in expected {
                let failed = report.tiers.iter().any(|row| row.tier == *tier && !row.pass);
                assert!(failed, "{tier} missed an error of {shift:e}");
            }
        }
    }
}
