//! Lines, dots and numbers drawn over a picture.

use super::lines::Drawn;
use super::sheet::{INK, write_text};
use glam::{DVec2, dvec2};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster_width};
use tiny_skia::{FillRule, IntSize, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// Pixels of a number's box beyond its digits, each way.
const PADDING: f64 = 4.0;
const LINE: f64 = 16.0;
/// Pixels between a point and the nearest edge of its number's box.
const DISTANCES: [f64; 8] = [10.0, 22.0, 38.0, 58.0, 84.0, 120.0, 160.0, 210.0];
/// Directions in which room for a number is looked for.
const DIRECTIONS: u32 = 12;

/// How lines are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    /// sRGB.
    pub colour: [u8; 3],
    /// Pixels.
    pub width: f32,
    /// 0 to 1.
    pub opacity: f32,
}

/// A number at a point of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Pixel coordinates.
    pub at: DVec2,
    /// What is written beside it.
    pub number: usize,
    /// sRGB.
    pub colour: [u8; 3],
    /// The point is in front: filled; else hollow and pale.
    pub is_seen: bool,
}

/// A picture that is drawn over.
#[derive(Debug)]
pub struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// Over an opaque picture: sRGB RGBA, 4 bytes a pixel, rows from top to bottom. `None` where bytes and size do not match.
    pub fn new([width, height]: [u32; 2], rgba8: Vec<u8>) -> Option<Canvas> {
        Some(Canvas { pixmap: Pixmap::from_vec(rgba8, IntSize::from_wh(width, height)?)? })
    }

    /// The picture, as it came.
    pub fn into_rgba8(self) -> Vec<u8> {
        self.pixmap.take()
    }

    /// Mixes everything with white: `left` of it, 0 to 1, is left.
    pub fn fade(&mut self, left: f32) {
        for channel in self.pixmap.data_mut() {
            *channel = 255 - ((255.0 - f32::from(*channel)) * left).round() as u8;
        }
        // Opaque as it was.
        self.pixmap.data_mut().iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = 255);
    }

    /// Draws parts of curves in one stroke, so that what overlaps is no darker.
    pub fn lines<'a>(&mut self, parts: impl IntoIterator<Item = &'a Drawn>, pen: Pen) {
        let mut path = PathBuilder::new();
        for part in parts {
            for (i, point) in part.points.iter().enumerate() {
                let [x, y] = point.as_vec2().to_array();
                if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
            }
            if part.closed {
                path.close();
            }
        }
        self.stroke(path, pen);
    }

    fn stroke(&mut self, path: PathBuilder, pen: Pen) {
        let stroke =
            Stroke { width: pen.width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        let Some(path) = path.finish() else { return };
        self.pixmap.stroke_path(&path, &paint(pen.colour, pen.opacity), &stroke, Transform::identity(), None);
    }

    fn fill(&mut self, path: Option<Path>, colour: [u8; 3]) {
        let Some(path) = path else { return };
        self.pixmap.fill_path(&path, &paint(colour, 1.0), FillRule::Winding, Transform::identity(), None);
    }

    /// A dot with a dark rim; hollow where it is not filled. `radius` in pixels.
    pub fn dot(&mut self, at: DVec2, radius: f32, colour: [u8; 3], is_filled: bool) {
        let [x, y] = at.as_vec2().to_array();
        self.fill(PathBuilder::from_circle(x, y, radius + 1.0), RIM);
        self.fill(PathBuilder::from_circle(x, y, radius), colour);
        if !is_filled {
            self.fill(PathBuilder::from_circle(x, y, radius - 1.5), [255; 3]);
        }
    }

    /// Draws numbers beside their points, the first one nearest to its own, with a line to it; none covers another or a point, as
    /// long as there is room; then those that are seen cover hidden ones.
    pub fn marks(&mut self, marks: &[Mark]) {
        let size = dvec2(f64::from(self.pixmap.width()), f64::from(self.pixmap.height()));
        let points: Vec<DVec2> = marks.iter().map(|mark| mark.at).collect();
        let boxes: Vec<DVec2> = marks.iter().map(|mark| box_of(mark.number)).collect();
        let middles = places(size, &points, &boxes);
        let pen = |mark: &Mark| Pen { colour: RIM, width: 1.0, opacity: if mark.is_seen { 0.9 } else { 0.45 } };
        for (mark, &middle) in marks.iter().zip(&middles) {
            self.lines([&Drawn { closed: false, points: vec![mark.at, middle] }], pen(mark));
        }
        // Hidden ones first, and of all others the first one last: on top.
        let mut order: Vec<usize> = (0..marks.len()).rev().collect();
        order.sort_by_key(|&i| marks[i].is_seen);
        for &i in &order {
            self.dot(marks[i].at, 4.5, marks[i].colour, marks[i].is_seen);
        }
        for i in order {
            self.number(&marks[i], middles[i] - 0.5 * boxes[i], boxes[i]);
        }
    }

    fn number(&mut self, mark: &Mark, corner: DVec2, extent: DVec2) {
        let corner = corner.round();
        let rect = |grown: f64| {
            let ([x, y], [w, h]) = ((corner - grown).as_vec2().to_array(), (extent + 2.0 * grown).as_vec2().to_array());
            Rect::from_xywh(x, y, w, h).map(PathBuilder::from_rect)
        };
        self.fill(rect(2.0), if mark.is_seen { RIM } else { PALE });
        self.fill(rect(1.0), if mark.is_seen { mark.colour } else { [255; 3] });
        self.fill(rect(-1.0), [255; 3]);
        let [x, y] = (corner + dvec2(PADDING, 1.0)).to_array().map(|x| x as usize);
        let ink = if mark.is_seen { INK } else { [PALE[0], PALE[1], PALE[2], 255] };
        let width = self.pixmap.width() as usize;
        let (pixels, _) = self.pixmap.data_mut().as_chunks_mut();
        write_text(pixels, width, [x, y], &mark.number.to_string(), ink);
    }
}

const RIM: [u8; 3] = [24, 26, 30];
const PALE: [u8; 3] = [128, 132, 140];

fn paint(colour: [u8; 3], opacity: f32) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    let [r, g, b] = colour;
    paint.set_color_rgba8(r, g, b, (opacity.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}

/// Width and height of a number's box.
fn box_of(number: usize) -> DVec2 {
    let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
    dvec2((number.to_string().len() * advance) as f64 + 2.0 * PADDING, LINE + 2.0)
}

/// Middles of boxes beside points, in their order: the first place, from near to far, that is in the picture and covers no other box
/// and no point; where there is none, the one that covers the fewest.
fn places(size: DVec2, points: &[DVec2], boxes: &[DVec2]) -> Vec<DVec2> {
    const MARGIN: f64 = 4.0;
    let mut taken: Vec<[DVec2; 2]> = Vec::new();
    for (&point, &extent) in points.iter().zip(boxes) {
        let half = 0.5 * extent + MARGIN;
        let candidates = DISTANCES.into_iter().flat_map(|distance| {
            (0..DIRECTIONS).map(move |k| {
                // Up to the right first.
                let turn = std::f64::consts::TAU * f64::from(k) / f64::from(DIRECTIONS) - 1.0;
                let direction = DVec2::from_angle(turn);
                let reach = (half / direction.abs().max(DVec2::splat(1e-9))).min_element();
                point + direction * (distance + reach)
            })
        });
        let cost = |&middle: &DVec2| {
            let kept = middle.clamp(half, (size - half).max(half));
            let outside = if kept == middle { 0 } else { 1000 };
            let overlaps = |[other, reach]: &&[DVec2; 2]| (*other - middle).abs().cmplt(*reach + half).all();
            let covers = |other: &&DVec2| (**other - middle).abs().cmplt(half + 3.0).all();
            outside + 10 * taken.iter().filter(overlaps).count() + points.iter().filter(covers).count()
        };
        let best = candidates.min_by_key(cost).unwrap_or(point);
        // In the picture, whatever is there.
        let best = best.clamp(half, (size - half).max(half));
        taken.push([best, half]);
    }
    taken.into_iter().map(|[middle, _]| middle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_apart_and_inside() {
        let points: Vec<DVec2> = (0..12).map(|k| dvec2(50.0 + f64::from(k % 4), 2.0 + f64::from(k / 4))).collect();
        let boxes: Vec<DVec2> = (1..=12).map(box_of).collect();
        let size = dvec2(300.0, 200.0);
        let middles = places(size, &points, &boxes);
        for (i, (a, &half)) in middles.iter().zip(&boxes).enumerate() {
            let half = 0.5 * half;
            assert!((a - half).min_element() >= 0.0 && (size - a - half).min_element() >= 0.0, "{a}");
            for (b, &other) in middles[..i].iter().zip(&boxes) {
                assert!(!(a - b).abs().cmplt(half + 0.5 * other).all(), "{a} {b}");
            }
        }
        // No room at all is no reason to fail.
        let tiny = dvec2(3.0, 3.0);
        assert!(places(tiny, &points, &boxes).iter().all(|place| place.is_finite()));
    }

    #[test]
    fn marks_are_drawn_and_pictures_stay_opaque() {
        let mark = |at: [f64; 2], number, is_seen| Mark { at: at.into(), number, colour: [250, 10, 20], is_seen };
        let mut canvas = Canvas::new([120, 80], [90, 100, 110, 255].repeat(120 * 80)).expect("the bytes match");
        canvas.fade(0.6);
        canvas.lines(
            [&Drawn { closed: true, points: vec![dvec2(5.0, 5.0), dvec2(20.0, 70.0), dvec2(40.0, 9.0)] }],
            Pen { colour: [0, 0, 255], width: 2.0, opacity: 1.0 },
        );
        canvas.marks(&[mark([30.0, 40.0], 7, true), mark([90.0, 40.0], 12, false), mark([119.0, 79.0], 103, true)]);
        let rgba8 = canvas.into_rgba8();
        let (pixels, _) = rgba8.as_chunks::<4>();
        let at = |x: usize, y: usize| pixels[y * 120 + x];
        assert!(pixels.iter().all(|pixel| pixel[3] == 255));
        assert_eq!((at(0, 79), at(30, 40), at(90, 40)), ([156, 162, 168, 255], [250, 10, 20, 255], [255; 4]));
        let count = |colour: [u8; 3]| pixels.iter().filter(|pixel| pixel[..3] == colour).count();
        assert!(count([0, 0, 255]) > 100 && count([250, 10, 20]) > 60 && count([255; 3]) > 300);
        // A picture of one pixel takes them too.
        let mut dot = Canvas::new([1, 1], vec![0, 0, 0, 255]).expect("the bytes match");
        dot.marks(&[mark([0.5, 0.5], 123, true)]);
        assert_eq!(dot.into_rgba8().len(), 4);
        assert!(Canvas::new([2, 2], vec![0; 4]).is_none());
    }
}
