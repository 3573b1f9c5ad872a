//! What hides what: patches in two rounds, the nearer ones first, and what those leave to be seen.

use super::bounds::Bounds;
use super::lens::Lens;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Patches around one with which its depth is compared, on average.
const AROUND: usize = 64;
/// Samples a block's side.
const BLOCK: usize = 8;
/// Most blocks a side of what is looked up: larger pieces are cut anyway.
const MOST: usize = 8;

/// Whether each patch, by a point of it, is nearer than the mean of those that are seen around it: a guess at what hides
/// others, on which nothing but time depends.
pub(super) fn in_front(lens: &Lens, points: &[DVec3]) -> Vec<bool> {
    let side = (points.len() / AROUND).isqrt().max(1);
    let cell = |&point: &DVec3| {
        let p = lens.project(point);
        let weight = lens.weight(p.z.max(lens.near));
        // Casts saturate: what lies beyond the picture counts with its border.
        let [x, y] = [(p.x, lens.size[0]), (p.y, lens.size[1])]
            .map(|(x, size)| x / weight / size * side as f64)
            .map(|x| x as usize);
        (y.min(side - 1) * side + x.min(side - 1), p.z)
    };
    let cells: Vec<(usize, f64)> = points.par_iter().map(cell).collect();
    let mut sums = vec![(0.0, 0.0); side * side];
    for &(cell, depth) in &cells {
        sums[cell].0 += depth;
        sums[cell].1 += 1.0;
    }
    cells.into_par_iter().map(|(cell, depth)| depth * sums[cell].1 <= sums[cell].0).collect()
}

/// The farthest depth that is seen in each block of samples: what lies beyond it is hidden.
#[derive(Debug)]
pub(super) struct Cover {
    columns: usize,
    farthest: Vec<f64>,
}

impl Cover {
    /// Of a tile's depth buffer.
    pub fn new(lens: &Lens, shown: &[f32]) -> Cover {
        let width = lens.size[0] as usize;
        let farthest = |rows: &[f32]| {
            let mut least = vec![f32::INFINITY; width.div_ceil(BLOCK)];
            for row in rows.chunks_exact(width) {
                for (least, block) in least.iter_mut().zip(row.chunks(BLOCK)) {
                    *least = block.iter().fold(*least, |least, &shown| least.min(shown));
                }
            }
            least.into_iter().map(|shown| lens.farthest(shown)).collect::<Vec<f64>>()
        };
        let rows: Vec<Vec<f64>> = shown.par_chunks(width * BLOCK).map(farthest).collect();
        Cover { columns: width.div_ceil(BLOCK), farthest: rows.concat() }
    }

    /// Whether all samples in these ranges see something nearer than what has these bounds.
    pub fn hides(&self, bounds: &Bounds, samples: &[Range<u32>; 2]) -> bool {
        let blocks = |range: &Range<u32>| range.start as usize / BLOCK..(range.end as usize).div_ceil(BLOCK);
        let [columns, mut rows] = samples.each_ref().map(blocks);
        let is_nearer = |row: usize| {
            let at = row * self.columns;
            self.farthest[at + columns.start..at + columns.end].iter().all(|&depth| depth < bounds.near)
        };
        columns.len().max(rows.len()) <= MOST && rows.all(is_nearer)
    }
}
