//! A contour within one cell: its ends on the cell's border, and points between them.

use super::model::{Line, Rect, Sum};
use super::piece::{Piece, Scene};
use crate::field::{Contour, weighted};
use glam::DVec3;

/// A contour within one cell, or the valid part of it.
#[derive(Debug)]
pub(super) struct Arc {
    pub patch: usize,
    /// Index of the contour.
    pub wanted: usize,
    /// Patch-local parameters.
    pub places: Vec<[f64; 2]>,
    /// World space, one a place.
    pub points: Vec<DVec3>,
    pub ends: [End; 2],
}

/// Where an arc ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// On a side of the cell.
    Side(Side),
    /// Inside it: beyond, the zero set is not the contour.
    Cut,
}

/// A place on a line of the patch on which one parameter is constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Side {
    /// The constant parameter: 0 for u, 1 for v.
    pub axis: usize,
    pub constant: f64,
    /// The other parameter.
    pub along: f64,
    /// The cell lies where the constant parameter is larger.
    pub above: bool,
    /// Length of the cell's side, in the patch's parameter: nothing else of the contour is on it.
    pub length: f64,
}

/// A point of the contour while it is traced.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Parameters of the piece.
    at: [f64; 2],
    position: DVec3,
    /// V, above 0 where the zero set is the contour.
    valid: f64,
}

/// A point of the contour as the models see it.
struct Guess {
    position: DVec3,
    /// How far the point may be from there.
    off: f64,
    valid: f64,
}

/// Smallest share of the tolerance that chords are held to at the places where they are measured.
const SHARE: f64 = 0.7;
/// Most halvings of an arc.
const HALVINGS: u32 = 16;
/// Halvings of an arc, at most, that look for a place where it ceases to be valid; and how far V may be from linear, over its least
/// value, where there is none.
const HALVINGS_CUT: u32 = 4;
const SAFE: f64 = 0.5;

/// A cell, and F and V on it.
pub(super) struct Cell<'a> {
    pub rect: Rect,
    pub sum: &'a Sum,
    pub valid: Option<&'a Sum>,
}

/// Draws arcs of one contour on one piece.
pub(super) struct Tracer<'a> {
    pub scene: &'a Scene<'a>,
    pub piece: &'a Piece,
    pub contour: &'a Contour,
    pub wanted: usize,
    pub tolerance: f64,
}

impl Tracer<'_> {
    /// F and V at parameters of the piece.
    fn values(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let Contour { zero, valid } = self.contour;
        let functions = self.piece.functions(self.scene, at)?;
        Some([weighted(zero, &functions), valid.map_or(1.0, |weights| weighted(&weights, &functions))])
    }

    fn node(&self, at: [f64; 2], valid: f64) -> Node {
        Node { at, position: self.piece.position(at), valid }
    }

    /// The arc through a cell on which F is monotone along `axis`, so that there is one value of that parameter for each of the other.
    pub fn simple(&self, cell: Cell, axis: usize, out: &mut Vec<Arc>) {
        if self.is_invalid(&cell, axis) {
            return;
        }
        let crossings = self.crossings(&cell);
        // Two by the signs at the corners; rounding may leave a corner without any.
        let [from, to] = crossings[..] else { return };
        let [(first, from), (last, to)] = [from, to];
        let mut nodes = vec![first];
        self.fill(&cell, axis, [first, last], 0, &mut nodes);
        nodes.push(last);
        self.emit_valid(&cell, axis, &nodes, [from, to], out);
    }

    /// Chords through a cell that is not divided further. Where two lines meet in a saddle, its middle says which ends belong
    /// together.
    pub fn smallest(&self, cell: Cell, out: &mut Vec<Arc>) {
        let crossings = self.crossings(&cell);
        let mut pairs = Vec::new();
        match crossings[..] {
            [a, b] => pairs.push([a, b]),
            // In the order left, right, low, high: each corner of the sign that the middle has not is cut off.
            [left, right, low, high] => {
                let Some([middle, _]) = self.values(cell.rect.at([0.5; 2])) else { return };
                if (middle > 0.0) == (cell.sum.corners[0] > 0.0) {
                    pairs.extend([[left, high], [low, right]]);
                } else {
                    pairs.extend([[left, low], [right, high]]);
                }
            }
            _ => {}
        }
        for [from, to] in pairs {
            let nodes = [from.0, to.0];
            if nodes.iter().all(|node| node.valid > 0.0) {
                out.push(self.arc(&nodes, [End::Side(from.1), End::Side(to.1)]));
            }
        }
    }

    /// Where the contour crosses the sides of a cell, at most once each: left, right, low, high.
    fn crossings(&self, Cell { rect, sum, .. }: &Cell) -> Vec<(Node, Side)> {
        let sides = [(0, false, [0, 2]), (0, true, [1, 3]), (1, false, [0, 1]), (1, true, [2, 3])];
        let crossing = |(axis, end, [first, last]): (usize, bool, [usize; 2])| {
            let signs = [sum.corners[first], sum.corners[last]];
            if (signs[0] > 0.0) == (signs[1] > 0.0) {
                return None;
            }
            let constant = if end { rect.high[axis] } else { rect.low[axis] };
            let place = |along: f64| if axis == 0 { [constant, along] } else { [along, constant] };
            let range = [rect.low[1 - axis], rect.high[1 - axis]];
            let line = sum.line(1 - axis, if end { 1.0 } else { 0.0 });
            let (along, valid) = zero(|x| self.values(place(x)), range, signs[0] > 0.0, &line)?;
            let at = self.piece.to_patch(place(along));
            let side = Side {
                axis,
                constant: at[axis],
                along: at[1 - axis],
                above: !end,
                length: (range[1] - range[0]) * self.piece.size,
            };
            Some((self.node(place(along), valid), side))
        };
        sides.into_iter().filter_map(crossing).collect()
    }

    /// The node of a cell at one value of the parameter that is not monotone.
    fn across(&self, Cell { rect, sum, .. }: &Cell, axis: usize, along: f64) -> Option<Node> {
        let place = |x: f64| if axis == 0 { [x, along] } else { [along, x] };
        let [low, high] = [rect.low[1 - axis], rect.high[1 - axis]];
        let line = sum.line(axis, (along - low) / (high - low));
        let range = [rect.low[axis], rect.high[axis]];
        let (x, valid) = zero(|x| self.values(place(x)), range, line.slope(0.5) < 0.0, &line)?;
        Some(self.node(place(x), valid))
    }

    /// What the models say of the arc at a part of the cell, 0 to 1, along the parameter that is not monotone.
    fn guess(&self, Cell { rect, sum, valid }: &Cell, axis: usize, part: f64) -> Guess {
        let line = sum.line(axis, part);
        let zero = line.zero();
        let place = |x: f64| if axis == 0 { [x, part] } else { [part, x] };
        let off = sum.error / line.slope(zero).abs();
        let [position, beside] =
            [zero, if zero < 0.5 { zero + off } else { zero - off }].map(|x| self.piece.position(rect.at(place(x))));
        Guess {
            position,
            off: if off < 0.5 { position.distance(beside) } else { f64::INFINITY },
            valid: valid.map_or(1.0, |valid| valid.value(place(zero))),
        }
    }

    /// Whether nothing of the arc is the contour, as clearly as the model can say.
    fn is_invalid(&self, cell: &Cell, axis: usize) -> bool {
        const PROBES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
        let Some(valid) = cell.valid.filter(|valid| valid.range()[0] <= 0.0) else { return false };
        let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
        for part in PROBES {
            let zero = cell.sum.line(axis, part).zero();
            let value = valid.value(if axis == 0 { [zero, part] } else { [part, zero] });
            if value >= 0.0 {
                return false;
            }
            (low, high) = (low.min(value), high.max(value));
        }
        high + (high - low) + valid.error < 0.0
    }

    /// Adds nodes between two until chords are within the tolerance, and V does not pass 0 twice between them unseen.
    fn fill(&self, cell: &Cell, axis: usize, [from, to]: [Node; 2], halvings: u32, out: &mut Vec<Node>) {
        let is_cut = (from.valid > 0.0) != (to.valid > 0.0);
        if halvings == HALVINGS || (!is_cut && from.position.distance(to.position) <= self.tolerance) {
            return;
        }
        let [a, b] = [from, to].map(|node| node.at[1 - axis]);
        let [low, high] = [cell.rect.low, cell.rect.high].map(|corner| corner[1 - axis]);
        // Where points are needed is read off the model; the points are not.
        let guess = |part: f64| self.guess(cell, axis, (a + part * (b - a) - low) / (high - low));
        let far = |p: DVec3| distance(p, from.position, to.position) > SHARE * self.tolerance;
        let may_be_far =
            |guess: &Guess| distance(guess.position, from.position, to.position) + guess.off > SHARE * self.tolerance;
        let middle = guess(0.5);
        // As far as V is linear, it is known between the three.
        let bend = (middle.valid - 0.5 * (from.valid + to.valid)).abs();
        let least = from.valid.abs().min(to.valid.abs()).min(middle.valid.abs());
        let is_known = is_cut || bend <= SAFE * least || halvings >= HALVINGS_CUT;
        // What is not the contour needs no points. Bends to both sides may meet the chord in the middle.
        let is_contour = from.valid > 0.0 || to.valid > 0.0;
        if !is_known || (is_contour && (may_be_far(&middle) || may_be_far(&guess(0.25)))) {
            let at = |part: f64| self.across(cell, axis, a + part * (b - a));
            let Some(middle) = at(0.5) else { return };
            if is_known && !far(middle.position) && !at(0.25).is_some_and(|node| far(node.position)) {
                return;
            }
            self.fill(cell, axis, [from, middle], halvings + 1, out);
            out.push(middle);
            self.fill(cell, axis, [middle, to], halvings + 1, out);
        }
    }

    /// The valid parts of a chain of nodes, cut where V passes 0.
    fn emit_valid(&self, cell: &Cell, axis: usize, nodes: &[Node], sides: [Side; 2], out: &mut Vec<Arc>) {
        let mut run: Vec<Node> = Vec::new();
        let mut start = End::Side(sides[0]);
        for (k, &node) in nodes.iter().enumerate() {
            let is_valid = node.valid > 0.0;
            if k > 0 && is_valid != (nodes[k - 1].valid > 0.0) {
                let edge =
                    self.last_valid(cell, axis, if is_valid { [node, nodes[k - 1]] } else { [nodes[k - 1], node] });
                if is_valid {
                    start = End::Cut;
                    run.push(edge);
                } else {
                    run.push(edge);
                    out.push(self.arc(&run, [start, End::Cut]));
                    run.clear();
                }
            }
            if is_valid {
                run.push(node);
            }
        }
        if run.len() > 1 {
            out.push(self.arc(&run, [start, End::Side(sides[1])]));
        }
    }

    /// The last node with V above 0 between one that has it and one that has not, to a millionth of the tolerance: by secants, of
    /// which an end that stays again counts for half as much (the Illinois method).
    fn last_valid(&self, cell: &Cell, axis: usize, [mut valid, mut other]: [Node; 2]) -> Node {
        const CUT: f64 = 1e-6;
        let [mut a, mut b] = [valid.valid, other.valid];
        let mut was_valid = None;
        for _ in 0..60 {
            let [from, to] = [valid, other].map(|node| node.at[1 - axis]);
            if valid.position.distance(other.position) <= CUT * self.tolerance {
                break;
            }
            let part = (a / (a - b)).clamp(1e-3, 0.999);
            let Some(node) = self.across(cell, axis, from + part * (to - from)) else { break };
            let is_valid = node.valid > 0.0;
            let less = if was_valid == Some(is_valid) { 0.5 } else { 1.0 };
            was_valid = Some(is_valid);
            match is_valid {
                true => (valid, a, b) = (node, node.valid, less * b),
                false => (other, a, b) = (node, less * a, node.valid),
            }
        }
        valid
    }

    fn arc(&self, nodes: &[Node], ends: [End; 2]) -> Arc {
        Arc {
            patch: self.piece.patch,
            wanted: self.wanted,
            places: nodes.iter().map(|node| self.piece.to_patch(node.at)).collect(),
            points: nodes.iter().map(|node| node.position).collect(),
            ends,
        }
    }
}

/// Distance of a point from a segment.
pub(super) fn distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (ab, ap) = (b - a, p - a);
    let t = ab.dot(ap) / ab.length_squared();
    (ap - ab * if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 }).length()
}

/// Part of a range within which secants gain digits with every step.
const NEAR: f64 = 1e-6;

/// Product of two steps, over the range's square, beyond which rounding is larger.
const MISSED: f64 = 1e-21;

/// A zero of the first of two functions, which is monotone on a range, to the last digits, and the second one there; `positive`: at the
/// range's start the first is above 0. From the zero of the polynomial that stands in for it by secants, which a tenth step or a third
/// value finds; where they fail, by halves. `None` where the functions are undefined on the way.
fn zero(
    f: impl Fn(f64) -> Option<[f64; 2]>,
    [mut low, mut high]: [f64; 2],
    positive: bool,
    line: &Line,
) -> Option<(f64, f64)> {
    let width = high - low;
    let smallest = 2.0 * f64::EPSILON * high.abs().max(low.abs()).max(width);
    let start = line.zero();
    let slope = line.slope(start) / width;
    let mut x = low + start * width;
    let [mut value, mut other] = f(x)?;
    let mut step = -value / slope;
    let mut before = width;
    for _ in 0..100 {
        if value == 0.0 || high - low <= smallest {
            break;
        }
        // Secants miss by the product of two steps, about.
        if step.abs() <= smallest || (step / width * (before / width)).abs() <= MISSED {
            x = (x + step).clamp(low, high);
            break;
        }
        if (value > 0.0) == positive {
            low = x;
        } else {
            high = x;
        }
        let mut next = x + step;
        if !(next > low && next < high) {
            next = 0.5 * (low + high);
        }
        let [new, beside] = f(next)?;
        // So near, a step that gains nothing has met rounding.
        let is_rounding = new.abs() > 0.25 * value.abs() && step.abs() < NEAR * width;
        if is_rounding && new.abs() >= value.abs() {
            break;
        }
        let secant = -new * (next - x) / (new - value);
        before = next - x;
        (x, value, other) = (next, new, beside);
        if is_rounding {
            break;
        }
        step = if secant.is_finite() { secant } else { 0.5 * (high - low) };
    }
    Some((x, other))
}
