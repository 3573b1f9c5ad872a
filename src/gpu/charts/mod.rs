//! What every sample sees first, exactly: patches cut into charts, in f64.
//!
//! # Theory
//! The projection of the surface is folded at its silhouette and one-to-one elsewhere. A *chart* is a piece of a patch on which the
//! projection is so close to affine that Newton's method must find the point that a sample sees, or that there is none. With
//! G(u,v) = (x,y) - p weight (homogeneous, so that perspective needs no division), J its derivative, J0 that in the middle,
//! and q >= |J0^-1 J - 1| in the maximum norm all over the piece and for all samples p in its bounds (from the control vectors of
//! the derivative nets, which are hulls): G is one-to-one for q < 1, and a Newton step, kept inside the piece, brings (u,v)
//! nearer to the solution by 2q / (1 - q) at least, whatever the start.
//! *Proof.* G(y) - G(x) = K (y - x) with K the mean of J on the way from x to y; |J0^-1 K - 1| <= q too. For G(y) = 0 the step
//! from x leads to x' = x + J(x)^-1 K (y - x), so x' - y = (J(x)^-1 K - 1)(y - x), and |J^-1 K - 1| = |(J0^-1 J)^-1 (J0^-1 K -
//! J0^-1 J)| <= 2q / (1 - q). Clamping to the square brings x' nearer to y, which lies in it.
//!
//! # Changes
//! Yasui & Kanai 2004 evaluate at parameters that the rasteriser interpolates, so positions miss their pixels and silhouettes are
//! those of the proxy. Here nothing depends on a proxy. Pieces are halved until they are charts, out of sight (hulls beyond the
//! picture or between the centres of the samples), or cover at most a few samples, which are solved at once in f64: along silhouettes only pieces
//! that hold the centre of a sample go on being halved, so they cost some work a sample and not a mesh finer than it. No patch
//! is left to its neighbours by adjacency either: each chart answers for its own square, within 0.002 samples.
//!
//! # Practice
//! [`Charts::new`] cuts all patches for one tile of a picture, in parallel, in the order of the patches; charts go to the adapter
//! with, for each tile of [`CHART_TILE`] samples, a list of those that may cover it, nearest first (`shaders/charts.wgsl`); what
//! was solved goes along as points ([`Speck`]).

mod bins;
mod divide;
mod lens;
mod piece;
mod solve;

use super::View;
use super::records::SpeckRecord;
use super::shader::{CHART_TEXELS, CHART_TILE};
use super::tables::Tables;
use super::view::Tile;
use divide::{Divider, Harvest};
use lens::Lens;
use piece::Bounds;
use rayon::prelude::*;

/// Distance in samples within which the border of a piece is taken for its inside, so that neighbours leave no gap: a
/// hundred times what f32 rounds in a chart, a fifth of the 0.01 pixel within which silhouettes are to be right.
pub(super) const BAND: f64 = 2e-4;

/// q up to which a piece is a chart: Newton's error shrinks to a half at least each step, in practice quadratically.
const MAX_DISTORTION: f64 = 0.2;

/// How the projection of a piece looks from its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    /// Sample coordinates near the middle, exact in f32.
    centre: [f64; 2],
    /// Depth in the middle.
    depth: f64,
    /// Weight in the middle: the depth in perspective, else 1.
    weight: f64,
    /// J0^-1.
    inverse: [[f64; 2]; 2],
    /// (u,v) that the linear map gives `centre`.
    start: [f64; 2],
    /// q.
    distortion: f64,
}

/// A piece of a patch whose projection is all but affine.
#[derive(Debug)]
struct Chart {
    patch: u32,
    bounds: Bounds,
    frame: Frame,
    /// Its place in the patch.
    origin: [f64; 2],
    size: [f64; 2],
    /// Bezier points: rows of v of x, y (samples from the frame's centre, times weight) and depth.
    net: [[[f32; 4]; 3]; 4],
}

impl Chart {
    /// Half the side of the square round (1/2, 1/2) in which the linear map sees every sample that the chart covers: it errs
    /// by q times the distance from the middle.
    fn half(&self) -> f64 {
        let band = self.frame.inverse.iter().map(|[a, b]| BAND * (a.abs() + b.abs())).fold(0.0, f64::max);
        0.5 * (1.0 + self.frame.distortion) + 2.0 * band + 1e-5
    }

    /// A depth that no point of the chart is nearer than, in f32.
    fn near(&self) -> f32 {
        (self.bounds.near - self.bounds.near.abs() * 1e-6) as f32
    }

    /// As shaders/charts.wgsl reads it.
    fn texels(&self) -> [[u32; 4]; CHART_TEXELS as usize] {
        let Frame { centre, depth, inverse: [m, n], start, .. } = self.frame;
        let row = |values: [f64; 4]| values.map(|x| (x as f32).to_bits());
        let mut texels = [[0; 4]; CHART_TEXELS as usize];
        texels[0] = row([centre[0], centre[1], f64::from(self.near()), depth]);
        texels[1] = row([m[0], m[1], n[0], n[1]]);
        texels[2] = row([start[0], start[1], self.half(), 0.0]);
        texels[2][3] = self.patch;
        texels[3] = row([self.origin[0], self.origin[1], self.size[0], self.size[1]]);
        for (texel, values) in texels[4..].iter_mut().zip(self.net.as_flattened()) {
            *texel = values.map(f32::to_bits);
        }
        texels
    }
}

/// A sample that was solved on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Speck {
    sample: [u32; 2],
    patch: u32,
    uv: [f32; 2],
    depth: f32,
}

/// Everything that the samples of a tile may see.
#[derive(Debug)]
pub(super) struct Charts {
    /// [`CHART_TEXELS`] a chart.
    pub texels: Vec<[u32; 4]>,
    /// First and end of the list of each tile, row by row.
    pub tiles: Vec<[u32; 2]>,
    /// Tiles a row and a column.
    pub grid: [u32; 2],
    /// Charts, tile by tile, nearest first.
    pub list: Vec<u32>,
    /// The nearest speck of each sample that has one.
    pub specks: Vec<SpeckRecord>,
}

impl Charts {
    /// Cuts all patches as `tile` of the picture sees them.
    pub fn new(tables: &Tables, view: &View, tile: &Tile) -> Charts {
        /// Patches a job.
        const JOB: usize = 64;
        let lens = Lens::new(view, tile, view.camera.near(tables.bounds()));
        let level = view.proxy_level.unwrap_or(0) as u8;
        let count = if divide::sees_box(&lens, tables.bounds()) { tables.patches() } else { 0 };
        let harvests: Vec<Harvest> = (0..count.div_ceil(JOB))
            .into_par_iter()
            .map(|job| {
                let mut divider = Divider::new(&lens, level);
                for patch in job * JOB..((job + 1) * JOB).min(count) {
                    divider.patch(patch as u32, tables.cells[patch].0, tables.source.nets(patch));
                }
                divider.out
            })
            .collect();
        let charts: Vec<&Chart> = harvests.iter().flat_map(|harvest| &harvest.charts).collect();
        let grid = tile.size.map(|n| n.div_ceil(CHART_TILE));
        let (tiles, list) = bins::sorted(&charts, grid);
        Charts {
            texels: charts.par_iter().flat_map_iter(|chart| chart.texels()).collect(),
            tiles,
            grid,
            list,
            specks: nearest(harvests.iter().flat_map(|harvest| &harvest.specks).copied().collect(), &lens),
        }
    }
}

/// The nearest speck of each sample.
fn nearest(mut specks: Vec<Speck>, lens: &Lens) -> Vec<SpeckRecord> {
    specks.par_sort_by(|a, b| (a.sample, a.depth).partial_cmp(&(b.sample, b.depth)).expect("depths are numbers"));
    specks.dedup_by_key(|speck| speck.sample);
    let record = |speck: &Speck| SpeckRecord {
        // The centre of the sample in normalised device coordinates.
        place: [0, 1].map(|k| {
            let x = (2.0 * f64::from(speck.sample[k]) + 1.0) / lens.size[k] - 1.0;
            if k == 0 { x as f32 } else { -x as f32 }
        }),
        patch_id: speck.patch + 1,
        uv: speck.uv,
        depth: speck.depth,
    };
    specks.iter().map(record).collect()
}
