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
//! One buffer of points, the regular patches first (192 B each), then the irregular ones (6,912 B each). Everything is
//! divided by [`Tables::unit`], a power of two near the size of the object, so that models in microns and in
//! kilometres use the same part of f32.

use super::GpuError;
use super::device::Device;
use super::records::{PatchRecord, Scale};
use super::shader::{KIND_IRREGULAR, KIND_REGULAR, SCALE_LEVELS};
use crate::stam::{LimitSurface, Net, WINDOW_POINTS};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Levels stored per irregular patch.
pub const TABLE_LEVELS: usize = 24;
const REGULAR_FLOATS: usize = 16 * 3;
const IRREGULAR_FLOATS: usize = TABLE_LEVELS * WINDOW_POINTS * 3;

/// One patch, as the tables want it.
#[derive(Debug, Clone)]
pub struct PatchNet {
    /// Depth in the quadtree of its ptex face.
    pub depth: u8,
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
        PatchNet { depth: record.depth, transition: record.transition, net: self.net(patch, TABLE_LEVELS), normal }
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

/// Contents of the buffers.
#[derive(Debug, Default)]
struct Packed {
    records: Vec<PatchRecord>,
    points: Vec<f32>,
    scales: Vec<Scale>,
    origins: Vec<DVec3>,
    transitions: Vec<u8>,
}

/// The tables of a surface on the adapter.
#[derive(Debug)]
pub struct Tables {
    pub(super) records: wgpu::Buffer,
    pub(super) points: wgpu::Buffer,
    pub(super) scales: wgpu::Buffer,
    /// Origin of every patch, world space.
    pub(super) origins: Vec<DVec3>,
    /// Depth and transition bits of every patch.
    pub(super) cells: Vec<(u8, u8)>,
    pub(super) bounds: [DVec3; 2],
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

    /// Box round the surface.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// Bytes on the adapter.
    pub fn size(&self) -> u64 {
        self.records.size() + self.points.size() + self.scales.size()
    }
}

/// Bytes that the points of a surface take on the adapter.
pub fn points_size(regular: usize, irregular: usize) -> u64 {
    4 * (regular as u64 * REGULAR_FLOATS as u64 + irregular as u64 * IRREGULAR_FLOATS as u64)
}

pub(super) fn upload<S: PatchSource + ?Sized>(device: &Device, source: &S) -> Result<Tables, GpuError> {
    let bounds = source.bounds();
    let diagonal = (bounds[1] - bounds[0]).length();
    let unit = if diagonal > 0.0 && diagonal.is_finite() { diagonal.log2().round().exp2() } else { 1.0 };
    let irregular = (0..source.count()).filter(|&i| source.is_irregular(i)).count();
    device.fits("the points of the patches", points_size(source.count() - irregular, irregular))?;
    let packed = pack(source, unit);
    let storage = wgpu::BufferUsages::STORAGE;
    Ok(Tables {
        records: device.buffer("the records of the patches", &packed.records, storage)?,
        points: device.buffer("the points of the patches", &packed.points, storage)?,
        scales: device.buffer("the powers of lambda", &packed.scales, storage)?,
        cells: packed.records.iter().map(|r| r.depth as u8).zip(packed.transitions).collect(),
        origins: packed.origins,
        bounds,
        unit,
    })
}

/// What the parallel part finds out about a patch.
struct Placed {
    patch: usize,
    record: PatchRecord,
    transition: u8,
    origin: DVec3,
    lambda: f64,
}

fn pack<S: PatchSource + ?Sized>(source: &S, unit: f64) -> Packed {
    let (irregular, regular): (Vec<usize>, Vec<usize>) = (0..source.count()).partition(|&i| source.is_irregular(i));
    let split = regular.len() * REGULAR_FLOATS;
    let mut points = vec![0f32; split + irregular.len() * IRREGULAR_FLOATS];
    let (first_block, second_block) = points.split_at_mut(split);
    let place = |start: usize, size: usize, (k, (floats, &patch)): (usize, (&mut [f32], &usize))| {
        place(source.patch(patch), patch, (start + k * size) as u32, floats, unit)
    };
    let mut placed: Vec<Placed> = first_block
        .par_chunks_exact_mut(REGULAR_FLOATS)
        .zip(&regular)
        .enumerate()
        .map(|item| place(0, REGULAR_FLOATS, item))
        .chain(
            second_block
                .par_chunks_exact_mut(IRREGULAR_FLOATS)
                .zip(&irregular)
                .enumerate()
                .map(|item| place(split, IRREGULAR_FLOATS, item)),
        )
        .collect();
    placed.sort_by_key(|p| p.patch);
    let mut packed = Packed { points, ..Packed::default() };
    let mut classes: HashMap<u64, u32> = HashMap::new();
    for mut p in placed {
        if p.record.kind == KIND_IRREGULAR {
            p.record.scales = *classes.entry(p.lambda.to_bits()).or_insert_with(|| {
                let first = packed.scales.len() as u32;
                packed.scales.extend((1..=SCALE_LEVELS as i32).map(|n| scale(p.lambda, n)));
                first
            });
        }
        packed.records.push(p.record);
        packed.origins.push(p.origin);
        packed.transitions.push(p.transition);
    }
    packed
}

fn scale(lambda: f64, n: i32) -> Scale {
    Scale { position: lambda.powi(n - 1) as f32, derivative: (2.0 * (2.0 * lambda).powi(n - 1)) as f32 }
}

/// Writes the points of one patch.
fn place(patch_net: PatchNet, patch: usize, first: u32, floats: &mut [f32], unit: f64) -> Placed {
    let PatchNet { depth, transition, net, normal } = patch_net;
    let normal = normal.as_vec3().to_array();
    let mut record = PatchRecord { normal, first, kind: KIND_REGULAR, scales: 0, depth: u32::from(depth), levels: 0 };
    let mut write = |at: usize, p: DVec3| floats[3 * at..3 * at + 3].copy_from_slice(&(p / unit).as_vec3().to_array());
    let (origin, lambda) = match net {
        Net::Regular(points) => {
            let origin = points[5];
            points.iter().enumerate().for_each(|(k, &p)| write(k, p - origin));
            (origin, 0.0)
        }
        Net::Irregular { limit, lambda, levels } => {
            record.kind = KIND_IRREGULAR;
            record.levels = levels.len().min(TABLE_LEVELS) as u32;
            levels.iter().flatten().take(TABLE_LEVELS * WINDOW_POINTS).enumerate().for_each(|(k, &p)| write(k, p));
            (limit, lambda)
        }
    };
    Placed { patch, record, transition, origin, lambda }
}
