//! The matrices of a class of irregular patches: normalised Stam tables (docs/LIMIT.md, section 4).
//!
//! # Theory
//! Stam 1998 (as in Yasui & Kanai 2004, eq. 2 and 8): after n subdivisions the L-shaped rest of an irregular patch is
//! made of three B-spline windows over the points P(n) = A' A^(n-1) C, with C the K control points of the patch, A the
//! step from them to the same points one level finer and A' the step to the 24 points of the three windows.
//!
//! # Changes
//! No eigenvectors of A but those at the vertex itself ([`modes`](super::modes)): powers of A do, so matrices without an
//! eigenbasis (creases, boundaries) are no special case. And the points are kept *normalised*, Phat(n) = (P(n) - s0) /
//! lambda^(n-1), so that they stay of the size of the control net and converge to the characteristic map; both are
//! computed from the deflated matrix B = A - 1 l0, without which the constant part of A^n would swamp them after some 40
//! levels.
//!
//! # Practice
//! [`ClassTable::new`] builds the matrices of one class; patches of the class share them, and so do all meshes ([`ClassTable::shared`]).

use super::loop_modes;
use super::loop_rows::{LOOP_WINDOW, LoopRows};
use super::modes::Modes;
use super::product::{Products, ROWS};
use super::rows::{Row, Rows};
use super::surface::combine;
use crate::kept::Kept;
use crate::patch::{LARGE_FAN, RingClass};
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// Levels kept in f64: the smallest u or v above zero that doubles near 1 resolve.
pub const LEVELS: usize = 52;

/// Points of the three windows of a level of quads: a 5x5 grid without its corner at (-1,-1). Of triangles they are those of
/// [`LOOP_WINDOW`](super::LOOP_WINDOW).
pub const WINDOW_POINTS: usize = 24;

/// Faces up to which a class keeps its matrices: their memory is 30 kB a face, and a sector of k faces has k classes.
/// Beyond, the levels of all patches at a vertex are computed together ([`pole`](super::pole)).
const KEPT_FACES: usize = LARGE_FAN;

/// Faces up to which a class is kept for other meshes: a hundred classes, 40 MB when all have come up.
const SHARED_FACES: u16 = 8;

/// Classes that came up.
static SHARED: Kept<RingClass, ClassTable> = Kept::new();

/// Matrices shared by all patches of a class.
#[derive(Debug)]
pub struct ClassTable {
    class: RingClass,
    /// lambda: largest eigenvalue of the subdivision matrix below 1.
    pub lambda: f64,
    /// l0: weights of the control points in the limit position of the extraordinary vertex.
    pub limit: Vec<f64>,
    /// Weights of the control points in two directions that span the tangent plane at the extraordinary vertex; `None`
    /// for corners, which have none. The levels converge to it like (next eigenvalue / lambda)^n, which is slow for high
    /// valence (0.82^n for N = 8), and like 1/n where the matrix is defective.
    pub tangents: Option<[Vec<f64>; 2]>,
    /// Takes the place of the second one where the two are parallel (a single boundary face along a straight line).
    pub(super) spare: Option<Vec<f64>>,
    /// A.
    step: Vec<Row>,
    /// A': the window points of the next level.
    windows: Vec<Row>,
    /// Mhat(n) at `levels[n-1]`, a row of K weights for each window point: Phat(n) = Mhat(n) C. Empty for large classes.
    levels: Vec<Vec<f64>>,
    /// The first levels once more, for products: a column of all their points for each control point.
    columns: OnceLock<Vec<f64>>,
}

/// Place (a,b) of window point `point` of a level of quads.
pub(super) fn grid_place(point: usize) -> (isize, isize) {
    let k = point as isize + 1;
    (k % 5 - 1, k / 5 - 1)
}

/// Levels that are computed together.
const TOGETHER: usize = 24;

impl ClassTable {
    /// Builds the matrices of a class.
    pub fn new(class: RingClass) -> Self {
        let (step, windows, modes) = if class.triangles {
            let rows = LoopRows::new(class);
            (rows.step(), rows.windows(), loop_modes::modes(class))
        } else {
            let rows = Rows::new(class);
            let windows = (0..WINDOW_POINTS).map(grid_place).map(|(a, b)| rows.refined(a, b)).collect();
            (rows.step(), windows, Modes::of(class))
        };
        let limit = left_eigenvector_of_one(&step);
        let Modes { lambda, tangents, spare } = modes;
        let mut table =
            Self { class, lambda, limit, tangents, spare, step, windows, levels: Vec::new(), columns: OnceLock::new() };
        if usize::from(class.faces) <= KEPT_FACES {
            table.levels = table.matrices();
        }
        table
    }

    /// As [`new`](Self::new); classes of up to 8 faces are built once and kept for the life of the process.
    pub fn shared(class: RingClass) -> Arc<Self> {
        let build = || Self::new(class);
        if class.faces <= SHARED_FACES { SHARED.get(class, build) } else { Arc::new(build()) }
    }

    /// The class.
    pub fn class(&self) -> RingClass {
        self.class
    }

    /// Whether what is derived from it is worth keeping for other meshes.
    pub(crate) fn is_shared(&self) -> bool {
        self.class.faces <= SHARED_FACES
    }

    /// Mhat(1) = A' (1 - 1 l0), Mhat(n+1) = Mhat(n) B / lambda.
    fn matrices(&self) -> Vec<Vec<f64>> {
        let start = |row: &Row| {
            let mut dense: Vec<f64> = self.limit.iter().map(|&w| -w).collect();
            row.iter().for_each(|&(k, w)| dense[k] += w);
            dense
        };
        let mut level: Vec<f64> = self.windows.iter().flat_map(start).collect();
        let mut levels = Vec::with_capacity(LEVELS);
        while levels.len() < LEVELS {
            let rows = level.chunks_exact(self.limit.len());
            let next = rows.flat_map(|row| deflated_step(row, &self.step, &self.limit, self.lambda)).collect();
            levels.push(std::mem::replace(&mut level, next));
        }
        levels
    }

    /// Whether the class is one of triangles.
    pub fn is_of_triangles(&self) -> bool {
        self.windows.len() == LOOP_WINDOW.len()
    }

    /// Number of control points, K.
    pub fn support(&self) -> usize {
        self.limit.len()
    }

    /// Weights of the K control points in window point `point` (0 to [`WINDOW_POINTS`]) of level `level`, 1 to [`LEVELS`];
    /// `None` for classes too large to keep their matrices.
    pub fn weights(&self, level: usize, point: usize) -> Option<&[f64]> {
        let size = self.limit.len();
        Some(&self.levels.get(level - 1)?[point * size..(point + 1) * size])
    }

    /// Phat(n) of a class of quads for n = `level`, 1 to [`LEVELS`], from control points relative to the limit position s0.
    pub fn level_points(&self, level: usize, points: &[DVec3]) -> [DVec3; WINDOW_POINTS] {
        if self.levels.is_empty() {
            return self.windows_of(&self.stepped(level, points));
        }
        let size = self.limit.len();
        let rows = &self.levels[level - 1];
        std::array::from_fn(|point| combine(&rows[point * size..(point + 1) * size], points))
    }

    /// Phat(1) to Phat(`levels`) of a class of quads, `levels` up to [`LEVELS`], as [`level_points`](Self::level_points).
    pub fn all_level_points(&self, levels: usize, points: &[DVec3]) -> Vec<[DVec3; WINDOW_POINTS]> {
        let together = if self.levels.is_empty() { 0 } else { levels.min(TOGETHER) };
        let mut out = Vec::with_capacity(levels);
        if together > 0 {
            let mut products = Products::default();
            products.take(points.iter().copied());
            let rows = (together * WINDOW_POINTS).next_multiple_of(ROWS);
            let [x, y, z] = products.multiply(self.columns(), TOGETHER * WINDOW_POINTS, rows);
            let point = |k: usize| DVec3::new(x[k], y[k], z[k]);
            out.extend((0..together).map(|level| std::array::from_fn(|k| point(level * WINDOW_POINTS + k))));
        }
        out.extend((together + 1..=levels).map(|level| self.level_points(level, points)));
        out
    }

    fn columns(&self) -> &[f64] {
        let column = |k: usize| self.levels[..TOGETHER].iter().flatten().skip(k).step_by(self.limit.len()).copied();
        self.columns.get_or_init(|| (0..self.limit.len()).flat_map(column).collect())
    }

    /// Phat(n) of a class of triangles, at the places of [`LOOP_WINDOW`](super::LOOP_WINDOW).
    pub fn loop_level_points(&self, level: usize, points: &[DVec3]) -> [DVec3; LOOP_WINDOW.len()] {
        self.window_points(level, |k| k, points)
    }

    /// The points of one window of a level, which are those numbered `point(k)` among all of it.
    pub(super) fn window_points<const N: usize>(
        &self,
        level: usize,
        point: impl Fn(usize) -> usize,
        points: &[DVec3],
    ) -> [DVec3; N] {
        if self.levels.is_empty() {
            let stepped = self.stepped(level, points);
            return std::array::from_fn(|k| sparse(&self.windows[point(k)], &stepped));
        }
        let size = self.limit.len();
        let rows = &self.levels[level - 1];
        std::array::from_fn(|k| combine(&rows[point(k) * size..(point(k) + 1) * size], points))
    }

    /// (B / lambda)^(level - 1) C.
    fn stepped(&self, level: usize, points: &[DVec3]) -> Vec<DVec3> {
        let (mut stepped, mut next) = (points.to_vec(), Vec::new());
        for _ in 1..level {
            self.step_once(&stepped, &mut next);
            std::mem::swap(&mut stepped, &mut next);
        }
        stepped
    }

    /// B / lambda times the points of a ring alone, which follow from no others; and l0 times them.
    pub(super) fn ring_step(&self, ring: &[DVec3]) -> (DVec3, Vec<DVec3>) {
        let constant = combine(&self.limit, ring);
        let over = 1.0 / self.lambda;
        let rows = &self.step[..ring.len()];
        (constant, rows.iter().map(|row| (sparse(row, ring) - constant) * over).collect())
    }

    /// Whether the class keeps its matrices.
    pub(super) fn keeps_matrices(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Makes `next` B / lambda times points.
    pub(super) fn step_once(&self, points: &[DVec3], next: &mut Vec<DVec3>) {
        let constant = combine(&self.limit, points);
        let over = 1.0 / self.lambda;
        next.clear();
        next.extend(self.step.iter().map(|row| (sparse(row, points) - constant) * over));
    }

    /// A' times points of a class of triangles.
    pub(super) fn loop_windows_of(&self, points: &[DVec3]) -> [DVec3; LOOP_WINDOW.len()] {
        std::array::from_fn(|k| sparse(&self.windows[k], points))
    }

    /// A' times points: those of the three windows.
    pub(super) fn windows_of(&self, points: &[DVec3]) -> [DVec3; WINDOW_POINTS] {
        let mut out = [DVec3::ZERO; WINDOW_POINTS];
        for (point, row) in out.iter_mut().zip(&self.windows) {
            *point = sparse(row, points);
        }
        out
    }

    /// Memory that the matrices take.
    pub fn bytes(&self) -> usize {
        let rows = self.step.iter().chain(&self.windows).map(|row| size_of_val(row.as_slice()));
        self.levels.iter().map(|level| size_of_val(level.as_slice())).chain(rows).sum()
    }
}

fn sparse(row: &Row, points: &[DVec3]) -> DVec3 {
    row.iter().map(|&(k, w)| w * points[k]).sum()
}

/// A row vector times B / lambda, B = A - 1 l0.
pub(super) fn deflated_step(row: &[f64], step: &[Row], limit: &[f64], lambda: f64) -> Vec<f64> {
    let constant: f64 = row.iter().sum();
    let mut out: Vec<f64> = limit.iter().map(|&w| -constant * w).collect();
    for (&x, entries) in row.iter().zip(step) {
        entries.iter().for_each(|&(k, w)| out[k] += x * w);
    }
    out.iter_mut().for_each(|x| *x /= lambda);
    out
}

/// l0 with l0 A = l0 and sum 1, by power iteration: the other eigenvalues are at most (6 + sqrt 20) / 16 = 0.655, of
/// triangles 5/8, so 128 steps leave 1e-23.
fn left_eigenvector_of_one(step: &[Row]) -> Vec<f64> {
    let mut limit = vec![0.0; step.len()];
    limit[0] = 1.0;
    for _ in 0..128 {
        let mut next = vec![0.0; step.len()];
        for (&x, entries) in limit.iter().zip(step) {
            entries.iter().for_each(|&(k, w)| next[k] += x * w);
        }
        let sum: f64 = next.iter().sum();
        limit = next.into_iter().map(|x| x / sum).collect();
    }
    limit
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::patch::Tip;

    /// Largest eigenvalue of B in absolute value, by power iteration from a vector without symmetry.
    pub(in crate::stam) fn iterated_eigenvalue(step: &[Row], limit: &[f64]) -> f64 {
        let mut vector: Vec<f64> = (0..step.len()).map(|k| (0.7 * k as f64).sin()).collect();
        let mut eigenvalue = 0.0;
        for _ in 0..2000 {
            let next = deflated_step(&vector, step, limit, 1.0);
            let [length, before] = [&next, &vector].map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt());
            eigenvalue = length / before;
            vector = next.into_iter().map(|x| x / length).collect();
        }
        eigenvalue
    }

    fn class(faces: u16, closed: bool, tip: Tip, sharp_spoke: Option<u16>) -> RingClass {
        RingClass { triangles: false, faces, closed, index: 0, tip, sharp_spoke }
    }

    #[test]
    fn limit_weights_of_smooth_vertices_are_the_known_ones() {
        // Halstead, Kass & DeRose 1993, section 3.1: N^2, 4 and 1 over N (N + 5).
        for n in 3..=12u16 {
            let table = ClassTable::new(class(n, true, Tip::Smooth, None));
            let valence = f64::from(n);
            let unit = 1.0 / (valence * (valence + 5.0));
            let expected = |k: usize| match k {
                0 => valence * valence * unit,
                k if k <= usize::from(n) => 4.0 * unit,
                k if k <= 2 * usize::from(n) => unit,
                _ => 0.0,
            };
            for (k, &weight) in table.limit.iter().enumerate() {
                assert!((weight - expected(k)).abs() < 1e-15, "N = {n}, point {k}: {weight}");
            }
        }
    }

    /// Some control points, relative to the limit position.
    fn points(table: &ClassTable) -> Vec<DVec3> {
        let point = |k: usize| DVec3::new((k as f64).sin(), (2.3 * k as f64).cos(), (0.7 * k as f64).sin() * 0.4);
        let points: Vec<DVec3> = (0..table.support()).map(point).collect();
        let limit = combine(&table.limit, &points);
        points.iter().map(|p| *p - limit).collect()
    }

    /// Far beyond the levels that are used, normals are those of the tangents, whatever the face and the window.
    #[test]
    fn normals_tend_to_the_tangent_plane() {
        let smooth = (3..=20).map(|n| class(n, true, Tip::Smooth, None));
        let creases = (1..=20).filter(|k| *k != 2).map(|k| class(k, false, Tip::Crease, None));
        let darts = (3..=20).map(|n| class(n, true, Tip::Smooth, Some(n / 3)));
        for class in smooth.chain(creases).chain(darts) {
            let mut table = ClassTable::new(class);
            table.levels.clear();
            let points = points(&table);
            let [first, second] =
                table.tangents.as_ref().expect("a tangent plane").each_ref().map(|w| combine(w, &points));
            let tip = first.cross(second).normalize();
            // Far levels lose the second direction by the ratio of the two eigenvalues: stop where 1e-8 of it is left.
            let eigenvalue = |w: &Vec<f64>| {
                let length = |w: &[f64]| w.iter().map(|x| x * x).sum::<f64>().sqrt();
                length(&deflated_step(w, &table.step, &table.limit, 1.0)) / length(w)
            };
            let [a, b] = table.tangents.as_ref().expect("a tangent plane").each_ref().map(eigenvalue);
            let level = (1e-8f64.ln() / (a.min(b) / a.max(b)).ln().min(-6e-3)).ceil() as usize;
            // Where the across direction is defective the angle shrinks like 1/n.
            let (level, allowed) = match (class.tip, class.faces) {
                (Tip::Crease, 1) => (45, 5.0),
                (Tip::Crease, 4) => (level, 2.0),
                _ => (level, 1e-2),
            };
            let grid = table.level_points(level, &points);
            let at = |a: usize, b: usize| grid[5 * (b + 1) + a];
            let normal = (at(2, 1) - at(1, 1)).cross(at(1, 2) - at(1, 1)).normalize();
            let angle = normal.cross(tip).length().atan2(normal.dot(tip)).to_degrees();
            assert!(angle < allowed, "{class:?}: {angle} degrees at level {level}");
        }
    }

    /// Classes that keep no matrices step their points: the same levels.
    #[test]
    fn stepping_is_the_matrices() {
        for class in [
            class(5, true, Tip::Smooth, None),
            class(4, false, Tip::Crease, None),
            class(3, true, Tip::Smooth, Some(1)),
        ] {
            let kept = ClassTable::new(class);
            let mut stepping = ClassTable::new(class);
            stepping.levels.clear();
            let points = points(&kept);
            for level in [1, 2, 7, 30, LEVELS] {
                let [a, b] = [&kept, &stepping].map(|table| table.level_points(level, &points));
                let together = kept.all_level_points(level, &points);
                assert_eq!(together.len(), level);
                for ((a, b), c) in a.iter().zip(&b).zip(&together[level - 1]) {
                    assert!(a.distance(*b) < 1e-12, "{class:?} level {level}: {a} {b}");
                    assert!(a.distance(*c) < 1e-14, "{class:?} level {level}: {a} {c}");
                }
            }
        }
    }

    #[test]
    fn tables_converge_to_the_characteristic_map() {
        // By the ratio of the next eigenvalue to lambda, 50 times: 1e-11 for valence 8, which has the slowest of these
        // smooth vertices; beside the sharp edge of a dart the ratio is 1/2 to 0.55.
        let dart = class(5, true, Tip::Smooth, Some(2));
        let smooth = [3, 5, 8].map(|n| (class(n, true, Tip::Smooth, None), (0.5f64 / 0.611).powi(50)));
        for (class, shrunk) in smooth.into_iter().chain([(dart, (0.5f64 / 0.55).powi(50))]) {
            let table = ClassTable::new(class);
            let change = |n: usize| {
                table.levels[n].iter().zip(&table.levels[n - 1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            assert!(change(LEVELS - 1) < 10.0 * shrunk * change(1), "{class:?}: {} {}", change(1), change(LEVELS - 1));
        }
    }
}
