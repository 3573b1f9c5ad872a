//! What every sample sees first, exactly: patches cut into charts, in f64.
//!
//! # Theory
//! The projection of the surface is folded at its silhouette and one-to-one elsewhere. A *chart* is a piece of a patch on which the
//! projection is so close to affine that Newton's method must find the point that a sample sees, or that there is none. With
//! G(u,v) = (x,y) - p weight (homogeneous, so that perspective needs no division), J its derivative, J0 that in the middle,
//! J0^-1 J = 1 + E, and all norms the maximum norm: let E change by at most b from side to side of the piece (by the control
//! vectors of the second derivatives, which are hulls), and |E| <= q, q >= b/2, for all samples p in its bounds. Then G is
//! one-to-one for q < 1, and a Newton step, kept inside the piece, brings (u,v) nearer to the solution by q / (1 - q) at least,
//! whatever the start.
//! *Proof.* G(y) - G(x) = J0 (1 + M) (y - x) with M the mean of E on the way from x to y, so |M| <= q. For G(y) = 0 the step
//! from x leads to x' = x + J(x)^-1 J0 (1 + M) (y - x), so x' - y = (1 + E(x))^-1 (M - E(x)) (y - x). On the way E departs from
//! E(x) by at most b times the part of the side that is gone, in the mean by b/2 <= q. Clamping to the square brings x' nearer to
//! y, which lies in it.
//!
//! # Changes
//! Yasui & Kanai 2004 evaluate at parameters that the rasteriser interpolates, so positions miss their pixels and silhouettes are
//! those of the proxy. Here nothing depends on a proxy. Pieces are halved until they are charts, out of sight (hulls beyond the
//! picture or between the centres of the samples), or cover at most a few samples, which are solved at once in f64: along silhouettes only pieces
//! that hold the centre of a sample go on being halved, so they cost some work a sample and not a mesh finer than it. No patch
//! is left to its neighbours by adjacency either: each chart answers for its own square, within 2e-4 samples.
//!
//! Squares of a triangle's parameters end at its diagonal: what is found beyond is left out ([`triangle`]).
//!
//! # Practice
//! [`Cutter`] cuts all patches for one tile of a picture, in parallel, in the order of the patches; the adapter draws every
//! chart as the parallelogram that must hold it, with Newton's method in each fragment (`shaders/charts.wgsl`) and depth from the
//! point that was found, and what was solved here as points ([`SpeckRecord`]); the depth buffer keeps what is seen first.
//!
//! Many patches are cut in two rounds: the nearer half, then the rest but for all that lies beyond what the depth buffer shows
//! of the first ([`Cover`]). That is no approximation: those pieces would have lost every depth test.

mod bounds;
mod cover;
mod divide;
mod frame;
mod lens;
mod net;
mod piece;
mod solve;
mod triangle;

use super::View;
use super::records::{ChartRecord, LensRecord, SpeckRecord};
use super::tables::Tables;
use super::view::Tile;
use super::watch::Watch;
use cover::Cover;
use divide::{Divider, Harvest};
use lens::Lens;
use rayon::prelude::*;

/// Distance in samples within which the border of a piece is taken for its inside, so that neighbours leave no gap: ten
/// times what f32 rounds in a chart, a fiftieth of the 0.01 pixel within which silhouettes are to be right.
pub(super) const BAND: f64 = 2e-4;

/// q up to which a piece is a chart, below 1/2: Newton's error shrinks by a fifth at least each step, in practice quadratically.
const MAX_DISTORTION: f64 = 0.45;

/// What the samples of a tile may see.
#[derive(Debug)]
pub(super) struct Charts {
    pub charts: Vec<ChartRecord>,
    pub specks: Vec<SpeckRecord>,
    pub lens: LensRecord,
    /// Whether they are drawn over others.
    pub is_rest: bool,
}

/// Cuts patches as a tile of a picture sees them: all at once or, where they are many, the nearer half first and then what that
/// does not hide.
#[derive(Debug)]
pub(super) struct Cutter<'a> {
    tables: &'a Tables,
    lens: Lens,
    /// Parts that every face is cut into at least, as a level.
    level: u8,
    /// Which patches come first; all of them if `None`.
    in_front: Option<Vec<bool>>,
}

impl<'a> Cutter<'a> {
    pub fn new(tables: &'a Tables, view: &View, tile: &Tile) -> Cutter<'a> {
        /// Patches from which on two rounds pay: to look at the depth buffer between them takes some milliseconds.
        const MANY: usize = 8192;
        let lens = Lens::new(view, tile, tables.bounds());
        let in_front = (tables.patches() >= MANY).then(|| cover::in_front(&lens, &tables.origins));
        Cutter { tables, lens, level: view.proxy_level.unwrap_or(0) as u8, in_front }
    }

    /// The charts that come first.
    pub fn first(&self, watch: Watch<'_>) -> Charts {
        self.cut(None, watch, |patch| self.in_front.as_ref().is_none_or(|in_front| in_front[patch]))
    }

    /// Whether that leaves patches over.
    pub fn has_rest(&self) -> bool {
        self.in_front.is_some()
    }

    /// The other charts, but for what is hidden by those that the depth buffer shows.
    pub fn rest(&self, depths: &[f32], watch: Watch<'_>) -> Charts {
        let cover = Cover::new(&self.lens, depths);
        self.cut(Some(&cover), watch, |patch| self.in_front.as_ref().is_some_and(|in_front| !in_front[patch]))
    }

    fn cut(&self, cover: Option<&Cover>, watch: Watch<'_>, is_meant: impl Fn(usize) -> bool + Sync) -> Charts {
        /// Patches a job.
        const JOB: usize = 64;
        let Cutter { tables, lens, level, .. } = self;
        let count = if divide::sees_box(lens, tables.bounds()) { tables.patches() } else { 0 };
        let done_one = watch.count(count.div_ceil(JOB));
        let harvests: Vec<Harvest> = (0..count.div_ceil(JOB))
            .into_par_iter()
            .map(|job| {
                let mut divider = Divider::new(lens, *level, cover);
                for patch in (job * JOB..((job + 1) * JOB).min(count)).filter(|&patch| is_meant(patch)) {
                    divider.patch(patch as u32, tables.cells[patch].0, tables.source.nets(patch));
                }
                done_one();
                divider.out
            })
            .collect();
        let charts: Vec<&[ChartRecord]> = harvests.iter().map(|harvest| harvest.charts.as_slice()).collect();
        let specks: Vec<&[SpeckRecord]> = harvests.iter().map(|harvest| harvest.specks.as_slice()).collect();
        Charts { charts: charts.concat(), specks: specks.concat(), lens: lens.record(), is_rest: cover.is_some() }
    }
}
