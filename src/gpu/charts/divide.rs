//! Cuts patches into charts, and solves what is too small for them.

use super::BAND;
use super::bounds::{Bounds, Line, Seen, seen};
use super::cover::Cover;
use super::frame::{ChartFrame, Flat};
use super::lens::Lens;
use super::piece::Piece;
use super::solve::{Hit, POINT, first_hit, newton};
use super::triangle::Quartic;
use crate::adaptive::Gregory;
use crate::gpu::records::{ChartRecord, SpeckRecord};
use crate::gpu::tables::PatchNets;
use crate::stam::{Rings, WINDOWS};
use glam::DVec3;
use std::ops::Range;

/// Samples in a piece's bounds up to which they are solved here rather than by the shader.
const FEW: usize = 2;
/// Longest side of a chart's bounds in samples: larger ones overlap more tiles that they do not cover, and take more steps.
const LARGEST: f64 = 48.0;
/// Extent below which a piece is no longer cut for its shape.
pub(super) const SMALLEST: f64 = 1.0 / (1u64 << DEEPEST) as f64;
/// Levels below which nothing straddles the near plane any more: what is left lies on it.
const DEEPEST: u32 = 32;

/// What a patch gives.
#[derive(Debug, Default)]
pub(super) struct Harvest {
    pub charts: Vec<ChartRecord>,
    pub specks: Vec<SpeckRecord>,
}

/// Cuts patches.
#[derive(Debug)]
pub(super) struct Divider<'a> {
    pub(super) lens: &'a Lens,
    /// Parts that every face is cut into at least, as a level.
    level: u8,
    patch: u32,
    cover: Option<&'a Cover>,
    pub out: Harvest,
}

impl<'a> Divider<'a> {
    pub fn new(lens: &'a Lens, level: u8, cover: Option<&'a Cover>) -> Self {
        Self { lens, level, patch: 0, cover, out: Harvest::default() }
    }

    /// A patch of refinement levels `levels` along u and v.
    pub fn patch(&mut self, patch: u32, levels: [u8; 2], nets: PatchNets<'_>) {
        self.patch = patch;
        match nets {
            PatchNets::Regular(net) => {
                let owed = levels.map(|own| self.level.saturating_sub(own));
                self.cut(&mut Piece::new(|k| self.lens.project(net[k]), [0.0; 2], 1.0, owed));
            }
            PatchNets::Irregular(rings) | PatchNets::IrregularTriangle(rings) => self.irregular(levels, rings),
            PatchNets::Triangle(net) => {
                let owed = levels.map(|own| self.level.saturating_sub(own));
                self.triangle(&Quartic::whole(&net.map(|p| self.lens.project(p))), owed);
            }
            PatchNets::Gregory(patch) => {
                let lens = self.lens;
                let patch = patch.mapped(|p| lens.project(p), |v| lens.turn(v));
                let owed = levels.map(|own| self.level.saturating_sub(own));
                if self.sees(patch.hull()) {
                    // What 4 x 4 sums of 16 products are off, and the weights of the bicubic through them make of that.
                    let rounding = 64.0 * f64::EPSILON * patch.hull().fold(DVec3::ZERO, |most, p| most.max(p.abs()));
                    self.gregory(&patch, rounding, [0.0; 2], 1.0, owed);
                }
            }
        }
    }

    /// Whether the tile may see anything of what is in a hull.
    pub(super) fn sees(&self, hull: impl Iterator<Item = DVec3> + Clone) -> bool {
        match seen(self.lens, hull) {
            Seen::No => false,
            Seen::Straddles => true,
            Seen::Within(bounds) => {
                let samples = bounds.samples(self.lens);
                samples.iter().all(|range| !range.is_empty()) && !self.hides(&bounds, &samples)
            }
        }
    }

    /// A square of a projected Gregory patch: quarters until each is as good as bicubic, but for rounding.
    fn gregory(&mut self, patch: &Gregory, rounding: DVec3, origin: [f64; 2], size: f64, owed: [u8; 2]) {
        /// Samples by which the bicubic may be off: small against [`BAND`], so that neighbours leave no gap.
        const TOLERANCE: f64 = 0.25 * BAND;
        let piece =
            Piece::through(|[u, v]| patch.position([origin[0] + u * size, origin[1] + v * size]), origin, size, owed);
        let gap = piece.gap(|uv| patch.position(uv));
        let is_bicubic = piece.error(self.lens, &gap) <= TOLERANCE || gap.largest().cmple(rounding).all();
        if is_bicubic || size < SMALLEST {
            return self.cut(&mut { piece });
        }
        if !self.sees_near(&piece, gap.largest()) {
            return;
        }
        let half = 0.5 * size;
        for [i, j] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
            let origin = [origin[0] + i * half, origin[1] + j * half];
            self.gregory(patch, rounding, origin, half, owed.map(|levels| levels.saturating_sub(1)));
        }
    }

    /// Whether the tile may see anything of what a piece approximates.
    pub(super) fn sees_near(&self, piece: &Piece, gap: DVec3) -> bool {
        // Twice, for the gap is measured at some points only.
        let reach = 2.0 * gap;
        let around = |p: DVec3| box_corners([p - reach, p + reach]);
        self.sees(piece.points().flat_map(around))
    }

    fn irregular(&mut self, levels: [u8; 2], rings: Rings<'_>) {
        let limit = self.lens.project(rings.limit());
        // Rings are linear in their points.
        let mut rings = rings.mapped(|p| self.lens.turn(p));
        loop {
            match seen(self.lens, rings.hull().map(|p| limit + p)) {
                Seen::No => return,
                Seen::Straddles if rings.level() > DEEPEST => return,
                Seen::Straddles => (),
                Seen::Within(bounds) => {
                    let samples = bounds.samples(self.lens);
                    if samples.iter().any(|range| range.is_empty()) || self.hides(&bounds, &samples) {
                        return;
                    }
                    if bounds.extent() < POINT {
                        // In an orthographic view it may lie before the near plane.
                        if bounds.near < self.lens.near {
                            return;
                        }
                        let seen = self.lens.seen(limit.to_array());
                        self.push_speck(samples.map(|range| range.start), bounds.near, [0.0; 2], seen);
                        return;
                    }
                }
            }
            let level = rings.level();
            let size = 0.5f64.powi(level as i32);
            let owed = levels.map(|own| self.level.saturating_sub(own).saturating_sub(level.min(255) as u8));
            if rings.is_triangle() {
                let points = rings.loop_grid();
                let windows = Quartic::windows(level, |k| limit + points[k]);
                windows.iter().for_each(|window| self.triangle(window, owed));
            } else {
                let grid = rings.grid();
                for window in WINDOWS {
                    let origin = window.map(|i| i as f64 * size);
                    self.cut(&mut Piece::new(|k| limit + grid.point(window, k), origin, size, owed));
                }
            }
            rings.descend();
        }
    }

    /// Cuts until everything is a chart, solved, or out of sight.
    pub(super) fn cut(&mut self, piece: &mut Piece) {
        if piece.is_beyond() {
            return;
        }
        let [u, v] = piece.size.map(f64::abs);
        match piece.seen(self.lens) {
            Seen::No => (),
            Seen::Straddles if u.min(v) < SMALLEST => (),
            Seen::Straddles if piece.has_no_area() => (),
            Seen::Straddles => self.halves(piece, v > u),
            Seen::Within(bounds) => self.within(piece, &bounds),
        }
    }

    fn within(&mut self, piece: &mut Piece, bounds: &Bounds) {
        let samples = bounds.samples(self.lens);
        let count = samples[0].len() * samples[1].len();
        if count == 0 || self.hides(bounds, &samples) {
            return;
        }
        let is_small = count <= FEW || piece.owed == [0; 2] && bounds.extent() <= LARGEST;
        let flat = if is_small { piece.flat(self.lens) } else { None };
        if flat.is_none() && piece.has_no_area() {
            return;
        }
        if flat.as_ref().is_some_and(|flat| is_between_samples(flat, count, &samples)) {
            return;
        }
        let chart = flat.as_ref().and_then(|flat| flat.chart(bounds));
        if count <= FEW {
            return self.solve(piece, flat.as_ref(), chart.as_ref(), samples);
        }
        if let Some(chart) = chart {
            return self.chart(piece, &chart);
        }
        // Cutting a piece that is seen edge on would only give more that see the same samples.
        if flat.is_none()
            && let Some(line) = piece.line(self.lens)
        {
            return self.solve_line(piece, line, samples);
        }
        self.halves(piece, piece.longer_along_v(self.lens, flat.as_ref()));
    }

    fn hides(&self, bounds: &Bounds, samples: &[Range<u32>; 2]) -> bool {
        self.cover.is_some_and(|cover| cover.hides(bounds, samples))
    }

    fn halves(&mut self, piece: &mut Piece, longer_along_v: bool) {
        let owes = piece.owed != [0; 2];
        let mut upper = piece.split(if owes { piece.owed[1] > piece.owed[0] } else { longer_along_v });
        self.cut(piece);
        self.cut(&mut upper);
    }

    fn chart(&mut self, piece: &Piece, ChartFrame { frame, half }: &ChartFrame) {
        let before_far = self.lens.before_far(frame.depth);
        let [x, y, depth] = [frame.centre[0], frame.centre[1], before_far].map(|x| (x as f32).to_bits());
        let row = |values: [f64; 4]| values.map(|x| x as f32);
        let [[a, b], [c, d]] = frame.inverse;
        self.out.charts.push(ChartRecord {
            id: [self.patch + 1, x, y, depth],
            inverse: row([a, b, c, d]),
            // The sign says that the piece ends at a diagonal, which follows from its place: shaders/charts.wgsl.
            start: row([
                frame.start[0],
                frame.start[1],
                if piece.clip.is_some() { -half[0] } else { half[0] },
                half[1],
            ]),
            place: row([piece.origin[0], piece.origin[1], piece.size[0], piece.size[1]]),
            net: piece.relative_to(self.lens, frame),
        });
    }

    /// Solves all samples in a piece's bounds.
    fn solve(&mut self, piece: &Piece, flat: Option<&Flat>, chart: Option<&ChartFrame>, samples: [Range<u32>; 2]) {
        for sample in each(samples) {
            let p = centre(sample);
            let hit = match (chart, flat) {
                (Some(chart), _) => newton(self.lens, piece, chart, p),
                (None, Some(flat)) if flat.misses(p) => None,
                (None, _) => first_hit(self.lens, piece, flat, p),
            };
            hit.into_iter().for_each(|hit| self.speck(piece, sample, hit));
        }
    }

    /// Solves the samples near the line that a piece is seen as.
    fn solve_line(&mut self, piece: &Piece, line: Line, samples: [Range<u32>; 2]) {
        for sample in each(samples).filter(|&sample| line.distance(centre(sample)) <= POINT + BAND) {
            let hit = first_hit(self.lens, piece, None, centre(sample));
            hit.into_iter().for_each(|hit| self.speck(piece, sample, hit));
        }
    }

    /// A hit in a piece. Its residual is what the sample sees of the point at the (u,v) that is handed on, with its rounding.
    fn speck(&mut self, piece: &Piece, sample: [u32; 2], hit: Hit) {
        let uv = hit.uv.map(|x| x as f32);
        let seen = self.lens.seen(piece.at(piece.to_own(uv.map(f64::from))).value);
        self.push_speck(sample, hit.depth, uv, seen);
    }

    fn push_speck(&mut self, sample: [u32; 2], depth: f64, uv: [f32; 2], seen: [f64; 2]) {
        let [x, y] = centre(sample);
        let residual = ((seen[0] - x).powi(2) + (seen[1] - y).powi(2)).sqrt() as f32;
        let place = self.lens.place(sample, depth);
        self.out.specks.push(SpeckRecord { place, patch_id: self.patch + 1, uv, residual });
    }
}

/// Whether a piece passes between the samples in its bounds. Asked of slivers, as the faces round a vertex of many faces are: they
/// see a sample here and there, and would be halved until their bounds are no longer than a sample.
fn is_between_samples(flat: &Flat, count: usize, samples: &[Range<u32>; 2]) -> bool {
    /// Samples that are tried: to halve the piece once costs as much as some ten.
    const MOST: usize = 64;
    /// Part of its bounds that a sliver covers, at most.
    const SLIVER: f64 = 0.25;
    let is_sliver = count > FEW && count <= MOST && flat.frame.area < SLIVER * count as f64;
    is_sliver && each(samples.clone()).all(|sample| flat.misses(centre(sample)))
}

/// The samples of a rectangle.
fn each([columns, rows]: [Range<u32>; 2]) -> impl Iterator<Item = [u32; 2]> {
    rows.flat_map(move |y| columns.clone().map(move |x| [x, y]))
}

fn centre(sample: [u32; 2]) -> [f64; 2] {
    sample.map(|k| f64::from(k) + 0.5)
}

/// Whether the tile may see anything of what is in a box.
pub(super) fn sees_box(lens: &Lens, bounds: [DVec3; 2]) -> bool {
    match seen(lens, box_corners(bounds).map(|corner| lens.project(corner))) {
        Seen::No => false,
        Seen::Straddles => true,
        Seen::Within(bounds) => bounds.samples(lens).iter().all(|range| !range.is_empty()),
    }
}

fn box_corners([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> + Clone {
    (0..8).map(move |i| {
        let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
        DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    })
}
