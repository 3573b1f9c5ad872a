//! Which charts may cover which tile of the picture.

use super::Chart;
use crate::gpu::shader::CHART_TILE;
use rayon::prelude::*;

/// First and end of each tile's part of the list, and the list: charts by tile, the nearest first.
pub(super) fn sorted(charts: &[&Chart], grid: [u32; 2]) -> (Vec<[u32; 2]>, Vec<u32>) {
    let mut entries: Vec<(u32, u32, u32)> = charts
        .par_iter()
        .enumerate()
        .flat_map_iter(|(index, chart)| {
            let depth = ordered(chart.near());
            tiles(chart, grid).map(move |tile| (tile, depth, index as u32))
        })
        .collect();
    entries.par_sort_unstable();
    let mut ranges = vec![[0u32; 2]; (grid[0] * grid[1]) as usize];
    for (place, &(tile, ..)) in entries.iter().enumerate() {
        let range = &mut ranges[tile as usize];
        if range[1] == 0 {
            range[0] = place as u32;
        }
        range[1] = place as u32 + 1;
    }
    (ranges, entries.into_iter().map(|(.., chart)| chart).collect())
}

/// Bits that are ordered as the numbers are.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

/// Tiles with samples in the chart's bounds and in the parallelogram that its linear map gives.
fn tiles(chart: &Chart, grid: [u32; 2]) -> impl Iterator<Item = u32> {
    let side = f64::from(CHART_TILE);
    let range = |k: usize| {
        let first = ((chart.bounds.low[k] - 1.0) / side).floor().max(0.0) as u32;
        let end = ((chart.bounds.high[k] + 1.0) / side).floor() as u32 + 1;
        first..end.min(grid[k])
    };
    let (frame, half) = (chart.frame, chart.half());
    let reaches = move |tile: [u32; 2]| {
        let d = [0, 1].map(|k| (f64::from(tile[k]) + 0.5) * side - frame.centre[k]);
        (0..2).all(|row| {
            let [a, b] = frame.inverse[row];
            (frame.start[row] + a * d[0] + b * d[1] - 0.5).abs() <= half + 0.5 * side * (a.abs() + b.abs())
        })
    };
    let columns = range(0);
    range(1)
        .flat_map(move |y| columns.clone().map(move |x| [x, y]))
        .filter(move |&tile| reaches(tile))
        .map(move |[x, y]| y * grid[0] + x)
}
