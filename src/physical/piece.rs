//! Pieces of a patch: whether the path's length is stationary somewhere in one, nowhere, or once.

use super::bezier::{self, Jet, Net};
use super::ends::{Ends, InBall};
use glam::{DMat2, DVec2, DVec3};

/// q up to which Newton's method decides. With H the Hessian, H0 that in the middle of the piece and |H0^-1 H - 1| <= q in it (maximum
/// norm), f is one-to-one, and a step from x to the zero y leaves (H0^-1 H(x))^-1 H0^-1 (H(x) - M) (x - y), M the mean of H on the way:
/// 2 q / (1 - q), half, of the distance at most. Keeping the step inside the piece, which holds y, brings it no farther.
const MAX_DISTORTION: f64 = 0.2;

/// A few roundings, as a part of what is rounded: of derivatives, or of the points that they are differences of.
const ROUNDING: f64 = 2e-15;

/// Newton steps: 2^-60 of a piece.
const STEPS: usize = 60;

/// A rectangle of a bicubic. The Bezier nets of its derivatives are cut out of those of the whole like its own: made of differences of its
/// own points, they would be rounding where it is small.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// Of S, S_u, S_v, S_uu, S_uv, S_vv, by its own parameters.
    nets: [Net; 6],
    /// Corner and sides in the parameters of what it was cut from.
    pub low: [f64; 2],
    pub size: [f64; 2],
}

/// How often each of a piece's nets is derived by u and by v.
const ORDERS: [[i32; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Where in a piece the path's length is stationary.
#[derive(Debug, Clone, Copy)]
pub(super) enum Verdict {
    Nowhere,
    /// At one point.
    Once(Zero),
    /// Not known.
    Unclear,
}

/// A simple zero of the gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Zero {
    /// Parameters of what the piece was cut from.
    pub uv: [f64; 2],
    /// Bound of the rounding of its position.
    pub error: f64,
    /// The path is shorter on some sides and longer on others.
    pub is_saddle: bool,
}

impl Piece {
    pub fn whole(net: &Net) -> Piece {
        let [u, v] = [0, 1].map(|axis| bezier::derivative(net, axis));
        let nets = [*net, u, v, bezier::derivative(&u, 0), bezier::derivative(&u, 1), bezier::derivative(&v, 1)];
        Piece { nets, low: [0.0; 2], size: [1.0; 2] }
    }

    /// The two halves across the longer side.
    pub fn halves(&self) -> [Piece; 2] {
        let axis = usize::from(longest(&self.nets[2]) > longest(&self.nets[1]));
        let mut halves = [*self; 2];
        for (k, net) in self.nets.iter().enumerate() {
            let factor = 0.5f64.powi(ORDERS[k][axis]);
            for (half, part) in halves.iter_mut().zip(bezier::halves(net, axis)) {
                half.nets[k] = part.map(|d| factor * d);
            }
        }
        for (k, half) in halves.iter_mut().enumerate() {
            half.size[axis] *= 0.5;
            half.low[axis] += k as f64 * half.size[axis];
        }
        halves
    }

    /// The middle, in the parameters of what the piece was cut from.
    pub fn middle(&self) -> [f64; 2] {
        self.outer(DVec2::splat(0.5))
    }

    fn outer(&self, at: DVec2) -> [f64; 2] {
        std::array::from_fn(|k| self.low[k] + self.size[k] * at[k])
    }

    /// Bounding box of the control points.
    pub fn bounds(&self) -> [DVec3; 2] {
        let first = [self.nets[0][0]; 2];
        self.nets[0][1..].iter().fold(first, |[low, high], p| [low.min(*p), high.max(*p)])
    }

    /// Decides where f = (pull . S_u, pull . S_v), minus the gradient of the path's length by (u,v), is zero. `whole` is what the piece
    /// was cut from.
    pub fn examine(&self, whole: &Net, ends: &Ends) -> Verdict {
        let [position, u, v, uu, uv, vv] = self.nets.each_ref().map(bezier::middle);
        let middle = Jet { position, first: [u, v], second: [uu, uv, vv] };
        let radius = farthest(&self.nets[0], position);
        let Some(ball) = ends.over(position, radius) else { return Verdict::Unclear };
        let [_, net_u, net_v, ..] = &self.nets;
        let long = [longest(net_u), longest(net_v)];
        // Unit vectors to an end nearby lose digits with the difference of coordinates.
        let rounding = ROUNDING * (1.0 + longest(whole) * ball.bend_most);
        if pulls_one_way(&ball, [net_u, net_v], middle.first, long.map(|long| rounding * long)) {
            return Verdict::Nowhere;
        }
        let gradient = DVec2::from_array(middle.first.map(|d| ball.pull.dot(d)));
        let hessian = hessian(&middle, ball.pull, &ball.bend);
        let change = self.hessian_change(&middle, &ball, long);
        if falls_one_way(gradient, &hessian, &change, rounding * long[0].max(long[1])) {
            return Verdict::Nowhere;
        }
        let rounding = [0, 1].map(|axis| rounding * (long[axis] + self.size[axis] * longest(whole)));
        self.by_newton(whole, ends, gradient, &hessian, &change, DVec2::from_array(rounding))
    }

    /// How far the Hessian may be from that in the middle: that of g . S_ij - S_i . B S_j, with g the pull and B its bend.
    fn hessian_change(&self, middle: &Jet, ball: &InBall, long: [f64; 2]) -> DMat2 {
        let away = [farthest(&self.nets[1], middle.first[0]), farthest(&self.nets[2], middle.first[1])];
        let [a, b] = middle.first.map(DVec3::length);
        let of = |k: usize| {
            let swing = |d: &DVec3| ball.pull.dot(*d - middle.second[k]).abs();
            ball.pull_change * longest(&self.nets[3 + k]) + self.nets[3 + k].iter().map(swing).fold(0.0, f64::max)
        };
        let bent = |i: usize, j: usize| {
            let still = [a, b];
            ball.bend_most * (away[i] * long[j] + still[i] * away[j]) + ball.bend_change * still[i] * still[j]
        };
        let mixed = of(1) + bent(0, 1);
        DMat2::from_cols_array(&[of(0) + bent(0, 0), mixed, mixed, of(2) + bent(1, 1)])
    }

    /// Newton's method, where it must find the zero if there is one; `rounding` of the gradient.
    fn by_newton(
        &self,
        whole: &Net,
        ends: &Ends,
        gradient: DVec2,
        hessian: &DMat2,
        change: &DMat2,
        rounding: DVec2,
    ) -> Verdict {
        let inverse = hessian.inverse();
        let distortion = magnitude(&inverse) * (*change * DVec2::ONE);
        if !distortion.cmple(DVec2::splat(MAX_DISTORTION)).all() {
            return Verdict::Unclear;
        }
        let noise = magnitude(&inverse) * rounding;
        let size = DVec2::from_array(self.size);
        // What neighbours on a border both take for inside.
        let band = noise.max_element() + 1e-12;
        let first = inverse * gradient;
        let reach = DVec2::splat(0.5 + band) + 0.5 * distortion;
        if first.abs().cmpgt(reach).any() {
            return Verdict::Nowhere;
        }
        let step_from = |at: DVec2| {
            let mut jet = bezier::jet(whole, self.outer(at));
            jet.first = [0, 1].map(|k| size[k] * jet.first[k]);
            let [uu, uv, vv] = jet.second;
            jet.second = [size.x * size.x * uu, size.x * size.y * uv, size.y * size.y * vv];
            let pull = ends.pull(jet.position);
            let gradient = DVec2::from_array(jet.first.map(|d| pull.dot(d)));
            -(self::hessian(&jet, pull, &ends.bend(jet.position)).inverse() * gradient)
        };
        let mut at = DVec2::splat(0.5);
        let mut step = -first;
        for _ in 0..STEPS {
            at = (at + step).clamp(DVec2::ZERO, DVec2::ONE);
            step = step_from(at);
            if step.abs().cmple(DVec2::splat(0.1 * band)).all() {
                break;
            }
        }
        if !step.abs().cmple(DVec2::splat(band)).all() {
            return Verdict::Nowhere;
        }
        let jet = bezier::jet(whole, self.outer(at));
        let error = noise.x * size.x * jet.first[0].length() + noise.y * size.y * jet.first[1].length();
        Verdict::Once(Zero { uv: self.outer(at), error, is_saddle: hessian.determinant() < 0.0 })
    }
}

/// Hessian of minus the path's length by (u,v).
fn hessian(jet: &Jet, pull: DVec3, bend: &glam::DMat3) -> DMat2 {
    let [u, v] = jet.first;
    let [uu, uv, vv] = jet.second.map(|d| pull.dot(d));
    let mixed = uv - u.dot(*bend * v);
    DMat2::from_cols_array(&[uu - u.dot(*bend * u), mixed, mixed, vv - v.dot(*bend * v)])
}

fn longest(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|d| d.length_squared()).fold(0.0, f64::max).sqrt()
}

fn farthest(points: &Net, from: DVec3) -> f64 {
    points.iter().map(|p| p.distance_squared(from)).fold(0.0, f64::max).sqrt()
}

/// The matrix of absolute values.
fn magnitude(matrix: &DMat2) -> DMat2 {
    DMat2::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs())
}

/// Whether the path grows everywhere along a direction of the surface that varies little: the steepest one, or one of two across each
/// other. `middle`, `rounding`: of both derivatives, the value in the middle and what may be wrong with products.
fn pulls_one_way(ball: &InBall, [u, v]: [&Net; 2], middle: [DVec3; 2], rounding: [f64; 2]) -> bool {
    let [mu, mv] = middle;
    // S_v without its part along S_u in the middle: where the two are nearly parallel, near some vertices, no digits are lost.
    let part = mu.dot(mv) / mu.length_squared();
    if !part.is_finite() {
        return false;
    }
    let mw = mv - part * mu;
    let steepest = [ball.pull.dot(mu) / mu.length_squared(), ball.pull.dot(mw) / mw.length_squared()];
    // By the combination a S_u + b (S_v - part S_u); what cancels in it counts as rounding.
    let one_way = |a: f64, b: f64| {
        let rounding = (a.abs() + (b * part).abs()) * rounding[0] + b.abs() * rounding[1];
        let side = |k: usize| {
            let d = a * u[k] + b * (v[k] - part * u[k]);
            let (along, slack) = (ball.pull.dot(d), ball.pull_change * d.length() + rounding);
            i32::from(along > slack) - i32::from(along < -slack)
        };
        let first = side(0);
        first != 0 && (1..16).all(|k| side(k) == first)
    };
    one_way(steepest[0], steepest[1]) || one_way(1.0, 0.0) || one_way(0.0, 1.0)
}

/// Whether f has one sign along an eigenvector e of the middle's Hessian: e . f(x) = e . f(m) + e^T H (x - m) with an H between,
/// |x - m| <= 1/2 in both parameters.
fn falls_one_way(gradient: DVec2, hessian: &DMat2, change: &DMat2, rounding: f64) -> bool {
    eigenvectors(hessian).into_iter().any(|(value, e)| {
        let spread = value.abs() * e.abs() + *change * e.abs();
        gradient.dot(e).abs() > 0.5 * (spread.x + spread.y) + 2.0 * rounding
    })
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix (a Jacobi rotation).
pub(super) fn eigenvectors(matrix: &DMat2) -> [(f64, DVec2); 2] {
    let (a, b, c) = (matrix.x_axis.x, matrix.x_axis.y, matrix.y_axis.y);
    let angle = 0.5 * (2.0 * b).atan2(a - c);
    let e = DVec2::from_angle(angle);
    [e, e.perp()].map(|e| (e.dot(*matrix * e), e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physical::PathEnd;
    use glam::dvec3;

    /// Down to the piece that decides, those that hold a stationary point never say that there is none.
    #[test]
    fn points_are_not_lost_on_the_way() {
        for k in 0..300 {
            let wave = |i: f64, j: f64| (1.3 * i + 0.7 * j + 0.4 * f64::from(k)).sin();
            let net = std::array::from_fn(|n| {
                let (i, j) = ((n % 4) as f64, (n / 4) as f64);
                dvec3(i, j, 0.3 * wave(i, j)) / 3.0
            });
            let uv = [0, 1].map(|axis| (f64::from(k) * [0.618, 0.755][axis]).fract());
            let jet = bezier::jet(&net, uv);
            let normal = jet.first[0].cross(jet.first[1]).normalize();
            // Light and eye mirrored in the normal.
            let to_light = (normal + 0.8 * wave(0.3, 2.0) * jet.first[0]).normalize();
            let to_eye = 2.0 * normal.dot(to_light) * normal - to_light;
            let ends = Ends([
                PathEnd::Point(jet.position + to_light * 3.0 * 0.1f64.powi(k % 5)),
                PathEnd::Point(jet.position + to_eye * 0.8),
            ]);
            let mut pieces = vec![Piece::whole(&net)];
            let mut found = Vec::new();
            while let Some(piece) = pieces.pop() {
                let holds = (0..2).all(|axis| {
                    let (low, size) = (piece.low[axis], piece.size[axis]);
                    uv[axis] > low + 1e-9 * size && uv[axis] < low + (1.0 - 1e-9) * size
                });
                match piece.examine(&net, &ends) {
                    Verdict::Nowhere => assert!(!holds, "case {k}: lost in {:?} {:?}", piece.low, piece.size),
                    Verdict::Once(zero) => found.push(zero.uv),
                    Verdict::Unclear => pieces.extend(piece.halves()),
                }
            }
            let off = |at: &[f64; 2]| (at[0] - uv[0]).hypot(at[1] - uv[1]);
            assert!(found.iter().map(off).fold(1.0, f64::min) < 1e-9, "case {k}: {uv:?} {found:?}");
        }
    }
}
