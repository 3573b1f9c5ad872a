//! Samples, grouped by the polynomial that they lie on.

use super::pieces::{self, PIECE_LEVELS, Plan};
use crate::stam::real::Real;
use crate::stam::{LimitSurface, Window};
use rayon::prelude::*;
use std::ops::Range;

/// Where a sample lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// On a piece, at (u,v) from its middle in parameters of the ptex face.
    Piece(u32, [f64; 2]),
    /// On a patch that has no piece there.
    Patch(u32, [f64; 2]),
    /// Nowhere: the ptex face is a hole.
    Hole,
}

impl Place {
    #[inline]
    pub fn new(surface: &LimitSurface, plan: &Plan, ptex: u32, uv: [f64; 2]) -> Self {
        let Some((patch, local)) = surface.locate(ptex, uv) else { return Self::Hole };
        let [first, next] = [plan.first[patch], plan.first[patch + 1]];
        let (piece, middle) = match next - first {
            0 => return Self::Patch(patch as u32, local),
            1 => (first, [0.5; 2]),
            _ => {
                let window = Window::at(local);
                if window.level as usize > PIECE_LEVELS {
                    return Self::Patch(patch as u32, local);
                }
                // Windows (1,0), (1,1) and (0,1) start at points 1, 6 and 5.
                let own = [0, 0, 0, 0, 0, 2, 1][window.first];
                (first + 3 * (window.level - 1) + own, pieces::middle(window.level as usize, own as usize))
            }
        };
        let middle = surface.patches()[patch].to_ptex(middle);
        Self::Piece(piece, [uv[0] - middle[0], uv[1] - middle[1]])
    }

    /// Samples of a piece come together, then those of patches, then holes.
    fn key(&self) -> (u8, u32) {
        match *self {
            Self::Piece(piece, _) => (0, piece),
            Self::Patch(patch, _) => (1, patch),
            Self::Hole => (2, 0),
        }
    }
}

/// Samples of the limit surface, in the order in which they are evaluated fastest: those on one polynomial together. Control points
/// may move; the places stay.
#[derive(Debug, Clone)]
pub struct Samples<T> {
    pub(super) u: Vec<T>,
    pub(super) v: Vec<T>,
    /// Pieces, and which samples lie on each; all of these come first.
    pub(super) runs: Vec<(u32, Range<u32>)>,
    /// The next samples: patch and its parameters. What comes after them are holes.
    pub(super) others: Vec<(u32, [f64; 2])>,
    pub(super) order: Vec<u32>,
}

impl<T: Real> Samples<T> {
    pub(super) fn new(surface: &LimitSurface, plan: &Plan, samples: &[(u32, T, T)]) -> Self {
        let place = |(index, &(ptex, u, v)): (usize, &(u32, T, T))| {
            (Place::new(surface, plan, ptex, [u.to_f64(), v.to_f64()]), index as u32)
        };
        let mut placed: Vec<(Place, u32)> = samples.par_iter().enumerate().map(place).collect();
        // Stable: samples that are grouped already keep their order.
        placed.par_sort_by_key(|(place, _)| place.key());
        let mut out = Self {
            u: Vec::with_capacity(samples.len()),
            v: Vec::with_capacity(samples.len()),
            runs: Vec::new(),
            others: Vec::new(),
            order: placed.iter().map(|&(_, index)| index).collect(),
        };
        for (place, _) in placed {
            match place {
                Place::Piece(piece, [u, v]) => {
                    out.u.push(T::of(u));
                    out.v.push(T::of(v));
                    let end = out.u.len() as u32;
                    match out.runs.last_mut() {
                        Some((last, range)) if *last == piece => range.end = end,
                        _ => out.runs.push((piece, end - 1..end)),
                    }
                }
                Place::Patch(patch, uv) => out.others.push((patch, uv)),
                Place::Hole => (),
            }
        }
        out
    }
}

impl<T> Samples<T> {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// For each sample in the order of evaluation, which one it was when they were placed.
    pub fn order(&self) -> &[u32] {
        &self.order
    }
}
