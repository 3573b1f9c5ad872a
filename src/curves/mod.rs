//! Contours of a field as exact curves on the limit surface.
//!
//! Theory: the lines that a surface mirrors are the contours f(u,v) = c of a function of its parameters (Ulmet 2003, Theorem RL and
//! RC; for highlight lines Beier & Chen 1994, eq. 7). A contour is the zero set of a smooth function F, see [`Contour`], as far as it
//! is valid. Patches are cut into bicubic pieces, along the levels of extraordinary vertices, and pieces into quarters, until on each
//! cell F has no zero or is monotone along an axis, and on the cell's sides has at most one zero each: then the signs at the corners
//! say what runs through it, and no loop is missed. What F does on a cell is read off the Bernstein coefficients of a polynomial of degree 4
//! through 25 of its values, with a margin for the polynomial's error, which is measured, not proven.
//! Changes against Ulmet, sec. 5: no grid that a loop could slip through, and no division by s . k, so that lines run up to the
//! horizon of the light.
//! How far chords are from the contour is bounded, not sampled: see `chord`.
//! Practice: all points are zeros of F to the last digits, found between bounds. Values are moved by a few roundings: where a mesh
//! is symmetric, contours lie on edges and meet in saddles, and the contour of a moved value does neither. So lines that meet in a
//! saddle pass it at about a millionth of its size, as one of the two pairs of branches.

mod arc;
mod chord;
mod divide;
mod join;
mod levels;
mod model;
mod occluder;
mod piece;
mod visible;

pub use visible::{Look, visible};

use crate::field::{Camera, Contour, Field};
use crate::stam::LimitSurface;
use arc::Arc;
use divide::Wanted;
use glam::DVec3;
use join::Chain;
use piece::Scene;
use rayon::prelude::*;

/// A place of the limit surface: ptex face and its parameters, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Ptex face.
    pub face: u32,
    /// Parameter along the face's first edge.
    pub u: f64,
    /// Parameter along the face's last edge.
    pub v: f64,
}

/// A contour, or the part of one that is in one piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Value of the field's first coordinate on it.
    pub value: f64,
    /// Which light of the family: the number k of the value k spacing.
    pub light: i32,
    /// The last point is joined to the first, which is not repeated.
    pub closed: bool,
    /// Points on the surface, world space.
    pub points: Vec<DVec3>,
    /// Where these are, a place each.
    pub places: Vec<Place>,
}

/// Roundings by which values are moved: many times what evaluation makes, and far below what anybody asks for.
const MOVED: f64 = 512.0;

/// Part of the tolerance by which arcs that are joined may end at different points before both are kept: rounding is far less, but ends at
/// sharp edges are joined up to a billionth of the diagonal. What is left out moves a chord by no more, which arcs leave room for.
const JOINT: f64 = 0.01;

/// Part of the tolerance below which a whole line is no line: normals at some corners turn for ever, by one over the level.
const SHORTEST: f64 = 1e-3;

/// The contours of a field, as `camera` sees it, for pairs of light and value; chords are within `tolerance` of the surface's curve,
/// world units.
///
/// The number of the light selects the light where the field is the distance from the nearest one; elsewhere it is only written to the
/// curve. A contour ends at boundaries and holes, where the field ceases (a mirrored ray parallel to the light plane), and at sharp
/// edges on both sides, unless both end at the same place. Lines shorter than a thousandth of the tolerance are left out. Curves come in the order of `values`; the same call gives the same curves.
///
/// # Panics
/// `tolerance` is not above 0.
pub fn trace(
    surface: &LimitSurface,
    field: &Field,
    camera: &Camera,
    values: &[(i32, f64)],
    tolerance: f64,
) -> Vec<Curve> {
    assert!(tolerance > 0.0, "a tolerance is above 0");
    let scene = Scene { surface, field, camera };
    let moved = |(light, value): (i32, f64)| {
        let contour: Option<Contour> = field.contour(light, value + MOVED * field.rounding(value, surface));
        contour.map(|contour| Wanted { light, value, contour })
    };
    let wanted: Vec<Wanted> = values.iter().copied().filter_map(moved).collect();
    let arcs: Vec<Arc> = (0..surface.patches().len())
        .into_par_iter()
        .flat_map_iter(|patch| divide::divide(scene, patch, &wanted, tolerance))
        .collect();
    let mut families: Vec<Vec<Arc>> = wanted.iter().map(|_| Vec::new()).collect();
    arcs.into_iter().for_each(|arc| families[arc.wanted].push(arc));
    let adjacency = surface.adjacency();
    let curves = families.par_iter().zip(&wanted).flat_map_iter(|(arcs, wanted)| {
        let mut chains = join::join(arcs, &adjacency, surface.diagonal());
        chains.sort_by_key(|chain| chain.arcs[0].0);
        let curves = chains.into_iter().map(|chain| Curve::new(surface, wanted, arcs, &chain, JOINT * tolerance));
        curves.filter(|curve| curve.points.len() > 1 && curve.length() > SHORTEST * tolerance)
    });
    curves.collect()
}

impl Curve {
    fn new(surface: &LimitSurface, wanted: &Wanted, arcs: &[Arc], chain: &Chain, joint: f64) -> Curve {
        let Wanted { light, value, .. } = *wanted;
        let mut curve = Curve { value, light, closed: chain.closed, points: Vec::new(), places: Vec::new() };
        for &(arc, turned) in &chain.arcs {
            curve.append(surface, &arcs[arc], turned, joint);
        }
        let is_round = |points: &[DVec3]| points[0].distance(points[points.len() - 1]) <= joint;
        if curve.closed && curve.points.len() > 1 && is_round(&curve.points) {
            // The end of the last arc is the start of the first.
            curve.points.pop();
            curve.places.pop();
        }
        curve.without_repeats()
    }

    fn append(&mut self, surface: &LimitSurface, arc: &Arc, turned: bool, joint: f64) {
        let patch = &surface.patches()[arc.patch];
        let count = arc.points.len();
        let first = if turned { count - 1 } else { 0 };
        // Where arcs are joined they share a point.
        let is_shared = self.points.last().is_some_and(|last| last.distance(arc.points[first]) <= joint);
        for k in usize::from(is_shared)..count {
            let k = if turned { count - 1 - k } else { k };
            let [u, v] = patch.to_ptex(arc.places[k]);
            self.points.push(arc.points[k]);
            self.places.push(Place { face: patch.ptex, u, v });
        }
    }

    /// The curve without points that are those before them, or have the same place; the first of a closed one comes after its last.
    pub(crate) fn without_repeats(mut self) -> Curve {
        let is_repeated = |curve: &Curve, a: usize, b: usize| {
            curve.points[a] == curve.points[b] || curve.places[a] == curve.places[b]
        };
        let mut kept: Vec<usize> = Vec::with_capacity(self.points.len());
        for k in 0..self.points.len() {
            if kept.last().is_none_or(|&last| !is_repeated(&self, last, k)) {
                kept.push(k);
            }
        }
        while self.closed && kept.len() > 1 && is_repeated(&self, kept[0], kept[kept.len() - 1]) {
            kept.pop();
        }
        if kept.len() < self.points.len() {
            self.points = kept.iter().map(|&k| self.points[k]).collect();
            self.places = kept.iter().map(|&k| self.places[k]).collect();
        }
        self
    }

    /// Its length, world units.
    pub fn length(&self) -> f64 {
        let open: f64 = self.points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let closing = if self.closed { self.points[0].distance(self.points[self.points.len() - 1]) } else { 0.0 };
        open + closing
    }
}
