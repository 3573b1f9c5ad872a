//! The verdict as a picture: the field, with what breaks it.

use super::Verdict;
use crate::cli::Failure;
use crate::cli::account::Account;
use crate::cli::outgoing;
use crate::cli::render::legend as field_legend;
use crate::curves::{Curve, Look, Place};
use crate::field::Pattern;
use crate::gpu::{Gpu, TableLayout, View};
use crate::output::{Canvas, Drawn, Mark, Panel, Pen, Scale, draw_legend, encode_png, in_picture, sheet};
use crate::quality::{Piece, Ranked, Subject};
use crate::stam::LimitSurface;
use crate::statistics::exact;
use glam::DVec2;
use rayon::prelude::*;
use std::path::Path;

/// How much of the field's picture is left under the marks.
const GROUND: f32 = 0.55;
/// What is within its limits, or ignored.
const QUIET: [u8; 3] = [96, 102, 112];
/// Chords of a piece of a joint.
const CHORDS: u32 = 8;

pub(super) struct Picture<'a> {
    pub surface: &'a LimitSurface,
    pub view: &'a View,
    /// How many are numbered.
    pub count: usize,
}

/// What is known of a place of the list before it is drawn.
struct Shown<'a> {
    ranked: &'a Ranked<'a>,
    colour: Option<[u8; 3]>,
    all: Vec<Drawn>,
    seen: Vec<Drawn>,
    /// Where its number is due, and whether that is in front.
    spot: Option<(DVec2, bool)>,
}

impl Picture<'_> {
    pub fn draw(&self, path: &Path, verdict: &Verdict<'_>, account: &mut Account) -> Result<(), Failure> {
        let gpu = account.time("adapter", Gpu::new)?;
        let layout = match self.view.field.method.reads_curvature() {
            true => TableLayout::Expanded,
            false => TableLayout::Auto,
        };
        let tables = account.time("tables", || gpu.upload_as(self.surface, layout))?;
        let mut frame = gpu.render(&tables, self.view)?;
        account.add(&frame.timings);
        let size = frame.size;
        let shown = account.time("hidden lines", || self.shown(verdict));
        if let Pattern::Heat { range: [low, high] } = self.view.pattern {
            // Before the picture fades, so that its colours are the legend's.
            let scale = Scale::linear(low as f32, high as f32);
            draw_legend(size, &mut frame.rgba8, &scale, &field_legend(&self.view.field.method));
        }
        let mut canvas = Canvas::new(size, frame.rgba8)
            .ok_or_else(|| Failure::Bad("the picture's bytes do not match its size".to_owned()))?;
        canvas.fade(GROUND);
        lines(&mut canvas, &shown);
        let marks = self.marks(verdict, &shown);
        canvas.marks(&marks);
        let panel = Panel {
            caption: format!("{}: {}", verdict.mesh.name, said(verdict, &marks, self.count)),
            rgba8: canvas.into_rgba8(),
            legend: Some((severities(verdict), legend(verdict))),
        };
        let (size, pixels) = sheet(size, &[panel]);
        account.time("write", || outgoing::write(path, |out| encode_png(out, size, &pixels, &verdict.made_by)))?;
        outgoing::note(path, &format!("{}x{} pixels", size[0], size[1]));
        Ok(())
    }

    fn shown<'a>(&self, verdict: &'a Verdict<'_>) -> Vec<Shown<'a>> {
        let look = Look::new(self.surface, &self.view.camera);
        let scale = severities(verdict);
        let of = |ranked: &'a Ranked<'a>| {
            let pieces = match ranked.subject {
                Subject::Feature(feature) => &feature.pieces[..],
                Subject::Vertex(_) => &[],
            };
            let curves: Vec<Curve> = pieces.iter().map(|piece| self.curve(piece)).collect();
            let flat =
                |curves: &[Curve]| curves.iter().flat_map(|curve| in_picture(&self.view.camera, curve)).collect();
            let spot = ranked.spot().and_then(|(_, position)| {
                let at = DVec2::from_array(self.view.camera.project(position)?);
                let size = DVec2::from_array(self.view.camera.size.map(f64::from));
                let is_inside = at.cmpge(DVec2::ZERO).all() && at.cmplt(size).all();
                is_inside.then(|| (at, look.sees(position)))
            });
            let is_over = ranked.is_over() && !verdict.is_ignored(ranked);
            let severity = ranked.severity().min(f64::from(f32::MAX)) as f32;
            let colour = is_over.then(|| scale.colour(severity));
            Shown { ranked, colour, all: flat(&curves), seen: flat(&look.visible(&curves)), spot }
        };
        verdict.ranked.par_iter().map(of).collect()
    }

    fn curve(&self, piece: &Piece) -> Curve {
        let points = (0..=CHORDS).map(|k| piece.point(self.surface, f64::from(k) / f64::from(CHORDS)));
        let points: Vec<_> = points.collect();
        // Where on the surface is not asked.
        let places = vec![Place { face: 0, u: 0.0, v: 0.0 }; points.len()];
        Curve { value: 0.0, light: 0, closed: false, points, places }
    }

    /// The numbers of the worst, as the list has them.
    fn marks(&self, verdict: &Verdict<'_>, shown: &[Shown<'_>]) -> Vec<Mark> {
        let judged = shown.iter().filter(|shown| !verdict.is_ignored(shown.ranked)).take(self.count);
        let marks = judged.enumerate().filter_map(|(i, shown)| {
            let (at, is_seen) = shown.spot?;
            Some(Mark { at, number: i + 1, colour: shown.colour.unwrap_or(QUIET), is_seen })
        });
        marks.collect()
    }
}

/// Colours of multiples of the limits: up to the largest angle or difference that there is.
fn severities(verdict: &Verdict<'_>) -> Scale {
    let limits = &verdict.limits;
    let most = (180.0 / limits.angle_deg).max(200.0 / limits.percent);
    Scale::logarithmic(1.0, most.clamp(10.0, 1e6) as f32)
}

/// Lines and dots of everything: hidden ones first and thin, the worst last.
fn lines(canvas: &mut Canvas, shown: &[Shown<'_>]) {
    const RIM: [u8; 3] = [24, 26, 30];
    let pen = |colour, width, opacity| Pen { colour, width, opacity };
    for shown in shown.iter().rev() {
        canvas.lines(&shown.all, pen(shown.colour.unwrap_or(QUIET), 1.0, 0.4));
    }
    for shown in shown.iter().rev() {
        match shown.colour {
            Some(colour) => {
                canvas.lines(&shown.seen, pen(RIM, 4.5, 1.0));
                canvas.lines(&shown.seen, pen(colour, 2.5, 1.0));
            }
            None => canvas.lines(&shown.seen, pen(QUIET, 1.5, 1.0)),
        }
    }
    for shown in shown.iter().rev() {
        if let (Subject::Vertex(_), Some((at, true))) = (shown.ranked.subject, shown.spot) {
            match shown.colour {
                Some(colour) => canvas.dot(at, 3.0, colour, true),
                None => canvas.dot(at, 1.5, QUIET, true),
            }
        }
    }
}

/// How many exceed their limits, and what of the numbered ones is there.
fn said(verdict: &Verdict<'_>, marks: &[Mark], count: usize) -> String {
    let mut text = match (verdict.passes(), verdict.over()) {
        (None, _) => "nothing to judge".to_owned(),
        (_, 0) => "none over its limits".to_owned(),
        (_, over) => format!("{over} over their limits"),
    };
    let numbered = verdict.judged().count().min(count);
    if marks.len() < numbered {
        text += &format!(", {} of the worst {numbered} in the picture", marks.len());
    }
    if marks.iter().any(|mark| !mark.is_seen) {
        text += " (hollow: hidden)";
    }
    text
}

fn legend(verdict: &Verdict<'_>) -> String {
    let limits = &verdict.limits;
    let unit = limits.unit();
    let [gap, angle, percent] = [limits.gap, limits.angle_deg, limits.percent].map(exact);
    format!("Times the limit ({gap} {unit}, {angle} degrees, {percent} %)")
}
