//! Where patches come from.

use crate::stam::{ClassTable, LimitSurface, Net, Rings};
use glam::DVec3;
use std::fmt::Debug;
use std::sync::Arc;

/// One patch, as the tables want it.
#[derive(Debug, Clone)]
pub struct PatchNet {
    /// Refinement levels along u and v, as [`Patch::levels`](crate::patch::Patch::levels).
    pub levels: [u8; 2],
    /// As [`Patch::transition`](crate::patch::Patch::transition).
    pub transition: u8,
    /// Control net, with 1 to [`TABLE_LEVELS`](super::TABLE_LEVELS) levels where it is irregular.
    pub net: Net,
    /// Limit normal at local (0,0) of an irregular patch.
    pub normal: DVec3,
}

/// The B-spline nets that a patch consists of.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "a net is a value on its way to be cut; a box each would cost more")]
pub enum PatchNets<'a> {
    /// 16 points, u fastest.
    Regular([DVec3; 16]),
    /// Three windows a level.
    Irregular(Rings<'a>),
}

/// Where patches come from: the limit surface, or regular nets.
pub trait PatchSource: Debug + Send + Sync {
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
    /// The nets of a patch.
    fn nets(&self, patch: usize) -> PatchNets<'_>;
    /// A box round the surface; any box if there are no patches.
    fn bounds(&self) -> [DVec3; 2];
    /// The source itself, to be kept: pictures are made from its nets.
    fn shared(&self) -> Arc<dyn PatchSource>;
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

    fn nets(&self, patch: usize) -> PatchNets<'_> {
        match self.rings(patch) {
            Some(rings) => PatchNets::Irregular(rings),
            None => PatchNets::Regular(self.regular_net(patch)),
        }
    }

    fn bounds(&self) -> [DVec3; 2] {
        self.bounds().unwrap_or([DVec3::ZERO, DVec3::ONE])
    }

    fn shared(&self) -> Arc<dyn PatchSource> {
        Arc::new(self.clone())
    }
}

/// Uniform bicubic B-spline nets, u fastest, each a face of its own.
impl PatchSource for Vec<[DVec3; 16]> {
    fn count(&self) -> usize {
        self.len()
    }

    fn is_irregular(&self, _: usize) -> bool {
        false
    }

    fn classes(&self) -> &[ClassTable] {
        &[]
    }

    fn class(&self, _: usize) -> Option<usize> {
        None
    }

    fn patch(&self, patch: usize, _: usize) -> PatchNet {
        PatchNet { levels: [0; 2], transition: 0, net: Net::Regular(self[patch]), normal: DVec3::ZERO }
    }

    fn nets(&self, patch: usize) -> PatchNets<'_> {
        PatchNets::Regular(self[patch])
    }

    fn bounds(&self) -> [DVec3; 2] {
        self.as_flattened()
            .iter()
            .fold(None, |bounds: Option<[DVec3; 2]>, &p| Some(bounds.map_or([p, p], |[a, b]| [a.min(p), b.max(p)])))
            .unwrap_or([DVec3::ZERO, DVec3::ONE])
    }

    fn shared(&self) -> Arc<dyn PatchSource> {
        Arc::new(self.clone())
    }
}
