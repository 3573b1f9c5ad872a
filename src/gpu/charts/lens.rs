//! From the world to homogeneous sample coordinates, in f64.

use super::net::{Row, row};
use crate::field::Axes;
use crate::gpu::View;
use crate::gpu::records::LensRecord;
use crate::gpu::view::Tile;
use glam::DVec3;

/// The projection onto the samples of a tile: sample (i,j) has its centre at (i + 1/2, j + 1/2).
#[derive(Debug, Clone)]
pub(super) struct Lens {
    eye: DVec3,
    /// Rows of x and y times weight, and of the depth.
    rows: [DVec3; 3],
    /// What the eye is projected to.
    shift: DVec3,
    /// The weight is the depth; else it is 1.
    pub perspective: bool,
    /// Depth below which nothing is seen, and that of the farthest point.
    pub near: f64,
    far: f64,
    /// Samples of the tile.
    pub size: [f64; 2],
}

impl Lens {
    /// For a surface inside `bounds`.
    pub fn new(view: &View, tile: &Tile, bounds: [DVec3; 2]) -> Lens {
        let camera = &view.camera;
        let Axes { right, up, forward, scale } = camera.axes();
        let [width, height] = camera.size.map(|n| 0.5 * f64::from(n * tile.samples));
        let [x, y] = tile.origin.map(f64::from);
        let [near, far] = camera.depth_range(bounds);
        let perspective = !camera.is_orthographic();
        let shift = [width - x, height - y];
        let mut rows = [right * (scale[0] * width), up * (-scale[1] * height), forward];
        if perspective {
            // The weight is the depth.
            rows[0] += shift[0] * forward;
            rows[1] += shift[1] * forward;
        }
        Lens {
            eye: camera.eye,
            rows,
            shift: if perspective { DVec3::ZERO } else { DVec3::new(shift[0], shift[1], 0.0) },
            perspective,
            near,
            far,
            size: tile.size.map(f64::from),
        }
    }

    /// x and y times weight, and depth, of a point.
    pub fn project(&self, point: DVec3) -> DVec3 {
        self.turn(point - self.eye) + self.shift
    }

    /// The linear part of [`project`](Self::project).
    #[inline]
    pub fn turn(&self, v: DVec3) -> DVec3 {
        let [x, y, depth] = &self.rows;
        DVec3::new(x.dot(v), y.dot(v), depth.dot(v))
    }

    /// Whether one depth is less than another by more than f32 can tell, which keeps depths that differ by rounding alone from
    /// being looked into.
    pub fn is_nearer(&self, depth: f64, than: f64) -> bool {
        than - depth > 1e-9 * (self.far - self.near) + 1e-15 * than.abs()
    }

    /// Samples aside that are as long as 1 in depth, where the weight is 1.
    pub fn samples_of_depth(&self) -> f64 {
        // In perspective the rows hold a part along the depth as well.
        let [x, _, forward] = &self.rows;
        x.cross(*forward).length()
    }

    /// Where in the picture a projected point is seen, in samples.
    pub fn seen(&self, [x, y, depth]: [f64; 3]) -> [f64; 2] {
        let weight = self.weight(depth);
        [x / weight, y / weight]
    }

    /// What x and y of a point at this depth are multiplied by.
    pub fn weight(&self, depth: f64) -> f64 {
        if self.perspective { depth } else { 1.0 }
    }

    /// One over the weights at these depths.
    #[inline]
    pub fn inverse_weights(&self, depths: &Row) -> Row {
        if self.perspective { row(|k| 1.0 / depths[k]) } else { [1.0; 4] }
    }

    /// Change of the weight with that of the depth.
    pub fn weight_change(&self, depth: f64) -> f64 {
        if self.perspective { depth } else { 0.0 }
    }

    /// Centre of a sample in normalised device coordinates, and what the depth buffer shows of a depth: reversed, so that
    /// the nearer is the greater.
    pub fn place(&self, sample: [u32; 2], depth: f64) -> [f32; 3] {
        let [x, y] = [0, 1].map(|k| (2.0 * f64::from(sample[k]) + 1.0) / self.size[k] - 1.0);
        [x as f32, -y as f32, (self.scale() * self.before_far(depth)) as f32]
    }

    /// How far a depth lies before the far end, in perspective as part of itself. Taken in f64, for seen from afar the object
    /// takes up the last digits of its depths.
    pub fn before_far(&self, depth: f64) -> f64 {
        (self.far - depth) / self.weight(depth)
    }

    /// A depth beyond all those that the depth buffer shows as `shown`, whatever f32 rounded; infinite for the background.
    pub fn farthest(&self, shown: f32) -> f64 {
        // Over a dozen roundings: of the near and the far distance, the depth, and their quotient or difference.
        const ROUNDING: f64 = 1e-6;
        let shown = f64::from(shown);
        let before_far = shown / self.scale();
        match self.perspective {
            _ if shown <= 0.0 => f64::INFINITY,
            true => {
                let depth = self.far / (1.0 + before_far);
                depth + ROUNDING * depth.min(self.far - self.near)
            }
            false => self.far - before_far + ROUNDING * (self.far - self.near),
        }
    }

    /// What makes [`before_far`](Self::before_far) of the near end 1.
    fn scale(&self) -> f64 {
        1.0 / self.before_far(self.near)
    }

    /// As shaders/charts.wgsl reads it.
    pub fn record(&self) -> LensRecord {
        LensRecord {
            size: self.size.map(|n| n as f32),
            perspective: if self.perspective { 1.0 } else { 0.0 },
            scale: self.scale() as f32,
        }
    }
}
