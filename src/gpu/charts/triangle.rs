//! Triangles as squares that end at their diagonals.
//!
//! A quartic triangle goes on beyond its diagonal as a polynomial does, so squares of its parameters are cut like those of any other
//! patch, and what lies beyond is left out where it is found: [`Clip`].

use super::divide::Divider;
use super::piece::Piece;
use crate::gpu::charts::BAND;
use crate::stam::box_spline::{self, BEZIER_POINTS, POINTS};
use crate::stam::{LOOP_WINDOWS, LoopWindow};
use glam::DVec3;

/// Where the triangle that a piece is of ends: u + v is at most `limit`, or at least, in windows that are turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clip {
    limit: f64,
    turned: bool,
}

impl Clip {
    /// How far u + v of the patch is beyond.
    pub fn excess(&self, [u, v]: [f64; 2]) -> f64 {
        if self.turned { self.limit - (u + v) } else { u + v - self.limit }
    }

    /// The piece's own parameters, brought back to the diagonal from beyond: half of what u + v is too much taken from each, but
    /// none is left below zero.
    pub fn brought_back(&self, own: [f64; 2], piece: &Piece) -> [f64; 2] {
        let excess = self.excess(piece.to_patch(own)).max(0.0);
        let size = piece.size.map(f64::abs);
        let from_v = (excess - (0.5 * excess).min(own[0] * size[0])).min(own[1] * size[1]);
        [own[0] - (excess - from_v) / size[0], own[1] - from_v / size[1]]
    }

    /// Whether a square lies beyond: its first corner is the one that is farthest inside.
    pub fn is_beyond(&self, origin: [f64; 2]) -> bool {
        self.excess(origin) >= 0.0
    }

    /// Whether a square reaches beyond.
    pub fn crosses(&self, origin: [f64; 2], size: [f64; 2]) -> bool {
        self.excess([origin[0] + size[0], origin[1] + size[1]]) > 0.0
    }

    /// Whether the limit follows from the first corner of a square, as shaders have it: the next power of two above its u + v,
    /// or below in windows that are turned.
    pub fn follows_from(&self, [u, v]: [f64; 2]) -> bool {
        self.turned || u + v >= 0.5 * self.limit
    }
}

/// A polynomial triangle, projected, and where it lies in the patch.
#[derive(Debug)]
pub(super) struct Quartic {
    bezier: [DVec3; BEZIER_POINTS],
    /// Its corner (0,0), and its extent, below zero where it is turned.
    pub origin: [f64; 2],
    pub size: f64,
    pub clip: Clip,
}

impl Quartic {
    /// A whole regular triangle, from its 12 projected points.
    pub fn whole(net: &[DVec3; POINTS]) -> Quartic {
        let clip = Clip { limit: 1.0, turned: false };
        Quartic { bezier: box_spline::bezier(net), origin: [0.0; 2], size: 1.0, clip }
    }

    /// The windows of a level, from its projected points.
    pub fn windows(level: u32, point: impl Fn(usize) -> DVec3) -> [Quartic; 3] {
        let unit = 0.5f64.powi(level as i32);
        LOOP_WINDOWS.map(|window: LoopWindow| {
            let turned = window.sign < 0.0;
            Quartic {
                bezier: box_spline::bezier(&std::array::from_fn(|k| point(window.point(k)))),
                origin: window.corner().map(|x| x * unit),
                size: window.sign * unit,
                clip: Clip { limit: if turned { unit } else { 2.0 * unit }, turned },
            }
        })
    }

    /// Points whose hull holds the triangle.
    fn hull(&self) -> impl Iterator<Item = DVec3> + Clone {
        self.bezier.iter().copied()
    }

    /// The projected point at parameters of the patch.
    fn at(&self, [u, v]: [f64; 2]) -> DVec3 {
        box_spline::bezier_point(&self.bezier, [(u - self.origin[0]) / self.size, (v - self.origin[1]) / self.size])
    }
}

impl Divider<'_> {
    /// A triangle: quarters until each is as good as bicubic, but for rounding.
    pub(super) fn triangle(&mut self, quartic: &Quartic, owed: [u8; 2]) {
        if self.sees(quartic.hull()) {
            // As of Gregory patches: sums of 15 products, and the weights of the bicubic through them.
            let rounding = 64.0 * f64::EPSILON * quartic.hull().fold(DVec3::ZERO, |most, p| most.max(p.abs()));
            self.square(quartic, rounding, quartic.origin, quartic.size, owed);
        }
    }

    fn square(&mut self, quartic: &Quartic, rounding: DVec3, origin: [f64; 2], size: f64, owed: [u8; 2]) {
        /// Samples by which the bicubic may be off: small against [`BAND`], so that neighbours leave no gap.
        const TOLERANCE: f64 = 0.25 * BAND;
        if quartic.clip.is_beyond(origin) {
            return;
        }
        let at = |[u, v]: [f64; 2]| quartic.at([origin[0] + u * size, origin[1] + v * size]);
        let piece = Piece::through(at, origin, size, owed);
        let gap = piece.gap(|uv| quartic.at(uv));
        let is_bicubic = piece.error(self.lens, &gap) <= TOLERANCE || gap.largest().cmple(rounding).all();
        let crosses = quartic.clip.crosses(origin, [size; 2]);
        let is_clear = !crosses || quartic.clip.follows_from(origin);
        if is_bicubic && is_clear || size.abs() < super::divide::SMALLEST {
            return self.cut(&mut { piece.clipped(crosses.then_some(quartic.clip)) });
        }
        if !is_bicubic && !self.sees_near(&piece, gap.largest()) {
            return;
        }
        let half = 0.5 * size;
        for [i, j] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
            let origin = [origin[0] + i * half, origin[1] + j * half];
            self.square(quartic, rounding, origin, half, owed.map(|levels| levels.saturating_sub(1)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_follow_from_the_first_corners() {
        let net: [DVec3; 16] = std::array::from_fn(|k| DVec3::splat(k as f64));
        for level in [1, 2, 7] {
            for quartic in Quartic::windows(level, |k| net[k]) {
                let Clip { limit, turned } = quartic.clip;
                for [i, j] in [[0.0, 0.0], [0.25, 0.5], [0.125, 0.75], [0.5, 0.375]] {
                    let origin = [quartic.origin[0] + i * quartic.size, quartic.origin[1] + j * quartic.size];
                    let clip = quartic.clip;
                    assert!(!clip.is_beyond(origin) && clip.follows_from(origin));
                    // As the shader has it.
                    let exponent = (origin[0] + origin[1]).log2();
                    let found = if turned { (exponent.ceil() - 1.0).exp2() } else { (exponent.floor() + 1.0).exp2() };
                    assert_eq!(found, limit, "{level} {i} {j} {turned}");
                }
                assert!(quartic.clip.is_beyond([0, 1].map(|k| quartic.origin[k] + 0.5 * quartic.size)));
            }
        }
    }
}
