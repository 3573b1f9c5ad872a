//! Divides pieces until the contours on each cell have a shape that its corners tell.

use super::arc::{Arc, Tracer};
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
    /// Error of the model one division before, and for how many divisions it has not become smaller.
    error: f64,
    stuck: u8,
}

/// Divisions of a piece: then it is as small as rounding lets two contours be told apart that moved values keep apart at saddles.
const DEEPEST: u8 = 24;
/// Divisions of cells that the field is undefined on mostly (its border is a curve), and at a few points (at one place).
const DEEPEST_UNDEFINED: [u8; 2] = [6, 14];
/// Divisions for which the error of a model may stay what it is: at kinks it halves, at jumps it stays.
const STUCK: u8 = 8;
/// Levels of an extraordinary vertex: the last ones are left for rounding.
const DEEPEST_LEVEL: usize = LEVELS - 8;
/// What the values on the square that a level leaves may exceed those of the level by, over their range. A field that is linear on the
/// tangent plane exceeds nothing; curvatures grow from level to level, by less than the factor that this allows.
const EXCESS: f64 = 1.0;

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
    let net = scene.surface.net(patch, 2);
    match Piece::regular(patch, &net) {
        Some(piece) => {
            let model = Model::new(&scene, &piece, &Rect::WHOLE);
            divider.cell(&piece, Rect::WHOLE, model, all, 0);
        }
        None => divider.levels(patch, net, all),
    }
    divider.arcs
}

impl Divider<'_> {
    /// Level by level towards an extraordinary vertex, while contours may be there.
    fn levels(&mut self, patch: usize, mut net: Net, mut candidates: Vec<Candidate>) {
        for level in 1..=DEEPEST_LEVEL {
            if matches!(&net, Net::Irregular { levels, .. } if levels.len() < level) {
                net = self.scene.surface.net(patch, if level < 8 { 8 } else { DEEPEST_LEVEL });
            }
            let pieces = Piece::level(patch, &net, level);
            let models: Vec<_> = pieces.iter().map(|piece| Model::new(&self.scene, piece, &Rect::WHOLE)).collect();
            // Before the models are gone: what may be further in.
            let further = |candidate: &Candidate| {
                let weights = &self.wanted[candidate.wanted].contour.zero;
                let mut range = [f64::INFINITY, f64::NEG_INFINITY];
                for model in &models {
                    let Ok(model) = model else { return level < 2 * usize::from(DEEPEST_UNDEFINED[1]) };
                    let [low, high] = model.sum(weights).range();
                    range = [range[0].min(low), range[1].max(high)];
                }
                let excess = EXCESS * (range[1] - range[0]);
                range[0] - excess <= 0.0 && range[1] + excess >= 0.0
            };
            let inner = candidates.iter().filter(|candidate| further(candidate)).copied().collect();
            for (piece, model) in pieces.iter().zip(models) {
                self.cell(piece, Rect::WHOLE, model, candidates.clone(), 0);
            }
            candidates = inner;
            if candidates.is_empty() {
                break;
            }
        }
    }

    fn cell(
        &mut self,
        piece: &Piece,
        rect: Rect,
        model: Result<Model, Undefined>,
        mut candidates: Vec<Candidate>,
        depth: u8,
    ) {
        match model {
            Ok(model) => candidates.retain_mut(|candidate| !self.settle(piece, rect, &model, candidate, depth)),
            Err(undefined) if depth >= DEEPEST_UNDEFINED[usize::from(undefined == Undefined::Partly)] => return,
            Err(_) => {}
        }
        if candidates.is_empty() {
            return;
        }
        for quarter in rect.quarters() {
            let model = Model::new(&self.scene, piece, &quarter);
            self.cell(piece, quarter, model, candidates.clone(), depth + 1);
        }
    }

    /// Whether the cell need not be divided for a contour; draws the arcs that are in it.
    fn settle(&mut self, piece: &Piece, rect: Rect, model: &Model, candidate: &mut Candidate, depth: u8) -> bool {
        let contour = &self.wanted[candidate.wanted].contour;
        let sum = model.sum(&contour.zero);
        let valid = contour.valid.map(|weights| model.sum(&weights));
        let tracer = Tracer { scene: &self.scene, piece, contour, wanted: candidate.wanted, tolerance: self.tolerance };
        match outcome(&sum, valid.as_ref()) {
            Outcome::Empty => true,
            Outcome::Simple(axis) => {
                tracer.simple(rect, axis, &sum.corners, &mut self.arcs);
                true
            }
            Outcome::Unclear if depth < DEEPEST => {
                let stuck = sum.error > 0.9 * candidate.error && sum.error > 64.0 * sum.rounding;
                candidate.stuck = if stuck { candidate.stuck + 1 } else { 0 };
                candidate.error = sum.error;
                // A jump of the field: no contour is there, only a change of sign.
                candidate.stuck >= STUCK
            }
            Outcome::Unclear => {
                tracer.smallest(rect, &sum.corners, &mut self.arcs);
                true
            }
        }
    }
}

fn outcome(sum: &Sum, valid: Option<&Sum>) -> Outcome {
    let [low, high] = sum.range();
    if low > 0.0 || high < 0.0 {
        return Outcome::Empty;
    }
    // Nothing but rounding: the field is constant here, and its value is not the one wanted, which has been moved.
    if high - low <= 64.0 * sum.rounding {
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
