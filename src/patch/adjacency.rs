//! What lies across every edge of every patch, T-junctions and ptex faces included.
//!
//! Each edge of a patch is an interval of a *line*: an edge of the control mesh, a spoke between the quadrants of an n-gon,
//! or a line u = const or v = const inside a ptex face. Dyadic intervals on the two sides of a line are matched; where
//! depths differ, an edge has several neighbours, or part of one.

use super::piece::Piece;
use super::{Patch, Patches};
use crate::osd::{INFINITE_SHARPNESS, Level};
use std::collections::HashMap;
use std::ops::Range;

/// Units of a line: intervals are dyadic with at most 11 levels (10 of isolation and the halves of an n-gon's edges).
const UNITS: u32 = 1 << 16;

/// A piece of a patch's edge, and the patch across it.
///
/// Edges are counted from v = 0 counter-clockwise and run that way, t from 0 to 1: (t,0), (1,t), (1-t,1), (0,1-t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Patch across.
    pub patch: u32,
    /// Its edge.
    pub edge: u8,
    /// An infinitely sharp edge lies between: the surface is continuous, its normal is not.
    pub sharp: bool,
    /// The piece: from t = `own[0]` to `own[1]` of the own edge.
    pub own: [f64; 2],
    /// Parameters of the other edge at the two ends of the piece; they run against the own ones.
    pub other: [f64; 2],
    /// Extent of the own patch across the edge over that of the other one.
    pub across: f64,
}

impl Neighbour {
    /// Parameters of a point in the other patch's frame, given in the own frame of edge `edge`: the affine map
    /// that continues the parameters across it. It is exact on the edge; beyond it, away from extraordinary vertices and
    /// sharp edges, both patches agree to second order.
    pub fn carry(&self, edge: u8, [u, v]: [f64; 2]) -> [f64; 2] {
        let (t, beyond) = match edge {
            0 => (u, -v),
            1 => (v, u - 1.0),
            2 => (1.0 - u, v - 1.0),
            _ => (1.0 - v, -u),
        };
        let part = (t - self.own[0]) / (self.own[1] - self.own[0]);
        let t = self.other[0] + part * (self.other[1] - self.other[0]);
        let inside = beyond * self.across;
        match self.edge {
            0 => [t, inside],
            1 => [1.0 - inside, t],
            2 => [1.0 - t, 1.0 - inside],
            _ => [inside, 1.0 - t],
        }
    }
}

/// An edge of a ptex face as an interval of a line.
#[derive(Debug, Clone, Copy)]
struct PtexEdge {
    line: u32,
    /// Part of the line, in halves of it, as the edge runs counter-clockwise round the face: it may run backwards.
    from: u8,
    to: u8,
    kind: PtexEdgeKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PtexEdgeKind {
    /// Of the control mesh.
    Smooth,
    /// Of the control mesh, infinitely sharp.
    Sharp,
    /// Not manifold: nothing lies across.
    Open,
    /// Between two quadrants of an n-gon.
    Spoke,
    /// Between two quadrants of a flat n-gon.
    SharpSpoke,
}

/// The four edges of every ptex face, and the level at which the ptex face is a quad.
#[derive(Debug, Clone, Default)]
pub(super) struct PtexEdges {
    edges: Vec<[PtexEdge; 4]>,
    levels: Vec<u8>,
    /// Control face of each ptex face.
    faces: Vec<u32>,
    lines: u32,
    /// While pieces are put together: the lines that other pieces have too, by the vertices of the control mesh.
    shared: Vec<([u32; 2], u32)>,
}

impl PtexEdges {
    /// Those of a piece's own faces. Lines are counted in the piece: its edges, then its spokes. `creased`: the surface has a
    /// crease along every line.
    pub fn new(control: &Level, piece: &Piece<'_>, creased: bool) -> Self {
        let mut out = Self { lines: control.edge_sharpness.len() as u32, ..Self::default() };
        for face in piece.core.clone() {
            let corners = control.corners(face);
            let size = corners.len();
            // Every control edge is a line from its lower vertex to its higher one.
            let mut whole: Vec<PtexEdge> = Vec::with_capacity(size);
            for [a, b, edge] in control.edges_of_face(face) {
                let (from, to) = if a < b { (0, 2) } else { (2, 0) };
                let faces = control.edge_faces[edge];
                let kind = match creased || control.edge_sharpness[edge] >= INFINITE_SHARPNESS {
                    _ if faces[0] < 0 => PtexEdgeKind::Open,
                    true => PtexEdgeKind::Sharp,
                    false => PtexEdgeKind::Smooth,
                };
                whole.push(PtexEdge { line: edge as u32, from, to, kind });
                let is_beyond = |face: i32| usize::try_from(face).is_ok_and(|face| !piece.core.contains(&face));
                if let Some(vertices) = &piece.vertices
                    && faces.into_iter().any(is_beyond)
                {
                    out.shared.push(([vertices[a.min(b)], vertices[a.max(b)]], edge as u32));
                }
            }
            let control_face = (piece.first_face + face - piece.core.start) as u32;
            if let &[a, b, c, d] = &whole[..] {
                out.edges.push([a, b, c, d]);
                out.levels.push(0);
                out.faces.push(control_face);
                continue;
            }
            // Quadrant k: half of edge k, the spoke to edge k, the spoke to edge k-1 backwards, half of edge k-1.
            let spokes = out.lines;
            out.lines += size as u32;
            let spoke = |k: usize, [from, to]: [u8; 2]| PtexEdge {
                line: spokes + (k % size) as u32,
                from,
                to,
                kind: if creased { PtexEdgeKind::SharpSpoke } else { PtexEdgeKind::Spoke },
            };
            for k in 0..size {
                let before = (k + size - 1) % size;
                out.edges.push([
                    PtexEdge { to: 1, ..whole[k] },
                    spoke(k, [2, 0]),
                    spoke(before, [0, 2]),
                    PtexEdge { from: 1, ..whole[before] },
                ]);
                out.levels.push(1);
                out.faces.push(control_face);
            }
        }
        out
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&self.edges[..]) + size_of_val(&self.levels[..]) + size_of_val(&self.faces[..])
    }

    /// Adds those of the next piece.
    pub fn append(&mut self, mut piece: Self, known: &mut HashMap<[u32; 2], u32>) {
        let mut lines: Vec<u32> = (self.lines..self.lines + piece.lines).collect();
        for (vertices, line) in piece.shared {
            let line = &mut lines[line as usize];
            *line = *known.entry(vertices).or_insert(*line);
        }
        piece.edges.as_flattened_mut().iter_mut().for_each(|edge| edge.line = lines[edge.line as usize]);
        self.lines += piece.lines;
        self.edges.append(&mut piece.edges);
        self.levels.append(&mut piece.levels);
        self.faces.append(&mut piece.faces);
    }
}

/// One edge of one patch on its line.
#[derive(Clone, Copy)]
struct Side {
    /// Which side of the line: the control face, the quadrant of an n-gon, or below and above a line inside a ptex face.
    side: u32,
    patch: u32,
    edge: u8,
    low: u32,
    high: u32,
    /// Runs against the line.
    backwards: bool,
    sharp: bool,
    /// Extent of the patch across the edge.
    across: f64,
}

impl Side {
    /// Parameter of the edge at a place of the line.
    fn parameter(&self, place: u32) -> f64 {
        let part = f64::from(place - self.low) / f64::from(self.high - self.low);
        if self.backwards { 1.0 - part } else { part }
    }
}

/// The neighbours of every patch.
#[derive(Debug)]
pub struct Adjacency {
    /// Neighbours of edge e of patch p: `offsets[4 p + e] .. offsets[4 p + e + 1]`.
    offsets: Vec<u32>,
    neighbours: Vec<Neighbour>,
}

impl Adjacency {
    /// Matches the edges of all patches.
    pub fn new(patches: &Patches) -> Self {
        let mut lines: HashMap<(u32, u32), Vec<Side>> = HashMap::new();
        for (index, patch) in patches.all().iter().enumerate() {
            for edge in 0..4 {
                if let Some((line, side)) = side(patches, patch, index as u32, edge) {
                    lines.entry(line).or_default().push(side);
                }
            }
        }
        let mut found: Vec<(u32, Neighbour)> = Vec::new();
        for mut sides in lines.into_values() {
            sides.sort_by_key(|s| (s.side, s.low));
            let split = sides.partition_point(|s| s.side == sides[0].side);
            let (first, second) = sides.split_at(split);
            if second.iter().all(|s| s.side == second[0].side) {
                matched(first, second, &mut found);
            }
        }
        found.sort_by(|a, b| (a.0, a.1.own[0]).partial_cmp(&(b.0, b.1.own[0])).expect("parameters are numbers"));
        let mut offsets = vec![0; 4 * patches.all().len() + 1];
        for (slot, _) in &found {
            offsets[*slot as usize + 1] += 1;
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        Self { offsets, neighbours: found.into_iter().map(|(_, neighbour)| neighbour).collect() }
    }

    /// The same for runs of these patches one after the other, some of them more than once. No run has neighbours in another.
    pub(crate) fn repeated(&self, runs: impl Iterator<Item = Range<u32>>) -> Self {
        let mut out = Self { offsets: vec![0], neighbours: Vec::new() };
        for run in runs {
            let first = (out.offsets.len() as u32 - 1) / 4;
            let slots = 4 * run.start as usize..4 * run.end as usize;
            let found = self.offsets[slots.start]..self.offsets[slots.end];
            let before = out.neighbours.len() as u32;
            out.offsets.extend(self.offsets[slots.start + 1..=slots.end].iter().map(|at| at - found.start + before));
            let moved = |n: &Neighbour| Neighbour { patch: n.patch - run.start + first, ..*n };
            out.neighbours.extend(self.neighbours[found.start as usize..found.end as usize].iter().map(moved));
        }
        out
    }

    /// What lies across a patch's edge, in the order in which the edge runs; nothing on a boundary, at a hole, or where
    /// the mesh is not manifold.
    pub fn across(&self, patch: usize, edge: u8) -> &[Neighbour] {
        let slot = 4 * patch + usize::from(edge);
        let range: Range<usize> = self.offsets[slot] as usize..self.offsets[slot + 1] as usize;
        &self.neighbours[range]
    }

    /// The neighbour across a patch's edge at parameter `t`, 0 to 1.
    pub fn at(&self, patch: usize, edge: u8, t: f64) -> Option<&Neighbour> {
        let all = self.across(patch, edge);
        all.iter().find(|n| t <= n.own[1]).or(all.last()).filter(|n| t >= n.own[0])
    }
}

/// The line of a patch's edge, and its interval there.
fn side(patches: &Patches, patch: &Patch, index: u32, edge: u8) -> Option<((u32, u32), Side)> {
    let ptex = patch.ptex as usize;
    let cell_edge = (edge + patch.rotation) % 4;
    // Along the ptex parameter that the edge follows: 0 is u, 1 is v.
    let along = usize::from(cell_edge % 2);
    let across = 1 - along;
    let span = |axis: usize| {
        let size = UNITS >> patch.depth[axis];
        (u32::from(patch.origin[axis]) * size, size)
    };
    let (low, length) = span(along);
    let (near, width) = span(across);
    let place = if matches!(cell_edge, 1 | 2) { near + width } else { near };
    let level = patches.ptex_edges.levels[ptex];
    let extent = f64::from(width) / f64::from(UNITS) / f64::from(1u32 << level);
    let part = |backwards: bool, low: u32, high: u32, side: u32, sharp: bool| Side {
        side,
        patch: index,
        edge,
        low,
        high,
        backwards,
        sharp,
        across: extent,
    };
    if place > 0 && place < UNITS {
        // Inside the ptex face: lines are numbered by ptex face, axis and place, behind those of the mesh.
        let line = (patches.ptex_edges.lines + patch.ptex, 2 * place + across as u32);
        let above = u32::from(place == near);
        return Some((line, part(matches!(cell_edge, 2 | 3), low, low + length, above, false)));
    }
    let PtexEdge { line, from, to, kind } = patches.ptex_edges.edges[ptex][usize::from(cell_edge)];
    if kind == PtexEdgeKind::Open {
        return None;
    }
    let [from, to] = [from, to].map(|halves| u32::from(halves) * (UNITS / 2));
    // Counter-clockwise from the start of the ptex edge.
    let start = if matches!(cell_edge, 2 | 3) { UNITS - low - length } else { low };
    let scaled = |x: u32| match from < to {
        true => from + (u64::from(x) * u64::from(to - from) / u64::from(UNITS)) as u32,
        false => from - (u64::from(x) * u64::from(from - to) / u64::from(UNITS)) as u32,
    };
    let [a, b] = [scaled(start), scaled(start + length)];
    // Two quadrants of an n-gon lie on the same side of a control edge.
    let is_spoke = matches!(kind, PtexEdgeKind::Spoke | PtexEdgeKind::SharpSpoke);
    let is_sharp = matches!(kind, PtexEdgeKind::Sharp | PtexEdgeKind::SharpSpoke);
    let side = if is_spoke { patch.ptex } else { patches.ptex_edges.faces[ptex] };
    Some(((line, 0), part(a > b, a.min(b), a.max(b), side, is_sharp)))
}

/// Pieces where an interval of one side overlaps one of the other, both ways.
fn matched(first: &[Side], second: &[Side], found: &mut Vec<(u32, Neighbour)>) {
    let (mut i, mut j) = (0, 0);
    while i < first.len() && j < second.len() {
        let (a, b) = (&first[i], &second[j]);
        let (low, high) = (a.low.max(b.low), a.high.min(b.high));
        if low < high {
            for (own, other) in [(a, b), (b, a)] {
                let ends = if own.backwards { [high, low] } else { [low, high] };
                found.push((
                    4 * own.patch + u32::from(own.edge),
                    Neighbour {
                        patch: other.patch,
                        edge: other.edge,
                        sharp: own.sharp,
                        own: ends.map(|place| own.parameter(place)),
                        other: ends.map(|place| other.parameter(place)),
                        across: own.across / other.across,
                    },
                ));
            }
        }
        if a.high <= b.high {
            i += 1;
        } else {
            j += 1;
        }
    }
}
