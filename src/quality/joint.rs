//! Joints between patches, measured.

use super::control::{Control, Line};
use super::form::{Form, axes};
use super::{Continuity, Extremes, Finding, Limits, LineBreak, Reading};
use crate::curves::Place;
use crate::osd::INFINITE_SHARPNESS;
use crate::patch::{Adjacency, Neighbour, PatchKind};
use crate::stam::{Jet, Jet2, LimitSurface, Window};
use glam::DVec3;
use rayon::prelude::*;

/// Parameters of the points of a piece that are measured. Its ends are left to the vertices: curvature need not exist there.
pub(super) const PARTS: [f64; 5] = [1.0 / 64.0, 0.25, 0.5, 0.75, 63.0 / 64.0];
/// Parameters across a semi-sharp crease at which its roundness is looked for, beside the crease itself. It is roundest there where
/// its sharpness is a whole number and its faces are flat; so this is a precaution.
const ASIDE: [f64; 2] = [0.25, 0.5];

/// A piece of a patch's edge: from t = `own[0]` to `own[1]` of the edge, as [`Neighbour`] counts them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Patch.
    pub patch: u32,
    /// Its edge.
    pub edge: u8,
    /// The ends.
    pub own: [f64; 2],
}

/// Local parameters of the point `t` of a patch's edge.
pub(super) fn on_edge(edge: u8, t: f64) -> [f64; 2] {
    [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][usize::from(edge)]
}

impl Piece {
    /// Point of the piece at a part of its length, 0 to 1.
    pub fn point(&self, surface: &LimitSurface, part: f64) -> DVec3 {
        let t = self.own[0] + part * (self.own[1] - self.own[0]);
        surface.evaluate(self.patch as usize, on_edge(self.edge, t)).position
    }
}

/// Place of a patch's point.
pub(super) fn place(surface: &LimitSurface, patch: usize, uv: [f64; 2]) -> Place {
    let patch = &surface.patches()[patch];
    let [u, v] = patch.to_ptex(uv);
    Place { face: patch.ptex, u, v }
}

/// How far the curvature of a patch may be off by rounding, one over model units.
///
/// Second differences of a net weigh its points with 4 in all, and each point carries the rounding of its refinement, some 16 units
/// in the last place of the largest `coordinate`: 64 eps M over the squared width of the net, which is the smaller
/// of the patch's two sides; of an irregular patch, a cell of level n is 2^n times smaller than its derivatives say, and its net is
/// relative to the vertex, so the factor comes in once.
pub(super) fn rounding(surface: &LimitSurface, patch: usize, uv: [f64; 2], jet: &Jet2, coordinate: f64) -> f64 {
    let (du, dv) = (jet.first.du, jet.first.dv);
    let width = du.cross(dv).length() / du.length().max(dv.length());
    let zoom = match surface.kind(patch) {
        PatchKind::Regular => 1.0,
        _ => 2f64.powi(Window::at(uv).level as i32),
    };
    64.0 * f64::EPSILON * coordinate * zoom / (width * width)
}

/// All joints of a line of the control mesh.
#[derive(Debug, Clone)]
pub(super) struct Measured {
    pub line: Line,
    pub sharp: bool,
    pub piece: Piece,
    pub extremes: Extremes,
    /// Largest curvature across a semi-sharp crease, by size.
    pub roundest: Option<f64>,
}

/// What the joints of a surface are like.
#[derive(Debug, Clone, Default)]
pub(super) struct Tally {
    /// Of smooth joints.
    pub smooth: Extremes,
    pub smooth_pieces: usize,
    /// Pieces of creases, and smooth ones beyond their limits.
    pub pieces: Vec<Measured>,
    /// Control edges with joints on them.
    pub edges: Vec<[u32; 2]>,
}

impl Tally {
    fn add(mut self, measured: Measured) -> Tally {
        if let Line::Edge(edge) = measured.line {
            self.edges.push(edge);
        }
        if measured.sharp || measured.roundest.is_some() {
            self.pieces.push(measured);
            return self;
        }
        self.smooth = self.smooth.and(measured.extremes);
        self.smooth_pieces += 1;
        if measured.extremes.severity() > 1.0 {
            self.pieces.push(measured);
        }
        self
    }

    fn and(mut self, mut other: Tally) -> Tally {
        self.smooth = self.smooth.and(other.smooth);
        self.smooth_pieces += other.smooth_pieces;
        self.pieces.append(&mut other.pieces);
        self.edges.append(&mut other.edges);
        self
    }
}

/// What joints are measured with.
pub(super) struct Gauge<'a> {
    pub surface: &'a LimitSurface,
    pub control: &'a Control<'a>,
    pub limits: &'a Limits,
    pub reading: Option<Reading<'a>>,
    /// Largest coordinate of the control points, by size.
    pub coordinate: f64,
}

impl Gauge<'_> {
    /// Measures all joints, each once.
    pub fn tally(&self, adjacency: &Adjacency) -> Tally {
        (0..self.surface.patches().len())
            .into_par_iter()
            .fold(Tally::default, |tally, patch| {
                (0..4).fold(tally, |tally, edge| {
                    let pieces = adjacency.across(patch, edge).iter();
                    // Every joint is in the lists of both sides.
                    pieces
                        .filter(|n| (patch as u32, edge) < (n.patch, n.edge))
                        .fold(tally, |tally, n| tally.add(self.measure(patch, edge, n)))
                })
            })
            .reduce(Tally::default, Tally::and)
    }

    fn measure(&self, patch: usize, edge: u8, neighbour: &Neighbour) -> Measured {
        let line = self.control.line(&self.surface.patches()[patch], edge);
        let sharpness = match line {
            Line::Edge(edge) => self.control.sharpness(edge),
            _ => 0.0,
        };
        let sharp = neighbour.sharp;
        let semi = !sharp && sharpness > 0.0 && sharpness < INFINITE_SHARPNESS;
        let piece = Piece { patch: patch as u32, edge, own: neighbour.own };
        let findings = PARTS.map(|part| self.finding(&piece, neighbour, part));
        let extremes =
            findings.iter().map(|&finding| Extremes::of(finding, self.limits)).fold(Extremes::default(), Extremes::and);
        let roundest = semi.then(|| self.roundest(&piece, neighbour, &findings));
        Measured { line, sharp, piece, extremes, roundest }
    }

    fn finding(&self, piece: &Piece, neighbour: &Neighbour, part: f64) -> Finding {
        let Piece { patch, edge, own: [from, to] } = *piece;
        let own = on_edge(edge, from + part * (to - from));
        let other = neighbour.carry(edge, own);
        let at = [(patch as usize, own), (neighbour.patch as usize, other)];
        self.compare(at, edge, false)
    }

    /// Compares two points, each given by its patch and local parameters, of which the first one is on this edge of its patch;
    /// `turned`: the second patch runs against the first one, so its normal counts from the other side.
    pub fn compare(&self, at: [(usize, [f64; 2]); 2], edge: u8, turned: bool) -> Finding {
        let mut sides = at.map(|(patch, uv)| self.surface.evaluate_second(patch, uv));
        let along = tangent(&sides[0].first, edge);
        let rounding = [0, 1].map(|i| rounding(self.surface, at[i].0, at[i].1, &sides[i], self.coordinate));
        if turned {
            sides[1] = sides[1].turned();
        }
        let [ours, theirs] = &sides;
        Finding {
            place: place(self.surface, at[0].0, at[0].1),
            position: ours.first.position,
            continuity: Continuity::new([ours, theirs], along, rounding),
            line: self.reading.and_then(|r| LineBreak::new(r.field, r.camera, [ours, theirs], along, rounding)),
        }
    }

    /// Largest curvature across a joint, by size, on it and beside it.
    fn roundest(&self, piece: &Piece, neighbour: &Neighbour, findings: &[Finding]) -> f64 {
        let on = findings.iter().filter_map(|finding| finding.continuity.curvature).flatten().map(f64::abs);
        let across = |patch: usize, edge: u8, t: f64, aside: f64| {
            let [u, v] = on_edge(edge, t);
            let uv = [[u, aside], [1.0 - aside, v], [u, 1.0 - aside], [aside, v]][usize::from(edge)];
            let jet = self.surface.evaluate_second(patch, uv);
            Form::of(&jet, axes(&jet, tangent(&jet.first, edge))?).map(|form| form.second.abs())
        };
        let sides = [(piece.patch, piece.edge, piece.own), (neighbour.patch, neighbour.edge, neighbour.other)];
        let beside = sides.into_iter().flat_map(|(patch, edge, [from, to])| {
            let parts = PARTS.into_iter().flat_map(|part| ASIDE.map(|aside| (part, aside)));
            parts.filter_map(move |(part, aside)| across(patch as usize, edge, from + part * (to - from), aside))
        });
        on.chain(beside).fold(0.0, f64::max)
    }
}

/// Derivative of a patch along its edge, counter-clockwise.
pub(super) fn tangent(jet: &Jet, edge: u8) -> DVec3 {
    let (du, dv) = (jet.du, jet.dv);
    [du, dv, -du, -dv][usize::from(edge)]
}
