//! Nets of triangles: what Loop's scheme has where [`surface`](super::surface) has quads.

use super::box_spline::{LATTICE, NEIGHBOURS, POINTS};
use super::class::LEVELS;
use super::loop_rows::LOOP_WINDOW;
use super::surface::LimitSurface;
use crate::patch::PHANTOM;
use glam::DVec3;

/// Where in the table of a class of triangles a patch-local point lies (Stam 1999, section 5): the window is a triangle one
/// level finer than what is left of the patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopWindow {
    /// n: u + v lies in [2^-n, 2^(1-n)).
    pub level: u32,
    /// The window's corner (0,0) in the lattice of the level.
    corner: [isize; 2],
    /// 1, or -1 for the window in the middle, which is turned by half a turn.
    pub sign: f64,
    /// Parameters inside the window.
    pub t: [f64; 2],
    /// Both parameters are 0, or so small that no level is left.
    pub at_vertex: bool,
}

/// The windows of a level: at (1,0), at (0,1), and between them.
pub const LOOP_WINDOWS: [LoopWindow; 3] = [
    LoopWindow { level: 1, corner: [1, 0], sign: 1.0, t: [0.0; 2], at_vertex: false },
    LoopWindow { level: 1, corner: [0, 1], sign: 1.0, t: [0.0; 2], at_vertex: false },
    LoopWindow { level: 1, corner: [1, 1], sign: -1.0, t: [0.0; 2], at_vertex: false },
];

impl LoopWindow {
    /// The window's corner (0,0), in units of 2^-n of the patch.
    pub fn corner(&self) -> [f64; 2] {
        self.corner.map(|x| x as f64)
    }

    /// The window at patch-local (u,v), u >= 0, v >= 0, u + v <= 1. At (0,0), and below 2^-1000 where 2^n would overflow, it is
    /// the inner corner of level [`LEVELS`].
    pub fn at([u, v]: [f64; 2]) -> Self {
        let sum = u + v;
        if sum < 2f64.powi(-1000) {
            return Self { level: LEVELS as u32, corner: [1, 0], sign: 1.0, t: [0.0; 2], at_vertex: true };
        }
        let exponent = (sum.to_bits() >> 52) as i32 - 1023;
        let level = (-exponent).max(1);
        let [a, b] = [u, v].map(|x| x * 2f64.powi(level));
        let (corner, sign, t) = if a >= 1.0 {
            ([1, 0], 1.0, [a - 1.0, b])
        } else if b >= 1.0 {
            ([0, 1], 1.0, [a, b - 1.0])
        } else {
            ([1, 1], -1.0, [1.0 - a, 1.0 - b])
        };
        Self { level: level as u32, corner, sign, t, at_vertex: false }
    }

    /// Number in [`LOOP_WINDOW`] of point `k` of the window's net.
    pub fn point(&self, k: usize) -> usize {
        let step = self.sign as isize;
        let place: [isize; 2] = std::array::from_fn(|axis| self.corner[axis] + step * LATTICE[k][axis]);
        LOOP_WINDOW.iter().position(|&point| point == place).expect("the windows' nets lie among the level's points")
    }
}

impl LimitSurface {
    /// The 12 points of a regular triangle, phantom points filled in.
    pub(crate) fn triangle_net(&self, patch: usize) -> [DVec3; POINTS] {
        let support = self.support(patch);
        let points: [Option<DVec3>; POINTS] =
            std::array::from_fn(|k| (support[k] != PHANTOM).then(|| self.refined_point(support[k])));
        let at = |place: [isize; 2]| LATTICE.iter().position(|&point| point == place).and_then(|k| points[k]);
        let net = std::array::from_fn(|k| points[k].unwrap_or_else(|| phantom(LATTICE[k], at)));
        self.moved_from_stored(patch, net)
    }
}

/// A point beyond a boundary or a sharp edge, from the neighbours of a corner of the triangle that it is a neighbour of: it completes
/// the parallelogram of the edge's ends and the corner opposite to it, or, where the corner has one face alone, lies
/// opposite to a neighbour (docs/LIMIT.md, section 8).
fn phantom(place: [isize; 2], at: impl Fn([isize; 2]) -> Option<DVec3>) -> DVec3 {
    let add = |[a, b]: [isize; 2], [c, d]: [isize; 2]| [a + c, b + d];
    for corner in [[0, 0], [1, 0], [0, 1]] {
        let Some(k) = NEIGHBOURS.iter().position(|&step| add(corner, step) == place) else { continue };
        let neighbour = |turns: usize| at(add(corner, NEIGHBOURS[(k + turns) % 6]));
        let Some(centre) = at(corner) else { continue };
        // The two before it, the two after it, the one opposite to it.
        for [edge, inner] in [[5, 4], [1, 2]] {
            if let (Some(edge), Some(inner)) = (neighbour(edge), neighbour(inner)) {
                return centre + (edge - inner);
            }
        }
        if let Some(opposite) = neighbour(3) {
            return centre + (centre - opposite);
        }
    }
    DVec3::NAN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_cover_the_triangle() {
        let cases = [
            ([1.0, 0.0], 1, [1.0, 0.0], 1.0),
            ([0.5, 0.25], 1, [0.0, 0.5], 1.0),
            ([0.25, 0.5], 1, [0.5, 0.0], 1.0),
            ([0.25, 0.375], 1, [0.5, 0.25], -1.0),
            ([0.125, 0.125], 2, [0.5, 0.5], -1.0),
            ([0.0, 0.125], 3, [0.0, 0.0], 1.0),
        ];
        for (uv, level, t, sign) in cases {
            let window = LoopWindow::at(uv);
            assert_eq!((window.level, window.t, window.sign), (level, t, sign), "{uv:?}");
            assert!((0..POINTS).all(|k| window.point(k) < LOOP_WINDOW.len()));
        }
    }

    /// Phantom points continue a plane.
    #[test]
    fn phantom_points_continue_the_surface() {
        let plane = |[i, j]: [isize; 2]| DVec3::new(i as f64, j as f64, (2 * i - 3 * j) as f64);
        // Real points of a corner of one face, of an edge, and of a corner of a sector of three.
        let one_face = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];
        let edge = [[-1, 0], [0, 0], [1, 0], [2, 0], [-1, 1], [0, 1], [1, 1], [-1, 2], [0, 2]];
        let sector = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2], [1, -1], [2, -1], [-1, 1], [-1, 2]];
        for real in [&one_face[..], &edge, &sector] {
            let at = |place: [isize; 2]| real.contains(&place).then(|| plane(place));
            for place in LATTICE.into_iter().filter(|place| !real.contains(place)) {
                assert_eq!(phantom(place, at), plane(place), "{place:?} of {real:?}");
            }
        }
    }
}
