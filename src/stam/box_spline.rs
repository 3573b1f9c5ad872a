//! The quartic box spline of regular triangle meshes, the limit of Loop's rules there.
//!
//! Points of the lattice are named (i,j), i along u and j along v; the triangle is that of (0,0), (1,0), (0,1), and the third
//! direction of the lattice runs from (1,0) to (0,1). A triangle is a quartic polynomial in (u,v), u >= 0, v >= 0, u + v <= 1,
//! of the 12 points round it (Stam 1999, appendix A). It is written as a Bezier triangle here.

use crate::patch::lattice;
use glam::DVec3;

/// Number of control points of a triangle.
pub const POINTS: usize = 12;

/// Their places in the lattice, row by row; the corners of the triangle are 4, 5 and 8.
pub const LATTICE: [[isize; 2]; POINTS] = lattice::NET;

/// Directions of the six neighbours of a lattice point, counter-clockwise.
pub const NEIGHBOURS: [[isize; 2]; 6] = lattice::NEIGHBOURS;

/// Number of points of a quartic Bezier triangle.
pub const BEZIER_POINTS: usize = 15;

/// Exponents (i,j) of u and v of each Bezier point; that of 1 - u - v is 4 - i - j.
const EXPONENTS: [[usize; 2]; BEZIER_POINTS] = [
    [0, 0],
    [1, 0],
    [2, 0],
    [3, 0],
    [4, 0],
    [0, 1],
    [1, 1],
    [2, 1],
    [3, 1],
    [0, 2],
    [1, 2],
    [2, 2],
    [0, 3],
    [1, 3],
    [0, 4],
];

/// 24 times the weights of the control points in each Bezier point. Derived by interpolating what the subdivision rules
/// and the limit rule (1/2, and 1/12 for each neighbour) give at the 15 points i/4, j/4.
const BEZIER: [[u8; POINTS]; BEZIER_POINTS] = [
    [2, 2, 0, 2, 12, 2, 0, 2, 2, 0, 0, 0],
    [1, 3, 0, 0, 12, 4, 0, 1, 3, 0, 0, 0],
    [0, 4, 0, 0, 8, 8, 0, 0, 4, 0, 0, 0],
    [0, 3, 1, 0, 4, 12, 0, 0, 3, 1, 0, 0],
    [0, 2, 2, 0, 2, 12, 2, 0, 2, 2, 0, 0],
    [0, 1, 0, 1, 12, 3, 0, 3, 4, 0, 0, 0],
    [0, 1, 0, 0, 10, 6, 0, 1, 6, 0, 0, 0],
    [0, 1, 0, 0, 6, 10, 0, 0, 6, 1, 0, 0],
    [0, 1, 0, 0, 3, 12, 1, 0, 4, 3, 0, 0],
    [0, 0, 0, 0, 8, 4, 0, 4, 8, 0, 0, 0],
    [0, 0, 0, 0, 6, 6, 0, 1, 10, 1, 0, 0],
    [0, 0, 0, 0, 4, 8, 0, 0, 8, 4, 0, 0],
    [0, 0, 0, 0, 4, 3, 0, 3, 12, 1, 1, 0],
    [0, 0, 0, 0, 3, 4, 0, 1, 12, 3, 0, 1],
    [0, 0, 0, 0, 2, 2, 0, 2, 12, 2, 2, 2],
];

const FACTORIALS: [f64; 5] = [1.0, 1.0, 2.0, 6.0, 24.0];

/// Weight of a control point in a Bezier point; 0 beyond the last.
pub fn bezier_weight(bezier: usize, control: usize) -> f64 {
    BEZIER.get(bezier).map_or(0.0, |row| f64::from(row[control]) / 24.0)
}

/// The Bezier points of a triangle, whose hull holds it, in the order of increasing exponents of v, then u.
pub fn bezier(net: &[DVec3; POINTS]) -> [DVec3; BEZIER_POINTS] {
    BEZIER.map(|row| row.iter().zip(net).map(|(&weight, &p)| f64::from(weight) / 24.0 * p).sum())
}

/// The point of a Bezier triangle at (u,v), which may lie outside.
pub fn bezier_point(points: &[DVec3; BEZIER_POINTS], [u, v]: [f64; 2]) -> DVec3 {
    // De Casteljau's steps, in the order of EXPONENTS: rows of equal exponents of v, each one shorter than the one before.
    let w = 1.0 - u - v;
    let mut points = *points;
    for degree in (0..4usize).rev() {
        let (mut from, mut to) = (0, 0);
        for row in 0..=degree {
            let length = degree + 2 - row;
            for k in 0..length - 1 {
                points[to] = w * points[from + k] + u * points[from + k + 1] + v * points[from + length + k];
                to += 1;
            }
            from += length;
        }
    }
    points[0]
}

/// n! / (i! j! k!) u^i v^j w^k, 0 where an exponent is negative.
fn bernstein(degree: isize, [i, j]: [isize; 2], [u, v, w]: [f64; 3]) -> f64 {
    let k = degree - i - j;
    if i < 0 || j < 0 || k < 0 {
        return 0.0;
    }
    let [a, b, c, n] = [i, j, k, degree].map(|n| FACTORIALS[n as usize]);
    n / (a * b * c) * u.powi(i as i32) * v.powi(j as i32) * w.powi(k as i32)
}

/// Sums over the Bezier points, as weights of the control points.
fn weights(of: impl Fn([isize; 2]) -> [f64; 3]) -> [[f64; 3]; POINTS] {
    let mut out = [[0.0; 3]; POINTS];
    for (exponents, row) in EXPONENTS.iter().zip(&BEZIER) {
        let values = of(exponents.map(|e| e as isize));
        for (sum, &weight) in out.iter_mut().zip(row) {
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += f64::from(weight) / 24.0 * value);
        }
    }
    out
}

/// Weights of the 12 points for the value, the derivative by u and the derivative by v.
pub fn first(u: f64, v: f64) -> [[f64; 3]; POINTS] {
    let at = [u, v, 1.0 - u - v];
    weights(|[i, j]| {
        let lower = |i, j| bernstein(3, [i, j], at);
        // Points lose an exponent of u or v, and gain where that of w is lost.
        let last = lower(i, j);
        [bernstein(4, [i, j], at), 4.0 * (lower(i - 1, j) - last), 4.0 * (lower(i, j - 1) - last)]
    })
}

/// Weights of the 12 points for the derivatives by uu, uv and vv.
pub fn second(u: f64, v: f64) -> [[f64; 3]; POINTS] {
    let at = [u, v, 1.0 - u - v];
    weights(|[i, j]| {
        let lower = |i, j| bernstein(2, [i, j], at);
        let last = lower(i, j);
        [
            12.0 * (lower(i - 2, j) - 2.0 * lower(i - 1, j) + last),
            12.0 * (lower(i - 1, j - 1) - lower(i - 1, j) - lower(i, j - 1) + last),
            12.0 * (lower(i, j - 2) - 2.0 * lower(i, j - 1) + last),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of what a function has on the lattice.
    fn sum(weights: &[[f64; 3]; POINTS], of: impl Fn(f64, f64) -> f64) -> [f64; 3] {
        let mut out = [0.0; 3];
        for (weights, [i, j]) in weights.iter().zip(LATTICE) {
            out.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * of(i as f64, j as f64));
        }
        out
    }

    fn assert_near(found: [f64; 3], expected: [f64; 3]) {
        found.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-14, "{found:?} {expected:?}"));
    }

    const PLACES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.2, 0.3], [0.5, 0.5], [0.1, 0.7]];

    /// The spline of a quadratic's values on the lattice is the quadratic and a constant: the box spline's second moments are
    /// those of its six directions, each uniform on an edge (variance 1/12, twice for each of the three).
    #[test]
    fn quadratics_are_reproduced_up_to_a_constant() {
        for [u, v] in PLACES {
            let (first, second) = (first(u, v), second(u, v));
            assert_near(sum(&first, |_, _| 1.0), [1.0, 0.0, 0.0]);
            assert_near(sum(&first, |x, _| x), [u, 1.0, 0.0]);
            assert_near(sum(&first, |_, y| y), [v, 0.0, 1.0]);
            assert_near(sum(&first, |x, _| x * x), [u * u + 1.0 / 3.0, 2.0 * u, 0.0]);
            assert_near(sum(&first, |x, y| x * y), [u * v - 1.0 / 6.0, v, u]);
            assert_near(sum(&second, |x, _| x * x), [2.0, 0.0, 0.0]);
            assert_near(sum(&second, |x, y| x * y), [0.0, 1.0, 0.0]);
            assert_near(sum(&second, |_, y| y * y), [0.0, 0.0, 2.0]);
        }
    }

    /// The Bezier points give what the weights give, inside and outside.
    #[test]
    fn bezier_points_are_those_of_the_spline() {
        let net: [DVec3; POINTS] = std::array::from_fn(|k| {
            let k = k as f64;
            DVec3::new(k.sin(), (2.3 * k).cos(), 0.4 * (0.7 * k).sin())
        });
        let points = bezier(&net);
        for [u, v] in PLACES.into_iter().chain([[0.9, 0.8], [1.0, 1.0]]) {
            let expected: DVec3 = first(u, v).iter().zip(net).map(|(w, p)| w[0] * p).sum();
            assert!(bezier_point(&points, [u, v]).distance(expected) < 1e-13, "{u} {v}");
        }
        assert_eq!(bezier_weight(6, 4), 10.0 / 24.0);
        assert_eq!(bezier_weight(15, 4), 0.0);
    }

    /// Derivatives are those of the values, by central differences: truncation h^2 / 6 of a third derivative, rounding 1e-16 / h.
    #[test]
    fn derivatives_are_those_of_the_values() {
        const STEP: f64 = 1e-5;
        for [u, v] in PLACES {
            let difference = |order: fn(f64, f64) -> [[f64; 3]; POINTS], value: usize, du: f64, dv: f64| {
                let [after, before] = [1.0, -1.0].map(|sign| order(u + sign * STEP * du, v + sign * STEP * dv));
                std::array::from_fn::<f64, POINTS, _>(|k| (after[k][value] - before[k][value]) / (2.0 * STEP))
            };
            let (first_at, second_at) = (first(u, v), second(u, v));
            for k in 0..POINTS {
                let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
                near(difference(first, 0, 1.0, 0.0)[k], first_at[k][1]);
                near(difference(first, 0, 0.0, 1.0)[k], first_at[k][2]);
                near(difference(first, 1, 1.0, 0.0)[k], second_at[k][0]);
                near(difference(first, 1, 0.0, 1.0)[k], second_at[k][1]);
                near(difference(first, 2, 0.0, 1.0)[k], second_at[k][2]);
            }
        }
    }
}
