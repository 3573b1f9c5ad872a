//! Where in the picture something is, by a hull.

use super::BAND;
use super::lens::Lens;
use super::net::{Net, Row, greatest, least, max, min};
use glam::DVec3;
use std::ops::Range;

/// Where in the picture a piece is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Seen {
    /// Nowhere.
    No,
    /// Partly in front of the near plane, in sight.
    Straddles,
    /// Within these bounds, which may lie beyond the picture.
    Within(Bounds),
}

/// A box in the picture, and the least depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub low: [f64; 2],
    pub high: [f64; 2],
    pub near: f64,
}

impl Bounds {
    /// Ranges of the tile's samples whose centres lie in the box or within [`BAND`] of it.
    ///
    /// Casts stand for `ceil` and `floor`, which are calls on processors that may lack the instructions.
    pub fn samples(&self, lens: &Lens) -> [Range<u32>; 2] {
        let along = |k: usize| {
            let size = lens.size[k];
            let low = min(max(self.low[k] - BAND - 0.5, 0.0), size);
            let below = low as u32;
            let first = below + u32::from(f64::from(below) < low);
            first..min(self.high[k] + BAND + 0.5, size) as u32
        };
        [along(0), along(1)]
    }

    /// Whether a point lies in the box or within [`BAND`] of it.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        (0..2).all(|k| point[k] >= self.low[k] - BAND && point[k] <= self.high[k] + BAND)
    }

    /// With `margin` samples more on each side.
    pub fn widened(&self, margin: f64) -> Bounds {
        Bounds { low: self.low.map(|x| x - margin), high: self.high.map(|x| x + margin), near: self.near }
    }

    /// Longest side.
    pub fn extent(&self) -> f64 {
        max(self.high[0] - self.low[0], self.high[1] - self.low[1])
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
    /// Through two points.
    pub fn new(a: [f64; 2], b: [f64; 2]) -> Line {
        let d = [b[0] - a[0], b[1] - a[1]];
        let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
        Line { through: a, across: [-d[1] / length, d[0] / length] }
    }

    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        ((x - self.through[0]) * self.across[0] + (y - self.through[1]) * self.across[1]).abs()
    }
}

/// Bounds of a projected net, and whether what it controls is seen at all.
#[inline]
pub(super) fn seen_net(lens: &Lens, [x, y, depth]: &[Net; 3]) -> Seen {
    let near = least(&across(depth, min));
    if near < lens.near {
        let point = |k: usize| DVec3::new(x[k / 4][k % 4], y[k / 4][k % 4], depth[k / 4][k % 4]);
        if let Some(seen) = crossing(lens, (0..16).map(point)) {
            return seen;
        }
    }
    let (mut low, mut high) = ([[f64::INFINITY; 4]; 2], [[f64::NEG_INFINITY; 4]; 2]);
    for j in 0..4 {
        let inverse = lens.inverse_weights(&depth[j]);
        for (axis, net) in [x, y].into_iter().enumerate() {
            for k in 0..4 {
                let value = net[j][k] * inverse[k];
                low[axis][k] = min(low[axis][k], value);
                high[axis][k] = max(high[axis][k], value);
            }
        }
    }
    Seen::Within(Bounds { low: [least(&low[0]), least(&low[1])], high: [greatest(&high[0]), greatest(&high[1])], near })
}

/// All rows of a net in one.
#[inline(always)]
fn across(net: &Net, of_two: impl Fn(f64, f64) -> f64) -> Row {
    let mut out = net[0];
    for row in &net[1..] {
        for k in 0..4 {
            out[k] = of_two(out[k], row[k]);
        }
    }
    out
}

/// The same for any projected points.
pub(super) fn seen(lens: &Lens, points: impl Iterator<Item = DVec3> + Clone) -> Seen {
    let mut bounds = Bounds { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2], near: f64::INFINITY };
    for point in points.clone() {
        bounds.near = min(bounds.near, point.z);
        let inverse = 1.0 / lens.weight(point.z);
        for (axis, value) in [point.x * inverse, point.y * inverse].into_iter().enumerate() {
            bounds.low[axis] = min(bounds.low[axis], value);
            bounds.high[axis] = max(bounds.high[axis], value);
        }
    }
    let crossing = if bounds.near < lens.near { crossing(lens, points) } else { None };
    crossing.unwrap_or(Seen::Within(bounds))
}

/// Of points that do not all lie beyond the near plane: out of sight if all lie before it, or all beyond one side of the
/// frustum. `None` for parallel lines of sight, which have no singular plane: what lies before the near plane is left out where
/// it is found.
#[cold]
fn crossing(lens: &Lens, points: impl Iterator<Item = DVec3>) -> Option<Seen> {
    let mut far = f64::NEG_INFINITY;
    // How far the points reach over each side from beyond.
    let mut reach = [[f64::NEG_INFINITY; 2]; 2];
    for point in points {
        far = max(far, point.z);
        let weight = lens.weight(point.z);
        for (axis, value) in [point.x, point.y].into_iter().enumerate() {
            reach[axis][0] = max(reach[axis][0], value - (0.5 - BAND) * weight);
            reach[axis][1] = max(reach[axis][1], (lens.size[axis] - 0.5 + BAND) * weight - value);
        }
    }
    if !lens.perspective {
        return (far < lens.near).then_some(Seen::No);
    }
    // What lies wholly within twice the near distance is left out too, for halves of what crosses the plane never end.
    let beyond = reach.iter().flatten().any(|&reach| reach < 0.0);
    Some(if far < 2.0 * lens.near || beyond { Seen::No } else { Seen::Straddles })
}
