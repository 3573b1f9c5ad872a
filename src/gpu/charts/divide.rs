//! Cuts patches into charts, and solves what is too small for them.

use super::lens::Lens;
use super::piece::{Bounds, Line, Piece, Seen, seen};
use super::solve::{POINT, chart, first_hit};
use super::{BAND, Frame};
use crate::gpu::records::{ChartRecord, SpeckRecord};
use crate::gpu::tables::PatchNets;
use crate::stam::{Rings, WINDOWS};
use glam::DVec3;

/// Samples in a piece's bounds up to which they are solved here rather than by the shader.
const FEW: u32 = 2;
/// Longest side of a chart's bounds in samples: larger ones overlap more tiles that they do not cover, and take more steps.
const LARGEST: f64 = 48.0;
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
    lens: &'a Lens,
    /// Parts that every face is cut into at least, as a level.
    level: u8,
    patch: u32,
    pieces: Vec<Piece>,
    pub out: Harvest,
}

impl<'a> Divider<'a> {
    pub fn new(lens: &'a Lens, level: u8) -> Self {
        Self { lens, level, patch: 0, pieces: Vec::new(), out: Harvest::default() }
    }

    /// A patch of refinement levels `levels` along u and v.
    pub fn patch(&mut self, patch: u32, levels: [u8; 2], nets: PatchNets<'_>) {
        self.patch = patch;
        match nets {
            PatchNets::Regular(net) => {
                let owed = levels.map(|own| self.level.saturating_sub(own));
                self.cut(Piece::new(self.lens, net[5], &net.map(|p| p - net[5]), [0.0; 2], 1.0, owed));
            }
            PatchNets::Irregular(rings) => self.irregular(levels, rings),
        }
    }

    fn irregular(&mut self, levels: [u8; 2], mut rings: Rings<'_>) {
        let limit = rings.limit();
        loop {
            match seen(self.lens, rings.hull().map(|p| self.lens.project(limit, p).map(|x| [x]))) {
                Seen::No => return,
                Seen::Straddles if rings.level() > DEEPEST => return,
                Seen::Straddles => (),
                Seen::Within(bounds) => {
                    let [columns, rows] = bounds.samples(self.lens);
                    if columns.is_empty() || rows.is_empty() {
                        return;
                    }
                    if bounds.extent() < POINT {
                        // In an orthographic view it may lie before the near plane.
                        if bounds.near < self.lens.near {
                            return;
                        }
                        self.speck([columns.start, rows.start], [0.0; 2], bounds.near);
                        return;
                    }
                }
            }
            let level = rings.level();
            let size = 0.5f64.powi(level as i32);
            let owed = levels.map(|own| self.level.saturating_sub(own).saturating_sub(level.min(255) as u8));
            for ([i, j], net) in WINDOWS.into_iter().zip(rings.windows()) {
                let origin = [i as f64 * size, j as f64 * size];
                self.cut(Piece::new(self.lens, limit, &net, origin, size, owed));
            }
            rings.descend();
        }
    }

    /// Cuts until everything is a chart, solved, or out of sight.
    fn cut(&mut self, piece: Piece) {
        if piece.seen(self.lens) == Seen::No || piece.has_no_area() {
            return;
        }
        self.pieces.push(piece);
        while let Some(piece) = self.pieces.pop() {
            let seen = piece.seen(self.lens);
            match seen {
                Seen::No => continue,
                Seen::Straddles if piece.size[0].min(piece.size[1]) < 0.5f64.powi(DEEPEST as i32) => continue,
                Seen::Straddles => (),
                Seen::Within(bounds) => {
                    let samples = bounds.samples(self.lens);
                    let count: u32 = samples.iter().map(|range| range.end - range.start).product();
                    if count == 0 {
                        continue;
                    }
                    if count <= FEW {
                        self.solve(&piece, &bounds, None);
                        continue;
                    }
                    if piece.owed == [0; 2]
                        && bounds.extent() <= LARGEST
                        && let Some(frame) = chart(self.lens, &piece, &bounds)
                    {
                        self.chart(&piece, &frame);
                        continue;
                    }
                    // Cutting a piece that is seen edge on would only give more that see the same samples.
                    if let Some(line) = piece.line(self.lens) {
                        self.solve(&piece, &bounds, Some(line));
                        continue;
                    }
                }
            }
            let along_v = match (piece.owed, seen) {
                ([0, 0], Seen::Within(_)) => piece.longer_along_v(self.lens),
                ([0, 0], _) => piece.size[1] > piece.size[0],
                ([u, v], _) => v > u,
            };
            self.pieces.extend(piece.split(along_v));
        }
    }

    fn chart(&mut self, piece: &Piece, frame: &Frame) {
        let [x, y, depth] = [frame.centre[0], frame.centre[1], frame.depth].map(|x| (x as f32).to_bits());
        let row = |values: [f64; 4]| values.map(|x| x as f32);
        let [[a, b], [c, d]] = frame.inverse;
        self.out.charts.push(ChartRecord {
            id: [self.patch + 1, x, y, depth],
            inverse: row([a, b, c, d]),
            start: row([frame.start[0], frame.start[1], frame.half(), 0.0]),
            place: row([piece.origin[0], piece.origin[1], piece.size[0], piece.size[1]]),
            net: piece.relative_to(self.lens, frame),
        });
    }

    /// Solves all samples in a piece's bounds; those near the line, if it is seen as one.
    fn solve(&mut self, piece: &Piece, bounds: &Bounds, line: Option<Line>) {
        let [columns, rows] = bounds.samples(self.lens);
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let p = [x, y].map(|k| f64::from(k) + 0.5);
            if line.is_some_and(|line| line.distance(p) > POINT + BAND) {
                continue;
            }
            if let Some(hit) = first_hit(self.lens, piece, bounds, p) {
                self.speck([x, y], hit.uv, hit.depth);
            }
        }
    }

    fn speck(&mut self, sample: [u32; 2], uv: [f64; 2], depth: f64) {
        let place = self.lens.place(sample, depth);
        self.out.specks.push(SpeckRecord { place, patch_id: self.patch + 1, uv: uv.map(|x| x as f32) });
    }
}

/// Whether the tile may see anything of what is in a box.
pub(super) fn sees_box(lens: &Lens, [low, high]: [DVec3; 2]) -> bool {
    let corner = |i: usize| {
        let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
        DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    };
    seen(lens, (0..8).map(|i| lens.project(corner(i), DVec3::ZERO).map(|x| [x]))) != Seen::No
}
