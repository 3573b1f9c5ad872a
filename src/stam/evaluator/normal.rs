//! Unit normals from derivatives, many at a time.

use super::polynomial::Piece;
use super::real::Real;
use pulp::Simd;

/// Unit normals of samples on one piece.
pub struct Normals<'a, 'b, T> {
    pub first: [[&'a [T]; 3]; 2],
    pub out: [&'b mut [T]; 3],
    /// Product of the longest derivatives on the piece, [`longest_product`].
    pub longest: f64,
    /// Row of the first sample.
    pub row: usize,
    /// Takes the rows whose derivatives are too nearly parallel or too short; their normals are not to be used.
    pub unclear: &'a mut Vec<usize>,
}

/// Part of the product of the longest derivatives that the area of a sample's derivatives must have: roundings of single precision
/// then turn a normal by 2^-24 * 2^6 at most (2e-4 degrees), and those of double precision by 2^-53 * 2^20 (7e-9 degrees).
fn least_area<T: Real>() -> f64 {
    if size_of::<T>() == 4 { 1.0 / 64.0 } else { 1.0 / f64::from(1 << 20) }
}

impl<T: Real> Normals<'_, '_, T> {
    #[inline(always)]
    pub fn run<S: Simd>(mut self, simd: S) {
        let (count, lanes) = (self.first[0][0].len(), T::count::<S>());
        let mul = |a, b| T::mul(simd, a, b);
        let least = least_area::<T>() * self.longest;
        let mut lengths = [T::default(); 64];
        for at in (0..count).step_by(lanes) {
            let end = (at + lanes).min(count);
            let [a, b] = self.first.map(|column| column.map(|slice| T::load(simd, &slice[at..end])));
            let minor = |i: usize, j: usize| T::sub(simd, mul(a[i], b[j]), mul(a[j], b[i]));
            let n = [minor(1, 2), minor(2, 0), minor(0, 1)];
            let square = T::mul_add(simd, n[0], n[0], T::mul_add(simd, n[1], n[1], mul(n[2], n[2])));
            let length = T::sqrt(simd, square);
            for (out, x) in self.out.iter_mut().zip(n) {
                T::store(simd, &mut out[at..end], T::div(simd, x, length));
            }
            T::store(simd, &mut lengths[..end - at], length);
            for (k, length) in lengths[..end - at].iter().enumerate() {
                let length = length.to_f64();
                if !(length > least && length.is_finite()) {
                    self.unclear.push(self.row + at + k);
                }
            }
        }
    }
}

/// Bounds of the derivatives of a piece over u and v up to these in absolute value, multiplied.
pub fn longest_product<T: Real>(piece: &Piece<T>, reach: [f64; 2]) -> f64 {
    let [u, v] = reach.map(|t| [1.0, t, t * t, t * t * t]);
    let (mut du, mut dv) = (0.0, 0.0);
    for p in 0..4 {
        for q in 0..4 {
            let of = |c| piece.0[Piece::<T>::slot(p, q, c)].to_f64().powi(2);
            let length = (of(0) + of(1) + of(2)).sqrt();
            if p > 0 {
                du += p as f64 * length * u[p - 1] * v[q];
            }
            if q > 0 {
                dv += q as f64 * length * u[p] * v[q - 1];
            }
        }
    }
    du * dv
}
