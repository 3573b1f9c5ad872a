//! Triangles, all of them tried: what the caster is checked against.

use crate::caster::Ray;
use catoptric::stam::{Jet, LimitSurface};
use glam::DVec3;

/// A finely tessellated surface.
#[derive(Debug)]
pub struct Brute {
    /// Rows of triangles, each with the centre and radius of a sphere that holds them.
    rows: Vec<(DVec3, f64, Vec<[DVec3; 3]>)>,
    /// Distance between triangles and surface, twice what is seen in the middle of cells and edges.
    pub error: f64,
}

impl Brute {
    /// Every patch in `parts` each way.
    pub fn new(surface: &LimitSurface, parts: usize) -> Brute {
        let mut brute = Brute { rows: Vec::new(), error: 0.0 };
        for patch in 0..surface.patches().len() {
            // Cells and their middles.
            let at = |i: usize, j: usize| {
                let uv = [i, j].map(|k| k as f64 / (2 * parts) as f64);
                surface.evaluate(patch, uv)
            };
            let side = 2 * parts + 1;
            let grid: Vec<Jet> = (0..side * side).map(|k| at(k % side, k / side)).collect();
            for (i, j) in (0..parts).flat_map(|j| (0..parts).map(move |i| (2 * i, 2 * j))) {
                if i == 0 {
                    brute.rows.push((DVec3::ZERO, 0.0, Vec::new()));
                }
                let p = |a: usize, b: usize| grid[(j + b) * side + i + a];
                let [a, b, c, d] = [p(0, 0), p(2, 0), p(2, 2), p(0, 2)].map(|jet| jet.position);
                brute.rows.last_mut().expect("just pushed").2.extend([[a, b, c], [a, c, d]]);
                // A chord is farthest from its curve in the middle, h^2 / 8 times the second derivative. Along the surface
                // the middles slide, which is no distance.
                for (middle, a, b) in [(p(1, 0), a, b), (p(1, 1), a, c), (p(0, 1), a, d)] {
                    let off = (middle.position - (a + b) * 0.5).dot(middle.normal).abs();
                    brute.error = brute.error.max(2.0 * off);
                }
            }
        }
        for (centre, radius, triangles) in &mut brute.rows {
            let points = || triangles.iter().flatten();
            *centre = points().sum::<DVec3>() / points().count() as f64;
            *radius = points().map(|p| p.distance(*centre)).fold(0.0, f64::max) * (1.0 + 1e-12);
        }
        brute
    }

    /// Nearest hit and the triangle's unit normal (Moeller & Trumbore 1997).
    pub fn first_hit(&self, ray: &Ray) -> Option<(f64, DVec3)> {
        let mut best: Option<(f64, DVec3)> = None;
        let unit = ray.direction.normalize();
        let near = |(centre, radius, _): &&(DVec3, f64, _)| (*centre - ray.origin).cross(unit).length() <= *radius;
        for &[a, b, c] in self.rows.iter().filter(near).flat_map(|(_, _, triangles)| triangles) {
            let (e1, e2, s) = (b - a, c - a, ray.origin - a);
            let p = ray.direction.cross(e2);
            let det = e1.dot(p);
            let q = s.cross(e1);
            let (u, v, t) = (s.dot(p) / det, ray.direction.dot(q) / det, e2.dot(q) / det);
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= ray.start && best.is_none_or(|(nearest, _)| t < nearest) {
                best = Some((t, e1.cross(e2).normalize_or_zero()));
            }
        }
        best
    }
}
