//! Physical reflection: all points of the surface that mirror a given light point into a given eye.
//!
//! # Theory
//! Ulmet 2003, sec. 3: with p and a the vectors from a surface point to the light and to the eye and n its normal, the point mirrors one
//! into the other where h(u,v) = p/|p| + a/|a| - 2 (a.n/|a|) n = 0 (eq. 3.1). The tangential part of h is minus the gradient of the
//! path's length L(u,v) = |p| + |a| along the surface, so by Fermat's principle these are the stationary points of L with light and eye on
//! the same side of the tangent plane. On a sphere this is Alhazen's problem.
//!
//! # Changes
//! Ulmet minimises |h|^2 by a simplex search from a start, which finds one point, or a minimum that is none. Here every patch is
//! searched. A patch is a bicubic, or the bicubics of its rings, down to 1e-12 of the surface round an extraordinary vertex. Each is halved
//! until a piece
//! * has no stationary point: the sum of the unit vectors to light and eye, known on the whole piece up to the angle under which they
//!   see it, has products of one sign with all control vectors of some direction along the surface; or the gradient keeps its sign
//!   along an eigenvector of the Hessian, whose change the second control differences bound; or
//! * is so small that the Hessian changes little: then there is one such point or none, and Newton's method must find it.
//!
//! Both are proofs, up to rounding. What is undecided after 54 halvings, or in more than 4096 pieces at a time, is a degenerate point: on a
//! caustic of the eye, or one of a curve of points. Points on shared edges are found by both patches and reported once.
//!
//! # Practice
//! [`physical_reflections`] gives the points that mirror, [`stationary_points`] also those where the path goes through the surface. Normals
//! are those of [`LimitSurface`]: on a sharp edge each side answers for its own. Both sides of the surface mirror, and nothing hides
//! anything, as in Ulmet: whether another part of the surface is in the way is for the caller to ask.

mod bezier;
mod ends;
mod gather;
mod piece;
mod search;

pub use ends::PathEnd;

use crate::curves::Place;
use crate::stam::LimitSurface;
use ends::Ends;
use glam::DVec3;
use rayon::prelude::*;

/// A point of the surface at which the length of the path from the light over it to the eye is stationary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Where it is.
    pub place: Place,
    /// The same as patch and patch-local (u,v), which have more digits near the corners of a face.
    pub patch: usize,
    /// Each 0 to 1.
    pub uv: [f64; 2],
    /// World space.
    pub position: DVec3,
    /// Unit normal there; on sharp edges, of the side that it was found on.
    pub normal: DVec3,
    /// Light and eye are on the same side of the tangent plane: the path is mirrored. Otherwise it goes through the surface.
    pub mirrors: bool,
    /// |h| of Ulmet's eq. 3.1, without unit: an angle in radians, for small ones. Where the path goes through, the length of the tangential
    /// part of h.
    pub residual: f64,
    /// What kind of stationary point it is.
    pub nature: Nature,
}

/// How the length of the path changes round a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Nature {
    /// It is shortest or longest there.
    Extremum,
    /// It is shorter to two sides and longer to the two between. Mirror images are turned round.
    Saddle,
    /// An extraordinary vertex, where curvature need not exist.
    Vertex,
    /// Several points in one, or a curve or an area of points, of which this is one: a caustic. Or too many to tell apart: then the residual
    /// may be large.
    Degenerate {
        /// Diagonal of the box that holds all of them, world units.
        extent: f64,
    },
}

/// All points of the surface that mirror `light` into `eye`, in the order of their places. On both sides of the surface; whether something
/// hides the light or the point is not looked at.
///
/// Two points within 1e-9 of the surface's diagonal count as one. A light or an eye on the surface itself is no such point.
pub fn physical_reflections(surface: &LimitSurface, light: PathEnd, eye: PathEnd) -> Vec<PathPoint> {
    let mut points = stationary_points(surface, light, eye);
    points.retain(|point| point.mirrors);
    points
}

/// All points at which the length of the path from `light` over the surface to `eye` is stationary: [`physical_reflections`], and those where
/// the path goes through. On a smooth closed surface that holds neither light nor eye, extrema less saddles are its Euler characteristic
/// (Poincare and Hopf), which tests rely on.
pub fn stationary_points(surface: &LimitSurface, light: PathEnd, eye: PathEnd) -> Vec<PathPoint> {
    let ends = Ends([light, eye]);
    let patches = 0..surface.patches().len();
    let findings: Vec<_> = patches.into_par_iter().map(|patch| search::search(surface, patch, &ends)).collect();
    gather::gather(surface, &ends, &findings)
}
