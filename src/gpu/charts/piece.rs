//! A rectangle of a patch as a projected Bezier net: bounds, halves, and how much its projection distorts.

use super::lens::Lens;
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

/// Bounds of projected points, and whether they are seen at all.
pub(super) fn seen(lens: &Lens, points: impl Iterator<Item = [f64; 3]>) -> Seen {
    let mut bounds = Bounds { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2], near: f64::INFINITY };
    let (mut some_before, mut all_before) = (false, true);
    // All points beyond one side of the frustum: so is what they control.
    let mut outside = [true; 4];
    for [x, y, depth] in points {
        let weight = lens.weight(depth);
        let before = depth < lens.near;
        some_before |= before;
        all_before &= before;
        for (k, value) in [x, y].into_iter().enumerate() {
            outside[2 * k] &= value < (0.5 - BAND) * weight;
            outside[2 * k + 1] &= value > (lens.size[k] - 0.5 + BAND) * weight;
        }
        let inverse = 1.0 / weight;
        for (k, value) in [x * inverse, y * inverse].into_iter().enumerate() {
            bounds.low[k] = bounds.low[k].min(value);
            bounds.high[k] = bounds.high[k].max(value);
        }
        bounds.near = bounds.near.min(depth);
    }
    if all_before || outside.contains(&true) {
        Seen::No
    } else if some_before {
        Seen::Straddles
    } else {
        Seen::Within(bounds)
    }
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
        seen(lens, (0..16).map(|k| [x[k / 4][k % 4], y[k / 4][k % 4], depth[k / 4][k % 4]]))
    }

    /// Whether a piece beyond the near plane is longer along v: by the lengths of its projected control polygons.
    pub fn longer_along_v(&self, lens: &Lens) -> bool {
        let at = |i: usize, j: usize| {
            let weight = lens.weight(self.net[2][j][i]);
            [self.net[0][j][i] / weight, self.net[1][j][i] / weight]
        };
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let along = |k: usize, v: bool| -> f64 {
            let point = |i: usize| if v { at(k, i) } else { at(i, k) };
            (0..3).map(|i| distance(point(i), point(i + 1))).sum()
        };
        let longest = |v: bool| (0..4).map(|k| along(k, v)).fold(0.0, f64::max);
        longest(true) > longest(false)
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
        let centre = [0, 1].map(|k| (middle.value[k] / weight * 16.0).round() / 16.0);
        let scale = 1.0 / weight;
        let relative = |d: [f64; 3]| {
            let change = lens.weight_change(d[2]) * scale;
            [d[0] * scale - centre[0] * change, d[1] * scale - centre[1] * change, change]
        };
        let (du, dv) = (relative(middle.du), relative(middle.dv));
        let determinant = du[0] * dv[1] - du[1] * dv[0];
        let lengths = du[0].hypot(du[1]) * dv[0].hypot(dv[1]);
        if determinant.abs() <= 1e-9 * lengths {
            return None;
        }
        let inverse = [[dv[1] / determinant, -dv[0] / determinant], [-du[1] / determinant, du[0] / determinant]];
        let reach = [0, 1].map(|k| (bounds.high[k] - centre[k]).max(centre[k] - bounds.low[k]) + BAND);
        // Largest deviation in each row of J0^-1 J - 1 of the column of u, then of v.
        let mut deviation = [[0.0f64; 2]; 2];
        let mut look = |column: usize, d: [f64; 3]| {
            let [x, y, change] = relative(d);
            let change = change.abs();
            for row in 0..2 {
                let [a, b] = inverse[row];
                let along = a * x + b * y - f64::from(u8::from(row == column));
                let slack = change * (a.abs() * reach[0] + b.abs() * reach[1]);
                deviation[column][row] = deviation[column][row].max(along.abs() + slack);
            }
        };
        for j in 0..4 {
            for i in 0..3 {
                look(0, std::array::from_fn(|c| 3.0 * (self.net[c][j][i + 1] - self.net[c][j][i])));
                look(1, std::array::from_fn(|c| 3.0 * (self.net[c][i + 1][j] - self.net[c][i][j])));
            }
        }
        let distortion = (0..2).map(|row| deviation[0][row] + deviation[1][row]).fold(0.0, f64::max);
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
                true => self.net[2][j][i] * scale,
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
