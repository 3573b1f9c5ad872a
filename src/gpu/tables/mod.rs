//! Patches as f32 tables: positions relative to a per-patch origin that stays on the CPU in f64.
//!
//! # Theory
//! Normalised Stam tables (docs/LIMIT.md, section 4). A regular patch is 16 points; an irregular one 24 levels of 24 points (the
//! three windows of a level overlap), its origin s0 and the powers of lambda, shared by all patches with that lambda.
//!
//! # Changes
//! Yasui & Kanai 2004, fig. 4 store 15 levels of 48 plain points in a texture. 24 levels are all that an f32 parameter
//! which rasterisation interpolated can reach; beyond, the last level serves again with its power of lambda
//! ([`tail_error`] says what that leaves out). Of the 24, the first are stored point by point and the rest as a few points
//! and a matrix of the class ([`TableLayout`], `basis.rs`).
//!
//! # Practice
//! One texture of points: what moves instances, matrices of the classes, then the patches in order, 192 B a regular one. A patch
//! that is another one in another place has a record of its own (16 B), and no points. What a texel means is described in
//! `shaders/shared/tables.wgsl`. Tables are built and handed over some 16 MiB at a time. Everything is divided
//! by [`Tables::unit`], a power of two near the size of the object, so that models in microns and in kilometres use the
//! same part of f32.

mod basis;
mod layout;
mod pack;
mod source;

pub use layout::{BUDGET, TableLayout, bytes};
pub use source::{PatchNet, PatchNets, PatchSource, Storage, TableNet};

use super::GpuError;
use super::device::Device;
use super::shader::Content;
use crate::stam::{ClassTable, LEVELS, WINDOW_POINTS};
use glam::DVec3;
use layout::Plan;
use std::sync::Arc;

/// Levels stored per irregular patch.
pub const TABLE_LEVELS: usize = 24;

/// The tables of a surface on the adapter.
#[derive(Debug)]
pub struct Tables {
    records: wgpu::Texture,
    points: wgpu::Texture,
    scales: wgpu::Texture,
    /// Origin of every patch, world space.
    pub(super) origins: Vec<DVec3>,
    /// Refinement levels and transition bits of every patch.
    pub(super) cells: Vec<([u8; 2], u8)>,
    /// Where the patches came from.
    pub(super) source: Arc<dyn PatchSource>,
    bounds: [DVec3; 2],
    layout: TableLayout,
    has_gregory: bool,
    has_instances: bool,
    size: u64,
    unit: f64,
}

impl Tables {
    /// World length of 1 in the buffers, a power of two.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Number of patches.
    pub fn patches(&self) -> usize {
        self.origins.len()
    }

    /// World-space origin of a patch: its buffers hold positions relative to it.
    pub fn origin(&self, patch: usize) -> DVec3 {
        self.origins[patch]
    }

    /// Area of the patches in quad faces of the control mesh.
    pub fn faces(&self) -> f64 {
        self.cells.iter().map(|&([u, v], _)| 0.5f64.powi(i32::from(u) + i32::from(v))).sum()
    }

    /// Box round the surface.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// Where the patches came from.
    pub fn source(&self) -> &dyn PatchSource {
        &*self.source
    }

    /// How irregular patches are stored; never [`TableLayout::Auto`].
    pub fn layout(&self) -> TableLayout {
        self.layout
    }

    /// What the passes that read them are compiled for.
    pub(super) fn content(&self) -> Content {
        match self.layout {
            _ if self.has_gregory => Content::Gregory,
            TableLayout::Expanded if self.has_instances => Content::Instances,
            TableLayout::Expanded => Content::Points,
            _ if self.has_instances => Content::InstancesWithTails,
            _ => Content::Tails,
        }
    }

    /// Bytes on the adapter.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// Blocks that the points are divided into.
    pub fn blocks(&self) -> u32 {
        self.points.depth_or_array_layers()
    }

    /// Views of patch records, points and scales: bindings 0, 1 and 2 of group 0 in every pass that evaluates.
    pub(super) fn views(&self) -> [wgpu::TextureView; 3] {
        let in_blocks =
            wgpu::TextureViewDescriptor { dimension: Some(wgpu::TextureViewDimension::D2Array), ..Default::default() };
        let [records, scales] = [&self.records, &self.scales].map(|texture| texture.create_view(&Default::default()));
        [records, self.points.create_view(&in_blocks), scales]
    }
}

/// What the tables leave out beyond their last level, as part of the largest point there: how much the points of a class
/// change from level [`TABLE_LEVELS`] to the deepest one of f64. Tangents are off by as much where u and v are below
/// 2^-24, and positions by lambda^24 of that (5e-10 for valence 3, 7e-6 for valence 8 of a quantity of that size).
/// `None` for classes that keep no matrices.
pub fn tail_error(class: &ClassTable) -> Option<f64> {
    let size = |row: &mut dyn Iterator<Item = f64>| row.map(|x| x * x).sum::<f64>().sqrt();
    let (mut change, mut largest) = (0.0f64, 0.0f64);
    for point in 0..WINDOW_POINTS {
        let [last, limit] = [class.weights(TABLE_LEVELS, point)?, class.weights(LEVELS, point)?];
        change = change.max(size(&mut last.iter().zip(limit).map(|(a, b)| a - b)));
        largest = largest.max(size(&mut limit.iter().copied()));
    }
    Some(change / largest)
}

pub(super) fn upload<S: PatchSource + ?Sized>(
    device: &Device,
    source: &S,
    layout: TableLayout,
) -> Result<Tables, GpuError> {
    let bounds = source.bounds();
    let diagonal = (bounds[1] - bounds[0]).length();
    let unit = if diagonal > 0.0 && diagonal.is_finite() { diagonal.log2().round().exp2() } else { 1.0 };
    let plan = Plan::new(source, layout, device.block_table_limit());
    let pack::Packed { points, records, scales, origins, cells } = pack::pack(device, source, &plan, unit)?;
    Ok(Tables {
        size: 16 * (records.len() as u64 + plan.texels) + 8 * scales.len() as u64,
        records: device.table("the records of the patches", &records, wgpu::TextureFormat::Rgba32Uint)?,
        points,
        scales: device.table("the powers of lambda", &scales, wgpu::TextureFormat::Rg32Float)?,
        cells,
        origins,
        source: source.shared(),
        bounds,
        layout: plan.layout,
        has_gregory: plan.has_gregory,
        has_instances: !plan.transforms.is_empty(),
        unit,
    })
}
