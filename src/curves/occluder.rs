//! The limit surface as what hides things: does a ray meet it?

use super::piece::Piece;
use crate::field::Ray;
use crate::stam::{LimitSurface, Net};
use glam::DVec3;
use rayon::prelude::*;

/// Part of the diagonal that flat parts may be off the surface by.
const FLAT: f64 = 1e-5;
/// Part of the diagonal below which the rest round an extraordinary vertex is taken as flat, and most levels before.
const REST: f64 = 1e-4;
const LEVELS: usize = 8;
/// Most halvings of a piece.
const HALVINGS: u32 = 16;
/// Pieces in a leaf of the tree.
const LEAF: usize = 4;

/// A bicubic Bezier net, u fastest.
type Net16 = [DVec3; 16];

/// A box.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

/// A tree of boxes over pieces of the surface.
#[derive(Debug)]
pub(super) struct Occluder {
    pieces: Vec<(Bounds, Net16)>,
    nodes: Vec<Node>,
    flat: f64,
}

#[derive(Debug)]
struct Node {
    bounds: Bounds,
    /// The first piece and their number; or, without pieces, the second child: the first one is next.
    first: usize,
    count: usize,
}

impl Occluder {
    pub fn new(surface: &LimitSurface) -> Occluder {
        let diagonal = surface.diagonal();
        let pieces = (0..surface.patches().len()).into_par_iter().flat_map_iter(|patch| pieces(surface, patch));
        let mut pieces: Vec<_> = pieces.map(|net| (Bounds::of(&net), net)).collect();
        let mut nodes = Vec::new();
        let count = pieces.len();
        if count > 0 {
            build(&mut pieces, 0, count, &mut nodes);
        }
        Occluder { pieces, nodes, flat: FLAT * diagonal }
    }

    /// Whether a ray meets the surface at a distance in the range.
    pub fn is_hit(&self, ray: &Ray, range: [f64; 2]) -> bool {
        let mut stack = vec![0];
        while let Some(index) = stack.pop() {
            let Some(node) = self.nodes.get(index) else { continue };
            if !node.bounds.is_met(ray, range) {
                continue;
            }
            if node.count == 0 {
                stack.extend([index + 1, node.first]);
                continue;
            }
            let pieces = &self.pieces[node.first..node.first + node.count];
            if pieces.iter().any(|(bounds, net)| bounds.is_met(ray, range) && self.meets(net, ray, range, 0)) {
                return true;
            }
        }
        false
    }

    fn meets(&self, net: &Net16, ray: &Ray, range: [f64; 2], halvings: u32) -> bool {
        let [along_u, along_v] = bend(net);
        if halvings == HALVINGS || along_u.max(along_v) <= self.flat {
            let [a, b, c, d] = [net[0], net[3], net[12], net[15]];
            return meets_triangle(ray, range, [a, b, d]) || meets_triangle(ray, range, [a, d, c]);
        }
        halves(net, along_v > along_u)
            .iter()
            .any(|half| Bounds::of(half).is_met(ray, range) && self.meets(half, ray, range, halvings + 1))
    }
}

/// The Bezier nets of a patch.
fn pieces(surface: &LimitSurface, patch: usize) -> Vec<Net16> {
    let net = surface.net(patch, LEVELS);
    if let Some(piece) = Piece::regular(patch, &net) {
        return vec![piece.bezier()];
    }
    let mut nets = Vec::new();
    for level in 1..=LEVELS {
        nets.extend(Piece::level(patch, &net, level).iter().map(Piece::bezier));
        let Net::Irregular { limit, .. } = &net else { break };
        let corner = |k: usize| nets[nets.len() - 3 + k];
        // The corners of the square that is left, at those of the three pieces round it.
        let [b, d, c] = [corner(0)[0], corner(1)[0], corner(2)[0]];
        if level == LEVELS || d.distance(*limit) < REST * surface.diagonal() {
            nets.push(std::array::from_fn(|k| {
                let [s, t] = [k % 4, k / 4].map(|i| i as f64 / 3.0);
                limit.lerp(b, s).lerp(c.lerp(d, s), t)
            }));
            break;
        }
    }
    nets
}

/// Cuts the pieces from `start` to `end` in two along the longest side of their middles' box.
fn build(pieces: &mut [(Bounds, Net16)], start: usize, end: usize, nodes: &mut Vec<Node>) {
    let all = &mut pieces[start..end];
    let bounds = all.iter().map(|(bounds, _)| *bounds).reduce(Bounds::with).unwrap_or(Bounds::of(&[]));
    let index = nodes.len();
    nodes.push(Node { bounds, first: start, count: end - start });
    if end - start <= LEAF {
        return;
    }
    let middles = Bounds::of(&all.iter().map(|(bounds, _)| bounds.middle()).collect::<Vec<_>>());
    let extent = middles.high - middles.low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let half = all.len() / 2;
    all.select_nth_unstable_by(half, |a, b| a.0.middle()[axis].total_cmp(&b.0.middle()[axis]));
    build(pieces, start, start + half, nodes);
    let second = nodes.len();
    nodes[index] = Node { bounds, first: second, count: 0 };
    build(pieces, start + half, end, nodes);
}

impl Bounds {
    fn of(points: &[DVec3]) -> Bounds {
        let (low, high) = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
        points.iter().fold(Bounds { low, high }, |all, &p| Bounds { low: all.low.min(p), high: all.high.max(p) })
    }

    fn with(self, other: Bounds) -> Bounds {
        Bounds { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// Slabs (Kay & Kajiya 1986); a direction of 0 gives infinities, which compare as they should unless the ray runs in a side.
    fn is_met(&self, ray: &Ray, [mut near, mut far]: [f64; 2]) -> bool {
        for axis in 0..3 {
            let inverse = 1.0 / ray.direction[axis];
            let [a, b] = [self.low, self.high].map(|side| (side[axis] - ray.origin[axis]) * inverse);
            if !a.is_nan() && !b.is_nan() {
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
        }
        near <= far
    }
}

/// How far a net may be from the plane quad of its corners along u and along v: a bound by second differences (Filip, Magedson &
/// Markot 1986).
fn bend(net: &Net16) -> [f64; 2] {
    let second = |k: usize, step: usize| (net[k] - 2.0 * net[k + step] + net[k + 2 * step]).length();
    let along_u = (0..16).filter(|k| k % 4 < 2).map(|k| second(k, 1)).fold(0.0, f64::max);
    let along_v = (0..8).map(|k| second(k, 4)).fold(0.0, f64::max);
    // The quad may be twisted: then it is two triangles in one of two ways.
    let twist = (net[0] - net[3] - net[12] + net[15]).length();
    [0.75 * along_u + 0.25 * twist, 0.75 * along_v + 0.25 * twist]
}

/// De Casteljau at 1/2.
fn halves(net: &Net16, is_along_v: bool) -> [Net16; 2] {
    let (step, across) = if is_along_v { (4, 1) } else { (1, 4) };
    let mut out = [*net; 2];
    for line in 0..4 {
        let at = |k: usize| line * across + k * step;
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| net[at(k)]);
        let (ab, bc, cd) = (a.midpoint(b), b.midpoint(c), c.midpoint(d));
        let (abc, bcd) = (ab.midpoint(bc), bc.midpoint(cd));
        let middle = abc.midpoint(bcd);
        for (k, p) in [a, ab, abc, middle].into_iter().enumerate() {
            out[0][at(k)] = p;
        }
        for (k, p) in [middle, bcd, cd, d].into_iter().enumerate() {
            out[1][at(k)] = p;
        }
    }
    out
}

/// Moller & Trumbore 1997, both sides.
fn meets_triangle(ray: &Ray, [near, far]: [f64; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let (e, f) = (b - a, c - a);
    let p = ray.direction.cross(f);
    let inverse = 1.0 / e.dot(p);
    let from = ray.origin - a;
    let u = from.dot(p) * inverse;
    let q = from.cross(e);
    let v = ray.direction.dot(q) * inverse;
    let t = f.dot(q) * inverse;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= near && t <= far
}
