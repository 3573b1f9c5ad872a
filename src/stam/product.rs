//! Small dense matrices times points, in vectors: what patches cost whose classes keep matrices.

use super::real::{Lanes, vectorized};
use glam::DVec3;
use pulp::{Simd, WithSimd};

/// Rows of a product: a multiple of it.
pub const ROWS: usize = 16;

/// Room for the products of one patch after the other.
#[derive(Debug, Default)]
pub struct Products {
    points: [Vec<f64>; 3],
    out: [Vec<f64>; 3],
}

impl Products {
    /// The points that are multiplied.
    pub fn take(&mut self, points: impl Iterator<Item = DVec3>) {
        self.points.iter_mut().for_each(Vec::clear);
        for point in points {
            self.points.iter_mut().zip(point.to_array()).for_each(|(to, x)| to.push(x));
        }
    }

    /// The first `rows` (a multiple of [`ROWS`]) sums of a matrix whose columns, one a point, have `stride` numbers: x, y and z.
    pub fn multiply(&mut self, matrix: &[f64], stride: usize, rows: usize) -> [&[f64]; 3] {
        self.out.iter_mut().for_each(|out| out.resize(rows, 0.0));
        let [x, y, z] = &mut self.out;
        vectorized(Product { matrix, stride, points: self.points.each_ref().map(|p| &p[..]), out: [x, y, z] });
        self.out.each_ref().map(|out| &out[..])
    }
}

/// A dense matrix times points: `out[c][r] = sum of matrix[k * stride + r] * points[c][k]` over k.
struct Product<'a> {
    /// Column by column, `stride` numbers each.
    matrix: &'a [f64],
    stride: usize,
    points: [&'a [f64]; 3],
    /// As many rows as are wanted: a multiple of 16.
    out: [&'a mut [f64]; 3],
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
        let stride = self.stride;
        let zero = <f64 as Lanes>::splat(simd, 0.0);
        let mut sums = [[zero; V]; 3];
        let [x, y, z] = self.points;
        let mut k = 0;
        while k < x.len() {
            let column = &self.matrix[k * stride + at..k * stride + at + V * lanes];
            let point = [
                <f64 as Lanes>::splat(simd, x[k]),
                <f64 as Lanes>::splat(simd, y[k]),
                <f64 as Lanes>::splat(simd, z[k]),
            ];
            let mut i = 0;
            while i < V {
                let weight = <f64 as Lanes>::load(simd, &column[i * lanes..(i + 1) * lanes]);
                sums[0][i] = <f64 as Lanes>::mul_add(simd, weight, point[0], sums[0][i]);
                sums[1][i] = <f64 as Lanes>::mul_add(simd, weight, point[1], sums[1][i]);
                sums[2][i] = <f64 as Lanes>::mul_add(simd, weight, point[2], sums[2][i]);
                i += 1;
            }
            k += 1;
        }
        let mut c = 0;
        while c < 3 {
            let mut i = 0;
            while i < V {
                <f64 as Lanes>::store(simd, &mut self.out[c][at + i * lanes..at + (i + 1) * lanes], sums[c][i]);
                i += 1;
            }
            c += 1;
        }
    }
}
