//! Fills the textures.

use super::basis::Basis;
use super::layout::{Plan, TRANSFORM_TEXELS};
use super::{PatchNet, PatchSource, TABLE_LEVELS, TableNet};
use crate::adaptive::Gregory;
use crate::gpu::GpuError;
use crate::gpu::device::Device;
use crate::gpu::shader::{KIND_GREGORY, KIND_IRREGULAR, KIND_REGULAR, SCALE_LEVELS};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Texels that are computed before they are handed to the adapter: 1 MiB, which caches keep.
const BATCH: usize = 1 << 16;

/// First points of the windows' rows in a level's grid of 5x5 points without the first: the rows of
/// the windows at u >= 1, then those at u < 1.
const WINDOW_ROWS: [usize; 9] = [0, 5, 10, 15, 20, 4, 9, 14, 19];

/// Contents of the textures; the points are on the adapter already.
pub(super) struct Packed {
    pub points: wgpu::Texture,
    pub records: Vec<[u32; 4]>,
    pub scales: Vec<[f32; 2]>,
    pub origins: Vec<DVec3>,
    pub cells: Vec<([u8; 2], u8)>,
}

/// What the parallel part finds out about a patch.
struct Placed {
    record: [u32; 4],
    cell: ([u8; 2], u8),
    origin: DVec3,
    lambda: Option<f64>,
}

pub(super) fn pack<S: PatchSource + ?Sized>(
    device: &Device,
    source: &S,
    plan: &Plan,
    unit: f64,
) -> Result<Packed, GpuError> {
    let format = wgpu::TextureFormat::Rgba32Float;
    let mut writer = device.block_table("the points of the patches", plan.texels, format)?;
    let mut next = plan.transforms.len() * TRANSFORM_TEXELS;
    if next > 0 {
        place_transforms(&plan.transforms, writer.room(next));
        writer.flush();
    }
    let instance = |patch: usize| (!plan.transforms.is_empty()).then(|| source.instance(patch)).flatten();
    let mut matrices = Vec::with_capacity(plan.bases.len());
    for class in 0..plan.bases.len() {
        let size = plan.matrix_texels(class);
        if let Some(basis) = plan.basis(class) {
            place_matrix(basis, writer.room(size));
            writer.flush();
        }
        matrices.push(next as u32);
        next += size;
    }

    let count = source.count();
    let (mut records, mut origins, mut cells) =
        (Vec::with_capacity(count), Vec::with_capacity(count), Vec::with_capacity(count));
    let mut scales = Scales::default();
    while records.len() < count {
        let mut jobs: Vec<(usize, usize, usize)> = Vec::new();
        let start = next;
        let mut end = records.len();
        while end < count && next - start < BATCH {
            let patch = end;
            end += 1;
            if instance(patch).is_some() {
                continue;
            }
            let size = plan.patch_texels(source.storage(patch), source.class(patch));
            jobs.push((patch, next, size));
            next += size;
        }
        let mut rest = writer.room(next - start);
        let mut slots = Vec::with_capacity(jobs.len());
        for &(patch, first, size) in &jobs {
            let (slot, after) = rest.split_at_mut(size);
            slots.push((patch, first, slot));
            rest = after;
        }
        let place = |(patch, first, slot): (usize, usize, &mut [[f32; 4]])| {
            let class = source.class(patch);
            let basis = class.and_then(|class| plan.basis(class));
            let levels = if basis.is_some() { plan.expanded } else { TABLE_LEVELS };
            let picked = basis.map_or(Vec::new(), |basis| source.picked(patch, &basis.picked));
            let mut placed = place(source.patch(patch, levels), picked, slot, unit);
            placed.record[0] = first as u32;
            placed.record[3] = class.and_then(|class| matrices.get(class)).copied().unwrap_or(0);
            placed
        };
        let placed: Vec<Placed> = slots.into_par_iter().map(place).collect();
        writer.flush();
        let mut placed = placed.into_iter();
        for patch in records.len()..end {
            if let Some((original, transform)) = instance(patch) {
                let [first, kind, scale, matrix]: [u32; 4] = records[original];
                records.push([first, kind, scale | (transform as u32 + 1) << 16, matrix]);
                origins.push(plan.transforms[transform].transform_point3(origins[original]));
                cells.push(cells[original]);
            } else if let Some(mut p) = placed.next() {
                p.record[2] = p.lambda.map_or(0, |lambda| scales.first(lambda));
                records.push(p.record);
                origins.push(p.origin);
                cells.push(p.cell);
            }
        }
    }
    Ok(Packed { points: writer.finish()?, records, scales: scales.texels, origins, cells })
}

/// lambda^m and 2^(m+1) lambda^m for each level m+1 of each lambda.
#[derive(Default)]
struct Scales {
    texels: Vec<[f32; 2]>,
    known: HashMap<u64, u32>,
}

impl Scales {
    fn first(&mut self, lambda: f64) -> u32 {
        *self.known.entry(lambda.to_bits()).or_insert_with(|| {
            let first = self.texels.len() as u32;
            let scale = |m: i32| [lambda.powi(m) as f32, (2.0 * (2.0 * lambda).powi(m)) as f32];
            self.texels.extend((0..SCALE_LEVELS as i32).map(scale));
            first
        })
    }
}

/// The columns of the matrices, three texels each; translations are in the origins of patches.
fn place_transforms(transforms: &[DAffine3], texels: &mut [[f32; 4]]) {
    let columns = transforms.iter().flat_map(|transform| transform.matrix3.to_cols_array_2d());
    for (texel, [x, y, z]) in texels.iter_mut().zip(columns) {
        *texel = [x as f32, y as f32, z as f32, 0.0];
    }
}

/// The matrix of a class: level by level, picked point by picked point, its weights in the 9 rows of a level.
fn place_matrix(basis: &Basis, texels: &mut [[f32; 4]]) {
    let picked = 4 * basis.groups();
    for (i, texel) in texels.iter_mut().enumerate() {
        let (row, k, level) = (WINDOW_ROWS[i % 9], i / 9 % picked, i / 9 / picked);
        *texel = std::array::from_fn(|i| basis.row(level, row + i).get(k).map_or(0.0, |&weight| weight as f32));
    }
}

/// The points of a 4x4 net relative to the sixth, each row but the first as its difference from the one before: see
/// shaders/shared/tables.wgsl.
fn differences(points: &[DVec3; 16]) -> [DVec3; 16] {
    std::array::from_fn(|k| points[k] - if k < 4 { points[5] } else { points[k - 4] })
}

/// Writes the texels of one patch; the record lacks what other patches decide.
fn place(net: PatchNet, mut picked: Vec<DVec3>, texels: &mut [[f32; 4]], unit: f64) -> Placed {
    let PatchNet { levels: cell, transition, net } = net;
    let mut at = 0;
    let mut row = |points: &[DVec3]| {
        let local: [DVec3; 4] = std::array::from_fn(|k| points[k] / unit);
        texels[at] = local.map(|p| p.x as f32);
        texels[at + 1] = local.map(|p| p.y as f32);
        texels[at + 2] = local.map(|p| p.z as f32);
        at += 3;
    };
    let (origin, kind, levels, groups, lambda) = match net {
        TableNet::Regular(points) => {
            differences(&points).chunks_exact(4).for_each(row);
            (points[5], KIND_REGULAR, 0, 0, None)
        }
        TableNet::Gregory(Gregory { bezier, spread }) => {
            differences(&bezier).chunks_exact(4).for_each(&mut row);
            row(&spread);
            (bezier[5], KIND_GREGORY, 0, 0, None)
        }
        TableNet::Irregular { limit, normal, lambda, levels } => {
            levels.iter().for_each(|grid| WINDOW_ROWS.iter().for_each(|&i| row(&grid[i..i + 4])));
            picked.resize(picked.len().next_multiple_of(4), DVec3::ZERO);
            picked.chunks_exact(4).for_each(&mut row);
            let [x, y, z] = normal.as_vec3().to_array();
            texels[at] = [x, y, z, 0.0];
            (limit, KIND_IRREGULAR, levels.len() as u32, picked.len() as u32 / 4, Some(lambda))
        }
        TableNet::Triangle(points) => {
            // Four zeros fill the last row.
            let origin = points[4];
            let local: [DVec3; 16] = std::array::from_fn(|k| points.get(k).map_or(DVec3::ZERO, |&p| p - origin));
            local.chunks_exact(4).for_each(row);
            (origin, KIND_REGULAR, 0, 0, None)
        }
        TableNet::IrregularTriangle { limit, normal, lambda, levels } => {
            levels.iter().take(TABLE_LEVELS).for_each(|points| points.chunks_exact(4).for_each(&mut row));
            let [x, y, z] = normal.as_vec3().to_array();
            texels[at] = [x, y, z, 0.0];
            (limit, KIND_IRREGULAR, levels.len().min(TABLE_LEVELS) as u32, 0, Some(lambda))
        }
    };
    let kind = kind | u32::from(cell[0]) << 8 | u32::from(cell[1]) << 12;
    Placed { record: [0, kind | levels << 16 | groups << 21, 0, 0], cell: (cell, transition), origin, lambda }
}
