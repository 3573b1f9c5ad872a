//! Tables that exceed an adapter: those of the patches that a tile sees, made when it is drawn.
//!
//! A picture sees at most one patch a sample, however many there are. So a surface whose tables exceed [`BUDGET`](super::BUDGET)
//! or the adapter stays on the host; what is seen of it, or asked for, becomes a surface of its own with the same bounds,
//! and thus the same units.

use super::{PatchNet, PatchNets, PatchSource, Storage, Tables, fill};
use crate::gpu::GpuError;
use crate::gpu::device::Device;
use crate::stam::ClassTable;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Some patches of a source, in order.
#[derive(Debug, Clone)]
struct Part {
    whole: Arc<dyn PatchSource>,
    patches: Arc<[u32]>,
    bounds: [DVec3; 2],
}

impl Part {
    fn at(&self, patch: usize) -> usize {
        self.patches[patch] as usize
    }
}

impl PatchSource for Part {
    fn count(&self) -> usize {
        self.patches.len()
    }

    fn storage(&self, patch: usize) -> Storage {
        self.whole.storage(self.at(patch))
    }

    fn classes(&self) -> &[Arc<ClassTable>] {
        self.whole.classes()
    }

    fn class(&self, patch: usize) -> Option<usize> {
        self.whole.class(self.at(patch))
    }

    fn patch(&self, patch: usize, levels: usize) -> PatchNet {
        self.whole.patch(self.at(patch), levels)
    }

    fn picked(&self, patch: usize, picked: &[[usize; 2]]) -> Vec<DVec3> {
        self.whole.picked(self.at(patch), picked)
    }

    fn place(&self, patch: usize) -> (DVec3, ([u8; 2], u8)) {
        self.whole.place(self.at(patch))
    }

    fn nets(&self, patch: usize) -> PatchNets<'_> {
        self.whole.nets(self.at(patch))
    }

    fn to_ptex(&self, patch: usize, uv: [f64; 2]) -> (u32, [f64; 2]) {
        self.whole.to_ptex(self.at(patch), uv)
    }

    fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    fn shared(&self) -> Arc<dyn PatchSource> {
        Arc::new(self.clone())
    }
}

impl Tables {
    /// The tables of some patches alone, ascending; their index there is that in the list.
    pub(in crate::gpu) fn part(&self, device: &Device, patches: Vec<u32>) -> Result<Tables, GpuError> {
        let patches: Arc<[u32]> = patches.into();
        let part = Part { whole: self.source.clone(), patches: patches.clone(), bounds: self.bounds };
        let plan = self.plan.for_part(&part);
        Ok(Tables { part: Some(patches), ..fill(device, &part, plan, self.unit)? })
    }

    /// The patch of the whole surface that a patch of these tables is.
    pub(in crate::gpu) fn in_whole(&self, patch: u32) -> u32 {
        self.part.as_ref().map_or(patch, |part| part[patch as usize])
    }
}

/// The values that are not `none`, ascending and once each, and the place of each value among them.
pub(in crate::gpu) fn numbered(values: &[u32], none: u32) -> (Vec<u32>, Vec<u32>) {
    let mut known: Vec<u32> = values.iter().copied().filter(|&value| value != none).collect();
    known.par_sort_unstable();
    known.dedup();
    let place = |&value: &u32| known.binary_search(&value).map_or(none, |place| place as u32);
    let places = values.par_iter().map(place).collect();
    (known, places)
}
