//! From the world to homogeneous sample coordinates, in f64.

use crate::field::Axes;
use crate::gpu::View;
use crate::gpu::view::Tile;
use glam::DVec3;

/// The projection onto the samples of a tile: sample (i,j) has its centre at (i + 1/2, j + 1/2).
#[derive(Debug, Clone)]
pub(super) struct Lens {
    eye: DVec3,
    /// Rows of x and y times weight, and of the depth.
    rows: [DVec3; 3],
    /// Constants of x and y, times weight.
    shift: [f64; 2],
    /// The weight is the depth; else it is 1.
    pub perspective: bool,
    /// Depth below which nothing is seen.
    pub near: f64,
    /// Samples of the tile.
    pub size: [f64; 2],
}

impl Lens {
    pub fn new(view: &View, tile: &Tile, near: f64) -> Lens {
        let camera = &view.camera;
        let Axes { right, up, forward, scale } = camera.axes();
        let [width, height] = camera.size.map(|n| 0.5 * f64::from(n * tile.samples));
        let [x, y] = tile.origin.map(f64::from);
        Lens {
            eye: camera.eye,
            rows: [right * (scale[0] * width), up * (-scale[1] * height), forward],
            shift: [width - x, height - y],
            perspective: true,
            near,
            size: tile.size.map(f64::from),
        }
    }

    /// x and y times weight, and depth, of a point given relative to `origin`.
    pub fn project(&self, origin: DVec3, point: DVec3) -> [f64; 3] {
        let d = (origin - self.eye) + point;
        let [x, y, depth] = self.rows.map(|row| row.dot(d));
        let weight = self.weight(depth);
        [x + self.shift[0] * weight, y + self.shift[1] * weight, depth]
    }

    /// What x and y of a point at this depth are multiplied by.
    pub fn weight(&self, depth: f64) -> f64 {
        if self.perspective { depth } else { 1.0 }
    }

    /// Change of the weight with that of the depth.
    pub fn weight_change(&self, depth: f64) -> f64 {
        if self.perspective { depth } else { 0.0 }
    }
}
