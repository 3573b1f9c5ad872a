//! Bicubic Bezier nets of points: their values, their halves, and the nets of their derivatives, which are hulls.

use glam::DVec3;

/// 4x4 control points, u fastest.
pub(super) type Net = [DVec3; 16];

/// Position, first and second derivatives (u, v; uu, uv, vv).
#[derive(Debug, Clone, Copy)]
pub(super) struct Jet {
    pub position: DVec3,
    pub first: [DVec3; 2],
    pub second: [DVec3; 3],
}

/// Index of point `k` of line `line` along an axis (0: u, 1: v).
fn index(axis: usize, line: usize, k: usize) -> usize {
    if axis == 0 { 4 * line + k } else { 4 * k + line }
}

/// Every line of a net along an axis, made anew.
fn along(net: &Net, axis: usize, change: impl Fn([DVec3; 4]) -> [DVec3; 4]) -> Net {
    let mut out = [DVec3::ZERO; 16];
    for line in 0..4 {
        let changed = change(std::array::from_fn(|k| net[index(axis, line, k)]));
        changed.into_iter().enumerate().for_each(|(k, point)| out[index(axis, line, k)] = point);
    }
    out
}

/// The Bezier net of a uniform bicubic B-spline.
pub(super) fn of_spline(net: &Net) -> Net {
    let line = |[a, b, c, d]: [DVec3; 4]| {
        [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
    };
    along(&along(net, 0, line), 1, line)
}

/// The lower and the upper half along an axis (de Casteljau at 1/2).
pub(super) fn halves(net: &Net, axis: usize) -> [Net; 2] {
    let points = |[a, b, c, d]: [DVec3; 4]| {
        let (ab, bc, cd) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d));
        let (abc, bcd) = (0.5 * (ab + bc), 0.5 * (bc + cd));
        [a, ab, abc, 0.5 * (abc + bcd), bcd, cd, d]
    };
    [0, 3].map(|first| along(net, axis, |line| std::array::from_fn(|k| points(line)[first + k])))
}

/// Control vectors of the derivative along an axis, raised to degree 3 so that all derivatives can be combined.
pub(super) fn derivative(net: &Net, axis: usize) -> Net {
    along(net, axis, |[a, b, c, d]| {
        let (first, middle, last) = (3.0 * (b - a), 3.0 * (c - b), 3.0 * (d - c));
        [first, (first + 2.0 * middle) / 3.0, (2.0 * middle + last) / 3.0, last]
    })
}

/// The value in the middle.
pub(super) fn middle(net: &Net) -> DVec3 {
    const W: [f64; 4] = [0.125, 0.375, 0.375, 0.125];
    (0..16).map(|k| W[k % 4] * W[k / 4] * net[k]).sum()
}

/// Value and derivatives of the cubic Bernstein polynomials.
fn bernstein(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
        [6.0 * s, 6.0 * (t - 2.0 * s), 6.0 * (s - 2.0 * t), 6.0 * t],
    ]
}

/// The polynomial at (u,v), also outside the unit square.
pub(super) fn jet(net: &Net, [u, v]: [f64; 2]) -> Jet {
    let (a, b) = (bernstein(u), bernstein(v));
    let sum = |i: usize, j: usize| -> DVec3 { (0..16).map(|k| a[i][k % 4] * b[j][k / 4] * net[k]).sum() };
    Jet { position: sum(0, 0), first: [sum(1, 0), sum(0, 1)], second: [sum(2, 0), sum(1, 1), sum(0, 2)] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stam::weights;
    use glam::dvec3;

    fn spline() -> Net {
        std::array::from_fn(|k| {
            let (i, j) = ((k % 4) as f64, (k / 4) as f64);
            dvec3(i + 0.1 * (3.0 * j).sin(), j - 0.2 * (i * j).cos(), (1.7 * i + 0.6 * j).sin())
        })
    }

    /// Against the B-spline's own weights; halves and hulls against the whole.
    #[test]
    fn nets_are_the_spline() {
        let (spline, net) = (spline(), of_spline(&spline()));
        let [low, high] = halves(&net, 1);
        for t in [[0.0, 0.0], [0.3, 0.8], [0.5, 0.5], [1.0, 0.25]] {
            let here = jet(&net, t);
            let expected: [DVec3; 3] =
                std::array::from_fn(|d| spline.iter().zip(weights(t)).map(|(p, w)| *p * w[d]).sum());
            for (a, b) in [here.position, here.first[0], here.first[1]].into_iter().zip(expected) {
                assert!(a.distance(b) < 1e-14, "{t:?}: {a} {b}");
            }
            let half = if t[1] < 0.5 { &low } else { &high };
            let inside = jet(half, [t[0], (2.0 * t[1]).rem_euclid(1.0)]);
            if t[1] < 1.0 {
                assert!(inside.position.distance(here.position) < 1e-14, "{t:?}");
                assert!(inside.second[1].distance(0.5 * here.second[1]) < 1e-13, "{t:?}");
                assert!(inside.second[2].distance(0.25 * here.second[2]) < 1e-13, "{t:?}");
            }
        }
    }

    /// The nets of derivatives have them as values.
    #[test]
    fn derivatives_have_nets() {
        let net = of_spline(&spline());
        for t in [[0.2, 0.9], [0.7, 0.4], [0.0, 1.0]] {
            let expected = jet(&net, t);
            for axis in 0..2 {
                let first = derivative(&net, axis);
                assert!(jet(&first, t).position.distance(expected.first[axis]) < 1e-13);
                let second = derivative(&first, axis);
                assert!(jet(&second, t).position.distance(expected.second[2 * axis]) < 1e-13);
            }
            let mixed = derivative(&derivative(&net, 0), 1);
            assert!(jet(&mixed, t).position.distance(expected.second[1]) < 1e-13);
        }
    }
}
