//! The matrices of a class of irregular patches: normalised Stam tables (design.md 3.2).
//!
//! # Theory
//! Stam 1998 (as in Yasui & Kanai 2004, eq. 2 and 8): after n subdivisions the L-shaped rest of an irregular patch is
//! made of three B-spline windows over the points P(n) = A' A^(n-1) C, with C the K control points of the patch, A the
//! step from them to the same points one level finer and A' the step to the 24 points of the three windows.
//!
//! # Changes
//! No eigenvectors: powers of A do, so matrices without an eigenbasis (creases, boundaries) are no special case. And
//! the points are kept *normalised*, Phat(n) = (P(n) - s0) / lambda^(n-1), so that they stay of the size of the control
//! net and converge to the characteristic map; both are computed from the deflated matrix B = A - 1 l0, without which
//! the constant part of A^n would swamp them after some 40 levels.
//!
//! # Practice
//! [`ClassTable::new`] builds the matrices of one class; patches of the class share them.

use super::rows::{Row, Rows};
use crate::patch::{RingClass, Tip};
use std::f64::consts::{PI, TAU};

/// Levels kept in f64: the smallest u or v above zero that doubles near 1 resolve.
pub const LEVELS: usize = 52;

/// Points of the three windows of a level: a 5x5 grid without its corner at (-1,-1).
pub const WINDOW_POINTS: usize = 24;

/// Matrices shared by all patches of a class.
#[derive(Debug)]
pub struct ClassTable {
    /// lambda: largest eigenvalue of the subdivision matrix below 1.
    pub lambda: f64,
    /// l0: weights of the control points in the limit position of the extraordinary vertex.
    pub limit: Vec<f64>,
    /// Weights of the control points in two tangents of the limit surface at a smooth extraordinary vertex, their cross
    /// product along the normal: the table itself converges to them like (next eigenvalue / lambda)^n, which for high
    /// valence is slow (0.82^n for N = 8).
    pub tangents: Option<[Vec<f64>; 2]>,
    /// Mhat(n) at `levels[n-1]`, [`WINDOW_POINTS`] rows of K weights: Phat(n) = Mhat(n) C.
    levels: Vec<Vec<f64>>,
}

impl ClassTable {
    /// Builds the matrices of a class.
    pub fn new(class: RingClass) -> Self {
        let rows = Rows::new(class);
        let step = rows.step();
        let size = step.len();
        let limit = left_eigenvector_of_one(&step);
        let lambda = subdominant_eigenvalue(class, &step, &limit);

        let windows = (1..=WINDOW_POINTS as isize).map(|k| rows.refined(k % 5 - 1, k / 5 - 1));
        let mut level: Vec<f64> = windows
            .flat_map(|row| {
                let mut dense: Vec<f64> = limit.iter().map(|&w| -w).collect();
                row.iter().for_each(|&(k, w)| dense[k] += w);
                dense
            })
            .collect();
        let mut levels = Vec::with_capacity(LEVELS);
        while levels.len() < LEVELS {
            let next = level.chunks_exact(size).flat_map(|row| deflated_step(row, &step, &limit, lambda)).collect();
            levels.push(std::mem::replace(&mut level, next));
        }
        let smooth = class.closed && class.tip == Tip::Smooth && class.sharp_spoke.is_none();
        let tangents = smooth.then(|| smooth_tangents(usize::from(class.faces), size));
        Self { lambda, limit, tangents, levels }
    }

    /// Number of levels.
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Weights of the K control points in window point `point` (0 to [`WINDOW_POINTS`]) of level `level`, 1 to
    /// [`LEVELS`].
    pub fn weights(&self, level: usize, point: usize) -> &[f64] {
        let size = self.limit.len();
        &self.levels[level - 1][point * size..(point + 1) * size]
    }

    /// Memory that the matrices take.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.as_slice())).sum()
    }
}

/// A row vector times B / lambda, B = A - 1 l0.
fn deflated_step(row: &[f64], step: &[Row], limit: &[f64], lambda: f64) -> Vec<f64> {
    let constant: f64 = row.iter().sum();
    let mut out: Vec<f64> = limit.iter().map(|&w| -constant * w).collect();
    for (&x, entries) in row.iter().zip(step) {
        entries.iter().for_each(|&(k, w)| out[k] += x * w);
    }
    out.iter_mut().for_each(|x| *x /= lambda);
    out
}

/// l0 with l0 A = l0 and sum 1, by power iteration: the other eigenvalues are at most (6 + sqrt 20) / 16 = 0.655, so 128
/// steps leave 1e-23.
fn left_eigenvector_of_one(step: &[Row]) -> Vec<f64> {
    let mut limit = vec![0.0; step.len()];
    limit[0] = 1.0;
    for _ in 0..128 {
        let mut next = vec![0.0; step.len()];
        for (&x, entries) in limit.iter().zip(step) {
            entries.iter().for_each(|&(k, w)| next[k] += x * w);
        }
        let sum: f64 = next.iter().sum();
        limit = next.into_iter().map(|x| x / sum).collect();
    }
    limit
}

/// Largest eigenvalue below 1.
///
/// Where the ring decouples into Fourier modes it is known: mode angle 2 pi / N for a smooth vertex (Stam 1998, appendix
/// A), pi / k between the two fixed edges of a sector, 0 round a fixed vertex; along a sharp edge it is 1/2. Only a dart,
/// whose sharp edge mixes the modes, is iterated: its matrix has an eigenbasis.
fn subdominant_eigenvalue(class: RingClass, step: &[Row], limit: &[f64]) -> f64 {
    let mode = |angle: f64| {
        let c = angle.cos();
        (5.0 + c + ((9.0 + c) * (1.0 + c)).sqrt()) / 16.0
    };
    let faces = f64::from(class.faces);
    match (class.closed, class.tip, class.sharp_spoke) {
        (true, Tip::Smooth, None) => mode(TAU / faces),
        (true, Tip::Smooth, Some(_)) => iterated_eigenvalue(step, limit),
        (true, _, _) => mode(0.0),
        (false, _, _) => mode(PI / faces).max(0.5),
    }
}

/// Left eigenvectors of lambda at a smooth vertex of valence N: Halstead, Kass & DeRose 1993, appendix A. The two are the
/// cosine and the sine mode, so the second leads the first by a quarter of the way round.
fn smooth_tangents(valence: usize, size: usize) -> [Vec<f64>; 2] {
    let angle = TAU / valence as f64;
    let spoke = 1.0 + angle.cos() + (angle / 2.0).cos() * (2.0 * (9.0 + angle.cos())).sqrt();
    [0.0, 0.25 * TAU].map(|phase| {
        let wave = |i: usize| (i as f64 * angle - phase).cos();
        let mut weights = vec![0.0; size];
        for i in 0..valence {
            weights[1 + i] = spoke * wave(i);
            weights[1 + valence + i] = wave(i) + wave(i + 1);
        }
        weights
    })
}

/// Largest eigenvalue of B in absolute value, by power iteration on its transpose.
fn iterated_eigenvalue(step: &[Row], limit: &[f64]) -> f64 {
    // No symmetry, so that no mode is missed.
    let mut vector: Vec<f64> = (0..step.len()).map(|k| (0.7 * k as f64).sin()).collect();
    let mut eigenvalue = 0.0;
    for _ in 0..2000 {
        let next = deflated_step(&vector, step, limit, 1.0);
        let [length, before] = [&next, &vector].map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt());
        eigenvalue = length / before;
        vector = next.into_iter().map(|x| x / length).collect();
    }
    eigenvalue
}

#[cfg(test)]
mod tests {
    use super::*;

    fn class(faces: u16, closed: bool, tip: Tip, sharp_spoke: Option<u16>) -> RingClass {
        RingClass { faces, closed, index: 0, tip, sharp_spoke }
    }

    #[test]
    fn closed_forms_are_the_iterated_eigenvalues() {
        let smooth = (2..=20).map(|n| class(n, true, Tip::Smooth, None));
        let cones = (3..=8).map(|n| class(n, true, Tip::Corner, None));
        // Sectors of 1, 2 and 4 faces have equal or defective eigenvalues at 1/2 or below the largest: iteration is slow
        // there, not the formula wrong; the others converge.
        let sectors =
            [3, 5, 6, 7].into_iter().flat_map(|k| [Tip::Crease, Tip::Corner].map(|tip| class(k, false, tip, None)));
        for class in smooth.chain(cones).chain(sectors) {
            let table = ClassTable::new(class);
            let iterated = iterated_eigenvalue(&Rows::new(class).step(), &table.limit);
            assert!((iterated - table.lambda).abs() < 1e-12, "{class:?}: {iterated} against {}", table.lambda);
        }
    }

    #[test]
    fn limit_weights_of_smooth_vertices_are_the_known_ones() {
        // Halstead, Kass & DeRose 1993, section 3.1: N^2, 4 and 1 over N (N + 5).
        for n in 3..=12u16 {
            let table = ClassTable::new(class(n, true, Tip::Smooth, None));
            let valence = f64::from(n);
            let unit = 1.0 / (valence * (valence + 5.0));
            let expected = |k: usize| match k {
                0 => valence * valence * unit,
                k if k <= usize::from(n) => 4.0 * unit,
                k if k <= 2 * usize::from(n) => unit,
                _ => 0.0,
            };
            for (k, &weight) in table.limit.iter().enumerate() {
                assert!((weight - expected(k)).abs() < 1e-15, "N = {n}, point {k}: {weight}");
            }
        }
    }

    #[test]
    fn tangents_are_left_eigenvectors() {
        for n in 3..=12 {
            let class = class(n, true, Tip::Smooth, None);
            let table = ClassTable::new(class);
            let step = Rows::new(class).step();
            for tangent in table.tangents.as_ref().expect("a smooth vertex has tangents") {
                let next = deflated_step(tangent, &step, &table.limit, table.lambda);
                let change = next.iter().zip(tangent).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(change < 1e-14, "N = {n}: {change}");
            }
        }
    }

    #[test]
    fn tables_converge_to_the_characteristic_map() {
        // By the ratio of the next eigenvalue to lambda, 50 times: 1e-11 for valence 8, which has the slowest of these
        // smooth vertices; beside the sharp edge of a dart the ratio is 1/2 to 0.55.
        let dart = class(5, true, Tip::Smooth, Some(2));
        let smooth = [3, 5, 8].map(|n| (class(n, true, Tip::Smooth, None), (0.5f64 / 0.611).powi(50)));
        for (class, shrunk) in smooth.into_iter().chain([(dart, (0.5f64 / 0.55).powi(50))]) {
            let table = ClassTable::new(class);
            let change = |n: usize| {
                table.levels[n].iter().zip(&table.levels[n - 1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            assert!(change(LEVELS - 1) < 10.0 * shrunk * change(1), "{class:?}: {} {}", change(1), change(LEVELS - 1));
        }
    }
}
