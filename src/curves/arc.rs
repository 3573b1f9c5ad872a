//! A contour within one cell: its ends on the cell's border, and points between them.

use super::chord::{Strip, Tip, distance};
use super::model::{Line, Model, Rect, Sum};
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

impl Node {
    fn tip(self) -> Tip {
        Tip { at: self.at, position: self.position }
    }
}

/// Share of the tolerance that chords are held to. The rest is for where arcs meet: see `JOINT` in the module above.
const SHARE: f64 = 0.98;
/// Share of the tolerance that the polynomials' error may take before better ones are made for some chords at once, if no more than so many
/// tolerances are left without it: those of one halving.
const SHARE_OF_ERROR: f64 = 0.5;
const SOON: f64 = 4.0;
/// What the error of a polynomial on a smaller rectangle is over the larger one's, at most, where it helps: at kinks of a field it is a
/// half, in rounding it is 1.
const BETTER: f64 = 0.7;
/// Where chords are measured that nothing bounds, and the share of the tolerance that they are held to there.
const MEASURED: [f64; 3] = [0.5, 0.25, 0.75];
const SHARE_MEASURED: f64 = 0.7;
/// Most halvings of an arc.
const HALVINGS: u32 = 16;
/// Halvings of an arc, at most, that look for a place where it ceases to be valid; and how far V may be from linear, over its least
/// value, where there is none.
const HALVINGS_CUT: u32 = 4;
const SAFE: f64 = 0.5;

/// A cell, and F and V on it.
#[derive(Clone, Copy)]
pub(super) struct Cell<'a> {
    pub rect: Rect,
    pub sum: &'a Sum,
    pub valid: Option<&'a Sum>,
}

/// A contour on a cell, single-valued along an axis.
struct Graph<'a> {
    cell: Cell<'a>,
    axis: usize,
    strip: Strip,
    /// All of the cell's zero set is the contour.
    is_valid: bool,
    /// No polynomial on a smaller rectangle is better.
    is_finest: bool,
}

impl<'a> Graph<'a> {
    fn new(piece: &Piece, cell: Cell<'a>, axis: usize) -> Graph<'a> {
        let strip = Strip::new(piece, cell.rect, cell.sum, axis);
        let is_valid = cell.valid.is_none_or(|valid| valid.range()[0] > 0.0);
        Graph { cell, axis, strip, is_valid, is_finest: false }
    }

    /// Whether V does not pass 0 between two nodes on the same side of it: as far as it is linear, it is known between them and their
    /// middle.
    fn keeps_sign(&self, [from, to]: [Node; 2]) -> bool {
        let Some(valid) = self.cell.valid.filter(|_| !self.is_valid) else { return true };
        let Rect { low, high } = self.cell.rect;
        let across = 1 - self.axis;
        let part = (0.5 * (from.at[across] + to.at[across]) - low[across]) / (high[across] - low[across]);
        let zero = self.cell.sum.line(self.axis, part).zero();
        let middle = valid.value(if self.axis == 0 { [zero, part] } else { [part, zero] });
        let bend = (middle - 0.5 * (from.valid + to.valid)).abs();
        bend <= SAFE * from.valid.abs().min(to.valid.abs()).min(middle.abs())
    }
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
        let graph = Graph::new(self.piece, cell, axis);
        self.fill(&graph, [first, last], 0, &mut nodes);
        nodes.push(last);
        self.emit_valid(&graph, &nodes, [from, to], out);
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
    fn fill(&self, graph: &Graph, [from, to]: [Node; 2], halvings: u32, out: &mut Vec<Node>) {
        let [a, b] = [from, to].map(|node| node.at[1 - graph.axis]);
        if halvings == HALVINGS || a == b {
            return;
        }
        let is_cut = (from.valid > 0.0) != (to.valid > 0.0);
        let is_known = is_cut || halvings >= HALVINGS_CUT || graph.keeps_sign([from, to]);
        // What is not the contour needs no points.
        let is_contour = from.valid > 0.0 || to.valid > 0.0;
        if is_known {
            if !is_contour {
                return;
            }
            let bound = graph.strip.bound([from, to].map(Node::tip));
            if bound.distance <= SHARE * self.tolerance {
                return;
            }
            let by_curve = if bound.by_error.is_finite() { bound.distance - bound.by_error } else { 0.0 };
            let is_spoilt = by_curve <= SHARE * self.tolerance
                || by_curve <= SOON * self.tolerance && bound.by_error > SHARE_OF_ERROR * self.tolerance;
            if is_spoilt {
                if graph.is_finest {
                    if self.is_near(graph, [from, to]) {
                        return;
                    }
                } else {
                    let rect = graph.strip.around([from, to].map(Node::tip), bound.width);
                    return self.fill_finer(graph, rect, [from, to], halvings, out);
                }
            }
        }
        let Some(middle) = self.across(&graph.cell, graph.axis, a + 0.5 * (b - a)) else { return };
        self.fill(graph, [from, middle], halvings + 1, out);
        out.push(middle);
        self.fill(graph, [middle, to], halvings + 1, out);
    }

    /// Adds nodes between two by polynomials on the smaller rectangle that holds the contour there, where that makes them better.
    fn fill_finer(&self, graph: &Graph, rect: Rect, ends: [Node; 2], halvings: u32, out: &mut Vec<Node>) {
        let Contour { zero, valid } = self.contour;
        let sums = Model::new(self.scene, self.piece, &rect)
            .ok()
            .map(|model| (model.sum(zero), valid.map(|weights| model.sum(&weights))));
        match &sums {
            Some((sum, valid)) if sum.error < BETTER * graph.cell.sum.error => {
                let cell = Cell { rect, sum, valid: valid.as_ref() };
                self.fill(&Graph::new(self.piece, cell, graph.axis), ends, halvings, out);
            }
            _ => {
                let strip = Strip::new(self.piece, graph.cell.rect, graph.cell.sum, graph.axis);
                let finest = Graph { cell: graph.cell, strip, is_finest: true, ..*graph };
                self.fill(&finest, ends, halvings, out);
            }
        }
    }

    /// Whether the contour is near a chord at the places where it is measured: for where rounding, or a kink of the field, leaves
    /// polynomials that say nothing.
    fn is_near(&self, graph: &Graph, [from, to]: [Node; 2]) -> bool {
        let [a, b] = [from, to].map(|node| node.at[1 - graph.axis]);
        let ends = [from.position, to.position];
        from.position.distance(to.position) <= self.tolerance
            || MEASURED.into_iter().all(|part| {
                let node = self.across(&graph.cell, graph.axis, a + part * (b - a));
                node.is_none_or(|node| distance(node.position, ends) <= SHARE_MEASURED * self.tolerance)
            })
    }

    /// The valid parts of a chain of nodes, cut where V passes 0.
    fn emit_valid(&self, graph: &Graph, nodes: &[Node], sides: [Side; 2], out: &mut Vec<Arc>) {
        let mut run: Vec<Node> = Vec::new();
        let mut start = End::Side(sides[0]);
        for (k, &node) in nodes.iter().enumerate() {
            let is_valid = node.valid > 0.0;
            if k > 0 && is_valid != (nodes[k - 1].valid > 0.0) {
                let before = nodes[k - 1];
                let pair = if is_valid { [node, before] } else { [before, node] };
                let edge = self.last_valid(&graph.cell, graph.axis, pair);
                // A part of a chord is another chord, which may be farther from the contour.
                if is_valid {
                    start = End::Cut;
                    run.push(edge);
                    self.fill(graph, [edge, node], 0, &mut run);
                } else {
                    self.fill(graph, [before, edge], 0, &mut run);
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
