//! The rings round an extraordinary vertex, level by level.
//!
//! For those who cut a patch into pieces rather than evaluate it at a point: [`Rings`] walks down the levels of an
//! irregular patch. Each level has the three windows that make up the L-shaped rest, and control points whose hull holds
//! all that is left of the patch.

use super::class::{ClassTable, WINDOW_POINTS};
use super::loop_rows::LOOP_WINDOW;
use super::pole::Wedge;
use super::surface::LimitSurface;
use glam::{DMat3, DVec3};

/// An irregular patch below one of its levels.
#[derive(Debug, Clone)]
pub struct Rings<'a> {
    table: &'a ClassTable,
    limit: DVec3,
    /// (B / lambda)^(n-1) C, relative to the limit position; at a vertex of many faces points whose hull holds these.
    points: Vec<DVec3>,
    /// What the levels come from at a vertex of many faces.
    wedge: Option<Box<Wedge<'a>>>,
    /// Room for the points of the next level.
    next: Vec<DVec3>,
    /// lambda^(n-1).
    scale: f64,
    level: u32,
}

/// The windows of a level: window (i,j) spans [i, i+1] x [j, j+1] in units of 2^-n of the patch.
pub const WINDOWS: [[usize; 2]; 3] = [[1, 0], [1, 1], [0, 1]];

/// The points that control the windows of a level.
#[derive(Debug, Clone)]
pub struct Grid([DVec3; WINDOW_POINTS]);

impl Grid {
    /// Point `k`, 0 to 15, of the B-spline net of window (i,j), u fastest.
    pub fn point(&self, [i, j]: [usize; 2], k: usize) -> DVec3 {
        // The grid is 5x5 and lacks its first point.
        self.0[5 * (j + k / 4) + i + k % 4 - 1]
    }
}

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
    pub fn hull(&self) -> impl Iterator<Item = DVec3> + Clone {
        self.points.iter().map(|&p| self.scale * p)
    }

    /// The points of the level's [`WINDOWS`] of a quad, relative to [`limit`](Self::limit).
    pub fn grid(&self) -> Grid {
        let points = || self.table.windows_of(&self.points);
        let mut grid = self.wedge.as_ref().map_or_else(points, |wedge| wedge.windows());
        for point in &mut grid {
            *point *= self.scale;
        }
        Grid(grid)
    }

    /// Whether the patch is a triangle.
    pub fn is_triangle(&self) -> bool {
        self.table.is_of_triangles()
    }

    /// The points of the level of a triangle, at the places of [`LOOP_WINDOW`], relative to [`limit`](Self::limit).
    pub fn loop_grid(&self) -> [DVec3; LOOP_WINDOW.len()] {
        let points = || self.table.loop_windows_of(&self.points);
        self.wedge.as_ref().map_or_else(points, |wedge| wedge.windows()).map(|point| self.scale * point)
    }

    /// The rings of the points that a linear map makes of these, from the level where they are.
    pub fn mapped(mut self, map: impl Fn(DVec3) -> DVec3) -> Self {
        for point in &mut self.points {
            *point = map(*point);
        }
        let [x, y, z] = DVec3::AXES.map(map);
        self.wedge = self.wedge.map(|wedge| Box::new(wedge.mapped(DMat3::from_cols(x, y, z))));
        self
    }

    /// One level deeper.
    pub fn descend(&mut self) {
        match &mut self.wedge {
            Some(wedge) => {
                match self.table.is_of_triangles() {
                    true => drop(wedge.descend::<{ LOOP_WINDOW.len() }>()),
                    false => drop(wedge.descend::<WINDOW_POINTS>()),
                }
                self.points.clear();
                self.points.extend(wedge.hull());
            }
            None => {
                self.table.step_once(&self.points, &mut self.next);
                std::mem::swap(&mut self.points, &mut self.next);
            }
        }
        self.scale *= self.table.lambda;
        self.level += 1;
    }
}

impl LimitSurface {
    /// The rings of an irregular patch from level 1; `None` for a regular one.
    pub fn rings(&self, patch: usize) -> Option<Rings<'_>> {
        let table = &**self.tables().get(self.class(patch)?)?;
        let wedge = self.wedge(patch).map(Box::new);
        let (points, limit) = match &wedge {
            Some(wedge) => (wedge.hull().collect(), wedge.limit()),
            None => self.irregular_net(patch, table),
        };
        Some(Rings { table, limit, points, wedge, next: Vec::new(), scale: 1.0, level: 1 })
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
                let found = rings.grid();
                for [i, j] in WINDOWS {
                    let net: [DVec3; 16] = std::array::from_fn(|k| found.point([i, j], k));
                    for (k, &point) in net.iter().enumerate() {
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
