//! How the projection of a piece looks from its middle.

use super::bounds::Bounds;
use super::lens::Lens;
use super::net::{Net, bend, greatest, least, max, min, row};
use super::piece::Jet;
use super::{BAND, MAX_DISTORTION};

/// The linear map that the projection is taken for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    /// Sample coordinates near the middle, exact in f32.
    pub centre: [f64; 2],
    /// Depth in the middle.
    pub depth: f64,
    /// Weight in the middle: the depth in perspective, else 1.
    pub weight: f64,
    /// J0^-1.
    pub inverse: [[f64; 2]; 2],
    /// (u,v) that the linear map gives `centre`.
    pub start: [f64; 2],
    /// Change of the weight along u and v in the middle, as a part of it.
    pub slope: f64,
    /// Whether v is longer than u, in city blocks.
    pub longer_along_v: bool,
    /// Samples that the linear map's parallelogram covers.
    pub area: f64,
}

impl Frame {
    /// From value and derivatives in the middle of a piece; `None` where the projection is singular there.
    pub fn new(lens: &Lens, middle: &Jet) -> Option<Frame> {
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
        // Squares of the product of lengths and, relative to it, of the sine of the angle: thinner parallelograms would lose
        // digits in f32.
        let lengths = (du[0] * du[0] + du[1] * du[1]) * (dv[0] * dv[0] + dv[1] * dv[1]);
        if determinant * determinant <= 1e-6 * lengths {
            return None;
        }
        let over = 1.0 / determinant;
        let inverse = [[dv[1] * over, -dv[0] * over], [-du[1] * over, du[0] * over]];
        let offset = [0, 1].map(|k| middle.value[k] * scale - centre[k]);
        let start = [0, 1].map(|row: usize| 0.5 - inverse[row][0] * offset[0] - inverse[row][1] * offset[1]);
        let slope = [middle.du, middle.dv].iter().map(|d| lens.weight_change(d[2]).abs()).sum::<f64>() * scale;
        let longer_along_v = dv[0].abs() + dv[1].abs() > du[0].abs() + du[1].abs();
        let area = determinant.abs();
        Some(Frame { centre, depth: middle.value[2], weight, inverse, start, slope, longer_along_v, area })
    }

    /// (u,v) that the linear map gives a sample, less those of the centre.
    pub fn flat(&self, p: [f64; 2]) -> [f64; 2] {
        let d = [p[0] - self.centre[0], p[1] - self.centre[1]];
        self.inverse.map(|[a, b]| a * d[0] + b * d[1])
    }

    /// [`BAND`] in (u,v).
    pub fn band(&self) -> f64 {
        let [u, v] = self.inverse.map(|[a, b]| BAND * (a.abs() + b.abs()));
        max(u, v)
    }
}

/// Samples by which rasterisers may move a corner, which is more than thin charts are wide: a multiple of their grid of 1/256.
const SNAP: f64 = 1.0 / 64.0;

/// A frame whose linear map is so close to the projection that Newton's method must find what a sample sees.
#[derive(Debug, Clone, Copy)]
pub(super) struct ChartFrame {
    pub frame: Frame,
    /// Half the sides of the rectangle round (1/2, 1/2) in which the linear map sees every sample that the chart covers: it errs
    /// by the mean of E on the way from the middle. And a thousandth more, for the rounding of the parallelogram's corners, and
    /// [`SNAP`].
    pub half: [f64; 2],
}

/// A net as a frame's linear map, undone, sees it: there u and v each grow by a third from control value to control value
/// along themselves, and not at all along the other, but for what the projection distorts.
#[derive(Debug)]
pub(super) struct Flat {
    pub frame: Frame,
    /// u and v, less those of the frame's centre, times weight.
    net: [Net; 2],
    /// Weights, as parts of that in the middle.
    weight: Net,
}

impl Flat {
    /// Of x and y times weight, and depth.
    #[inline(always)]
    pub fn new(lens: &Lens, frame: Frame, [x, y, depth]: &[Net; 3]) -> Flat {
        let mut flat = Flat { frame, net: [[[0.0; 4]; 4]; 2], weight: [[0.0; 4]; 4] };
        let scale = 1.0 / frame.weight;
        for j in 0..4 {
            let weight = row(|i| lens.weight(depth[j][i]) * scale);
            let x = row(|i| x[j][i] * scale - frame.centre[0] * weight[i]);
            let y = row(|i| y[j][i] * scale - frame.centre[1] * weight[i]);
            for (net, [a, b]) in flat.net.iter_mut().zip(frame.inverse) {
                net[j] = row(|i| a * x[i] + b * y[i]);
            }
            flat.weight[j] = weight;
        }
        flat
    }

    /// The chart that a piece within `bounds` is, if it is one.
    ///
    /// With J the derivative of (x,y) - p weight by the piece's own u and v for a sample p in the bounds, J0 that in the middle
    /// for the sample there, and J0^-1 J = 1 + E: in the middle E is `slant`, what the weight's slope makes of the distance
    /// between the samples, and it changes by at most `bend` from side to side. All in the maximum norm.
    #[inline(always)]
    pub fn chart(&self, bounds: &Bounds) -> Option<ChartFrame> {
        let Frame { centre, inverse, slope, .. } = &self.frame;
        let reach = [0, 1].map(|k| max(bounds.high[k] - centre[k], centre[k] - bounds.low[k]) + BAND);
        let weight_bend = bend(&self.weight);
        let (mut distortion, mut mean) = (0.0, 0.0);
        for (net, [a, b]) in self.net.iter().zip(inverse) {
            let reach = a.abs() * reach[0] + b.abs() * reach[1];
            let (slant, bend) = (reach * slope, bend(net) + reach * weight_bend);
            distortion = max(distortion, slant + 0.5 * bend);
            mean = max(mean, slant + 0.25 * bend);
        }
        let half = inverse.map(|[a, b]| 0.501 * (1.0 + mean) + (2.0 * BAND + SNAP) * (a.abs() + b.abs()));
        (distortion < MAX_DISTORTION).then_some(ChartFrame { frame: self.frame, half })
    }

    /// Whether the sample at `p` cannot see the piece, nor within [`BAND`] of it: whether all of it lies to one side of `p`.
    pub fn misses(&self, p: [f64; 2]) -> bool {
        let band = self.frame.band();
        let at = self.frame.flat(p);
        self.net.iter().zip(at).any(|(net, at)| {
            let (mut low, mut high) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
            for (values, weights) in net.iter().zip(&self.weight) {
                for k in 0..4 {
                    low[k] = min(low[k], values[k] - (at + band) * weights[k]);
                    high[k] = max(high[k], values[k] - (at - band) * weights[k]);
                }
            }
            least(&low) > 0.0 || greatest(&high) < 0.0
        })
    }
}
