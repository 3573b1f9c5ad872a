//! What rounding alone does to an answer: OpenSubdiv computes in world coordinates, so the farther a mesh is from the
//! origin, and the smaller the cell that is differentiated, the less its answers can say.

use crate::mesh::SubdivMesh;
use glam::DVec3;

/// Rounding errors of a point, in units of 2^-52 of the largest coordinate. The worst case: a refined point is a sum of
/// about 9 terms with weights that add up to 1, so 9/2 units a level and 45 after ten; 16 terms of a patch's basis are 8
/// more. Their sum, 53, rounded up to a power of two. Poles have longer sums, which the base of the tolerances covers.
const ROUNDINGS: f64 = 64.0;

/// Sum of the absolute derivatives of the cubic B-spline basis, at most (in the middle of a cell: 1/8 + 5/8 + 5/8 + 1/8).
const DERIVATIVE: f64 = 1.5;

/// Roundings in units of a model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounding {
    /// Length that errors are divided by: the diagonal, or where all points are equal their largest coordinate.
    pub unit: f64,
    /// Length by which rounding moves a point.
    pub point: f64,
}

/// Smallest extent that can be judged: the square of 2^-52 of it is still far from underflow.
pub(super) const LEAST_EXTENT: f64 = 1e-120;

impl Rounding {
    pub fn of(mesh: &SubdivMesh) -> Self {
        let (low, high) = mesh.bounds().unwrap_or_default();
        let largest = low.abs().max(high.abs()).max_element();
        let diagonal = low.distance(high);
        let unit = [diagonal, largest, 1.0].into_iter().find(|&length| length > 0.0).unwrap_or(1.0);
        Self { unit, point: ROUNDINGS * f64::EPSILON * largest.max(LEAST_EXTENT) }
    }

    /// The same for answers that are one sum of `terms` control points, which adds half a unit a term.
    pub fn summing(&self, terms: u32) -> Self {
        Self { point: self.point * (1.0 + f64::from(terms) / (2.0 * ROUNDINGS)), ..*self }
    }

    /// Share of a position's error, in units.
    pub fn position(&self) -> f64 {
        self.point / self.unit
    }

    /// Length by which a first derivative is off where the patch that answers has the side `cell`.
    pub fn derivative(&self, cell: f64) -> f64 {
        DERIVATIVE * self.point / cell
    }
}

/// Largest angle in degrees by which the normal of `du` and `dv` turns when each derivative is off by `error`: the angle
/// of each, as seen in the plane across the other. Infinite where there is no normal.
pub(super) fn turn_deg(du: DVec3, dv: DVec3, error: f64) -> f64 {
    let (Some(a), Some(b)) = (du.try_normalize(), dv.try_normalize()) else { return f64::INFINITY };
    let turn = error * (1.0 / du.length() + 1.0 / dv.length()) / a.cross(b).length();
    if turn.is_nan() { f64::INFINITY } else { turn.to_degrees() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_turn_as_far_as_their_derivatives_allow() {
        let error = 1e-9;
        for (du, dv) in
            [(DVec3::X, DVec3::Y), (DVec3::X * 100.0, DVec3::Y * 1e-3), (DVec3::X, DVec3::new(1.0, 1e-3, 0.0))]
        {
            let normal = du.cross(dv).normalize();
            // The worst errors point out of the plane.
            let turned = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (0.0, 1.0)].map(|(a, b)| {
                let n = (du + a * error * normal).cross(dv + b * error * normal).normalize();
                n.cross(normal).length().to_degrees()
            });
            let worst = turned.into_iter().fold(0.0, f64::max);
            let bound = turn_deg(du, dv, error);
            assert!(worst <= bound * 1.0001 && worst > 0.3 * bound, "{worst:e} {bound:e}");
        }
        assert_eq!(turn_deg(DVec3::X, DVec3::X, error), f64::INFINITY);
        assert_eq!(turn_deg(DVec3::X, DVec3::ZERO, error), f64::INFINITY);
        assert_eq!(turn_deg(DVec3::X, DVec3::NAN, error), f64::INFINITY);
    }
}
