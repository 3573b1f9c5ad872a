//! OpenSubdiv's own patches: feature-adaptive refinement with approximating end caps.
//!
//! What most programs show of a subdivision surface (`Far::PatchTable`): bicubic B-splines where the mesh is regular, and end caps
//! where refinement stops at a feature. [`AdaptivePatches`] evaluates them as OpenSubdiv does, in f64; the
//! [`gpu`](crate::gpu) draws them through the passes of the exact surface, so that pictures differ by the patches alone.
//!
//! ```
//! use catoptric::adaptive::AdaptivePatches;
//! use catoptric::{mesh, osd};
//!
//! let patches = AdaptivePatches::new(&mesh::sample(), osd::Isolation::uniform(3), osd::EndCap::Gregory)?;
//! println!("{} patches, {} of them end caps", patches.patches().len(), patches.end_caps());
//! # Ok::<(), osd::Error>(())
//! ```

mod accuracy;
mod gregory;

pub use accuracy::Accuracy;
pub use gregory::{Gregory, weights};

use crate::mesh::SubdivMesh;
use crate::osd::{EndCap, Error, Far, FarNet, FarPatch, Isolation};
use crate::stam::{Jet, weights as spline_weights};
use glam::DVec3;
use std::sync::Arc;

/// The patches of a mesh by OpenSubdiv's feature-adaptive refinement. Clones share them.
#[derive(Debug, Clone)]
pub struct AdaptivePatches {
    patches: Arc<[FarPatch]>,
    bounds: [DVec3; 2],
    bytes: u64,
}

impl AdaptivePatches {
    /// Refines and builds the patches.
    ///
    /// # Errors
    /// The mesh is not valid, a level is out of range, or OpenSubdiv reports an error.
    pub fn new(mesh: &SubdivMesh, isolation: Isolation, end_cap: EndCap) -> Result<AdaptivePatches, Error> {
        let far = Far::with(mesh, isolation, end_cap)?;
        let patches: Arc<[FarPatch]> = far.patches()?.into();
        let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for point in patches.iter().flat_map(|patch| patch.net.points()) {
            bounds = [bounds[0].min(*point), bounds[1].max(*point)];
        }
        if patches.is_empty() {
            bounds = [DVec3::ZERO, DVec3::ONE];
        }
        Ok(AdaptivePatches { patches, bounds, bytes: far.bytes() })
    }

    /// The patches.
    pub fn patches(&self) -> &[FarPatch] {
        &self.patches
    }

    /// How many of them approximate.
    pub fn end_caps(&self) -> usize {
        self.patches.iter().filter(|patch| patch.is_end_cap).count()
    }

    /// Bytes of OpenSubdiv's table, as [`Far::bytes`].
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// A box round the control points; any box if there are none.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// Evaluates a patch at its own (u,v), each 0 to 1, as OpenSubdiv does; derivatives by these.
    pub fn evaluate(&self, patch: usize, uv: [f64; 2]) -> Jet {
        match &self.patches[patch].net {
            FarNet::Gregory(points) => Gregory::new(points).evaluate(uv),
            FarNet::BSpline(net) => {
                let weights = spline_weights(uv);
                let [position, du, dv] =
                    [0, 1, 2].map(|row| weights.iter().zip(net).map(|(w, &p)| w[row] * p).sum::<DVec3>());
                Jet::new(position, du, dv)
            }
        }
    }
}
