//! One sample on one piece, in f64: for what is smaller than a few samples, and for silhouettes.

use super::BAND;
use super::bounds::{Bounds, Seen};
use super::frame::{ChartFrame, Flat};
use super::lens::Lens;
use super::piece::Piece;

/// A point of the surface that a sample sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Parameters of the patch.
    pub uv: [f64; 2],
    pub depth: f64,
}

/// Halvings after which a piece is a point, whatever its bounds say.
const DEEPEST: u32 = 96;
/// Samples that a piece may span and be a point: a fiftieth of the 0.01 pixel within which silhouettes are to be right.
pub(super) const POINT: f64 = 2e-4;

/// The first point of a piece that the sample at `p` sees, by halving down to charts. Within [`BAND`] of the piece's border,
/// the border is seen.
pub(super) fn first_hit(lens: &Lens, piece: &Piece, flat: Option<&Flat>, p: [f64; 2]) -> Option<Hit> {
    let mut search = Search { lens, p, first: None };
    search.halves(&mut piece.clone(), flat, 0);
    search.first
}

/// The search for the first point that a sample sees.
struct Search<'a> {
    lens: &'a Lens,
    p: [f64; 2],
    first: Option<Hit>,
}

impl Search<'_> {
    fn piece(&mut self, piece: &mut Piece, seen: Seen, depth: u32) {
        match seen {
            _ if piece.is_beyond() => (),
            Seen::No => (),
            Seen::Straddles if depth == DEEPEST => (),
            Seen::Straddles => self.halves(piece, None, depth),
            Seen::Within(bounds) => self.within(piece, &bounds, depth),
        }
    }

    fn within(&mut self, piece: &mut Piece, bounds: &Bounds, depth: u32) {
        let hidden = |first: Hit| !self.lens.is_nearer(bounds.near, first.depth);
        if !bounds.contains(self.p) || self.first.is_some_and(hidden) {
            return;
        }
        if bounds.extent() < POINT || depth == DEEPEST {
            return self.keep(Hit { uv: piece.to_patch([0.5; 2]), depth: bounds.near });
        }
        let flat = piece.flat(self.lens);
        if let Some(flat) = &flat {
            if flat.misses(self.p) {
                return;
            }
            if let Some(chart) = flat.chart(bounds) {
                return newton(self.lens, piece, &chart, self.p).into_iter().for_each(|hit| self.keep(hit));
            }
        }
        self.halves(piece, flat.as_ref(), depth);
    }

    /// The nearer half first: where a piece is seen edge on, all of it lies behind a hit at its near edge.
    fn halves(&mut self, lower: &mut Piece, flat: Option<&Flat>, depth: u32) {
        let mut upper = lower.split(lower.longer_along_v(self.lens, flat));
        let seen = [lower.seen(self.lens), upper.seen(self.lens)];
        if nearest(&seen[0]) < nearest(&seen[1]) {
            self.piece(lower, seen[0], depth + 1);
            self.piece(&mut upper, seen[1], depth + 1);
        } else {
            self.piece(&mut upper, seen[1], depth + 1);
            self.piece(lower, seen[0], depth + 1);
        }
    }

    fn keep(&mut self, hit: Hit) {
        if self.first.is_none_or(|first| hit.depth < first.depth) && hit.depth >= self.lens.near {
            self.first = Some(hit);
        }
    }
}

fn nearest(seen: &Seen) -> f64 {
    match seen {
        Seen::Within(bounds) => bounds.near,
        _ => f64::NEG_INFINITY,
    }
}

/// Newton's method on a chart, kept inside the piece. It contracts: see [`MAX_DISTORTION`](super::MAX_DISTORTION).
pub(super) fn newton(lens: &Lens, piece: &Piece, chart: &ChartFrame, p: [f64; 2]) -> Option<Hit> {
    /// Samples by which the last step may move.
    const SETTLED: f64 = 1e-7;
    const STEPS: usize = 64;
    let (flat, start) = (chart.frame.flat(p), chart.frame.start);
    let guess = [start[0] + flat[0], start[1] + flat[1]];
    if guess.iter().zip(chart.half).any(|(x, half)| (x - 0.5).abs() > half) {
        return None;
    }
    let clamp = |uv: [f64; 2]| uv.map(|x| x.clamp(0.0, 1.0));
    let mut uv = clamp(guess);
    for _ in 0..STEPS {
        let jet = piece.at(uv);
        let weight = lens.weight(jet.value[2]);
        let scale = 1.0 / weight;
        let at_sample = |v: [f64; 3], weight: f64| [0, 1].map(|k| (v[k] - p[k] * weight) * scale);
        let g = at_sample(jet.value, weight);
        let [du, dv] = [jet.du, jet.dv].map(|d| at_sample(d, lens.weight_change(d[2])));
        let over = 1.0 / (du[0] * dv[1] - du[1] * dv[0]);
        let step = [(g[1] * dv[0] - g[0] * dv[1]) * over, (g[0] * du[1] - g[1] * du[0]) * over];
        let target = [uv[0] + step[0], uv[1] + step[1]];
        let next = clamp(target);
        let length = |from: [f64; 2], to: [f64; 2]| {
            let [a, b] = [to[0] - from[0], to[1] - from[1]];
            let [x, y] = [a * du[0] + b * dv[0], a * du[1] + b * dv[1]];
            (x * x + y * y).sqrt()
        };
        if length(uv, next) < SETTLED {
            let depth = jet.value[2] + (next[0] - uv[0]) * jet.du[2] + (next[1] - uv[1]) * jet.dv[2];
            // What lies beyond the diagonal of a triangle goes back to it.
            let back = piece.clip.map_or(next, |clip| clip.brought_back(next, piece));
            let is_inside = length(next, target) <= BAND && length(next, back) <= BAND;
            return (is_inside && depth >= lens.near).then(|| Hit { uv: piece.to_patch(back), depth });
        }
        uv = next;
    }
    None
}
