//! The exact limit in f64: the reference of everything else.
//!
//! A [`LimitSurface`] holds the patches of a mesh, their control points and the [class tables](ClassTable), and
//! evaluates position, derivatives and normal anywhere.

pub mod box_spline;
mod bspline;
mod class;
mod curvature;
mod evaluate;
mod evaluator;
mod instances;
mod loop_modes;
mod loop_rows;
mod loop_surface;
mod modes;
mod moving;
mod pole;
mod product;
mod real;
mod rings;
mod rows;
mod surface;

pub use class::{ClassTable, LEVELS, WINDOW_POINTS};
pub use curvature::Curvature;
pub use evaluator::{Column, Columns, Evaluator, PIECE_LEVELS, Results, Samples, Wanted};
pub use loop_rows::LOOP_WINDOW;
pub use loop_surface::{LOOP_WINDOWS, LoopWindow};
pub use moving::{MoveError, MovingSurface};
pub use real::Real;
pub use rings::{Grid, Rings, WINDOWS};
pub use surface::{LimitSurface, Net};

use glam::DVec3;

/// Position, first derivatives and unit normal of the limit surface at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// Limit position.
    pub position: DVec3,
    /// Derivative by u.
    pub du: DVec3,
    /// Derivative by v.
    pub dv: DVec3,
    /// Unit normal, the limit of the normals inside the patch; zero where there is none.
    pub normal: DVec3,
}

impl Jet {
    /// With the normal that the derivatives span; zero where they are parallel or vanish.
    pub fn new(position: DVec3, du: DVec3, dv: DVec3) -> Jet {
        Jet { position, du, dv, normal: evaluate::unit(du, dv) }
    }
}

/// A [`Jet`] with second derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet2 {
    /// Position, first derivatives and normal.
    pub first: Jet,
    /// Second derivative by u.
    pub duu: DVec3,
    /// Mixed derivative.
    pub duv: DVec3,
    /// Second derivative by v.
    pub dvv: DVec3,
}

/// Where in a Stam table a patch-local point lies (Yasui & Kanai 2004, section 4.1 and eq. 2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// n: the larger of u and v lies in [2^-n, 2^(1-n)).
    pub level: u32,
    /// First row of the table that holds the 4x4 net of the window, rows of 5 points.
    pub first: usize,
    /// Parameters inside the window.
    pub t: [f64; 2],
    /// Both parameters are 0, or so small that no level is left.
    pub at_vertex: bool,
}

impl Window {
    /// The window at patch-local (u,v), each 0 to 1. At (0,0), and below 2^-1000 where 2^n would overflow, it is the inner
    /// corner of level [`LEVELS`].
    pub fn at([u, v]: [f64; 2]) -> Self {
        let largest = u.max(v);
        if largest < 2f64.powi(-1000) {
            return Self { level: LEVELS as u32, first: 6, t: [0.0; 2], at_vertex: true };
        }
        // The exponent of the larger parameter is -n; at 1 the window of level 1 ends.
        let exponent = (largest.to_bits() >> 52) as i32 - 1023;
        let level = (-exponent).max(1);
        let [a, b] = [u, v].map(|x| x * 2f64.powi(level));
        let [i, j] = [a, b].map(|x| usize::from(x >= 1.0));
        Self { level: level as u32, first: 5 * j + i, t: [a - i as f64, b - j as f64], at_vertex: false }
    }

    /// Index in the table of point k (u fastest) of the window's 4x4 net. The table leaves out (-1,-1), so it starts
    /// one early.
    pub fn point(&self, k: usize) -> usize {
        self.first + 5 * (k / 4) + k % 4 - 1
    }
}

/// The tensor-product weights at parameters inside a window or a regular patch: value, d/du, d/dv for each of the 16
/// points of the net, u fastest.
pub fn weights(t: [f64; 2]) -> [[f64; 3]; 16] {
    bspline::tensor(t[0], t[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_cover_the_parameter_square() {
        let cases = [
            ([1.0, 0.3], 1, [1.0, 0.6]),
            ([0.5, 0.25], 1, [0.0, 0.5]),
            ([0.49, 0.25], 2, [0.96, 0.0]),
            ([0.1, 0.25], 2, [0.4, 0.0]),
        ];
        for (uv, level, t) in cases {
            let window = Window::at(uv);
            assert_eq!(window.level, level, "{uv:?}");
            assert!((window.t[0] - t[0]).abs() + (window.t[1] - t[1]).abs() < 1e-15, "{uv:?}: {window:?}");
        }
    }
}
