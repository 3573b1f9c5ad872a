//! Divides pieces until the contours on each cell have a shape that its corners tell.

use super::arc::{Arc, Cell, Tracer};
use super::levels::{Ahead, Approach};
use super::model::{Model, Rect, Sum, Undefined};
use super::piece::{Piece, Scene};
use crate::field::Contour;
use crate::stam::{LEVELS, Net};

/// A contour that is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted {
    pub light: i32,
    pub value: f64,
    pub contour: Contour,
}

/// A contour that may run through a cell.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    wanted: usize,
    /// Error of an earlier model, and for how many divisions it has hardly become smaller.
    error: f64,
    stuck: u8,
}

/// Divisions of a piece: then it is as small as rounding lets two contours be told apart that moved values keep apart at saddles.
const DEEPEST: u8 = 24;
/// Divisions of cells that the field is undefined on in part, up to a curve.
const DEEPEST_UNDEFINED: u8 = 7;
/// Divisions for which the error of a poor model may stay what it is, more or less: at kinks it halves each time, at jumps of the field and in rounding it stays.
const STUCK: u8 = 9;
/// Cells of one size that a contour may leave unclear. Saddles leave a few of any size; lines along which the field touches the value (the
/// Gaussian curvature of a ruled patch, 0) leave more and more, and what the field does there is below rounding.
const CROWD: usize = 512;
/// Levels of an extraordinary vertex: the last ones are left for rounding. Where there is no tangent plane, fields change by as much on
/// every level, and ptex parameters beyond these have lost the digits for it.
const DEEPEST_LEVEL: usize = LEVELS - 8;
const DEEPEST_LEVEL_OF_CORNERS: usize = 12;
/// Levels beyond one that are looked at before contours are ruled out further in, and where.
const AHEAD: usize = 2;
const LOOKS: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]];

/// What a cell is to a contour.
enum Outcome {
    Empty,
    /// Single-valued along an axis.
    Simple(usize),
    Unclear,
}

/// The contours on one patch.
pub(super) struct Divider<'a> {
    scene: Scene<'a>,
    wanted: &'a [Wanted],
    tolerance: f64,
    arcs: Vec<Arc>,
}

/// The arcs of all wanted contours on a patch.
pub(super) fn divide(scene: Scene, patch: usize, wanted: &[Wanted], tolerance: f64) -> Vec<Arc> {
    let mut divider = Divider { scene, wanted, tolerance, arcs: Vec::new() };
    let all = (0..wanted.len()).map(|wanted| Candidate { wanted, error: f64::INFINITY, stuck: 0 }).collect();
    let net = scene.surface.net(patch, 1 + AHEAD);
    match Piece::regular(patch, &net) {
        Some(piece) => {
            let model = Model::new(&scene, &piece, &Rect::WHOLE);
            divider.piece(&piece, &model, all);
        }
        None => divider.levels(patch, net, all),
    }
    divider.arcs
}

impl Divider<'_> {
    /// Level by level towards an extraordinary vertex, while contours may be there.
    fn levels(&mut self, patch: usize, mut net: Net, mut candidates: Vec<Candidate>) {
        let Scene { surface, field, .. } = self.scene;
        let is_smooth = surface.class(patch).is_some_and(|class| surface.classes()[class].has_tangent_plane());
        let vertex = (is_smooth && !field.method.reads_curvature()).then(|| self.scene.functions(patch, [0.0; 2]));
        let mut ahead = Ahead { vertex: vertex.flatten(), ..Ahead::default() };
        let mut approaches = vec![Approach::NONE; self.wanted.len()];
        let deepest = if is_smooth { DEEPEST_LEVEL } else { DEEPEST_LEVEL_OF_CORNERS };
        for level in 1..=deepest {
            if matches!(&net, Net::Irregular { levels, .. } if levels.len() < level + AHEAD) {
                net = surface.net(patch, if level < 8 { 8 + AHEAD } else { DEEPEST_LEVEL + AHEAD });
            }
            let pieces = Piece::level(patch, &net, level);
            let models: Vec<_> = pieces.iter().map(|piece| Model::new(&self.scene, piece, &Rect::WHOLE)).collect();
            for (piece, model) in pieces.iter().zip(&models) {
                self.piece(piece, model, candidates.clone());
            }
            if models.iter().all(|model| matches!(model, Err(Undefined::Everywhere))) {
                break;
            }
            let models: Vec<_> = models.into_iter().map(Result::ok).collect();
            let further = (level + 1..=level + AHEAD).flat_map(|level| Piece::level(patch, &net, level));
            let looks = further.flat_map(|piece| LOOKS.map(|at| piece.functions(&self.scene, at)));
            ahead.further = looks.flatten().collect();
            candidates.retain(|candidate| {
                let weights = &self.wanted[candidate.wanted].contour.zero;
                approaches[candidate.wanted].may_arrive(level, &models, weights, &ahead)
            });
            if candidates.is_empty() {
                break;
            }
        }
    }

    /// Divides a piece, all cells of a size before the smaller ones.
    fn piece(&mut self, piece: &Piece, model: &Result<Model, Undefined>, candidates: Vec<Candidate>) {
        let mut crowd = vec![0; self.wanted.len()];
        let mut next = Vec::new();
        if let Some((rect, candidates)) = self.settled(piece, Rect::WHOLE, model, candidates, 0) {
            next.push((rect, self.models(piece, &rect, model, &candidates), candidates));
        }
        for depth in 1..=DEEPEST {
            let mut cells = Vec::new();
            for (rect, models, candidates) in next.drain(..) {
                for (quarter, model) in rect.quarters().into_iter().zip(models) {
                    if let Some((rect, candidates)) = self.settled(piece, quarter, &model, candidates.clone(), depth) {
                        cells.push((rect, candidates, model));
                    }
                }
            }
            crowd.fill(0);
            for candidate in cells.iter().flat_map(|(_, candidates, _)| candidates) {
                crowd[candidate.wanted] += 1;
            }
            for (rect, mut candidates, model) in cells {
                candidates.retain(|candidate| {
                    let is_kept = depth < DEEPEST && crowd[candidate.wanted] <= CROWD;
                    if let (false, Ok(model)) = (is_kept, &model) {
                        self.give_up(piece, rect, model, candidate);
                    }
                    is_kept
                });
                if !candidates.is_empty() {
                    next.push((rect, self.models(piece, &rect, &model, &candidates), candidates));
                }
            }
            if next.is_empty() {
                break;
            }
        }
    }

    /// Models of the quarters of a cell: parts of the cell's own, where that is precise enough for the candidates.
    fn models(
        &self,
        piece: &Piece,
        rect: &Rect,
        model: &Result<Model, Undefined>,
        candidates: &[Candidate],
    ) -> [Result<Model, Undefined>; 4] {
        let is_precise = |candidate: &Candidate, model: &Model| {
            let Contour { zero, valid } = &self.wanted[candidate.wanted].contour;
            let is_known = |valid: Sum| valid.range()[0] > 0.0 || valid.is_precise();
            model.sum(zero).is_precise() && valid.is_none_or(|valid| is_known(model.sum(&valid)))
        };
        let inherited = model.as_ref().ok().filter(|model| candidates.iter().all(|c| is_precise(c, model)));
        match inherited.and_then(|model| model.quarters(&self.scene, piece, rect)) {
            Some(models) => models.map(Ok),
            None => rect.quarters().map(|quarter| Model::new(&self.scene, piece, &quarter)),
        }
    }

    /// A cell with the candidates for which it must be divided; draws the others.
    fn settled(
        &mut self,
        piece: &Piece,
        rect: Rect,
        model: &Result<Model, Undefined>,
        mut candidates: Vec<Candidate>,
        depth: u8,
    ) -> Option<(Rect, Vec<Candidate>)> {
        match model {
            Ok(model) => candidates.retain_mut(|candidate| !self.settle(piece, rect, model, candidate)),
            Err(Undefined::Partly) if depth < DEEPEST_UNDEFINED => {}
            Err(_) => return None,
        }
        (!candidates.is_empty()).then_some((rect, candidates))
    }

    /// Whether the cell need not be divided for a contour; draws the arcs that are in it.
    fn settle(&mut self, piece: &Piece, rect: Rect, model: &Model, candidate: &mut Candidate) -> bool {
        let contour = &self.wanted[candidate.wanted].contour;
        if model.excludes(&contour.zero) {
            return true;
        }
        let sum = model.sum(&contour.zero);
        let valid = contour.valid.map(|weights| model.sum(&weights));
        let cell = Cell { rect, sum: &sum, valid: valid.as_ref() };
        match outcome(&sum, valid.as_ref()) {
            Outcome::Empty => true,
            Outcome::Simple(axis) => {
                let scene = &self.scene;
                let tracer = Tracer { scene, piece, contour, wanted: candidate.wanted, tolerance: self.tolerance };
                tracer.simple(cell, axis, &mut self.arcs);
                true
            }
            Outcome::Unclear => {
                if sum.is_poor() && sum.error > 0.25 * candidate.error {
                    candidate.stuck += 1;
                } else {
                    candidate.stuck = 0;
                    candidate.error = sum.error;
                }
                // A jump, or nothing but rounding: no contour is there, only changes of sign.
                candidate.stuck > STUCK
            }
        }
    }

    /// Draws what the corners of a cell say that is divided no further.
    fn give_up(&mut self, piece: &Piece, rect: Rect, model: &Model, candidate: &Candidate) {
        let contour = &self.wanted[candidate.wanted].contour;
        let sum = model.sum(&contour.zero);
        if !sum.is_poor() {
            let scene = &self.scene;
            let tracer = Tracer { scene, piece, contour, wanted: candidate.wanted, tolerance: self.tolerance };
            tracer.smallest(Cell { rect, sum: &sum, valid: None }, &mut self.arcs);
        }
    }
}

fn outcome(sum: &Sum, valid: Option<&Sum>) -> Outcome {
    let [low, high] = sum.range();
    if low > 0.0 || high < 0.0 {
        return Outcome::Empty;
    }
    if valid.is_some_and(|valid| valid.range()[1] < 0.0) {
        return Outcome::Empty;
    }
    let is_simple = |axis: &usize| {
        sum.is_monotone(*axis) && sum.is_simple_on_side(*axis, false) && sum.is_simple_on_side(*axis, true)
    };
    (0..2).find(is_simple).map_or(Outcome::Unclear, Outcome::Simple)
}
