//! A few points of a Stam table that give all the others: the compact form of a class.
//!
//! # Theory
//! The points of all levels are linear in the K control points: Phat = M C, one row of M a point
//! ([`ClassTable::weights`]). An interpolative decomposition (Cheng, Gimbutas, Martinsson & Rokhlin 2005, "On the
//! compression of low rank matrices") picks r rows S of M and writes M = U S up to a tolerance, so Phat = U (S C): r points
//! of the table itself and a matrix that patches of the class share.
//!
//! # Changes
//! The obvious compact form stores the K control points, Phat = M C, whose products cancel: entries of M have both signs and sum to
//! zero. Here the rows are picked by pivoting, so that U has small entries (absolute values that sum to 3 to 10 in a row up
//! to valence 12) and normals are as exact as those of the expanded table. And r is below K: 17 of 18 points for
//! valence 5, 25 of 30 for valence 11 without the first four levels, for modes that have decayed below f32's rounding are
//! not stored.
//!
//! # Practice
//! [`Basis::new`] by Gram-Schmidt with row pivots, in f64, some 0.3 ms for a class of valence 5.

use super::TABLE_LEVELS;
use crate::kept::Kept;
use crate::patch::RingClass;
use crate::stam::{ClassTable, WINDOW_POINTS};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Rows of M that are left out are below this part of the largest row: half of f32's rounding (2^-24), so that what is
/// left out and what is rounded are alike.
const TOLERANCE: f64 = 1.0 / (1u64 << 25) as f64;

/// The picked points of a class and how all points of its levels follow from them.
#[derive(Debug)]
pub(super) struct Basis {
    /// Level (from 1) and window point of each picked point.
    pub picked: Vec<[usize; 2]>,
    /// U: a row of `picked.len()` weights for each of the [`WINDOW_POINTS`] points of each level.
    pub weights: Vec<f64>,
}

/// Bases of classes that came up, by class and first level.
static SHARED: Kept<(RingClass, usize), Option<Arc<Basis>>> = Kept::new();

impl Basis {
    /// As [`new`](Self::new), of the levels from `first` on; those of classes that are kept for other meshes are kept too.
    pub fn shared(table: &ClassTable, first: usize) -> Option<Arc<Basis>> {
        let build = || Basis::new(table, first..=TABLE_LEVELS).map(Arc::new);
        match table.is_shared() {
            true => Option::clone(&SHARED.get((table.class(), first), build)),
            false => build(),
        }
    }

    /// Decomposes these levels of a class; `None` for large classes, which keep no matrices (more than 16 faces): their
    /// patches are few and stay expanded.
    pub fn new(table: &ClassTable, levels: RangeInclusive<usize>) -> Option<Basis> {
        let points: Vec<[usize; 2]> = levels.flat_map(|n| (0..WINDOW_POINTS).map(move |p| [n, p])).collect();
        let mut rest: Vec<Vec<f64>> =
            points.iter().map(|&[level, p]| Some(table.weights(level, p)?.to_vec())).collect::<Option<_>>()?;
        let largest = |rows: &[Vec<f64>]| {
            let sizes = rows.iter().map(|row| dot(row, row)).enumerate();
            sizes.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
        };
        let smallest = TOLERANCE.powi(2) * largest(&rest).1;
        let (mut directions, mut chosen): (Vec<Vec<f64>>, Vec<usize>) = Default::default();
        let mut coordinates: Vec<Vec<f64>> = vec![Vec::new(); points.len()];
        loop {
            let (pivot, size) = largest(&rest);
            if size <= smallest || chosen.len() == rest[pivot].len() {
                break;
            }
            let mut direction = rest[pivot].clone();
            // What rounding left of earlier directions, which counts once the rest is small.
            for earlier in &directions {
                subtract(&mut direction, earlier, dot(&rest[pivot], earlier));
            }
            let length = dot(&direction, &direction).sqrt();
            direction.iter_mut().for_each(|x| *x /= length);
            for (row, own) in rest.iter_mut().zip(&mut coordinates) {
                let along = dot(row, &direction);
                subtract(row, &direction, along);
                own.push(along);
            }
            chosen.push(pivot);
            directions.push(direction);
        }
        let triangle: Vec<Vec<f64>> = chosen.iter().map(|&pivot| coordinates[pivot].clone()).collect();
        coordinates.iter_mut().for_each(|row| solve(&triangle, row));
        let picked = chosen.iter().map(|&pivot| points[pivot]).collect();
        Some(Basis { picked, weights: coordinates.concat() })
    }

    /// Groups of four points that the picked ones fill.
    pub fn groups(&self) -> usize {
        self.picked.len().div_ceil(4)
    }

    /// Weights of window point `point` of the `level`-th level (from 0) of the basis.
    pub fn row(&self, level: usize, point: usize) -> &[f64] {
        let size = self.picked.len();
        &self.weights[(level * WINDOW_POINTS + point) * size..][..size]
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn subtract(from: &mut [f64], what: &[f64], factor: f64) {
    from.iter_mut().zip(what).for_each(|(x, y)| *x -= factor * y);
}

/// Replaces coordinates c along the directions by weights u of the picked rows: u R = c, R lower triangular.
fn solve(triangle: &[Vec<f64>], row: &mut [f64]) {
    for k in (0..row.len()).rev() {
        row[k] /= triangle[k][k];
        let weight = row[k];
        subtract(&mut row[..k], &triangle[k][..k], weight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::Tip;

    fn classes() -> Vec<RingClass> {
        let class = |faces, closed, index, tip, sharp_spoke| RingClass {
            triangles: false,
            faces,
            closed,
            index,
            tip,
            sharp_spoke,
        };
        let smooth = (2..=16).map(|n| class(n, true, 0, Tip::Smooth, None));
        let darts = (0..5).map(|spoke| class(5, true, 0, Tip::Smooth, Some(spoke)));
        let sectors = [1, 3, 4, 6].into_iter().flat_map(|k| {
            let tips = [Tip::Crease, Tip::Corner].into_iter();
            tips.flat_map(move |tip| (0..k).map(move |index| class(k, false, index, tip, None)))
        });
        smooth.chain(darts).chain(sectors).collect()
    }

    #[test]
    fn picked_points_give_all_points() {
        for class in classes() {
            let table = ClassTable::new(class);
            let size = table.support();
            let weights = |level, point| table.weights(level, point).expect("a class that keeps its matrices");
            for first in [1, 5] {
                let basis = Basis::new(&table, first..=TABLE_LEVELS).expect("a class that keeps its matrices");
                let (mut worst, mut norm, mut entries) = (0.0f64, 0.0f64, 0.0f64);
                for level in first..=TABLE_LEVELS {
                    for point in 0..WINDOW_POINTS {
                        let row = basis.row(level - first, point);
                        let mut rest = weights(level, point).to_vec();
                        norm = norm.max(dot(&rest, &rest).sqrt());
                        for (&weight, &[level, point]) in row.iter().zip(&basis.picked) {
                            subtract(&mut rest, weights(level, point), weight);
                        }
                        worst = worst.max(dot(&rest, &rest).sqrt());
                        entries = entries.max(row.iter().map(|w| w.abs()).sum());
                    }
                }
                println!(
                    "{class:?} from {first}: {} of {size} points, deepest {}, weights {entries:.1}, left out {:e}",
                    basis.picked.len(),
                    basis.picked.iter().map(|&[level, _]| level).max().unwrap_or(0),
                    worst / norm,
                );
                assert!(worst <= 2.0 * TOLERANCE * norm, "{class:?}: {worst:e} of {norm}");
                // Rounding of the picked points is multiplied by the sum of the weights.
                assert!(entries < 32.0, "{class:?}: weights sum to {entries}");
            }
        }
    }
}
