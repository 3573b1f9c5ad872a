//! A rectangle of a patch as a projected Bezier net: bounds, halves, and how much its projection distorts.

use super::bounds::{Bounds, Seen, seen_net};
use super::lens::Lens;
use super::net::{Net, Row, bezier_of_spline, combined, dot, greatest, halve, max, row, transposed, unevenness};
use super::{BAND, Frame};
use glam::DVec3;

/// A bicubic piece of the surface, projected.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// x and y times weight, and depth.
    net: [Net; 3],
    /// First corner in the patch.
    pub origin: [f64; 2],
    /// Extent in the patch.
    pub size: [f64; 2],
    /// Levels that it is yet to be divided by along u and v, whatever it looks like.
    pub owed: [u8; 2],
}

impl Piece {
    /// Of a projected uniform bicubic B-spline net, u fastest.
    pub fn new(spline: &[DVec3; 16], origin: [f64; 2], size: f64, owed: [u8; 2]) -> Piece {
        let mut net = [[[0.0; 4]; 4]; 3];
        for (k, point) in spline.iter().enumerate() {
            net[0][k / 4][k % 4] = point.x;
            net[1][k / 4][k % 4] = point.y;
            net[2][k / 4][k % 4] = point.z;
        }
        for net in &mut net {
            *net = bezier_of_spline(net);
        }
        Piece { net, origin, size: [size; 2], owed }
    }

    pub fn seen(&self, lens: &Lens) -> Seen {
        seen_net(lens, &self.net)
    }

    /// Whether a piece beyond the near plane is longer along v: by the lengths of its projected control polygons, in city
    /// blocks.
    pub fn longer_along_v(&self, lens: &Lens) -> bool {
        let (mut along_u, mut along_v) = ([0.0; 4], [0.0; 4]);
        let [x, y, depth] = &self.net;
        let mut inverse = [[0.0; 4]; 4];
        for j in 0..4 {
            inverse[j] = lens.inverse_weights(&depth[j]);
        }
        for net in [x, y] {
            let mut seen = [[0.0; 4]; 4];
            for j in 0..4 {
                seen[j] = row(|i| net[j][i] * inverse[j][i]);
            }
            for k in 0..4 {
                for i in 0..3 {
                    along_u[k] += (seen[k][i + 1] - seen[k][i]).abs();
                    along_v[k] += (seen[i + 1][k] - seen[i][k]).abs();
                }
            }
        }
        greatest(&along_v) > greatest(&along_u)
    }

    /// Leaves the lower half along u or v, returns the upper one.
    pub fn split(&mut self, along_v: bool) -> Piece {
        let axis = usize::from(along_v);
        self.size[axis] *= 0.5;
        self.owed[axis] = self.owed[axis].saturating_sub(1);
        let mut origin = self.origin;
        origin[axis] += self.size[axis];
        let [x, y, depth] = &mut self.net;
        let net = [halve(x, along_v), halve(y, along_v), halve(depth, along_v)];
        Piece { net, origin, size: self.size, owed: self.owed }
    }

    /// How the projection looks from the middle of the piece; `None` where it is singular there.
    ///
    /// With J the derivative of (x,y) - p weight by the piece's own u and v, at any of its points and for any sample p in its
    /// bounds, and J0 that in the middle for the sample there, `distortion` bounds the maximum norm of J0^-1 J - 1: derivative
    /// nets are convex combinations of their control vectors.
    pub fn frame(&self, lens: &Lens, bounds: &Bounds) -> Option<Frame> {
        let middle = self.middle();
        let weight = lens.weight(middle.value[2]);
        let scale = 1.0 / weight;
        // Sixteenths: exact in f32 over every tile.
        let centre = [0, 1].map(|k| f64::from((middle.value[k] * scale * 16.0) as i32) / 16.0);
        let relative = |d: [f64; 3]| {
            let change = lens.weight_change(d[2]) * scale;
            [d[0] * scale - centre[0] * change, d[1] * scale - centre[1] * change]
        };
        let (du, dv) = (relative(middle.du), relative(middle.dv));
        let determinant = du[0] * dv[1] - du[1] * dv[0];
        // Squares of the product of lengths and, relative to it, of the sine of the angle: thinner parallelograms would lose digits
        // in f32.
        let lengths = (du[0] * du[0] + du[1] * du[1]) * (dv[0] * dv[0] + dv[1] * dv[1]);
        if determinant * determinant <= 1e-6 * lengths {
            return None;
        }
        let over = 1.0 / determinant;
        let inverse = [[dv[1] * over, -dv[0] * over], [-du[1] * over, du[0] * over]];
        let reach = [0, 1].map(|k| max(bounds.high[k] - centre[k], centre[k] - bounds.low[k]) + BAND);
        let distortion = self.distortion(lens, centre, scale, &inverse, reach);
        let offset = [0, 1].map(|k| middle.value[k] * scale - centre[k]);
        let start = [0, 1].map(|row: usize| 0.5 - inverse[row][0] * offset[0] - inverse[row][1] * offset[1]);
        Some(Frame { centre, depth: middle.value[2], weight, inverse, start, distortion })
    }

    /// q, for samples within `reach` of `centre`.
    #[inline(always)]
    fn distortion(&self, lens: &Lens, centre: [f64; 2], scale: f64, inverse: &[[f64; 2]; 2], reach: [f64; 2]) -> f64 {
        let [x, y, depth] = &self.net;
        let mut change = [[0.0; 4]; 4];
        // The net as the inverse of the linear map sees it: there each of (u,v) grows by a third from control value to control
        // value along itself, and not at all along the other.
        let mut flat = [[[0.0; 4]; 4]; 2];
        for j in 0..4 {
            change[j] = row(|i| lens.weight_change(depth[j][i]) * scale);
            let [x, y] =
                [(x, centre[0]), (y, centre[1])].map(|(net, at)| row(|i| net[j][i] * scale - at * change[j][i]));
            for (flat, [a, b]) in flat.iter_mut().zip(inverse) {
                flat[j] = row(|i| a * x[i] + b * y[i]);
            }
        }
        let change_over = 3.0 * (unevenness(&change, 0.0) + unevenness(&transposed(&change), 0.0));
        let mut distortion = 0.0;
        for (axis, net) in flat.iter().enumerate() {
            let [along_u, along_v] = [[1.0 / 3.0, 0.0], [0.0, 1.0 / 3.0]][axis];
            let deviation = 3.0 * (unevenness(&transposed(net), along_u) + unevenness(net, along_v));
            let slack = change_over * (inverse[axis][0].abs() * reach[0] + inverse[axis][1].abs() * reach[1]);
            distortion = max(distortion, deviation + slack);
        }
        distortion
    }

    /// The net relative to a frame, as charts hold it: x and y relative to the frame's centre, and depth relative to its own.
    pub fn relative_to(&self, lens: &Lens, frame: &Frame) -> [[[f32; 4]; 3]; 4] {
        let scale = 1.0 / frame.weight;
        let depth_scale = if lens.perspective { scale } else { 1.0 };
        let mut out = [[[0.0; 4]; 3]; 4];
        for (j, [x, y, depth]) in out.iter_mut().enumerate() {
            for i in 0..4 {
                let weight = lens.weight(self.net[2][j][i]);
                x[i] = ((self.net[0][j][i] - frame.centre[0] * weight) * scale) as f32;
                y[i] = ((self.net[1][j][i] - frame.centre[1] * weight) * scale) as f32;
                depth[i] = ((self.net[2][j][i] - frame.depth) * depth_scale) as f32;
            }
        }
        out
    }

    /// Value and derivatives at the piece's own (u,v).
    #[inline]
    pub fn at(&self, [u, v]: [f64; 2]) -> Jet {
        self.jet(bernstein(u), bernstein(v))
    }

    fn middle(&self) -> Jet {
        const MIDDLE: (Row, Row) = ([0.125, 0.375, 0.375, 0.125], [-0.75, -0.75, 0.75, 0.75]);
        self.jet(MIDDLE, MIDDLE)
    }

    #[inline(always)]
    fn jet(&self, (bu, du): (Row, Row), (bv, dv): (Row, Row)) -> Jet {
        let mut jet = Jet { value: [0.0; 3], du: [0.0; 3], dv: [0.0; 3] };
        for (c, net) in self.net.iter().enumerate() {
            let (line, slope) = (combined(net, &bv), combined(net, &dv));
            jet.value[c] = dot(&line, &bu);
            jet.du[c] = dot(&line, &du);
            jet.dv[c] = dot(&slope, &bu);
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
#[inline(always)]
fn bernstein(t: f64) -> (Row, Row) {
    let s = 1.0 - t;
    (
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
    )
}
