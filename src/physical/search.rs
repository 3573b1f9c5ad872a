//! The search of a patch: cut into bicubics, and those into halves until each piece is decided.

use super::bezier;
use super::ends::Ends;
use super::piece::{Piece, Verdict, Zero};
use crate::stam::{LimitSurface, Net, WINDOWS};
use glam::DVec3;

/// Part of the surface's diagonal below which what is left at an extraordinary vertex counts as the vertex itself.
const TIP: f64 = 1e-12;

/// Halvings after which a piece is given up: 2^-27 of a bicubic each way, where differences of path lengths, which grow with the
/// square, are rounding.
const HALVINGS: usize = 54;

/// Undecided pieces of one bicubic at a time from which on it is given up. Isolated points need some ten; whole curves of points, such as
/// the circle that mirrors its own axis, this many after a few halvings.
const MOST: usize = 4096;

/// A bicubic that a patch is made of.
struct Bicubic {
    /// Relative to `origin`.
    net: bezier::Net,
    origin: DVec3,
    /// Corner and side of its square in the patch.
    low: [f64; 2],
    size: f64,
}

/// What was found in a patch.
#[derive(Debug, Default)]
pub(super) struct Findings {
    pub zeros: Vec<Zero>,
    /// Pieces that were given up.
    pub unclear: Vec<Unclear>,
    /// The patch is irregular: its corner (0,0) has not been looked at.
    pub has_tip: bool,
}

/// A piece that was given up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unclear {
    pub patch: usize,
    /// Its middle.
    pub uv: [f64; 2],
    /// Box around it, world space.
    pub bounds: [DVec3; 2],
    /// It is as small as pieces get.
    pub is_smallest: bool,
}

/// Looks for the points of a patch where the path's length is stationary; zeros in patch parameters.
pub(super) fn search(surface: &LimitSurface, patch: usize, ends: &Ends) -> Findings {
    let mut findings = Findings::default();
    let Some(mut rings) = surface.rings(patch) else {
        if let Net::Regular(net) = surface.net(patch, 0) {
            // Relative to a corner: world coordinates would cost digits of the derivatives.
            let origin = net[5];
            let net = bezier::of_spline(&net.map(|p| p - origin));
            Bicubic { net, origin, low: [0.0; 2], size: 1.0 }.search(patch, ends, &mut findings);
        }
        return findings;
    };
    findings.has_tip = true;
    let least = TIP * surface.diagonal();
    while rings.hull().any(|p| p.length() > least) {
        let grid = rings.grid();
        let size = 0.5f64.powi(rings.level() as i32);
        for window in WINDOWS {
            let net = bezier::of_spline(&std::array::from_fn(|k| grid.point(window, k)));
            let bicubic = Bicubic { net, origin: rings.limit(), low: window.map(|k| k as f64 * size), size };
            bicubic.search(patch, ends, &mut findings);
        }
        rings.descend();
    }
    findings
}

impl Bicubic {
    fn search(&self, patch: usize, ends: &Ends, findings: &mut Findings) {
        let ends = ends.relative_to(self.origin);
        let mut undecided = vec![Piece::whole(&self.net)];
        let mut is_smallest = true;
        for _ in 0..HALVINGS {
            let mut next = Vec::new();
            for piece in &undecided {
                match piece.examine(&self.net, &ends) {
                    Verdict::Nowhere => (),
                    Verdict::Once(zero) => findings.zeros.push(Zero { uv: self.in_patch(zero.uv), ..zero }),
                    Verdict::Unclear => next.extend(piece.halves()),
                }
            }
            undecided = next;
            is_smallest = undecided.len() <= MOST;
            if undecided.is_empty() || !is_smallest {
                break;
            }
        }
        findings.unclear.extend(undecided.iter().map(|piece| Unclear {
            patch,
            uv: self.in_patch(piece.middle()),
            bounds: piece.bounds().map(|p| p + self.origin),
            is_smallest,
        }));
    }

    fn in_patch(&self, uv: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|k| (self.low[k] + self.size * uv[k]).clamp(0.0, 1.0))
    }
}
