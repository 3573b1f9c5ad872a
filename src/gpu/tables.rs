//! Patches as f32 buffers: positions relative to a per-patch origin that stays on the CPU in f64.
//!
//! # Theory
//! design.md 3.2: normalised Stam tables. A regular patch is 16 points; an irregular one 24 levels of 24 points (the
//! three windows of a level overlap), its origin s0 and the powers of lambda, shared by all patches with that lambda.
//!
//! # Changes
//! Yasui & Kanai 2004, fig. 4 store 15 levels of 48 plain points in a texture. 24 levels are all that an f32 parameter
//! which rasterisation interpolated can reach; beyond, the last level serves again with its power of lambda.
//!
//! # Practice
//! One texture of points, the regular patches first (192 B each), then the irregular ones (10.4 kB each). The layout of a
//! texel is described in `shaders/shared/limit_point.wgsl`. Everything is divided by [`Tables::unit`], a power of two
//! near the size of the object, so that models in microns and in kilometres use the same part of f32.

use super::GpuError;
use super::device::Device;
use super::shader::{KIND_IRREGULAR, KIND_REGULAR, LEVEL_TEXELS, SCALE_LEVELS};
use crate::stam::{LimitSurface, Net};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Levels stored per irregular patch.
pub const TABLE_LEVELS: usize = 24;
/// Texels of a regular patch: 4 rows of 4 points, x, y and z each.
const REGULAR_TEXELS: usize = 12;
/// Texels of an irregular patch: its levels and its normal.
const IRREGULAR_TEXELS: usize = TABLE_LEVELS * LEVEL_TEXELS as usize + 1;
/// First points of the windows' rows in a level's grid of 5x5 points without the first: the rows of
/// the windows at u >= 1, then those at u < 1.
const WINDOW_ROWS: [usize; 9] = [0, 5, 10, 15, 20, 4, 9, 14, 19];

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
    /// A patch.
    fn patch(&self, patch: usize) -> PatchNet;
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

    fn patch(&self, patch: usize) -> PatchNet {
        let normal = match self.is_irregular(patch) {
            true => self.evaluate(patch, [0.0, 0.0]).normal,
            false => DVec3::ZERO,
        };
        let record = self.patches()[patch];
        PatchNet { levels: record.levels(), transition: record.transition, net: self.net(patch, TABLE_LEVELS), normal }
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

    fn patch(&self, patch: usize) -> PatchNet {
        self[patch].clone()
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

/// Contents of the textures.
#[derive(Debug, Default)]
struct Packed {
    records: Vec<[u32; 4]>,
    points: Vec<[f32; 4]>,
    scales: Vec<[f32; 2]>,
    origins: Vec<DVec3>,
    cells: Vec<([u8; 2], u8)>,
}

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
    bounds: [DVec3; 2],
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

    /// Bytes on the adapter.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// Views of patch records, points and scales: bindings 0, 1 and 2 of group 0 in every pass that evaluates.
    pub(super) fn views(&self) -> [wgpu::TextureView; 3] {
        [&self.records, &self.points, &self.scales].map(|texture| texture.create_view(&Default::default()))
    }
}

/// Texels that the points of a surface take (16 bytes each).
pub fn points_texels(regular: usize, irregular: usize) -> u64 {
    regular as u64 * REGULAR_TEXELS as u64 + irregular as u64 * IRREGULAR_TEXELS as u64
}

pub(super) fn upload<S: PatchSource + ?Sized>(device: &Device, source: &S) -> Result<Tables, GpuError> {
    const POINTS: &str = "the points of the patches";
    let bounds = source.bounds();
    let diagonal = (bounds[1] - bounds[0]).length();
    let unit = if diagonal > 0.0 && diagonal.is_finite() { diagonal.log2().round().exp2() } else { 1.0 };
    let (irregular, regular): (Vec<usize>, Vec<usize>) = (0..source.count()).partition(|&i| source.is_irregular(i));
    device.table_fits(POINTS, points_texels(regular.len(), irregular.len()), 16)?;
    let packed = pack(source, &regular, &irregular, unit);
    Ok(Tables {
        size: (16 * packed.records.len() + 16 * packed.points.len() + 8 * packed.scales.len()) as u64,
        records: device.table("the records of the patches", &packed.records, wgpu::TextureFormat::Rgba32Uint)?,
        points: device.table(POINTS, &packed.points, wgpu::TextureFormat::Rgba32Float)?,
        scales: device.table("the powers of lambda", &packed.scales, wgpu::TextureFormat::Rg32Float)?,
        cells: packed.cells,
        origins: packed.origins,
        bounds,
        unit,
    })
}

/// What the parallel part finds out about a patch.
struct Placed {
    patch: usize,
    record: [u32; 4],
    cell: ([u8; 2], u8),
    origin: DVec3,
    lambda: Option<f64>,
}

fn pack<S: PatchSource + ?Sized>(source: &S, regular: &[usize], irregular: &[usize], unit: f64) -> Packed {
    let split = regular.len() * REGULAR_TEXELS;
    let mut points = vec![[0f32; 4]; split + irregular.len() * IRREGULAR_TEXELS];
    let (first_block, second_block) = points.split_at_mut(split);
    let block = |texels: &mut [[f32; 4]], patches: &[usize], start: usize, size: usize| -> Vec<Placed> {
        let items = texels.par_chunks_exact_mut(size).zip(patches).enumerate();
        items.map(|(k, (texels, &i))| place(source.patch(i), i, start + k * size, texels, unit)).collect()
    };
    let mut placed = block(first_block, regular, 0, REGULAR_TEXELS);
    placed.extend(block(second_block, irregular, split, IRREGULAR_TEXELS));
    placed.sort_unstable_by_key(|p| p.patch);
    let mut packed = Packed { points, ..Packed::default() };
    let mut classes: HashMap<u64, u32> = HashMap::new();
    for mut p in placed {
        if let Some(lambda) = p.lambda {
            p.record[2] = *classes.entry(lambda.to_bits()).or_insert_with(|| {
                let first = packed.scales.len() as u32;
                packed.scales.extend((0..SCALE_LEVELS as i32).map(|n| scale(lambda, n)));
                first
            });
        }
        packed.records.push(p.record);
        packed.origins.push(p.origin);
        packed.cells.push(p.cell);
    }
    packed
}

/// lambda^m and 2^(m+1) lambda^m for level m+1.
fn scale(lambda: f64, m: i32) -> [f32; 2] {
    [lambda.powi(m) as f32, (2.0 * (2.0 * lambda).powi(m)) as f32]
}

/// Writes the texels of one patch, which start at `first`.
fn place(patch_net: PatchNet, patch: usize, first: usize, texels: &mut [[f32; 4]], unit: f64) -> Placed {
    let PatchNet { levels: cell, transition, net, normal } = patch_net;
    let mut at = 0;
    let mut row = |points: &[DVec3]| {
        let local: [DVec3; 4] = std::array::from_fn(|k| points[k] / unit);
        texels[at] = local.map(|p| p.x as f32);
        texels[at + 1] = local.map(|p| p.y as f32);
        texels[at + 2] = local.map(|p| p.z as f32);
        at += 3;
    };
    let (origin, kind, levels, lambda) = match net {
        Net::Regular(points) => {
            let origin = points[5];
            points.map(|p| p - origin).chunks_exact(4).for_each(row);
            (origin, KIND_REGULAR, 0, None)
        }
        Net::Irregular { limit, lambda, levels } => {
            let stored = levels.len().min(TABLE_LEVELS);
            levels[..stored].iter().for_each(|grid| WINDOW_ROWS.iter().for_each(|&i| row(&grid[i..i + 4])));
            let [x, y, z] = normal.as_vec3().to_array();
            texels[stored * LEVEL_TEXELS as usize] = [x, y, z, 0.0];
            (limit, KIND_IRREGULAR, stored as u32, Some(lambda))
        }
    };
    let record = [first as u32, kind | u32::from(cell[0]) << 8 | u32::from(cell[1]) << 12 | levels << 16, 0, 0];
    Placed { patch, record, cell: (cell, transition), origin, lambda }
}
