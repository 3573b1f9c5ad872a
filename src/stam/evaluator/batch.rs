//! Samples on pieces, run by run.

use super::columns::Column;
use super::normal::{Normals, longest_product};
use super::polynomial::{Piece, Run};
use super::samples::Samples;
use crate::stam::real::Real;
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// A range of samples that lie on pieces, and where their results go.
pub struct Batch<'a, 'b, T> {
    pub pieces: &'a [Piece<T>],
    pub samples: &'a Samples<T>,
    pub job: Range<usize>,
    /// Columns of the job, as many as [`COLUMNS`](super::polynomial::COLUMNS) says.
    pub out: &'a mut [&'b mut [T]],
    /// Needs first derivatives in `out`.
    pub normals: Option<&'a mut Column<'b, T>>,
    /// Takes the rows whose normals are left to the reference.
    pub unclear: &'a mut Vec<usize>,
}

/// A batch with derivatives up to an order.
pub struct Ordered<'a, 'b, T, const ORDER: usize>(pub Batch<'a, 'b, T>);

impl<T: Real, const ORDER: usize> WithSimd for Ordered<'_, '_, T, ORDER> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Batch { pieces, samples, job, out, mut normals, unclear } = self.0;
        let first = samples.runs.partition_point(|(_, run)| run.end as usize <= job.start);
        let mut at = job.start;
        for (piece, run) in &samples.runs[first..] {
            let end = job.end.min(run.end as usize);
            if at >= end {
                break;
            }
            let piece = &pieces[*piece as usize];
            let (u, v) = (&samples.u[at..end], &samples.v[at..end]);
            let rows = at - job.start..end - job.start;
            Run::<T, ORDER> { piece, u, v, out, first: rows.start }.run(simd);
            if let Some(normals) = &mut normals {
                let reach = [u, v].map(|t| t.iter().fold(0.0, |reach: f64, t| reach.max(t.to_f64().abs())));
                let longest = longest_product(piece, reach);
                let first = [3, 6].map(|k| [0, 1, 2].map(|c| &out[k + c][rows.clone()]));
                let out = normals.each_mut().map(|column| &mut column[rows.clone()]);
                Normals { first, out, longest, row: rows.start, unclear }.run(simd);
            }
            at = end;
        }
    }
}
