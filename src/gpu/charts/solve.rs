//! One sample on one piece, in f64: for what is smaller than a few samples, and for silhouettes.

use super::lens::Lens;
use super::piece::{Bounds, Piece, Seen};
use super::{BAND, Frame, MAX_DISTORTION};

/// A point of the surface that a sample sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Parameters of the patch.
    pub uv: [f64; 2],
    pub depth: f64,
}

/// Halvings after which a piece is a point, whatever its bounds say.
const DEEPEST: u32 = 96;
/// Samples that a piece may span and be a point: a fifth of the 0.01 pixel within which silhouettes are to be right.
pub(super) const POINT: f64 = 2e-4;

/// The first point of a piece that the sample at `p` sees: by Newton's method where the projection is a chart, by halving
/// elsewhere. Within [`BAND`] of the piece's border, the border is seen.
pub(super) fn first_hit(lens: &Lens, piece: &Piece, bounds: &Bounds, p: [f64; 2]) -> Option<Hit> {
    if let Some(frame) = chart(lens, piece, bounds) {
        return newton(lens, piece, &frame, p).filter(|hit| hit.depth >= lens.near);
    }
    let mut first: Option<Hit> = None;
    let keep = |first: &mut Option<Hit>, hit: Hit| {
        if hit.depth >= lens.near && first.is_none_or(|first| hit.depth < first.depth) {
            *first = Some(hit);
        }
    };
    let mut stack = vec![(piece.clone(), Seen::Within(*bounds), 0)];
    while let Some((piece, seen, depth)) = stack.pop() {
        match seen {
            Seen::No => continue,
            Seen::Within(bounds) => {
                if !bounds.contains(p) || first.is_some_and(|first| !lens.is_nearer(bounds.near, first.depth)) {
                    continue;
                }
                if bounds.extent() < POINT || depth == DEEPEST {
                    keep(&mut first, Hit { uv: piece.to_patch([0.5; 2]), depth: bounds.near });
                    continue;
                }
                if let Some(frame) = chart(lens, &piece, &bounds) {
                    newton(lens, &piece, &frame, p).into_iter().for_each(|hit| keep(&mut first, hit));
                    continue;
                }
            }
            Seen::Straddles if depth == DEEPEST => continue,
            Seen::Straddles => (),
        }
        let along_v = match seen {
            Seen::Within(_) => piece.longer_along_v(lens),
            _ => piece.size[1] > piece.size[0],
        };
        let mut halves = piece.split(along_v).map(|half| {
            let seen = half.seen(lens);
            (half, seen, depth + 1)
        });
        // The nearer one is looked at first: where a piece is seen edge on, all of it lies behind a hit at its near edge.
        if nearest(&halves[0].1) < nearest(&halves[1].1) {
            halves.swap(0, 1);
        }
        stack.extend(halves);
    }
    first
}

fn nearest(seen: &Seen) -> f64 {
    match seen {
        Seen::Within(bounds) => bounds.near,
        _ => f64::NEG_INFINITY,
    }
}

/// The frame of a piece, if it is a chart.
pub(super) fn chart(lens: &Lens, piece: &Piece, bounds: &Bounds) -> Option<Frame> {
    piece.frame(lens, bounds).filter(|frame| frame.distortion < MAX_DISTORTION)
}

/// Newton's method, kept inside the piece. It contracts: see [`MAX_DISTORTION`].
fn newton(lens: &Lens, piece: &Piece, frame: &Frame, p: [f64; 2]) -> Option<Hit> {
    /// Samples by which the last step may move.
    const SETTLED: f64 = 1e-7;
    const STEPS: usize = 64;
    let d = [p[0] - frame.centre[0], p[1] - frame.centre[1]];
    let clamp = |uv: [f64; 2]| uv.map(|x| x.clamp(0.0, 1.0));
    let mut uv = clamp([0, 1].map(|k| frame.start[k] + frame.inverse[k][0] * d[0] + frame.inverse[k][1] * d[1]));
    for _ in 0..STEPS {
        let jet = piece.at(uv);
        let scale = 1.0 / lens.weight(jet.value[2]);
        let at_sample = |v: [f64; 3], weight: f64| [0, 1].map(|k| (v[k] - p[k] * weight) * scale);
        let g = at_sample(jet.value, lens.weight(jet.value[2]));
        let [du, dv] = [jet.du, jet.dv].map(|d| at_sample(d, lens.weight_change(d[2])));
        let determinant = du[0] * dv[1] - du[1] * dv[0];
        let step = [g[1] * dv[0] - g[0] * dv[1], g[0] * du[1] - g[1] * du[0]].map(|x| x / determinant);
        let target = [uv[0] + step[0], uv[1] + step[1]];
        let next = clamp(target);
        let length = |from: [f64; 2], to: [f64; 2]| {
            let [a, b] = [to[0] - from[0], to[1] - from[1]];
            let [x, y] = [a * du[0] + b * dv[0], a * du[1] + b * dv[1]];
            (x * x + y * y).sqrt()
        };
        let (moved, excess) = (length(uv, next), length(next, target));
        if moved < SETTLED {
            let depth = jet.value[2] + (next[0] - uv[0]) * jet.du[2] + (next[1] - uv[1]) * jet.dv[2];
            return (excess <= BAND).then(|| Hit { uv: piece.to_patch(next), depth });
        }
        uv = next;
    }
    None
}
