//! Bicubic polynomials of points, many samples at a time.

use super::real::{Lanes, Real};
use pulp::{Simd, WithSimd};

/// Coefficients of x, y and z: that of u^p v^q at `12*p + 3*q`, u and v counted from the middle of the piece in parameters of the
/// ptex face.
///
/// # Theory
/// A net of B-spline points costs 16 products a column, twice over; the same polynomial by Horner's rule takes 28 a coordinate with both
/// derivatives. About the middle of its square the power basis is well conditioned: its coefficients are sums of the net's
/// points with weights of at most 1, those of derivatives are differences that were taken in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Piece<T>(pub [T; 48]);

impl<T> Piece<T> {
    /// Where the coefficient of u^p v^q of a coordinate is.
    #[inline(always)]
    pub const fn slot(p: usize, q: usize, coordinate: usize) -> usize {
        12 * p + 3 * q + coordinate
    }
}

impl<T: Real> Default for Piece<T> {
    fn default() -> Self {
        Self([T::default(); 48])
    }
}

/// Columns of a jet up to some order of derivatives: x, y and z of position, du, dv, duu, duv and dvv.
pub const COLUMNS: [usize; 3] = [3, 9, 18];

/// Evaluates one polynomial at many places.
pub struct Run<'a, 'b, T, const ORDER: usize> {
    pub piece: &'a Piece<T>,
    pub u: &'a [T],
    pub v: &'a [T],
    /// [`COLUMNS`] of them.
    pub out: &'a mut [&'b mut [T]],
    /// Row of the first sample there.
    pub first: usize,
}

impl<T: Real, const ORDER: usize> Run<'_, '_, T, ORDER> {
    #[inline(always)]
    pub fn run<S: Simd>(self, simd: S) {
        let Self { piece, u, v, out, first } = self;
        let (count, lanes) = (u.len(), T::count::<S>());
        let mut at = 0;
        while at < count {
            let end = (at + lanes).min(count);
            let [x, y] = [u, v].map(|t| T::load(simd, &t[at..end]));
            for coordinate in 0..3 {
                let jet = jet::<S, T, ORDER>(simd, piece, coordinate, x, y);
                for (k, value) in jet.into_iter().take(COLUMNS[ORDER] / 3).enumerate() {
                    T::store(simd, &mut out[3 * k + coordinate][first + at..first + end], value);
                }
            }
            at = end;
        }
    }
}

/// Value, and derivatives by u, v, uu, uv and vv, of which `ORDER` says how many: the others repeat the value.
#[inline(always)]
fn jet<S: Simd, T: Real, const ORDER: usize>(
    simd: S,
    piece: &Piece<T>,
    coordinate: usize,
    u: T::Vector<S>,
    v: T::Vector<S>,
) -> [T::Vector<S>; 6] {
    let constant = |p, q| T::splat(simd, piece.0[Piece::<T>::slot(p, q, coordinate)]);
    let rows: [_; 4] = std::array::from_fn(|q| horner::<S, T, ORDER>(simd, std::array::from_fn(|p| constant(p, q)), u));
    let along = |k: usize| [rows[0][k], rows[1][k], rows[2][k], rows[3][k]];
    let [value, dv, dvv] = horner::<S, T, ORDER>(simd, along(0), v);
    match ORDER {
        0 => [value; 6],
        1 => {
            let [du, ..] = horner::<S, T, 0>(simd, along(1), v);
            [value, du, dv, value, value, value]
        }
        _ => {
            let [du, duv, _] = horner::<S, T, 1>(simd, along(1), v);
            let [duu, ..] = horner::<S, T, 0>(simd, along(2), v);
            [value, du, dv, duu, duv, dvv]
        }
    }
}

/// A cubic with its first and second derivative by one sweep of Horner's rule (Knuth, The Art of Computer Programming 2, section 4.6.4);
/// those beyond `ORDER` repeat the value.
#[inline(always)]
fn horner<S: Simd, T: Real, const ORDER: usize>(simd: S, c: [T::Vector<S>; 4], t: T::Vector<S>) -> [T::Vector<S>; 3] {
    let step = |a, b| T::mul_add(simd, a, t, b);
    let value_2 = step(c[3], c[2]);
    let value_1 = step(value_2, c[1]);
    let value = step(value_1, c[0]);
    if ORDER == 0 {
        return [value; 3];
    }
    let first_1 = step(c[3], value_2);
    let first = step(first_1, value_1);
    if ORDER == 1 {
        return [value, first, value];
    }
    let second = step(c[3], first_1);
    [value, first, T::add(simd, second, second)]
}

/// Evaluates polynomials at one place each, coordinates side by side in a vector: position, du and dv.
#[inline(always)]
pub fn single<S: Simd, T: Real>(simd: S, piece: &Piece<T>, u: T, v: T) -> [[T; 3]; 3] {
    let lanes = T::count::<S>();
    // Rows first: u runs over all four at a time.
    let [mut values, mut slopes] = [[T::default(); 12]; 2];
    let t = T::splat(simd, u);
    for at in (0..12).step_by(lanes) {
        let end = (at + lanes).min(12);
        let c = std::array::from_fn(|p| T::load(simd, &piece.0[12 * p + at..12 * p + end]));
        let [value, slope, _] = horner::<S, T, 1>(simd, c, t);
        T::store(simd, &mut values[at..end], value);
        T::store(simd, &mut slopes[at..end], slope);
    }
    let t = T::splat(simd, v);
    let mut out = [[T::default(); 3]; 3];
    for at in (0..3).step_by(lanes) {
        let end = (at + lanes).min(3);
        let rows = |from: &[T; 12]| std::array::from_fn(|q| T::load(simd, &from[3 * q + at..3 * q + end]));
        let [value, dv, _] = horner::<S, T, 1>(simd, rows(&values), t);
        let [du, ..] = horner::<S, T, 0>(simd, rows(&slopes), t);
        for (out, x) in out.iter_mut().zip([value, du, dv]) {
            T::store(simd, &mut out[at..end], x);
        }
    }
    out
}

/// A dense matrix times points: `out[c][r] = sum of matrix[k * rows + r] * points[c][k]` over k.
pub struct Product<'a> {
    /// Column by column, `out[c].len()` numbers each: a multiple of 16.
    pub matrix: &'a [f64],
    pub points: [&'a [f64]; 3],
    pub out: [&'a mut [f64]; 3],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let lanes = f64::count::<S>();
        let rows = self.out[0].len();
        let mut at = 0;
        while at + 4 * lanes <= rows {
            self.block::<S, 4>(simd, at);
            at += 4 * lanes;
        }
        while at < rows {
            self.block::<S, 2>(simd, at);
            at += 2 * lanes;
        }
    }
}

impl Product<'_> {
    /// `V` vectors of rows from `at` on, whose sums stay in registers.
    #[inline(always)]
    fn block<S: Simd, const V: usize>(&mut self, simd: S, at: usize) {
        let lanes = f64::count::<S>();
        let rows = self.out[0].len();
        let mut sums = [[f64::splat(simd, 0.0); V]; 3];
        for (k, column) in self.matrix.chunks_exact(rows).enumerate() {
            let column = &column[at..at + V * lanes];
            let weights: [_; V] = std::array::from_fn(|i| f64::load(simd, &column[i * lanes..(i + 1) * lanes]));
            for (sums, points) in sums.iter_mut().zip(&self.points) {
                let point = f64::splat(simd, points[k]);
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    *sum = <f64 as Lanes>::mul_add(simd, weight, point, *sum);
                }
            }
        }
        for (out, sums) in self.out.iter_mut().zip(sums) {
            for (i, sum) in sums.into_iter().enumerate() {
                f64::store(simd, &mut out[at + i * lanes..at + (i + 1) * lanes], sum);
            }
        }
    }
}
