//! Joins arcs across the sides of cells and patches into curves.

use super::arc::{Arc, End, Side};
use crate::patch::Adjacency;
use glam::DVec3;
use std::collections::HashMap;

/// What ends at a sharp edge is one line if both sides end at the same place, to this part of the diagonal.
const SAME_PLACE: f64 = 1e-9;

/// A chain of arcs; the flag turns an arc round.
pub(super) struct Chain {
    pub arcs: Vec<(usize, bool)>,
    pub closed: bool,
}

/// End 2 k is the first of arc k, 2 k + 1 its last.
struct Ends<'a> {
    arcs: &'a [Arc],
    /// What each end is joined to.
    mates: Vec<Option<usize>>,
}

/// Two ends that may belong together, nearest first.
struct Pair {
    distance: f64,
    ends: [usize; 2],
}

/// Which ends are on one line of one patch: patch, constant parameter and its value.
type Line = (usize, usize, u64);

/// Chains the arcs of a contour.
pub(super) fn join(arcs: &[Arc], adjacency: &Adjacency, diagonal: f64) -> Vec<Chain> {
    let mut ends = Ends { arcs, mates: vec![None; 2 * arcs.len()] };
    let mut lines: HashMap<Line, Vec<usize>> = HashMap::new();
    for end in 0..2 * arcs.len() {
        if let Some(side) = ends.side(end) {
            lines.entry((arcs[end / 2].patch, side.axis, side.constant.to_bits())).or_default().push(end);
        }
    }
    let mut pairs = Vec::new();
    for (&(patch, axis, constant), on_line) in &lines {
        match edge(axis, f64::from_bits(constant)) {
            None => ends.inside(on_line, &mut pairs),
            Some(edge) => {
                let others = |patch: usize, edge: u8| {
                    let (axis, constant) = line_of(edge);
                    lines.get(&(patch, axis, constant.to_bits())).map_or(&[][..], Vec::as_slice)
                };
                ends.across(patch, edge, on_line, adjacency, others, SAME_PLACE * diagonal, &mut pairs);
            }
        }
    }
    ends.take(pairs);
    let left = ends.left_over(SAME_PLACE * diagonal);
    ends.take(left);
    ends.chains()
}

/// The edge of the patch that a line is, if it is one.
fn edge(axis: usize, constant: f64) -> Option<u8> {
    match (axis, constant) {
        (1, 0.0) => Some(0),
        (0, 1.0) => Some(1),
        (1, 1.0) => Some(2),
        (0, 0.0) => Some(3),
        _ => None,
    }
}

fn line_of(edge: u8) -> (usize, f64) {
    [(1, 0.0), (0, 1.0), (1, 1.0), (0, 0.0)][usize::from(edge)]
}

/// Parameter of an edge, which runs counter-clockwise, at the patch's parameter along it; and back.
fn along_edge(edge: u8, along: f64) -> f64 {
    if edge < 2 { along } else { 1.0 - along }
}

impl Ends<'_> {
    fn side(&self, end: usize) -> Option<Side> {
        match self.arcs[end / 2].ends[end % 2] {
            End::Side(side) => Some(side),
            End::Cut => None,
        }
    }

    fn position(&self, end: usize) -> DVec3 {
        let points = &self.arcs[end / 2].points;
        if end.is_multiple_of(2) { points[0] } else { points[points.len() - 1] }
    }

    /// Pairs on a line inside a patch: one from each side, no further apart than the longer cell.
    fn inside(&self, on_line: &[usize], pairs: &mut Vec<Pair>) {
        for (k, &a) in on_line.iter().enumerate() {
            for &b in &on_line[k + 1..] {
                let (Some(first), Some(second)) = (self.side(a), self.side(b)) else { continue };
                let distance = (first.along - second.along).abs();
                if first.above != second.above && distance <= first.length.max(second.length) {
                    pairs.push(Pair { distance, ends: [a, b] });
                }
            }
        }
    }

    /// Pairs across an edge of a patch; where it is sharp, they must be at the same place.
    #[expect(clippy::too_many_arguments, reason = "one edge, and all that is known of both sides")]
    fn across<'b>(
        &self,
        patch: usize,
        edge: u8,
        on_line: &[usize],
        adjacency: &Adjacency,
        others: impl Fn(usize, u8) -> &'b [usize],
        same: f64,
        pairs: &mut Vec<Pair>,
    ) {
        for neighbour in adjacency.across(patch, edge) {
            let other_ends = others(neighbour.patch as usize, neighbour.edge);
            let [low, high] = neighbour.own;
            let stretch = (neighbour.other[1] - neighbour.other[0]) / (high - low);
            for &a in on_line {
                let Some(own) = self.side(a) else { continue };
                let t = along_edge(edge, own.along);
                for &b in other_ends.iter().filter(|&&b| b > a) {
                    let Some(other) = self.side(b) else { continue };
                    let mapped = low + (along_edge(neighbour.edge, other.along) - neighbour.other[0]) / stretch;
                    let reach = own.length.max(other.length / stretch.abs());
                    let is_on_piece = mapped >= low - reach && mapped <= high + reach;
                    let is_same = !neighbour.sharp || self.position(a).distance(self.position(b)) <= same;
                    if is_on_piece && is_same && (mapped - t).abs() <= reach {
                        pairs.push(Pair { distance: (mapped - t).abs(), ends: [a, b] });
                    }
                }
            }
        }
    }

    /// Pairs of what is left at one place: round an extraordinary vertex that no level resolves.
    fn left_over(&self, same: f64) -> Vec<Pair> {
        let cell = |p: DVec3| (p / (4.0 * same)).round().as_i64vec3();
        let mut at: HashMap<glam::I64Vec3, Vec<usize>> = HashMap::new();
        let mut pairs = Vec::new();
        for end in (0..self.mates.len()).filter(|&end| self.mates[end].is_none() && self.side(end).is_some()) {
            let here = at.entry(cell(self.position(end))).or_default();
            for &other in here.iter() {
                let distance = self.position(end).distance(self.position(other));
                if distance <= same {
                    pairs.push(Pair { distance, ends: [other, end] });
                }
            }
            here.push(end);
        }
        pairs
    }

    /// Joins pairs, nearest first.
    fn take(&mut self, mut pairs: Vec<Pair>) {
        pairs.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.ends.cmp(&b.ends)));
        for Pair { ends: [a, b], .. } in pairs {
            if self.mates[a].is_none() && self.mates[b].is_none() {
                self.mates[a] = Some(b);
                self.mates[b] = Some(a);
            }
        }
    }

    /// Follows the joints: first from free ends, then round what is closed.
    fn chains(&self) -> Vec<Chain> {
        let mut seen = vec![false; self.arcs.len()];
        let mut chains = Vec::new();
        let mut follow = |start: usize, closed: bool| {
            let mut arcs = Vec::new();
            let mut end = start;
            loop {
                if std::mem::replace(&mut seen[end / 2], true) {
                    break;
                }
                arcs.push((end / 2, end % 2 == 1));
                match self.mates[end ^ 1] {
                    Some(next) => end = next,
                    None => break,
                }
            }
            if !arcs.is_empty() {
                chains.push(Chain { arcs, closed });
            }
        };
        for end in (0..self.mates.len()).filter(|&end| self.mates[end].is_none()) {
            follow(end, false);
        }
        for end in (0..self.mates.len()).step_by(2) {
            follow(end, true);
        }
        chains
    }
}
