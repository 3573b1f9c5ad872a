//! Unit normals from derivatives, many at a time.

use super::polynomial::Piece;
use crate::stam::real::Real;
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
    pub fn run<S: Simd>(self, simd: S) {
        let (count, lanes) = (self.first[0][0].len(), T::count::<S>());
        let least = least_area::<T>() * self.longest;
        let mut lengths = [T::default(); 64];
        let mut at = 0;
        while at < count {
            let end = (at + lanes).min(count);
            let a = load(simd, &self.first[0], at, end);
            let b = load(simd, &self.first[1], at, end);
            let x = minor::<S, T>(simd, [a[1], b[2]], [a[2], b[1]]);
            let y = minor::<S, T>(simd, [a[2], b[0]], [a[0], b[2]]);
            let z = minor::<S, T>(simd, [a[0], b[1]], [a[1], b[0]]);
            let square = T::mul_add(simd, x, x, T::mul_add(simd, y, y, T::mul(simd, z, z)));
            let length = T::sqrt(simd, square);
            T::store(simd, &mut self.out[0][at..end], T::div(simd, x, length));
            T::store(simd, &mut self.out[1][at..end], T::div(simd, y, length));
            T::store(simd, &mut self.out[2][at..end], T::div(simd, z, length));
            T::store(simd, &mut lengths[..end - at], length);
            for (k, length) in lengths[..end - at].iter().enumerate() {
                let length = length.to_f64();
                if !(length > least && length.is_finite()) {
                    self.unclear.push(self.row + at + k);
                }
            }
            at = end;
        }
    }
}

#[inline(always)]
fn load<S: Simd, T: Real>(simd: S, from: &[&[T]; 3], at: usize, end: usize) -> [T::Vector<S>; 3] {
    [T::load(simd, &from[0][at..end]), T::load(simd, &from[1][at..end]), T::load(simd, &from[2][at..end])]
}

/// The difference of two products.
#[inline(always)]
fn minor<S: Simd, T: Real>(simd: S, [a, b]: [T::Vector<S>; 2], [c, d]: [T::Vector<S>; 2]) -> T::Vector<S> {
    T::sub(simd, T::mul(simd, a, b), T::mul(simd, c, d))
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
