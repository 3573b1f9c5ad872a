//! A rectangle of a piece, and polynomials that stand in for the functions on it.

use super::piece::{Piece, Scene};
use crate::field::Functions;

/// Points each way: polynomials of degree 4.
pub(super) const N: usize = 5;
/// Chebyshev-Lobatto points, which have corners and edges among them.
const NODES: [f64; N] = [0.0, 0.146_446_609_406_726_24, 0.5, 0.853_553_390_593_273_8, 1.0];
/// Where the polynomials are tried: between the nodes, along u and along v.
const TRIED: [[f64; 2]; 5] = [[0.32, 0.07], [0.93, 0.32], [0.68, 0.93], [0.07, 0.68], [0.4, 0.6]];
/// What the error elsewhere may be over that at the tried places. Empirical: of a million random places in cells of all own meshes
/// none was beyond it.
const SAFETY: f64 = 4.0;
/// How much larger the error of a derivative may be, over the cell's extent: the square of the degree (Markov's inequality).
const STEEPER: f64 = 16.0;

/// Part of the spread of a polynomial below which its error is rounding.
const ROUNDING: f64 = 1e-9;

/// Bernstein coefficients, u fastest.
pub(super) type Coefficients = [f64; N * N];

/// A rectangle in parameters of a piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rect {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Rect {
    pub const WHOLE: Rect = Rect { low: [0.0; 2], high: [1.0; 2] };

    /// Parameters of the piece at a place of the rectangle; corners are exact.
    pub fn at(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        let mix = |axis: usize, x: f64| (1.0 - x) * self.low[axis] + x * self.high[axis];
        [mix(0, s), mix(1, t)]
    }

    pub fn quarters(&self) -> [Rect; 4] {
        let middle = self.at([0.5; 2]);
        std::array::from_fn(|k| {
            let upper = [k % 2 == 1, k / 2 == 1];
            let side = |axis: usize| match upper[axis] {
                false => (self.low[axis], middle[axis]),
                true => (middle[axis], self.high[axis]),
            };
            let (u, v) = (side(0), side(1));
            Rect { low: [u.0, v.0], high: [u.1, v.1] }
        })
    }
}

/// Stand-ins for the functions on a rectangle.
#[derive(Debug)]
pub(super) struct Model {
    bernstein: [Coefficients; 4],
    /// Least and largest value that each function may have.
    ranges: [[f64; 2]; 4],
    /// How far the stand-ins may be from the functions.
    error: Functions,
    /// The functions at the corners (0,0), (1,0), (0,1), (1,1).
    corners: [Functions; 4],
}

/// Why there is no model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Undefined {
    /// At some of the points.
    Partly,
    /// At all of them.
    Everywhere,
}

impl Model {
    pub fn new(scene: &Scene, piece: &Piece, rect: &Rect) -> Result<Model, Undefined> {
        let mut values = [[0.0; N * N]; 4];
        let (mut undefined, mut size) = (0, [0.0f64; 4]);
        for (i, u) in NODES.into_iter().enumerate() {
            let line = piece.line(scene, rect.at([u, 0.0])[0]);
            for (j, v) in NODES.into_iter().enumerate() {
                let Some(functions) = piece.functions_on(scene, &line, rect.at([0.0, v])[1]) else {
                    undefined += 1;
                    continue;
                };
                for c in 0..4 {
                    values[c][j * N + i] = functions[c];
                    size[c] = size[c].max(functions[c].abs());
                }
            }
        }
        match undefined {
            0 => {}
            1.. if undefined < N * N => return Err(Undefined::Partly),
            _ => return Err(Undefined::Everywhere),
        }
        let corner = |k: usize| std::array::from_fn(|c| values[c][k]);
        let corners = [0, N - 1, N * N - N, N * N - 1].map(corner);
        let bernstein = values.each_ref().map(to_bernstein);
        let mut error = [0.0f64; 4];
        for at in TRIED {
            let functions = piece.functions(scene, rect.at(at)).ok_or(Undefined::Partly)?;
            for c in 0..4 {
                error[c] = error[c].max((evaluate(&bernstein[c], at) - functions[c]).abs());
            }
        }
        // Rounding is no news.
        let error = std::array::from_fn(|c| SAFETY * error[c] + 8.0 * f64::EPSILON * size[c]);
        Ok(Model::with(bernstein, error, corners))
    }

    fn with(bernstein: [Coefficients; 4], error: Functions, corners: [Functions; 4]) -> Model {
        let ranges = std::array::from_fn(|c| range(bernstein[c].iter().copied(), error[c]));
        Model { bernstein, ranges, error, corners }
    }

    /// Whether a weighted sum of the functions is not 0 anywhere, as far as their ranges tell.
    pub fn excludes(&self, weights: &Functions) -> bool {
        let (mut low, mut high) = (0.0, 0.0);
        for (&weight, &[least, most]) in weights.iter().zip(&self.ranges) {
            let (a, b) = (weight * least, weight * most);
            low += a.min(b);
            high += a.max(b);
        }
        low > 0.0 || high < 0.0
    }

    /// The same polynomials on the quarters of the rectangle, in the order of [`Rect::quarters`]; `None` where a function is undefined at
    /// one of their corners.
    pub fn quarters(&self, scene: &Scene, piece: &Piece, rect: &Rect) -> Option<[Model; 4]> {
        let mut corners = [[[0.0; 4]; 3]; 3];
        for (i, u) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            let line = piece.line(scene, rect.at([u, 0.0])[0]);
            for (j, v) in [0.0, 0.5, 1.0].into_iter().enumerate() {
                corners[j][i] = match i % 2 + j % 2 {
                    0 => self.corners[j + i / 2],
                    _ => piece.functions_on(scene, &line, rect.at([0.0, v])[1])?,
                };
            }
        }
        let halves = self.bernstein.each_ref().map(|of| halves(of, N, 1).map(|half| self::halves(&half, 1, N)));
        Some(std::array::from_fn(|k| {
            let (i, j) = (k % 2, k / 2);
            let corners = [corners[j][i], corners[j][i + 1], corners[j + 1][i], corners[j + 1][i + 1]];
            Model::with(std::array::from_fn(|c| halves[c][i][j]), self.error, corners)
        }))
    }

    /// A weighted sum of the functions.
    pub fn sum(&self, weights: &Functions) -> Sum {
        let mut coefficients = [0.0; N * N];
        let mut error = 0.0;
        for (c, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            for (sum, x) in coefficients.iter_mut().zip(&self.bernstein[c]) {
                *sum += weight * x;
            }
            error += weight.abs() * self.error[c];
        }
        let corners = self.corners.each_ref().map(|functions| crate::field::weighted(weights, functions));
        Sum { coefficients, error, corners }
    }
}

/// A weighted sum of functions on a rectangle.
#[derive(Debug)]
pub(super) struct Sum {
    coefficients: Coefficients,
    /// How far the polynomial may be from the sum.
    pub error: f64,
    /// The sum itself at (0,0), (1,0), (0,1), (1,1).
    pub corners: [f64; 4],
}

impl Sum {
    /// Least and largest value that the sum may have: polynomials lie in the hull of their Bernstein coefficients.
    pub fn range(&self) -> [f64; 2] {
        range(self.coefficients.iter().copied(), self.error)
    }
    /// Largest difference of the polynomial's values, about.
    pub fn spread(&self) -> f64 {
        let [low, high] = range(self.coefficients.iter().copied(), 0.0);
        high - low
    }

    /// Whether the error is no better than the range of values over this factor.
    pub fn is_poor(&self) -> bool {
        const POOR: f64 = 64.0;
        self.spread() <= POOR * self.error
    }

    /// Whether the error is so small that it does not matter on quarters either. Where the contour nearly is a side it does: there, only
    /// rounding settles what is on which.
    pub fn is_precise(&self) -> bool {
        const PRECISE: f64 = 4096.0;
        const NEAR: f64 = 1.0 / 64.0;
        let spread = self.spread();
        let is_near = |(axis, end): (usize, usize)| (0..N).all(|k| self.on_side(axis, end, k).abs() <= NEAR * spread);
        spread >= PRECISE * self.error && ![(0, 0), (0, N - 1), (1, 0), (1, N - 1)].into_iter().any(is_near)
    }

    /// Coefficient k of the side where `axis` is constant, at its coefficient `end`.
    fn on_side(&self, axis: usize, end: usize, k: usize) -> f64 {
        self.coefficients[if axis == 0 { k * N + end } else { end * N + k }]
    }

    /// Whether it grows or shrinks everywhere along an axis.
    pub fn is_monotone(&self, axis: usize) -> bool {
        let step = [1, N][axis];
        let differences = (0..N * N)
            .filter(|k| if axis == 0 { k % N < N - 1 } else { k / N < N - 1 })
            .map(|k| (N - 1) as f64 * (self.coefficients[k + step] - self.coefficients[k]));
        let [low, high] = range(differences, STEEPER * self.error);
        low > 0.0 || high < 0.0
    }

    /// Whether it has at most one zero on the side of the rectangle where `axis` is constant, at its end or its start, which
    /// the signs at the corners show.
    pub fn is_simple_on_side(&self, axis: usize, end: bool) -> bool {
        let of = |k: usize| self.on_side(axis, if end { N - 1 } else { 0 }, k);
        let [low, high] = range((0..N).map(of), self.error);
        // With a sign; or on the contour but for rounding, where signs at the corners are as good as any.
        let is_rounding = self.error < ROUNDING * self.spread() && low.abs().max(high) <= 4.0 * self.error;
        if low > 0.0 || high < 0.0 || is_rounding {
            return true;
        }
        let differences = (0..N - 1).map(|k| (N - 1) as f64 * (of(k + 1) - of(k)));
        let [low, high] = range(differences, STEEPER * self.error);
        low > 0.0 || high < 0.0
    }
}

impl Sum {
    /// The polynomial along `axis`, at a place 0 to 1 of the other: Bernstein coefficients.
    pub fn line(&self, axis: usize, place: f64) -> Line {
        let weights = basis(place);
        Line::new(std::array::from_fn(|k| {
            let of = |j: usize| self.coefficients[if axis == 0 { j * N + k } else { k * N + j }];
            (0..N).map(|j| weights[j] * of(j)).sum()
        }))
    }
}

impl Sum {
    /// Coefficients of x^i t^j of the polynomial, a row an i: x is the parameter of `axis`, t the other one, both 0 to 1.
    pub fn powers(&self, axis: usize) -> [[f64; N]; N] {
        let of = |i: usize, j: usize| self.coefficients[if axis == 0 { j * N + i } else { i * N + j }];
        let by_t: [Line; N] = std::array::from_fn(|i| Line::new(std::array::from_fn(|j| of(i, j))));
        let by_x: [Line; N] = std::array::from_fn(|j| Line::new(std::array::from_fn(|i| by_t[i].0[j])));
        std::array::from_fn(|i| std::array::from_fn(|j| by_x[j].0[i]))
    }

    /// Largest second derivatives of the polynomial, which the second differences of its coefficients bound: twice along `axis`, along
    /// both parameters, and twice along the other one.
    pub fn bend(&self, axis: usize) -> [f64; 3] {
        let of = |i: usize, j: usize| self.coefficients[j * N + i];
        let [mut u, mut mixed, mut v] = [0.0f64; 3];
        for k in 0..N {
            for i in 1..N - 1 {
                u = u.max((of(i - 1, k) - 2.0 * of(i, k) + of(i + 1, k)).abs());
                v = v.max((of(k, i - 1) - 2.0 * of(k, i) + of(k, i + 1)).abs());
            }
        }
        for j in 1..N {
            for i in 1..N {
                mixed = mixed.max((of(i, j) - of(i - 1, j) - of(i, j - 1) + of(i - 1, j - 1)).abs());
            }
        }
        let degree = (N - 1) as f64;
        let [u, mixed, v] = [degree * (degree - 1.0) * u, degree * degree * mixed, degree * (degree - 1.0) * v];
        if axis == 0 { [u, mixed, v] } else { [v, mixed, u] }
    }

    /// The polynomial's value.
    pub fn value(&self, at: [f64; 2]) -> f64 {
        evaluate(&self.coefficients, at)
    }
}

/// A polynomial of degree 4 on 0 to 1, by its powers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line([f64; N]);

impl Line {
    fn new([a, b, c, d, e]: [f64; N]) -> Line {
        Line([
            a,
            4.0 * (b - a),
            6.0 * (c - 2.0 * b + a),
            4.0 * (d - 3.0 * (c - b) - a),
            e - 4.0 * (d + b) + 6.0 * c + a,
        ])
    }

    fn value(&self, x: f64) -> f64 {
        let [a, b, c, d, e] = self.0;
        a + x * (b + x * (c + x * (d + x * e)))
    }

    /// Its derivative.
    pub fn slope(&self, x: f64) -> f64 {
        let [_, b, c, d, e] = self.0;
        b + x * (2.0 * c + x * (3.0 * d + x * (4.0 * e)))
    }

    /// A zero between ends of different sign, or the end that is nearer to 0.
    pub fn zero(&self) -> f64 {
        let [first, last] = [self.0[0], self.value(1.0)];
        if (first > 0.0) == (last > 0.0) {
            return if first.abs() < last.abs() { 0.0 } else { 1.0 };
        }
        let [mut low, mut high] = [0.0, 1.0];
        let mut x = first / (first - last);
        for _ in 0..12 {
            let value = self.value(x);
            if (value > 0.0) == (first > 0.0) {
                low = x
            } else {
                high = x
            }
            let step = -value / self.slope(x);
            if step.abs() < 1e-9 {
                break;
            }
            let next = x + step;
            x = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        x
    }
}

fn basis(x: f64) -> [f64; N] {
    let y = 1.0 - x;
    let (x2, y2) = (x * x, y * y);
    [y2 * y2, 4.0 * y2 * y * x, 6.0 * y2 * x2, 4.0 * y * x2 * x, x2 * x2]
}

fn range(values: impl Iterator<Item = f64>, margin: f64) -> [f64; 2] {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    [low - margin, high + margin]
}

/// From values at the nodes to Bernstein coefficients, one line of them: the inverse of the matrix of Bernstein polynomials there.
const TO_BERNSTEIN: [[f64; N]; N] = to_bernstein_matrix();

const fn to_bernstein_matrix() -> [[f64; N]; N] {
    // Gauss-Jordan on [B | 1], B[i][k] = binomial(4, k) x^k (1 - x)^(4 - k); the pivots are far from 0.
    let binomial = [1.0, 4.0, 6.0, 4.0, 1.0];
    let mut b = [[0.0; N]; N];
    let mut inverse = [[0.0; N]; N];
    let mut i = 0;
    while i < N {
        let mut k = 0;
        while k < N {
            let mut x = binomial[k];
            let mut n = 0;
            while n < N - 1 {
                x *= if n < k { NODES[i] } else { 1.0 - NODES[i] };
                n += 1;
            }
            b[i][k] = x;
            k += 1;
        }
        inverse[i][i] = 1.0;
        i += 1;
    }
    let mut pivot = 0;
    while pivot < N {
        let scale = 1.0 / b[pivot][pivot];
        let mut k = 0;
        while k < N {
            b[pivot][k] *= scale;
            inverse[pivot][k] *= scale;
            k += 1;
        }
        let mut row = 0;
        while row < N {
            let factor = b[row][pivot];
            let mut k = 0;
            while row != pivot && k < N {
                b[row][k] -= factor * b[pivot][k];
                inverse[row][k] -= factor * inverse[pivot][k];
                k += 1;
            }
            row += 1;
        }
        pivot += 1;
    }
    inverse
}

fn to_bernstein(values: &Coefficients) -> Coefficients {
    let mut half = [0.0; N * N];
    let mut out = [0.0; N * N];
    for j in 0..N {
        for k in 0..N {
            for i in 0..N {
                half[j * N + k] += TO_BERNSTEIN[k][i] * values[j * N + i];
            }
        }
    }
    for k in 0..N {
        for j in 0..N {
            for i in 0..N {
                out[k * N + i] += TO_BERNSTEIN[k][j] * half[j * N + i];
            }
        }
    }
    out
}

/// Both halves of polynomials of which coefficients `step` apart belong together, each of the N lines starting `line` apart
/// (de Casteljau).
fn halves(whole: &Coefficients, line: usize, step: usize) -> [Coefficients; 2] {
    let mut halves = [*whole; 2];
    for start in (0..N).map(|k| k * line) {
        let at = |k: usize| start + k * step;
        for round in 1..N {
            for k in (round..N).rev() {
                halves[0][at(k)] = 0.5 * (halves[0][at(k - 1)] + halves[0][at(k)]);
            }
            for k in 0..N - round {
                halves[1][at(k)] = 0.5 * (halves[1][at(k)] + halves[1][at(k + 1)]);
            }
        }
    }
    halves
}

fn evaluate(bernstein: &Coefficients, at: [f64; 2]) -> f64 {
    let [u, v] = at.map(basis);
    (0..N * N).map(|k| u[k % N] * v[k / N] * bernstein[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_four_are_themselves() {
        let f = |[u, v]: [f64; 2]| (1.0 - 2.0 * u + u.powi(4)) * (0.3 + v * v - 2.0 * v.powi(3)) + v.powi(4);
        let values = std::array::from_fn(|k| f([NODES[k % N], NODES[k / N]]));
        let bernstein = to_bernstein(&values);
        let sum = Sum { coefficients: bernstein, error: 0.0, corners: [0.0; 4] };
        for at in TRIED.into_iter().chain([[0.0, 1.0], [1.0, 0.3]]) {
            for axis in 0..2 {
                assert!((sum.line(axis, at[1 - axis]).value(at[axis]) - f(at)).abs() < 1e-14, "{at:?} along {axis}");
            }
            assert!((evaluate(&bernstein, at) - f(at)).abs() < 1e-14, "{at:?}");
            for axis in 0..2 {
                let [x, t] = [at[axis], at[1 - axis]];
                let powers = sum.powers(axis);
                let value: f64 =
                    (0..N * N).map(|k| powers[k / N][k % N] * x.powi((k / N) as i32) * t.powi((k % N) as i32)).sum();
                assert!((value - f(at)).abs() < 1e-13, "{at:?} by powers");
            }
            for k in 0..4 {
                let quarter = &halves(&halves(&bernstein, N, 1)[k % 2], 1, N)[k / 2];
                let of_whole = [0.5 * (at[0] + (k % 2) as f64), 0.5 * (at[1] + (k / 2) as f64)];
                assert!((evaluate(quarter, at) - f(of_whole)).abs() < 1e-14, "{at:?} of quarter {k}");
            }
        }
    }
}
