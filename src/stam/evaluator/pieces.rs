//! From the control points of patches to bicubic pieces of ptex faces.
//!
//! A regular patch is one bicubic. An irregular one has three on each level n of its Stam table (docs/LIMIT.md, section 4), on squares
//! half as large each time; those of the first [`PIECE_LEVELS`] levels are stored. Both are linear in the control points, and patches of a
//! class share the matrix, so that a patch costs one small dense product.

use super::polynomial::{Piece, Product};
use super::real::{Real, vectorized};
use crate::patch::Patch;
use crate::stam::{ClassTable, LimitSurface, WINDOWS};
use glam::DVec3;
use rayon::prelude::*;

/// Levels of an irregular patch that are stored: all of it but 4^-4 of its area.
pub const PIECE_LEVELS: usize = 4;

/// Pieces of an irregular patch.
const IRREGULAR_PIECES: usize = 3 * PIECE_LEVELS;

/// Power coefficients of the four cubic B-splines about the middle of their interval: row p has those of t^p.
const POWERS: [[f64; 4]; 4] = [
    [1.0 / 48.0, 23.0 / 48.0, 23.0 / 48.0, 1.0 / 48.0],
    [-1.0 / 8.0, -5.0 / 8.0, 5.0 / 8.0, 1.0 / 8.0],
    [1.0 / 4.0, -1.0 / 4.0, -1.0 / 4.0, 1.0 / 4.0],
    [-1.0 / 6.0, 1.0 / 2.0, -1.0 / 2.0, 1.0 / 6.0],
];

/// Where the pieces of patches are.
#[derive(Debug, Clone)]
pub struct Plan {
    /// First piece of each patch, and at the end their number. Patches that have none are evaluated by the reference.
    pub first: Vec<u32>,
    regular: Vec<f64>,
    /// By class: a column of 16 coefficients for each piece, for each control point; none for classes that keep no matrices.
    classes: Vec<Option<Vec<f64>>>,
}

impl Plan {
    pub fn new(surface: &LimitSurface) -> Self {
        let classes: Vec<Option<Vec<f64>>> = match surface.has_triangles() {
            true => vec![None; surface.tables().len()],
            false => surface.tables().par_iter().map(irregular_matrix).collect(),
        };
        let mut first = Vec::with_capacity(surface.patches().len() + 1);
        let mut pieces = 0;
        for patch in 0..surface.patches().len() {
            first.push(pieces);
            pieces += match surface.class(patch) {
                None => u32::from(!surface.has_triangles()),
                Some(class) if classes[class].is_some() => IRREGULAR_PIECES as u32,
                Some(_) => 0,
            };
        }
        first.push(pieces);
        Self { first, regular: regular_matrix(), classes }
    }

    /// Number of pieces.
    pub fn count(&self) -> usize {
        self.first.last().map_or(0, |&count| count as usize)
    }

    /// The patch that a piece is of, and the middle of the piece in its parameters.
    pub fn patch(&self, piece: u32) -> (usize, [f64; 2]) {
        let patch = self.first.partition_point(|&first| first <= piece) - 1;
        let own = (piece - self.first[patch]) as usize;
        match self.first[patch + 1] - self.first[patch] {
            1 => (patch, [0.5; 2]),
            _ => (patch, middle(own / 3 + 1, own % 3)),
        }
    }

    /// Computes all pieces.
    pub fn fill<T: Real>(&self, surface: &LimitSurface, pieces: &mut [Piece<T>]) {
        const JOB: usize = 256;
        let patches = surface.patches().len();
        let (mut jobs, mut rest) = (Vec::new(), pieces);
        for start in (0..patches).step_by(JOB) {
            let end = (start + JOB).min(patches);
            let (own, others) = rest.split_at_mut((self.first[end] - self.first[start]) as usize);
            jobs.push((start..end, own));
            rest = others;
        }
        jobs.into_par_iter().for_each_init(Scratch::default, |scratch, (range, mut own)| {
            for patch in range {
                let (pieces, others) = own.split_at_mut((self.first[patch + 1] - self.first[patch]) as usize);
                self.fill_patch(surface, patch, scratch, pieces);
                own = others;
            }
        });
    }

    fn fill_patch<T: Real>(
        &self,
        surface: &LimitSurface,
        patch: usize,
        scratch: &mut Scratch,
        pieces: &mut [Piece<T>],
    ) {
        if pieces.is_empty() {
            return;
        }
        let (matrix, origin) = match surface.class(patch) {
            None => {
                let net = surface.regular_net(patch);
                scratch.take(net.iter().map(|point| *point - net[5]));
                (&self.regular, net[5])
            }
            Some(class) => {
                let (points, limit) = surface.irregular_net(patch, &surface.tables()[class]);
                scratch.take(points.into_iter());
                (self.classes[class].as_ref().expect("patches without a matrix have no pieces"), limit)
            }
        };
        scratch.multiply(matrix, 16 * pieces.len());
        let of = &surface.patches()[patch];
        for (k, piece) in pieces.iter_mut().enumerate() {
            let level = if surface.class(patch).is_some() { k / 3 + 1 } else { 0 };
            let at = |coordinate: usize| &scratch.out[coordinate][16 * k..16 * (k + 1)];
            *piece = placed(of, level, [at(0), at(1), at(2)], origin);
        }
    }
}

/// Room for one patch.
#[derive(Default)]
struct Scratch {
    points: [Vec<f64>; 3],
    out: [Vec<f64>; 3],
}

impl Scratch {
    fn take(&mut self, points: impl Iterator<Item = DVec3>) {
        self.points.iter_mut().for_each(Vec::clear);
        for point in points {
            self.points.iter_mut().zip(point.to_array()).for_each(|(to, x)| to.push(x));
        }
    }

    fn multiply(&mut self, matrix: &[f64], rows: usize) {
        self.out.iter_mut().for_each(|out| out.resize(rows, 0.0));
        let [x, y, z] = &mut self.out;
        vectorized(Product { matrix, points: self.points.each_ref().map(|p| &p[..]), out: [x, y, z] });
    }
}

/// Coefficients by the window's own parameters, turned into those by the parameters of the ptex face and moved to `origin`.
fn placed<T: Real>(patch: &Patch, level: usize, own: [&[f64]; 3], origin: DVec3) -> Piece<T> {
    // The window's u is the face's u, v, -u or -v, 2^(depth + level) times as fast.
    let rates = patch.scale().map(|scale| scale * f64::from(1u32 << level));
    let turned = !patch.rotation.is_multiple_of(2);
    let signs = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][usize::from(patch.rotation)];
    let powers = [0, 1].map(|k| {
        let rate = signs[k] * rates[k];
        [1.0, rate, rate * rate, rate * rate * rate]
    });
    let mut piece = Piece::default();
    for (coordinate, own) in own.into_iter().enumerate() {
        for q in 0..4 {
            for p in 0..4 {
                let own = if turned { own[4 * p + q] } else { own[4 * q + p] };
                let moved = if p + q == 0 { origin[coordinate] } else { 0.0 };
                piece.0[Piece::<T>::slot(p, q, coordinate)] = T::of(own * (powers[0][p] * powers[1][q]) + moved);
            }
        }
    }
    piece
}

/// The window (from 0: of [`WINDOWS`]) that is piece `piece` of its level, in parameters of the patch: the middle.
pub fn middle(level: usize, window: usize) -> [f64; 2] {
    WINDOWS[window].map(|i| (i as f64 + 0.5) / f64::from(1u32 << level))
}

/// 16 points to 16 coefficients, that of u^p v^q at `4*q + p`; column by column.
fn regular_matrix() -> Vec<f64> {
    let column = |point: usize| {
        let (i, j) = (point % 4, point / 4);
        (0..16).map(move |row| POWERS[row % 4][i] * POWERS[row / 4][j])
    };
    (0..16).flat_map(column).collect()
}

/// K points to the coefficients of the windows of the levels; `None` if the class keeps no matrices.
fn irregular_matrix(table: &ClassTable) -> Option<Vec<f64>> {
    let (size, rows) = (table.support(), 16 * IRREGULAR_PIECES);
    let regular = regular_matrix();
    let mut matrix = vec![0.0; rows * size];
    for level in 1..=PIECE_LEVELS {
        let scale = table.lambda.powi(level as i32 - 1);
        for (window, [i, j]) in WINDOWS.into_iter().enumerate() {
            let first = 16 * (3 * (level - 1) + window);
            for point in 0..16 {
                let weights = table.weights(level, 5 * (j + point / 4) + i + point % 4 - 1)?;
                let column = &regular[16 * point..16 * (point + 1)];
                for (k, &weight) in weights.iter().enumerate() {
                    let to = &mut matrix[k * rows + first..k * rows + first + 16];
                    to.iter_mut().zip(column).for_each(|(to, &x)| *to += scale * weight * x);
                }
            }
        }
    }
    Some(matrix)
}
