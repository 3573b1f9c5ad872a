//! The exact limit in f64: the reference of everything else.

use crate::{mesh::SubdivMesh, patch::Patch};
use glam::DVec3;

/// Position, first derivatives and unit normal of the limit surface at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// Limit position.
    pub position: DVec3,
    /// Derivative by u.
    pub du: DVec3,
    /// Derivative by v.
    pub dv: DVec3,
    /// Unit normal: the limit of the normals inside the patch (zero where the surface has none).
    pub normal: DVec3,
}

/// The control net of a patch, as an evaluator wants it.
#[derive(Debug, Clone)]
pub enum Net {
    /// 16 uniform bicubic B-spline points, u fastest: point (i,j), i,j in -1..=2, at `4*(j+1) + (i+1)`; corners 5, 6, 10, 9.
    Regular([DVec3; 16]),
    /// Normalised Stam table, design.md 3.2.
    Irregular {
        /// s0, the limit position of the extraordinary vertex at local (0,0).
        limit: DVec3,
        /// lambda, the largest eigenvalue of the subdivision matrix below 1.
        lambda: f64,
        /// Phat of level n at `levels[n-1]`: 24 points, the grid (a,b), a,b in -1..=3, u fastest, without (-1,-1):
        /// point (a,b) at `5*(b+1) + (a+1) - 1`.
        levels: Vec<[DVec3; 24]>,
    },
}

/// The limit surface of a mesh.
#[derive(Debug)]
pub struct LimitSurface {}

impl LimitSurface {
    /// Refines the mesh and builds its patches and tables.
    pub fn new(_mesh: &SubdivMesh) -> Result<Self, crate::osd::Error> {
        todo!()
    }
    /// All patches.
    pub fn patches(&self) -> &[Patch] {
        todo!()
    }
    /// Number of ptex faces (holes included).
    pub fn ptex_count(&self) -> usize {
        todo!()
    }
    /// Length of the bounding-box diagonal of the control points.
    pub fn diagonal(&self) -> f64 {
        todo!()
    }
    /// Bounds of the limit surface (a box that encloses it).
    pub fn bounds(&self) -> [DVec3; 2] {
        todo!()
    }
    /// The patch at (u,v) of a ptex face and the patch-local (u,v); `None` in a hole.
    pub fn locate(&self, _ptex: u32, _u: f64, _v: f64) -> Option<(usize, [f64; 2])> {
        todo!()
    }
    /// Evaluates a patch at its local (u,v), derivatives by the local parameters.
    pub fn evaluate(&self, _patch: usize, _uv: [f64; 2]) -> Jet {
        todo!()
    }
    /// Evaluates a ptex face at (u,v), derivatives by the ptex parameters; `None` in a hole.
    pub fn evaluate_ptex(&self, _ptex: u32, _u: f64, _v: f64) -> Option<(usize, Jet)> {
        todo!()
    }
    /// Control net of a patch, `levels` levels of it where it is irregular.
    pub fn net(&self, _patch: usize, _levels: usize) -> Net {
        todo!()
    }
}
