//! A rectangle of a patch as a projected Bezier net: bounds, halves, and how much its projection distorts.

use super::bounds::{Line, Seen, seen_net};
use super::frame::{Flat, Frame};
use super::lens::Lens;
use super::net::{Net, Row, bezier_of_spline, bezier_through, combined, dot, greatest, halve, max, min, row};
use super::solve::POINT;
use super::triangle::Clip;
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
    /// Where the surface ends inside it.
    pub clip: Option<Clip>,
}

impl Piece {
    /// Of a projected uniform bicubic B-spline net, u fastest.
    #[inline]
    pub fn new(spline: impl Fn(usize) -> DVec3, origin: [f64; 2], size: f64, owed: [u8; 2]) -> Piece {
        let mut net = [[[0.0; 4]; 4]; 3];
        for k in 0..16 {
            let point = spline(k);
            net[0][k / 4][k % 4] = point.x;
            net[1][k / 4][k % 4] = point.y;
            net[2][k / 4][k % 4] = point.z;
        }
        for net in &mut net {
            *net = bezier_of_spline(net);
        }
        Piece { net, origin, size: [size; 2], owed, clip: None }
    }

    /// The bicubic that goes through 4 x 4 points of a projected surface, given by the piece's own parameters: on its borders it
    /// depends on nothing but the points there.
    pub fn through(at: impl Fn([f64; 2]) -> DVec3, origin: [f64; 2], size: f64, owed: [u8; 2]) -> Piece {
        const THIRDS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
        let mut net = [[[0.0; 4]; 4]; 3];
        for j in 0..4 {
            for i in 0..4 {
                let point = at([THIRDS[i], THIRDS[j]]).to_array();
                (0..3).for_each(|c| net[c][j][i] = point[c]);
            }
        }
        Piece { net: net.map(|values| bezier_through(&values)), origin, size: [size; 2], owed, clip: None }
    }

    /// The same, where the surface ends at a diagonal.
    pub fn clipped(self, clip: Option<Clip>) -> Piece {
        Piece { clip, ..self }
    }

    /// Whether all of it lies where the surface has ended.
    pub fn is_beyond(&self) -> bool {
        self.clip.is_some_and(|clip| clip.is_beyond(self.origin))
    }

    /// How far a surface, given by the patch's parameters, is from the piece at nine points between those of
    /// [`through`](Self::through).
    pub fn gap(&self, surface: impl Fn([f64; 2]) -> DVec3) -> Gap {
        const BETWEEN: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];
        Gap(std::array::from_fn(|k| {
            let own = [BETWEEN[k % 3], BETWEEN[k / 3]];
            surface(self.to_patch(own)) - DVec3::from_array(self.at(own).value)
        }))
    }

    /// Samples that a gap is at most, wherever the tile sees a point of the piece: where the piece is nearest. What it is off in
    /// depth counts like what it is off aside.
    pub fn error(&self, lens: &Lens, gap: &Gap) -> f64 {
        let nearest = self.points().fold(f64::INFINITY, |near, p| min(near, p.z)) - gap.largest().z;
        gap.samples(lens) / lens.weight(max(nearest, lens.near))
    }

    /// The control points, projected.
    pub fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        (0..16).map(|k| DVec3::from_array([0, 1, 2].map(|c| self.net[c][k / 4][k % 4])))
    }

    pub fn seen(&self, lens: &Lens) -> Seen {
        seen_net(lens, &self.net)
    }

    /// Whether a piece beyond the near plane is longer along v in the picture, in city blocks: in its middle, or where nothing is
    /// known of that, by its control polygons.
    pub fn longer_along_v(&self, lens: &Lens, flat: Option<&Flat>) -> bool {
        if let Some(flat) = flat {
            return flat.frame.longer_along_v;
        }
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

    /// Whether all control points lie on a line in space: what they control has no area, and no line of sight meets it.
    pub fn has_no_area(&self) -> bool {
        let point = |k: usize| DVec3::from_array([0, 1, 2].map(|c| self.net[c][k / 4][k % 4]));
        let from = point(0);
        let farthest = (1..16)
            .map(|k| point(k) - from)
            .fold(DVec3::ZERO, |far, d| if d.length_squared() > far.length_squared() { d } else { far });
        // Relative to the length of the line; rounding is below it unless the eye is a million lengths away.
        const ROUNDING: f64 = 1e-10;
        let most = ROUNDING * farthest.length();
        // Of unit length first, for products of tiny numbers vanish.
        let direction = farthest.normalize_or_zero();
        (1..16).all(|k| (point(k) - from).cross(direction).length() <= most)
    }

    /// The line that the piece is seen as, if its projected hull is nowhere wider than [`POINT`].
    pub fn line(&self, lens: &Lens) -> Option<Line> {
        let seen: [[f64; 2]; 16] = std::array::from_fn(|k| {
            let [x, y, depth] = [0, 1, 2].map(|c| self.net[c][k / 4][k % 4]);
            [x / lens.weight(depth), y / lens.weight(depth)]
        });
        let farthest = |[x, y]: [f64; 2]| {
            let length = |p: [f64; 2]| (p[0] - x).abs() + (p[1] - y).abs();
            seen.into_iter().fold([x, y], |far, p| if length(p) > length(far) { p } else { far })
        };
        let through = farthest(seen[0]);
        let line = Line::new(through, farthest(through));
        seen.into_iter().all(|p| line.distance(p) < 0.5 * POINT).then_some(line)
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
        Piece { net, origin, size: self.size, owed: self.owed, clip: self.clip }
    }

    /// How the projection looks from the middle of the piece; `None` where it is singular there.
    #[inline]
    pub fn flat(&self, lens: &Lens) -> Option<Flat> {
        Frame::new(lens, &self.middle()).map(|frame| Flat::new(lens, frame, &self.net))
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

    /// The piece's own parameters at those of the patch.
    pub fn to_own(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [(u - self.origin[0]) / self.size[0], (v - self.origin[1]) / self.size[1]]
    }

    /// Parameters of the patch at the piece's own.
    pub fn to_patch(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + u * self.size[0], self.origin[1] + v * self.size[1]]
    }
}

/// What a surface is off a piece at some points: x and y times weight, and depth.
#[derive(Debug)]
pub(super) struct Gap([DVec3; 9]);

impl Gap {
    /// The most in each coordinate.
    pub fn largest(&self) -> DVec3 {
        self.0.iter().fold(DVec3::ZERO, |most, d| most.max(d.abs()))
    }

    /// The most that it is in samples where the weight is 1: x - p weight for every p that is a sample of the tile.
    fn samples(&self, lens: &Lens) -> f64 {
        let mut most = 0.0;
        for d in &self.0 {
            let weight = lens.weight_change(d.z);
            for (axis, x) in [d.x, d.y].into_iter().enumerate() {
                most = max(most, max(x.abs(), (x - lens.size[axis] * weight).abs()));
            }
            most = max(most, d.z.abs() * lens.samples_of_depth());
        }
        most
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
