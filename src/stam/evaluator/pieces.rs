//! From the control points of patches to bicubic pieces of ptex faces.
//!
//! A regular patch is one bicubic. An irregular one has three on each level n of its Stam table (docs/LIMIT.md, section 4), on squares
//! half as large each time; those of the first [`PIECE_LEVELS`] levels are stored. Both are linear in the control points, and patches of a
//! class share the matrix, so that a patch costs one small dense product.

use super::polynomial::Piece;
use crate::kept::Kept;
use crate::patch::{Patch, RingClass};
use crate::stam::product::Products;
use crate::stam::{ClassTable, LimitSurface, Real, WINDOWS};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

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
    classes: Vec<Option<Arc<Vec<f64>>>>,
}

impl Plan {
    pub fn new(surface: &LimitSurface) -> Self {
        let classes: Vec<Option<Arc<Vec<f64>>>> = match surface.has_triangles() {
            true => vec![None; surface.tables().len()],
            false => surface.tables().par_iter().map(|table| shared_matrix(table)).collect(),
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
        jobs.into_par_iter().for_each_init(Products::default, |products, (range, mut own)| {
            for patch in range {
                let (pieces, others) = own.split_at_mut((self.first[patch + 1] - self.first[patch]) as usize);
                self.fill_patch(surface, patch, products, pieces);
                own = others;
            }
        });
    }

    fn fill_patch<T: Real>(
        &self,
        surface: &LimitSurface,
        patch: usize,
        products: &mut Products,
        pieces: &mut [Piece<T>],
    ) {
        if pieces.is_empty() {
            return;
        }
        let of = &surface.patches()[patch];
        let Some(class) = surface.class(patch) else {
            let net = surface.regular_net(patch);
            products.take(net.iter().map(|point| *point - net[5]));
            let sums = products.multiply(&self.regular, 16, 16);
            return Frame::new(of, 0).place(coefficients(sums, 0), net[5], &mut pieces[0]);
        };
        let (points, limit) = surface.irregular_net(patch, &surface.tables()[class]);
        products.take(points.into_iter());
        let matrix = self.classes[class].as_ref().expect("patches without a matrix have no pieces");
        let rows = 16 * pieces.len();
        let sums = products.multiply(matrix, rows, rows);
        for (level, own) in pieces.chunks_exact_mut(3).enumerate() {
            let frame = Frame::new(of, level + 1);
            for (window, piece) in own.iter_mut().enumerate() {
                frame.place(coefficients(sums, 3 * level + window), limit, piece);
            }
        }
    }
}

/// Those of a piece.
fn coefficients(sums: [&[f64]; 3], piece: usize) -> [&[f64; 16]; 3] {
    sums.map(|sums| sums[16 * piece..].first_chunk().expect("16 rows a piece"))
}

/// How coefficients by a window's own parameters become those by the parameters of the ptex face: the window's u is the face's u, v,
/// -u or -v, 2^(depth + level) times as fast.
struct Frame {
    /// u and v change places.
    turned: bool,
    /// Factor of the coefficient of u^p v^q at `4*p + q`.
    factors: [f64; 16],
}

impl Frame {
    fn new(patch: &Patch, level: usize) -> Self {
        let rates = patch.scale().map(|scale| scale * f64::from(1u32 << level));
        let signs = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][usize::from(patch.rotation)];
        let [u, v] =
            [signs[0] * rates[0], signs[1] * rates[1]].map(|rate| [1.0, rate, rate * rate, rate * rate * rate]);
        let mut factors = [0.0; 16];
        for (k, factor) in factors.iter_mut().enumerate() {
            *factor = u[k / 4] * v[k % 4];
        }
        Self { turned: !patch.rotation.is_multiple_of(2), factors }
    }

    fn place<T: Real>(&self, own: [&[f64; 16]; 3], origin: DVec3, piece: &mut Piece<T>) {
        let mut put = |k: usize, from: usize| {
            for (coordinate, own) in own.iter().enumerate() {
                piece.0[3 * k + coordinate] = T::of(own[from] * self.factors[k]);
            }
        };
        match self.turned {
            false => (0..16).for_each(|k| put(k, k)),
            true => (0..16).for_each(|k| put(k, 4 * (k % 4) + k / 4)),
        }
        for (coordinate, origin) in origin.to_array().into_iter().enumerate() {
            piece.0[coordinate] = T::of(own[coordinate][0] + origin);
        }
    }
}

/// The window (from 0: of [`WINDOWS`]) that is piece `piece` of its level, in parameters of the patch: the middle.
pub fn middle(level: usize, window: usize) -> [f64; 2] {
    WINDOWS[window].map(|i| (i as f64 + 0.5) / f64::from(1u32 << level))
}

/// 16 points to 16 coefficients, that of u^p v^q at `4*p + q`; column by column.
fn regular_matrix() -> Vec<f64> {
    let column = |point: usize| {
        let (i, j) = (point % 4, point / 4);
        (0..16).map(move |row| POWERS[row / 4][i] * POWERS[row % 4][j])
    };
    (0..16).flat_map(column).collect()
}

/// Matrices of classes that came up.
static SHARED: Kept<RingClass, Option<Arc<Vec<f64>>>> = Kept::new();

/// As [`irregular_matrix`]; those of classes that are kept for other meshes are kept too.
fn shared_matrix(table: &ClassTable) -> Option<Arc<Vec<f64>>> {
    let build = || irregular_matrix(table).map(Arc::new);
    if table.is_shared() { Option::clone(&SHARED.get(table.class(), build)) } else { build() }
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
