//! Bicubic polynomials of points, many samples at a time.

use crate::stam::real::Real;
use pulp::Simd;

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

// What follows is compiled for each vector width by being inlined into a function that has the instructions: closures, and what takes
// them, would be left behind as calls.

impl<T: Real, const ORDER: usize> Run<'_, '_, T, ORDER> {
    #[inline(always)]
    pub fn run<S: Simd>(self, simd: S) {
        let Self { piece, u, v, out, first } = self;
        let (count, lanes) = (u.len(), T::count::<S>());
        let mut at = 0;
        while at < count {
            let end = (at + lanes).min(count);
            let (x, y) = (T::load(simd, &u[at..end]), T::load(simd, &v[at..end]));
            let mut coordinate = 0;
            while coordinate < 3 {
                let jet = jet::<S, T, ORDER>(simd, piece, coordinate, x, y);
                let mut k = 0;
                while k < COLUMNS[ORDER] / 3 {
                    T::store(simd, &mut out[3 * k + coordinate][first + at..first + end], jet[k]);
                    k += 1;
                }
                coordinate += 1;
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
    let a = horner::<S, T, ORDER>(simd, row(simd, piece, 0, coordinate), u);
    let b = horner::<S, T, ORDER>(simd, row(simd, piece, 1, coordinate), u);
    let c = horner::<S, T, ORDER>(simd, row(simd, piece, 2, coordinate), u);
    let d = horner::<S, T, ORDER>(simd, row(simd, piece, 3, coordinate), u);
    let [value, dv, dvv] = horner::<S, T, ORDER>(simd, [a[0], b[0], c[0], d[0]], v);
    match ORDER {
        0 => [value; 6],
        1 => {
            let [du, ..] = horner::<S, T, 0>(simd, [a[1], b[1], c[1], d[1]], v);
            [value, du, dv, value, value, value]
        }
        _ => {
            let [du, duv, _] = horner::<S, T, 1>(simd, [a[1], b[1], c[1], d[1]], v);
            let [duu, ..] = horner::<S, T, 0>(simd, [a[2], b[2], c[2], d[2]], v);
            [value, du, dv, duu, duv, dvv]
        }
    }
}

/// The cubic in u that v^q has, in all lanes.
#[inline(always)]
fn row<S: Simd, T: Real>(simd: S, piece: &Piece<T>, q: usize, coordinate: usize) -> [T::Vector<S>; 4] {
    [
        T::splat(simd, piece.0[Piece::<T>::slot(0, q, coordinate)]),
        T::splat(simd, piece.0[Piece::<T>::slot(1, q, coordinate)]),
        T::splat(simd, piece.0[Piece::<T>::slot(2, q, coordinate)]),
        T::splat(simd, piece.0[Piece::<T>::slot(3, q, coordinate)]),
    ]
}

/// A cubic with its first and second derivative by one sweep of Horner's rule (Knuth, The Art of Computer Programming 2, section 4.6.4);
/// those beyond `ORDER` repeat the value.
#[inline(always)]
fn horner<S: Simd, T: Real, const ORDER: usize>(simd: S, c: [T::Vector<S>; 4], t: T::Vector<S>) -> [T::Vector<S>; 3] {
    let value_2 = T::mul_add(simd, c[3], t, c[2]);
    let value_1 = T::mul_add(simd, value_2, t, c[1]);
    let value = T::mul_add(simd, value_1, t, c[0]);
    if ORDER == 0 {
        return [value; 3];
    }
    let first_1 = T::mul_add(simd, c[3], t, value_2);
    let first = T::mul_add(simd, first_1, t, value_1);
    if ORDER == 1 {
        return [value, first, value];
    }
    let second = T::mul_add(simd, c[3], t, first_1);
    [value, first, T::add(simd, second, second)]
}

/// Evaluates a polynomial at one place: position, du and dv. The loops over what lies side by side become vectors.
#[inline(always)]
pub fn single<S: Simd, T: Real>(_: S, piece: &Piece<T>, u: T, v: T) -> [[T; 3]; 3] {
    // u first, which runs over all four powers of v at a time.
    let (mut values, mut slopes) = ([T::default(); 12], [T::default(); 12]);
    let mut i = 0;
    while i < 12 {
        let [a, b, c, d] = [piece.0[i], piece.0[12 + i], piece.0[24 + i], piece.0[36 + i]];
        let value_2 = T::fused::<S>(d, u, c);
        let value_1 = T::fused::<S>(value_2, u, b);
        values[i] = T::fused::<S>(value_1, u, a);
        slopes[i] = T::fused::<S>(T::fused::<S>(d, u, value_2), u, value_1);
        i += 1;
    }
    let mut out = [[T::default(); 3]; 3];
    let mut c = 0;
    while c < 3 {
        let value_2 = T::fused::<S>(values[9 + c], v, values[6 + c]);
        let value_1 = T::fused::<S>(value_2, v, values[3 + c]);
        let slope_2 = T::fused::<S>(slopes[9 + c], v, slopes[6 + c]);
        let slope_1 = T::fused::<S>(slope_2, v, slopes[3 + c]);
        out[0][c] = T::fused::<S>(value_1, v, values[c]);
        out[1][c] = T::fused::<S>(slope_1, v, slopes[c]);
        out[2][c] = T::fused::<S>(T::fused::<S>(values[9 + c], v, value_2), v, value_1);
        c += 1;
    }
    out
}
