//! How far a chord may be from the contour between its ends: a bound for the whole chord, not a look at some of its points.
//!
//! Theory: on a cell, Q is the polynomial that stands in for F, and |F - Q| <= e. Let l(s), 0 <= s <= 1, be the chord of the parameters and n
//! the normal to it. Points of the contour are l(s) + d n, and |Q| <= e there. Let |Q_n| >= g on l, and |Q_nn| <= m on the cell. Then
//! |d| <= w with w = (max |Q(l)| + e) / (g - m w): at d = +-w, F has different signs, so the contour between the ends stays in the
//! strip. With any function k(s), whose values are vectors, and the surface's points P,
//!
//! ```text
//! P(l + d n) = (P - k Q)(l) + k Q(l + d n) + d (P - k Q)_n, the last one somewhere between
//! ```
//!
//! k is linear, and at the ends such that (P - k Q)_n = 0. The first term is a polynomial of degree 9 in s. The distance from the chord in
//! space is a convex function, so it is largest at one of the Bernstein points. The second term is at most |k| e, and the third is at most
//! w max |(P - k Q)_n(l)| + w^2 / 2 (max |P_nn| + |k| m), which falls with the fourth power of the chord's length.
//!
//! Changes against the textbook's bound, an eighth of the largest second derivative: bends to both sides do not add up, and a parameter that
//! runs unevenly along the curve does not count.

use super::model::{N, Rect, Sum};
use super::piece::Piece;
use glam::DVec3;
use std::ops::{Add, AddAssign, Mul};

/// Coefficients of a cubic.
const CUBIC: usize = 4;

/// Least width of a rectangle round a piece of the contour, on each side of it, over its length.
const NARROWEST: f64 = 0.25;

/// Share of what leaves the strip's width unknown that the error of Q may have before a better Q is wanted.
const MOST_BENT: f64 = 0.0625;

/// The polynomials of a cell on which chords of one contour lie.
#[derive(Debug)]
pub(super) struct Strip {
    /// The parameter along which F is monotone.
    axis: usize,
    rect: Rect,
    /// Coefficients of Q: those of x^i t^j, x along the axis and t across it, both 0 to 1 on the cell.
    zero: [[f64; N]; N],
    /// Largest |Q_xx|, |Q_xt| and |Q_tt|.
    zero_bend: [f64; 3],
    /// How far Q may be from F.
    error: f64,
    /// Coefficients of the position in parameters of the piece, world units from the piece's origin.
    position: [[DVec3; CUBIC]; CUBIC],
    /// Largest second derivatives of the position, on the whole piece.
    position_bend: [f64; 3],
    origin: DVec3,
}

/// What is known of a chord.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound {
    /// The contour between the ends is no farther from the chord, world units; infinite where nothing is known.
    pub distance: f64,
    /// The part of it that the error of Q brings: less with a polynomial on a smaller rectangle.
    pub by_error: f64,
    /// The contour is no farther from the chord of the parameters: in parameters of the cell, each 0 to 1; infinite as above.
    pub width: f64,
}

impl Bound {
    const UNKNOWN: Bound = Bound { distance: f64::INFINITY, by_error: 0.0, width: f64::INFINITY };
}

/// An end of a chord.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tip {
    /// Parameters of the piece.
    pub at: [f64; 2],
    pub position: DVec3,
}

impl Strip {
    /// Of the contour that is the zero of a sum on a cell, and is single-valued along `axis`.
    pub fn new(piece: &Piece, rect: Rect, sum: &Sum, axis: usize) -> Strip {
        let (position, origin) = piece.powers(axis);
        Strip {
            axis,
            rect,
            zero: sum.powers(axis),
            zero_bend: sum.bend(axis),
            error: sum.error,
            position,
            position_bend: piece.bend(axis),
            origin,
        }
    }

    /// How far the chord between two points of the contour may be from the contour.
    pub fn bound(&self, [from, to]: [Tip; 2]) -> Bound {
        let extent = [self.axis, 1 - self.axis].map(|axis| self.rect.high[axis] - self.rect.low[axis]);
        // x and t of the ends on the piece, and on the cell.
        let [a, b] = [from, to].map(|tip| [tip.at[self.axis], tip.at[1 - self.axis]]);
        let low = [self.axis, 1 - self.axis].map(|axis| self.rect.low[axis]);
        let on_cell = |end: [f64; 2]| [0, 1].map(|k| (end[k] - low[k]) / extent[k]);
        let start = on_cell(a);
        let step = [0, 1].map(|k| (b[k] - a[k]) / extent[k]);
        let length = step[0].hypot(step[1]);
        if step[1] == 0.0 {
            return Bound::UNKNOWN;
        }
        let (q, qx) = along::<f64, N, { 2 * N - 1 }>(&self.zero, start, step);
        let (p, px) = along::<DVec3, CUBIC, { 2 * CUBIC - 1 }>(&self.position, a, [0, 1].map(|k| b[k] - a[k]));
        // The derivative along n = (dt, -dx) / length, from the one along x and the one along the chord.
        let (by_x, by_chord) = (length / step[1], -step[0] / (step[1] * length));
        let qn: [f64; 2 * N - 2] = std::array::from_fn(|k| by_x * qx[k] + by_chord * (k + 1) as f64 * q[k + 1]);
        let pn: [DVec3; 2 * CUBIC - 2] =
            std::array::from_fn(|k| px[k] * (by_x * extent[0]) + p[k + 1] * (by_chord * (k + 1) as f64));
        let normal = [step[1] / length, -step[0] / length];
        let bend = |of: &[f64; 3], extent: [f64; 2]| {
            let [x, t] = [0, 1].map(|k| (normal[k] * extent[k]).abs());
            of[0] * x * x + 2.0 * of[1] * x * t + of[2] * t * t
        };
        let zero_bend = bend(&self.zero_bend, [1.0; 2]);

        let steepness = range(&to_bernstein(qn));
        let least = if steepness[0] > 0.0 { steepness[0] } else { -steepness[1] };
        if least.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return Bound::UNKNOWN;
        }
        let [low, high] = range(&to_bernstein(q));
        // w = (value / least) / (1 - bent w / least), solved for w.
        let bent = |value: f64| 4.0 * zero_bend * value / (least * least);
        let value = low.abs().max(high.abs()) + self.error;
        if bent(value) > 1.0 {
            let by_error = if bent(self.error) > MOST_BENT { f64::INFINITY } else { 0.0 };
            return Bound { by_error, ..Bound::UNKNOWN };
        }
        let width = 2.0 * value / least / (1.0 + (1.0 - bent(value)).sqrt());

        // k at the start, and by how much it changes; there (P - k Q)_n vanishes.
        let first = pn[0] / qn[0];
        let last = sum(&pn) / qn.iter().sum::<f64>();
        let change = last - first;
        let size = first.length().max(last.length());
        let times_k = |of: &[f64], k: usize| {
            let at = |k: Option<usize>| k.and_then(|k| of.get(k)).copied().unwrap_or(0.0);
            first * at(Some(k)) + change * at(k.checked_sub(1))
        };
        let beside: [DVec3; 2 * N] = std::array::from_fn(|k| p.get(k).copied().unwrap_or(DVec3::ZERO) - times_k(&q, k));
        let ends = [from, to].map(|tip| tip.position - self.origin);
        let off = to_bernstein(beside).into_iter().map(|point| distance(point, ends)).fold(0.0, f64::max);
        let slope: [DVec3; 2 * N - 1] =
            std::array::from_fn(|k| pn.get(k).copied().unwrap_or(DVec3::ZERO) - times_k(&qn, k));
        let slope = to_bernstein(slope).into_iter().map(DVec3::length).fold(0.0, f64::max);
        let curved = bend(&self.position_bend, extent) + size * zero_bend;
        let by_error = size * self.error;
        Bound { distance: off + by_error + width * (slope + 0.5 * width * curved), by_error, width }
    }

    /// The rectangle that holds the contour between two of its points, of which the chord of the parameters is within `width`.
    pub fn around(&self, [from, to]: [Tip; 2], width: f64) -> Rect {
        let mut rect = self.rect;
        let across = 1 - self.axis;
        let part = (from.at[across] - to.at[across]).abs() / (rect.high[across] - rect.low[across]);
        // Not so narrow that the polynomials would be those of a line.
        let room = width.max(NARROWEST * part);
        for axis in 0..2 {
            let room = if axis == across { 0.0 } else { room * (self.rect.high[axis] - self.rect.low[axis]) };
            rect.low[axis] = rect.low[axis].max(from.at[axis].min(to.at[axis]) - room);
            rect.high[axis] = rect.high[axis].min(from.at[axis].max(to.at[axis]) + room);
        }
        rect
    }
}

/// What polynomials are made of.
trait Coefficient: Copy + Default + Add<Output = Self> + AddAssign + Mul<f64, Output = Self> {}

impl Coefficient for f64 {}
impl Coefficient for DVec3 {}

fn sum<T: Coefficient>(of: &[T]) -> T {
    of.iter().fold(T::default(), |sum, &x| sum + x)
}

/// A polynomial in x and t, and its derivative by x, on a line: coefficients of powers of the line's parameter.
fn along<T: Coefficient, const M: usize, const D: usize>(
    of: &[[T; M]; M],
    [x, t]: [f64; 2],
    [dx, dt]: [f64; 2],
) -> ([T; D], [T; D]) {
    let (mut value, mut slope) = ([T::default(); D], [T::default(); D]);
    let times_x = |of: &mut [T; D]| {
        for k in (1..D).rev() {
            of[k] = of[k] * x + of[k - 1] * dx;
        }
        of[0] = of[0] * x;
    };
    for line in of.iter().rev() {
        times_x(&mut slope);
        for (slope, &value) in slope.iter_mut().zip(&value) {
            *slope += value;
        }
        times_x(&mut value);
        for (value, coefficient) in value.iter_mut().zip(shifted(*line, t, dt)) {
            *value += coefficient;
        }
    }
    (value, slope)
}

/// A polynomial in t, by powers of s where t = at + by s.
fn shifted<T: Coefficient, const M: usize>(mut of: [T; M], at: f64, by: f64) -> [T; M] {
    for round in 0..M {
        for k in (round..M - 1).rev() {
            let above = of[k + 1];
            of[k] += above * at;
        }
    }
    let mut power = 1.0;
    for coefficient in &mut of {
        *coefficient = *coefficient * power;
        power *= by;
    }
    of
}

/// Bernstein coefficients of a polynomial on 0 to 1 that is given by its powers.
fn to_bernstein<T: Coefficient, const D: usize>(mut of: [T; D]) -> [T; D] {
    let mut binomial = 1.0;
    for (k, coefficient) in of.iter_mut().enumerate() {
        *coefficient = *coefficient * (1.0 / binomial);
        binomial *= (D - 1 - k) as f64 / (k + 1) as f64;
    }
    for round in 1..D {
        for k in (round..D).rev() {
            let before = of[k - 1];
            of[k] += before;
        }
    }
    of
}

fn range(of: &[f64]) -> [f64; 2] {
    of.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
}

/// Distance of a point from a segment.
pub(super) fn distance(p: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let (ab, ap) = (b - a, p - a);
    let t = ab.dot(ap) / ab.length_squared();
    (ap - ab * if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 }).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    /// On a line, polynomials and their derivatives have the values of the whole.
    #[test]
    fn lines_of_polynomials_are_parts_of_them() {
        let of: [[f64; 3]; 3] = [[1.0, -2.0, 0.5], [0.3, 0.7, -1.1], [2.0, -0.4, 0.9]];
        let at = |x: f64, t: f64| (0..9).map(|k| of[k / 3][k % 3] * x.powi(k as i32 / 3) * t.powi(k as i32 % 3)).sum();
        let by_x = |x: f64, t: f64| {
            (3..9).map(|k| of[k / 3][k % 3] * (k / 3) as f64 * x.powi(k as i32 / 3 - 1) * t.powi(k as i32 % 3)).sum()
        };
        let (start, step) = ([0.2, 0.9], [0.7, -0.5]);
        let (value, slope) = along::<f64, 3, 5>(&of, start, step);
        for s in [0.0, 0.3, 1.0] {
            let [x, t]: [f64; 2] = [0, 1].map(|k| start[k] + s * step[k]);
            let evaluate = |of: [f64; 5]| (0..5).map(|k| of[k] * f64::powi(s, k as i32)).sum::<f64>();
            let (expected, steep): (f64, f64) = (at(x, t), by_x(x, t));
            assert!((evaluate(value) - expected).abs() < 1e-14 && (evaluate(slope) - steep).abs() < 1e-14);
        }
    }

    /// A parabola in degree 2 is in the hull of its Bernstein coefficients, and the ends are coefficients.
    #[test]
    fn bernstein_coefficients_hold_the_polynomial() {
        let coefficients = to_bernstein([0.5, -2.0, 3.0, 0.25]);
        assert!((coefficients[0] - 0.5).abs() < 1e-15 && (coefficients[3] - 1.75).abs() < 1e-15);
        let [low, high] = range(&coefficients);
        for k in 0..=10 {
            let s = f64::from(k) / 10.0;
            let value = 0.5 + s * (-2.0 + s * (3.0 + s * 0.25));
            assert!(low <= value && value <= high);
        }
    }

    #[test]
    fn distances_are_from_segments() {
        let ends = [DVec3::ZERO, dvec3(2.0, 0.0, 0.0)];
        assert_eq!(distance(dvec3(1.0, 0.5, 0.0), ends), 0.5);
        assert_eq!(distance(dvec3(5.0, 4.0, 0.0), ends), 5.0);
        assert_eq!(distance(dvec3(0.0, 1.0, 0.0), [DVec3::ZERO; 2]), 1.0);
    }
}
