//! The rings round an extraordinary vertex, level by level.
//!
//! For those who cut a patch into pieces rather than evaluate it at a point: [`Rings`] walks down the levels of an
//! irregular patch. Each level has the three windows that make up the L-shaped rest, and control points whose hull holds
//! all that is left of the patch.

use super::class::{ClassTable, WINDOW_POINTS};
use super::surface::LimitSurface;
use glam::DVec3;

/// An irregular patch below one of its levels.
#[derive(Debug, Clone)]
pub struct Rings<'a> {
    table: &'a ClassTable,
    limit: DVec3,
    /// (B / lambda)^(n-1) C, relative to the limit position.
    points: Vec<DVec3>,
    /// lambda^(n-1).
    scale: f64,
    level: u32,
}

/// The windows of a level: window (i,j) spans [i, i+1] x [j, j+1] in units of 2^-n of the patch.
pub const WINDOWS: [[usize; 2]; 3] = [[1, 0], [1, 1], [0, 1]];

impl Rings<'_> {
    /// The level n, from 1: what is left is u and v up to 2^(1-n).
    pub fn level(&self) -> u32 {
        self.level
    }

    /// s0, the limit position of the extraordinary vertex.
    pub fn limit(&self) -> DVec3 {
        self.limit
    }

    /// Control points, relative to [`limit`](Self::limit). The rest of the patch, u and v up to 2^(1-n), lies in their
    /// convex hull: every finer point is an affine combination of them with weights from 0 to 1.
    pub fn hull(&self) -> impl Iterator<Item = DVec3> {
        self.points.iter().map(|&p| self.scale * p)
    }

    /// The B-spline nets of the level's [`WINDOWS`], relative to [`limit`](Self::limit), u fastest.
    pub fn windows(&self) -> [[DVec3; 16]; 3] {
        let grid: [DVec3; WINDOW_POINTS] = self.table.windows_of(&self.points).map(|p| self.scale * p);
        // The grid lacks its first point.
        WINDOWS.map(|[i, j]| std::array::from_fn(|k| grid[5 * (j + k / 4) + i + k % 4 - 1]))
    }

    /// One level deeper.
    pub fn descend(&mut self) {
        self.points = self.table.stepped_once(&self.points);
        self.scale *= self.table.lambda;
        self.level += 1;
    }
}

impl LimitSurface {
    /// The rings of an irregular patch from level 1; `None` for a regular one.
    pub fn rings(&self, patch: usize) -> Option<Rings<'_>> {
        let table = &self.tables()[self.class(patch)?];
        let (points, limit) = self.irregular_net(patch, table);
        Some(Rings { table, limit, points, scale: 1.0, level: 1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;
    use crate::stam::{Net, weights};

    /// Down the levels, windows are the nets that evaluation uses, and all limit points of the rest lie in the hull's box.
    #[test]
    fn rings_hold_the_rest_of_the_patch() {
        let surface = LimitSurface::new(&mesh::sample()).expect("the sample has a surface");
        let irregular = (0..surface.patches().len()).filter(|&patch| surface.class(patch).is_some());
        let mut seen = 0;
        for patch in irregular.step_by(7) {
            seen += 1;
            let mut rings = surface.rings(patch).expect("an irregular patch");
            let Net::Irregular { limit, lambda, levels } = surface.net(patch, 20) else { panic!("it is irregular") };
            let size = levels[0].iter().fold(0.0f64, |size, p| size.max(p.length()));
            for (n, grid) in levels.iter().enumerate() {
                let rest = 0.5f64.powi(n as i32);
                let [low, high] = rings
                    .hull()
                    .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
                for [u, v] in [[1.0, 1.0], [1.0, 0.0], [0.3, 0.7], [0.01, 0.4], [0.0, 0.0]] {
                    let p = surface.evaluate(patch, [u * rest, v * rest]).position - limit;
                    let slack = 1e-14 * size;
                    assert!((p - low).min_element() >= -slack && (high - p).min_element() >= -slack, "level {n}: {p}");
                }
                let scale = lambda.powi(n as i32);
                for ([i, j], net) in WINDOWS.into_iter().zip(rings.windows()) {
                    for (k, point) in net.into_iter().enumerate() {
                        let expected = scale * grid[5 * (j + k / 4) + i + k % 4 - 1];
                        assert!(point.distance(expected) < 1e-12 * scale * size, "level {n}, window {i} {j}");
                    }
                    let middle: DVec3 = net.iter().zip(weights([0.5; 2])).map(|(&p, w)| w[0] * p).sum();
                    let at = [i, j].map(|x| (x as f64 + 0.5) * 0.5 * rest);
                    assert!(middle.distance(surface.evaluate(patch, at).position - limit) < 1e-13 * size);
                }
                rings.descend();
            }
        }
        assert!(seen > 10);
    }
}
