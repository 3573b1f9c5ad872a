//! Where patches come from.

use super::TABLE_LEVELS;
use crate::stam::{ClassTable, LimitSurface, Net};
use glam::DVec3;

/// One patch, as the tables want it.
#[derive(Debug, Clone)]
pub struct PatchNet {
    /// Refinement levels along u and v, as [`Patch::levels`](crate::patch::Patch::levels).
    pub levels: [u8; 2],
    /// As [`Patch::transition`](crate::patch::Patch::transition).
    pub transition: u8,
    /// Control net, with 1 to [`TABLE_LEVELS`] levels where it is irregular.
    pub net: Net,
    /// Limit normal at local (0,0) of an irregular patch.
    pub normal: DVec3,
}

/// Where patches come from: the limit surface, or a slice in tests.
pub trait PatchSource: Sync {
    /// Number of patches.
    fn count(&self) -> usize;
    /// Whether a patch has a table of levels.
    fn is_irregular(&self, patch: usize) -> bool;
    /// The classes whose matrices patches share; none if every irregular patch is to be stored level by level.
    fn classes(&self) -> &[ClassTable];
    /// Index into [`classes`](Self::classes) of an irregular patch.
    fn class(&self, patch: usize) -> Option<usize>;
    /// A patch with so many levels, if it has as many.
    fn patch(&self, patch: usize, levels: usize) -> PatchNet;
    /// A box round the surface; any box if there are no patches.
    fn bounds(&self) -> [DVec3; 2];
}

impl PatchSource for LimitSurface {
    fn count(&self) -> usize {
        self.patches().len()
    }

    fn is_irregular(&self, patch: usize) -> bool {
        self.class(patch).is_some()
    }

    fn classes(&self) -> &[ClassTable] {
        self.tables()
    }

    fn class(&self, patch: usize) -> Option<usize> {
        self.class(patch)
    }

    fn patch(&self, patch: usize, levels: usize) -> PatchNet {
        let normal = match PatchSource::is_irregular(self, patch) {
            true => self.evaluate(patch, [0.0, 0.0]).normal,
            false => DVec3::ZERO,
        };
        let record = self.patches()[patch];
        PatchNet { levels: record.levels(), transition: record.transition, net: self.net(patch, levels), normal }
    }

    fn bounds(&self) -> [DVec3; 2] {
        self.bounds().unwrap_or([DVec3::ZERO, DVec3::ONE])
    }
}

impl PatchSource for [PatchNet] {
    fn count(&self) -> usize {
        self.len()
    }

    fn is_irregular(&self, patch: usize) -> bool {
        matches!(self[patch].net, Net::Irregular { .. })
    }

    fn classes(&self) -> &[ClassTable] {
        &[]
    }

    fn class(&self, _: usize) -> Option<usize> {
        None
    }

    fn patch(&self, patch: usize, levels: usize) -> PatchNet {
        let mut patch = self[patch].clone();
        if let Net::Irregular { levels: stored, .. } = &mut patch.net {
            stored.truncate(levels.min(TABLE_LEVELS));
        }
        patch
    }

    fn bounds(&self) -> [DVec3; 2] {
        let points = self.iter().flat_map(|patch| match &patch.net {
            Net::Regular(points) => points.to_vec(),
            Net::Irregular { limit, levels, .. } => levels[0].iter().map(|p| *p + *limit).collect(),
        });
        points
            .fold(None, |bounds: Option<[DVec3; 2]>, p| Some(bounds.map_or([p, p], |[a, b]| [a.min(p), b.max(p)])))
            .unwrap_or([DVec3::ZERO, DVec3::ONE])
    }
}
