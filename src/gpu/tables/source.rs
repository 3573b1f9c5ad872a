//! Where patches come from.

use crate::adaptive::{AdaptivePatches, Gregory};
use crate::osd::FarNet;
use crate::stam::{ClassTable, LOOP_WINDOW, LimitSurface, Net, Rings, WINDOW_POINTS, box_spline};
use glam::{DAffine3, DVec3};
use std::fmt::Debug;
use std::sync::Arc;

/// One patch, as the tables want it.
#[derive(Debug, Clone)]
pub struct PatchNet {
    /// Refinement levels along u and v, as [`Patch::levels`](crate::patch::Patch::levels).
    pub levels: [u8; 2],
    /// As [`Patch::transition`](crate::patch::Patch::transition).
    pub transition: u8,
    /// Control points.
    pub net: TableNet,
}

/// The control points of a patch, as the tables want them.
#[derive(Debug, Clone)]
pub enum TableNet {
    /// A uniform bicubic B-spline, u fastest.
    Regular([DVec3; 16]),
    /// Levels of a Stam table.
    Irregular {
        /// s0, the limit position at local (0,0).
        limit: DVec3,
        /// Limit normal there.
        normal: DVec3,
        /// Subdominant eigenvalue.
        lambda: f64,
        /// As [`Net::Irregular`], 1 to [`TABLE_LEVELS`](super::TABLE_LEVELS) of them.
        levels: Vec<[DVec3; WINDOW_POINTS]>,
    },
    /// An end cap of OpenSubdiv.
    Gregory(Gregory),
    /// The 12 points of a triangle.
    Triangle([DVec3; box_spline::POINTS]),
    /// Levels of a Stam table of a triangle.
    IrregularTriangle {
        /// s0, the limit position at local (0,0).
        limit: DVec3,
        /// Limit normal there.
        normal: DVec3,
        /// Subdominant eigenvalue.
        lambda: f64,
        /// As [`Net::IrregularTriangle`], [`TABLE_LEVELS`](super::TABLE_LEVELS) of them.
        levels: Vec<[DVec3; LOOP_WINDOW.len()]>,
    },
}

/// What the tables take for a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// 16 points.
    Regular,
    /// A table of levels.
    Irregular,
    /// 16 points and 4 differences.
    Gregory,
    /// 12 points.
    Triangle,
    /// A table of levels of 16 points.
    IrregularTriangle,
}

/// The nets that a patch consists of.
#[derive(Debug)]
pub enum PatchNets<'a> {
    /// 16 points, u fastest.
    Regular([DVec3; 16]),
    /// Three windows a level.
    Irregular(Rings<'a>),
    /// A Bezier net with inner points that depend on (u,v).
    Gregory(Gregory),
    /// 12 points of a triangle.
    Triangle([DVec3; box_spline::POINTS]),
    /// Three windows a level, of a triangle.
    IrregularTriangle(Rings<'a>),
}

/// Where patches come from: the limit surface, OpenSubdiv's own patches, or regular nets.
pub trait PatchSource: Debug + Send + Sync {
    /// Number of patches.
    fn count(&self) -> usize;
    /// How a patch is stored.
    fn storage(&self, patch: usize) -> Storage;
    /// The classes whose matrices patches share; none if every irregular patch is to be stored level by level.
    fn classes(&self) -> &[Arc<ClassTable>];
    /// Index into [`classes`](Self::classes) of an irregular patch.
    fn class(&self, patch: usize) -> Option<usize>;
    /// Of a patch that is an earlier one in another place: that one, and which of [`transforms`](Self::transforms) moves it.
    fn instance(&self, _patch: usize) -> Option<(usize, usize)> {
        None
    }

    /// What moves patches to where their instances are.
    fn transforms(&self) -> Vec<DAffine3> {
        Vec::new()
    }

    /// A patch with so many levels, if it has as many.
    fn patch(&self, patch: usize, levels: usize) -> PatchNet;
    /// Window points of an irregular patch that has a class, each by its level (from 1) and its number there.
    fn picked(&self, patch: usize, picked: &[[usize; 2]]) -> Vec<DVec3> {
        let deepest = picked.iter().map(|&[level, _]| level).max().unwrap_or(1);
        match self.patch(patch, deepest).net {
            TableNet::Irregular { levels, .. } => {
                picked.iter().map(|&[level, point]| levels[level - 1][point]).collect()
            }
            _ => Vec::new(),
        }
    }
    /// Some point near a patch, and its cell: refinement levels and transition bits, as in [`PatchNet`].
    fn place(&self, patch: usize) -> (DVec3, ([u8; 2], u8)) {
        let PatchNet { levels, transition, net } = self.patch(patch, 1);
        let point = match net {
            TableNet::Regular(points) => points[5],
            TableNet::Irregular { limit, .. } | TableNet::IrregularTriangle { limit, .. } => limit,
            TableNet::Gregory(Gregory { bezier, .. }) => bezier[5],
            TableNet::Triangle(points) => points[4],
        };
        (point, (levels, transition))
    }
    /// The nets of a patch.
    fn nets(&self, patch: usize) -> PatchNets<'_>;
    /// Ptex face and its parameters at those of a patch.
    fn to_ptex(&self, patch: usize, uv: [f64; 2]) -> (u32, [f64; 2]);
    /// A box round the surface; any box if there are no patches.
    fn bounds(&self) -> [DVec3; 2];
    /// The source itself, to be kept: pictures are made from its nets.
    fn shared(&self) -> Arc<dyn PatchSource>;
}

impl PatchSource for LimitSurface {
    fn count(&self) -> usize {
        self.patches().len()
    }

    fn storage(&self, patch: usize) -> Storage {
        match (self.class(patch).is_some(), self.has_triangles()) {
            (false, false) => Storage::Regular,
            (true, false) => Storage::Irregular,
            (false, true) => Storage::Triangle,
            (true, true) => Storage::IrregularTriangle,
        }
    }

    fn classes(&self) -> &[Arc<ClassTable>] {
        // Triangles are stored level by level.
        if self.has_triangles() { &[] } else { self.tables() }
    }

    fn class(&self, patch: usize) -> Option<usize> {
        self.class(patch).filter(|_| !self.has_triangles())
    }

    fn instance(&self, patch: usize) -> Option<(usize, usize)> {
        self.instance(patch)
    }

    fn transforms(&self) -> Vec<DAffine3> {
        // The shader of triangles does not move them, so each has points of its own.
        if self.has_triangles() { Vec::new() } else { self.transforms() }
    }

    fn patch(&self, patch: usize, levels: usize) -> PatchNet {
        let record = self.patches()[patch];
        let normal = || self.vertex_normal(patch);
        let net = match self.net_for_tables(patch, levels) {
            Net::Triangle(points) => TableNet::Triangle(points),
            Net::IrregularTriangle { limit, lambda, levels } => {
                TableNet::IrregularTriangle { limit, normal: normal(), lambda, levels }
            }
            Net::Regular(points) => TableNet::Regular(points),
            Net::Irregular { limit, lambda, levels } => TableNet::Irregular { limit, normal: normal(), lambda, levels },
        };
        PatchNet { levels: record.levels(), transition: record.transition, net }
    }

    fn picked(&self, patch: usize, picked: &[[usize; 2]]) -> Vec<DVec3> {
        self.window_points(patch, picked)
    }

    fn place(&self, patch: usize) -> (DVec3, ([u8; 2], u8)) {
        let record = self.patches()[patch];
        (self.control_point(patch), (record.levels(), record.transition))
    }

    fn nets(&self, patch: usize) -> PatchNets<'_> {
        match (self.rings(patch), self.has_triangles()) {
            (Some(rings), false) => PatchNets::Irregular(rings),
            (None, false) => PatchNets::Regular(self.regular_net(patch)),
            (Some(rings), true) => PatchNets::IrregularTriangle(rings),
            (None, true) => PatchNets::Triangle(self.triangle_net(patch)),
        }
    }

    fn to_ptex(&self, patch: usize, uv: [f64; 2]) -> (u32, [f64; 2]) {
        let patch = self.patches()[patch];
        (patch.ptex, patch.to_ptex(uv))
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

    fn storage(&self, _: usize) -> Storage {
        Storage::Regular
    }

    fn classes(&self) -> &[Arc<ClassTable>] {
        &[]
    }

    fn class(&self, _: usize) -> Option<usize> {
        None
    }

    fn patch(&self, patch: usize, _: usize) -> PatchNet {
        PatchNet { levels: [0; 2], transition: 0, net: TableNet::Regular(self[patch]) }
    }

    fn nets(&self, patch: usize) -> PatchNets<'_> {
        PatchNets::Regular(self[patch])
    }

    fn to_ptex(&self, patch: usize, uv: [f64; 2]) -> (u32, [f64; 2]) {
        (patch as u32, uv)
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

impl PatchSource for AdaptivePatches {
    fn count(&self) -> usize {
        self.patches().len()
    }

    fn storage(&self, patch: usize) -> Storage {
        match self.patches()[patch].net {
            FarNet::BSpline(_) => Storage::Regular,
            FarNet::Gregory(_) => Storage::Gregory,
        }
    }

    fn classes(&self) -> &[Arc<ClassTable>] {
        &[]
    }

    fn class(&self, _: usize) -> Option<usize> {
        None
    }

    fn patch(&self, patch: usize, _: usize) -> PatchNet {
        let record = &self.patches()[patch];
        let net = match &record.net {
            FarNet::BSpline(net) => TableNet::Regular(*net),
            FarNet::Gregory(points) => TableNet::Gregory(Gregory::new(points)),
        };
        PatchNet { levels: [record.level; 2], transition: record.transition, net }
    }

    fn nets(&self, patch: usize) -> PatchNets<'_> {
        match &self.patches()[patch].net {
            FarNet::BSpline(net) => PatchNets::Regular(*net),
            FarNet::Gregory(points) => PatchNets::Gregory(Gregory::new(points)),
        }
    }

    fn to_ptex(&self, patch: usize, uv: [f64; 2]) -> (u32, [f64; 2]) {
        let patch = &self.patches()[patch];
        (patch.ptex, patch.to_ptex(uv))
    }

    fn bounds(&self) -> [DVec3; 2] {
        self.bounds()
    }

    fn shared(&self) -> Arc<dyn PatchSource> {
        Arc::new(self.clone())
    }
}
