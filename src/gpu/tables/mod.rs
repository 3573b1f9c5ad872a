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
//! same part of f32. What exceeds [`BUDGET`] or the adapter is built for the patches that a picture sees (`part.rs`).

mod basis;
mod layout;
mod pack;
mod part;
mod source;

pub use layout::{BUDGET, TableLayout, bytes};
pub(super) use part::numbered;
pub use source::{PatchNet, PatchNets, PatchSource, Storage, TableNet};

use super::GpuError;
use super::device::Device;
use super::shader::Content;
use crate::stam::{ClassTable, LEVELS, WINDOW_POINTS};
use glam::DVec3;
use layout::Plan;
use rayon::prelude::*;
use std::sync::Arc;

/// Levels stored per irregular patch.
pub const TABLE_LEVELS: usize = 24;

/// The tables of a surface on the adapter.
#[derive(Debug)]
pub struct Tables {
    /// `None` where they exceed the adapter: [`Tables::part`] makes those of some patches.
    textures: Option<Textures>,
    /// Origin of every patch, world space.
    pub(super) origins: Vec<DVec3>,
    /// Refinement levels and transition bits of every patch.
    pub(super) cells: Vec<([u8; 2], u8)>,
    /// Where the patches came from.
    pub(super) source: Arc<dyn PatchSource>,
    bounds: [DVec3; 2],
    plan: Plan,
    unit: f64,
    /// Bytes that may be on the adapter.
    room: u64,
    /// Where these are the tables of a part: its patches.
    part: Option<Arc<[u32]>>,
}

#[derive(Debug)]
struct Textures {
    records: wgpu::Texture,
    points: wgpu::Texture,
    scales: wgpu::Texture,
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

    /// Whether patches are triangles.
    pub fn has_triangles(&self) -> bool {
        self.plan.has_triangles
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
        self.plan.layout
    }

    /// What the passes that read them are compiled for.
    pub(super) fn content(&self) -> Content {
        let has_instances = !self.plan.transforms.is_empty();
        match self.plan.layout {
            _ if self.plan.has_triangles => Content::Triangles,
            _ if self.plan.has_gregory => Content::Gregory,
            TableLayout::Expanded if has_instances => Content::Instances,
            TableLayout::Expanded => Content::Points,
            _ if has_instances => Content::InstancesWithTails,
            _ => Content::Tails,
        }
    }

    /// Bytes of all tables; on the adapter, if [`is_resident`](Self::is_resident).
    pub fn size(&self) -> u64 {
        self.plan.bytes
    }

    /// Whether the tables are on the adapter. Those that exceed [`BUDGET`] or the adapter are not: pictures of the exact
    /// pipeline and samples get what they need of them, others are refused.
    pub fn is_resident(&self) -> bool {
        self.textures.is_some()
    }

    /// Blocks that the points are divided into.
    pub fn blocks(&self) -> u32 {
        self.textures.as_ref().map_or(0, |textures| textures.points.depth_or_array_layers())
    }

    /// Patches whose tables are sure to fit.
    pub(super) fn largest_part(&self) -> usize {
        (self.room.saturating_sub(self.plan.matrices) / self.plan.largest_patch) as usize
    }

    /// Views of patch records, points and scales: bindings 0, 1 and 2 of group 0 in every pass that evaluates.
    ///
    /// # Panics
    /// The tables are not resident.
    pub(super) fn views(&self) -> [wgpu::TextureView; 3] {
        let Textures { records, points, scales } = self.textures.as_ref().expect("tables that are on the adapter");
        let in_blocks =
            wgpu::TextureViewDescriptor { dimension: Some(wgpu::TextureViewDimension::D2Array), ..Default::default() };
        let [records, scales] = [records, scales].map(|texture| texture.create_view(&Default::default()));
        [records, points.create_view(&in_blocks), scales]
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
    let limit = device.block_table_limit();
    let plan = Plan::new(source, layout, limit);
    if plan.bytes <= BUDGET && plan.texels <= limit {
        return fill(device, source, plan, unit);
    }
    let room = BUDGET.min(16 * limit);
    let places: Vec<_> = (0..source.count()).into_par_iter().map(|patch| source.place(patch)).collect();
    let (origins, cells) = places.into_iter().unzip();
    Ok(Tables { textures: None, origins, cells, source: source.shared(), bounds, plan, unit, room, part: None })
}

/// Builds planned tables on the adapter.
fn fill<S: PatchSource + ?Sized>(device: &Device, source: &S, plan: Plan, unit: f64) -> Result<Tables, GpuError> {
    let pack::Packed { points, records, scales, origins, cells } = pack::pack(device, source, &plan, unit)?;
    let textures = Textures {
        records: device.table("the records of the patches", &records, wgpu::TextureFormat::Rgba32Uint)?,
        points,
        scales: device.table("the powers of lambda", &scales, wgpu::TextureFormat::Rg32Float)?,
    };
    device.queue.submit([]);
    let (source, bounds) = (source.shared(), source.bounds());
    Ok(Tables { textures: Some(textures), origins, cells, source, bounds, room: plan.bytes, plan, unit, part: None })
}
