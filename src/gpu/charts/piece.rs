//! A rectangle of a patch as a projected Bezier net: bounds, halves, and how much its projection distorts.

use super::lens::Lens;
use super::solve::POINT;
use super::{BAND, Frame};
use glam::DVec3;

/// Four control values along u.
type Row = [f64; 4];

/// A bicubic piece of the surface, projected.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// x and y times weight, and depth; rows of v.
    net: [[Row; 4]; 3],
    /// First corner in the patch.
    pub origin: [f64; 2],
    /// Extent in the patch.
    pub size: [f64; 2],
    /// Levels that it is yet to be divided by along u and v, whatever it looks like.
    pub owed: [u8; 2],
}

/// Where in the picture a piece is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Seen {
    /// Nowhere.
    No,
    /// Partly in front of the near plane, in sight.
    Straddles,
    /// Within these bounds.
    Within(Bounds),
}

/// A box in the picture, and the range of depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub low: [f64; 2],
    pub high: [f64; 2],
    pub near: f64,
}

impl Bounds {
    /// Ranges of the tile's samples whose centres lie in the box or within [`BAND`] of it.
    pub fn samples(&self, lens: &Lens) -> [std::ops::Range<u32>; 2] {
        std::array::from_fn(|k| {
            let first = (self.low[k] - BAND - 0.5).ceil().max(0.0);
            let end = (self.high[k] + BAND - 0.5).floor().min(lens.size[k] - 1.0) + 1.0;
            if first < end { first as u32..end as u32 } else { 0..0 }
        })
    }

    /// Whether a point lies in the box or within [`BAND`] of it.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        (0..2).all(|k| point[k] >= self.low[k] - BAND && point[k] <= self.high[k] + BAND)
    }

    /// Longest side.
    pub fn extent(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}

/// A line in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    through: [f64; 2],
    /// Unit vector across it.
    across: [f64; 2],
}

impl Line {
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        ((x - self.through[0]) * self.across[0] + (y - self.through[1]) * self.across[1]).abs()
    }
}

/// The larger of two numbers: `f64::max` asks for NaN, which keeps loops from becoming vectors.
fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Bounds of projected points, and whether what they control is seen at all. In groups of `N`.
pub(super) fn seen<const N: usize>(lens: &Lens, points: impl Iterator<Item = [[f64; N]; 3]>) -> Seen {
    let mut low = [[f64::INFINITY; N]; 2];
    let mut high = [[f64::NEG_INFINITY; N]; 2];
    let (mut near, mut far) = ([f64::INFINITY; N], [f64::NEG_INFINITY; N]);
    // How far the points reach over each side of the frustum from beyond: at most 0 if all of them lie beyond.
    let mut reach = [[f64::NEG_INFINITY; N]; 4];
    for points in points {
        let depth = &points[2];
        let weight: [f64; N] = std::array::from_fn(|k| lens.weight(depth[k]));
        for k in 0..N {
            near[k] = min(near[k], depth[k]);
            far[k] = max(far[k], depth[k]);
        }
        for (axis, side) in [(0, lens.size[0]), (1, lens.size[1])] {
            for k in 0..N {
                let value = points[axis][k];
                reach[2 * axis][k] = max(reach[2 * axis][k], value - (0.5 - BAND) * weight[k]);
                reach[2 * axis + 1][k] = max(reach[2 * axis + 1][k], (side - 0.5 + BAND) * weight[k] - value);
                let seen = value / weight[k];
                low[axis][k] = min(low[axis][k], seen);
                high[axis][k] = max(high[axis][k], seen);
            }
        }
    }
    let least = |values: &[f64; N]| values.iter().copied().fold(f64::INFINITY, min);
    let most = |values: &[f64; N]| values.iter().copied().fold(f64::NEG_INFINITY, max);
    if most(&far) < lens.near || reach.iter().any(|side| most(side) < 0.0) {
        return Seen::No;
    }
    let near = least(&near);
    // Parallel lines of sight have no singular plane: what lies before the near plane is left out where it is found.
    // And what lies wholly within twice its distance is left out, for halves of what crosses it never end.
    if lens.perspective && near < lens.near {
        return if most(&far) < 2.0 * lens.near { Seen::No } else { Seen::Straddles };
    }
    Seen::Within(Bounds { low: low.each_ref().map(least), high: high.each_ref().map(most), near })
}

/// Bezier points of a uniform cubic B-spline piece.
fn bezier([a, b, c, d]: Row) -> Row {
    let third = 1.0 / 3.0;
    let [p, q] = [(2.0 * b + c) * third, (b + 2.0 * c) * third];
    [(a + 4.0 * b + c) / 6.0, p, q, (b + 4.0 * c + d) / 6.0]
}

fn transposed(net: &[Row; 4]) -> [Row; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| net[j][i]))
}

/// Control values of the derivative across rows of Bezier points.
fn differences(net: &[Row; 4]) -> [f64; 12] {
    std::array::from_fn(|k| 3.0 * (net[k / 4 + 1][k % 4] - net[k / 4][k % 4]))
}

/// Both halves of rows of Bezier points: de Casteljau at 1/2, all columns at once.
fn halves([a, b, c, d]: &[Row; 4]) -> [[Row; 4]; 2] {
    let mean = |p: &Row, q: &Row| -> Row { std::array::from_fn(|k| 0.5 * (p[k] + q[k])) };
    let (ab, bc, cd) = (mean(a, b), mean(b, c), mean(c, d));
    let (abc, bcd) = (mean(&ab, &bc), mean(&bc, &cd));
    let middle = mean(&abc, &bcd);
    [[*a, ab, abc, middle], [middle, bcd, cd, *d]]
}

impl Piece {
    /// A uniform bicubic B-spline net, u fastest, relative to `from`.
    pub fn new(lens: &Lens, from: DVec3, net: &[DVec3; 16], origin: [f64; 2], size: f64, owed: [u8; 2]) -> Piece {
        let projected = net.map(|p| lens.project(from, p));
        let net = std::array::from_fn(|c| {
            let rows: [Row; 4] = std::array::from_fn(|j| bezier(std::array::from_fn(|i| projected[4 * j + i][c])));
            transposed(&transposed(&rows).map(bezier))
        });
        Piece { net, origin, size: [size; 2], owed }
    }

    pub fn seen(&self, lens: &Lens) -> Seen {
        let [x, y, depth] = &self.net;
        seen(lens, (0..4).map(|j| [x[j], y[j], depth[j]]))
    }

    /// Whether a piece beyond the near plane is longer along v: by the lengths of its projected control polygons, in city
    /// blocks.
    pub fn longer_along_v(&self, lens: &Lens) -> bool {
        let mut lengths = [[0.0; 4]; 2];
        let inverse = self.net[2].map(|row| row.map(|depth| 1.0 / lens.weight(depth)));
        for net in &self.net[..2] {
            let seen: [Row; 4] = std::array::from_fn(|j| std::array::from_fn(|i| net[j][i] * inverse[j][i]));
            for k in 0..4 {
                for i in 0..3 {
                    lengths[0][k] += (seen[k][i + 1] - seen[k][i]).abs();
                    lengths[1][k] += (seen[i + 1][k] - seen[i][k]).abs();
                }
            }
        }
        let [along_u, along_v] = lengths.map(|lengths| lengths.into_iter().fold(0.0, max));
        along_v > along_u
    }

    /// Whether all control points lie on a line in space: what they control has no area, and no line of sight meets it.
    pub fn has_no_area(&self) -> bool {
        let point = |k: usize| DVec3::from_array(std::array::from_fn(|c| self.net[c][k / 4][k % 4]));
        let from = point(0);
        let farthest = (1..16)
            .map(|k| point(k) - from)
            .fold(DVec3::ZERO, |far, d| if d.length_squared() > far.length_squared() { d } else { far });
        // Relative to the length of the line; rounding is below it unless the eye is a million lengths away.
        const ROUNDING: f64 = 1e-10;
        let most = ROUNDING * farthest.length_squared();
        (1..16).all(|k| (point(k) - from).cross(farthest).length() <= most)
    }

    /// The line that the piece is seen as, if its projected hull is nowhere wider than [`POINT`].
    pub fn line(&self, lens: &Lens) -> Option<Line> {
        let seen = |k: usize| {
            let inverse = 1.0 / lens.weight(self.net[2][k / 4][k % 4]);
            [self.net[0][k / 4][k % 4] * inverse, self.net[1][k / 4][k % 4] * inverse]
        };
        let along = |k: usize, [x, y]: [f64; 2]| {
            let p = seen(k);
            (p[0] - x).abs() + (p[1] - y).abs()
        };
        let farthest = |from: [f64; 2]| {
            let far = (0..16).fold((0, 0.0), |(best, most), k| match along(k, from) {
                length if length > most => (k, length),
                _ => (best, most),
            });
            seen(far.0)
        };
        let through = farthest(seen(0));
        let to = farthest(through);
        let d = [to[0] - through[0], to[1] - through[1]];
        let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
        let line = Line { through, across: [-d[1] / length, d[0] / length] };
        let thin = (0..16).all(|k| line.distance(seen(k)) < 0.5 * POINT);
        thin.then_some(line)
    }

    /// The lower and the upper half along u or v.
    pub fn split(&self, along_v: bool) -> [Piece; 2] {
        let mut parts = [self.clone(), self.clone()];
        let axis = usize::from(along_v);
        for (c, net) in self.net.iter().enumerate() {
            let [low, high] = match along_v {
                true => halves(net),
                false => halves(&transposed(net)).map(|half| transposed(&half)),
            };
            (parts[0].net[c], parts[1].net[c]) = (low, high);
        }
        for part in &mut parts {
            part.size[axis] *= 0.5;
            part.owed[axis] = part.owed[axis].saturating_sub(1);
        }
        parts[1].origin[axis] += parts[1].size[axis];
        parts
    }

    /// How the projection looks from the middle of the piece; `None` where it is singular there.
    ///
    /// With J the derivative of (x,y) - p weight by the piece's own u and v, at any of its points and for any sample p in its
    /// bounds, and J0 that in the middle for the sample there, `distortion` bounds the maximum norm of J0^-1 J - 1: derivative
    /// nets are convex combinations of their control vectors.
    pub fn frame(&self, lens: &Lens, bounds: &Bounds) -> Option<Frame> {
        let middle = self.at([0.5; 2]);
        let weight = lens.weight(middle.value[2]);
        // Sixteenths: exact in f32 over every tile.
        let centre = [0, 1].map(|k| f64::from((middle.value[k] / weight * 16.0) as i32) / 16.0);
        let scale = 1.0 / weight;
        let relative = |d: [f64; 3]| {
            let change = lens.weight_change(d[2]) * scale;
            [d[0] * scale - centre[0] * change, d[1] * scale - centre[1] * change, change]
        };
        let (du, dv) = (relative(middle.du), relative(middle.dv));
        let determinant = du[0] * dv[1] - du[1] * dv[0];
        // Squares of the product of lengths and, relative to it, of the sine of the angle: thinner parallelograms would lose digits
        // in f32.
        let lengths = (du[0] * du[0] + du[1] * du[1]) * (dv[0] * dv[0] + dv[1] * dv[1]);
        if (determinant * determinant).partial_cmp(&(1e-6 * lengths)) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let inverse = [[dv[1] / determinant, -dv[0] / determinant], [-du[1] / determinant, du[0] / determinant]];
        let reach = [0, 1].map(|k| (bounds.high[k] - centre[k]).max(centre[k] - bounds.low[k]) + BAND);
        // Largest deviation in each row of J0^-1 J - 1 of the column of u, then of v.
        let mut deviation = [[0.0f64; 2]; 2];
        let (along_u, along_v) =
            (self.net.map(|net| differences(&transposed(&net))), self.net.map(|net| differences(&net)));
        for (column, [x, y, depth]) in [along_u, along_v].into_iter().enumerate() {
            for k in 0..12 {
                let change = lens.weight_change(depth[k]);
                let (x, y) = ((x[k] - centre[0] * change) * scale, (y[k] - centre[1] * change) * scale);
                let change = change.abs() * scale;
                for row in 0..2 {
                    let [a, b] = inverse[row];
                    let along = a * x + b * y - if row == column { 1.0 } else { 0.0 };
                    let slack = change * (a.abs() * reach[0] + b.abs() * reach[1]);
                    deviation[column][row] = max(deviation[column][row], along.abs() + slack);
                }
            }
        }
        let distortion = max(deviation[0][0] + deviation[1][0], deviation[0][1] + deviation[1][1]);
        let offset = [0, 1].map(|k| middle.value[k] * scale - centre[k]);
        let start = [0, 1].map(|row: usize| 0.5 - inverse[row][0] * offset[0] - inverse[row][1] * offset[1]);
        Some(Frame { centre, depth: middle.value[2], weight, inverse, start, distortion })
    }

    /// The net relative to a frame, as charts hold it: x and y relative to the frame's centre, and depth relative to its own.
    pub fn relative_to(&self, lens: &Lens, frame: &Frame) -> [[[f32; 4]; 3]; 4] {
        let scale = 1.0 / frame.weight;
        std::array::from_fn(|j| {
            let weight = |i: usize| lens.weight(self.net[2][j][i]);
            let side = |k: usize| -> [f32; 4] {
                std::array::from_fn(|i| ((self.net[k][j][i] - frame.centre[k] * weight(i)) * scale) as f32)
            };
            let depth = |i: usize| match lens.perspective {
                true => (self.net[2][j][i] - frame.depth) * scale,
                false => self.net[2][j][i] - frame.depth,
            };
            [side(0), side(1), std::array::from_fn(|i| depth(i) as f32)]
        })
    }

    /// Value and derivatives at the piece's own (u,v).
    pub fn at(&self, [u, v]: [f64; 2]) -> Jet {
        let [(bu, du), (bv, dv)] = [u, v].map(bernstein);
        let mut jet = Jet { value: [0.0; 3], du: [0.0; 3], dv: [0.0; 3] };
        for (c, net) in self.net.iter().enumerate() {
            for (j, row) in net.iter().enumerate() {
                let line: f64 = (0..4).map(|i| row[i] * bu[i]).sum();
                let slope: f64 = (0..4).map(|i| row[i] * du[i]).sum();
                jet.value[c] += line * bv[j];
                jet.du[c] += slope * bv[j];
                jet.dv[c] += line * dv[j];
            }
        }
        jet
    }

    /// Parameters of the patch at the piece's own.
    pub fn to_patch(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + u * self.size[0], self.origin[1] + v * self.size[1]]
    }
}

/// x and y times weight, and depth, with their derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jet {
    pub value: [f64; 3],
    pub du: [f64; 3],
    pub dv: [f64; 3],
}

/// The cubic Bernstein polynomials and their derivatives.
fn bernstein(t: f64) -> (Row, Row) {
    let s = 1.0 - t;
    (
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
    )
}
