//! The matrices of a class of irregular patches: normalised Stam tables (design.md 3.2).
//!
//! # Theory
//! Stam 1998 (as in Yasui & Kanai 2004, eq. 2 and 8): after n subdivisions the L-shaped rest of an irregular patch is
//! made of three B-spline windows over the points P(n) = A' A^(n-1) C, with C the K control points of the patch, A the
//! step from them to the same points one level finer and A' the step to the 24 points of the three windows.
//!
//! # Changes
//! No eigenvectors: powers of A do, so matrices without an eigenbasis (creases, boundaries) are no special case. And
//! the points are kept *normalised*, Phat(n) = (P(n) - s0) / lambda^(n-1), so that they stay of the size of the control
//! net and converge to the characteristic map; both are computed from the deflated matrix B = A - 1 l0, without which
//! the constant part of A^n would swamp them after some 40 levels.
//!
//! # Practice
//! [`ClassTable::new`] builds the matrices of one class; patches of the class share them.

use super::matrix::Matrix;
use crate::patch::{RingClass, Tip};

/// Levels kept in f64: the smallest u or v above zero that doubles near 1 resolve.
pub const LEVELS: usize = 52;

/// Points of the three windows of a level: a 5x5 grid without its corner at (-1,-1).
pub const WINDOW_POINTS: usize = 24;

/// Matrices shared by all patches of a class.
#[derive(Debug)]
pub struct ClassTable {
    /// Largest eigenvalue of the subdivision matrix below 1.
    pub lambda: f64,
    /// l0: weights of the control points in the limit position of the extraordinary vertex.
    pub limit: Vec<f64>,
    /// Mhat(n) at `levels[n-1]`, 24 x K: Phat(n) = Mhat(n) C.
    pub levels: Vec<Matrix>,
}

/// A control point or a sum of some, as weights of the K control points.
type Row = Vec<f64>;

/// Writes subdivided points as rows over the K control points of a class.
struct Rows {
    class: RingClass,
    outer: Vec<(isize, isize)>,
    size: usize,
}

impl Rows {
    fn new(class: RingClass) -> Self {
        Self { class, outer: class.outer(), size: class.support() }
    }

    fn sum(&self, terms: &[(f64, &Row)]) -> Row {
        let mut out = vec![0.0; self.size];
        for (factor, row) in terms {
            out.iter_mut().zip(*row).for_each(|(x, y)| *x += factor * y);
        }
        out
    }

    fn average(&self, rows: &[Row]) -> Row {
        let terms: Vec<_> = rows.iter().map(|row| (1.0 / rows.len() as f64, row)).collect();
        self.sum(&terms)
    }

    fn unit(&self, index: usize) -> Row {
        let mut row = vec![0.0; self.size];
        row[index] = 1.0;
        row
    }

    fn vertex(&self) -> Row {
        self.unit(0)
    }

    fn spoke(&self, spoke: usize) -> Row {
        self.unit(1 + spoke % self.class.spokes())
    }

    fn opposite(&self, face: usize) -> Row {
        self.unit(1 + self.class.spokes() + face % usize::from(self.class.faces))
    }

    /// Face point of face `face` of the ring.
    fn face_point(&self, face: usize) -> Row {
        let face = face % usize::from(self.class.faces);
        self.average(&[self.vertex(), self.spoke(face), self.opposite(face), self.spoke(face + 1)])
    }

    /// Edge point of a spoke: Catmull & Clark 1978, or the midpoint of an infinitely sharp edge.
    fn spoke_point(&self, spoke: usize) -> Row {
        if self.class.is_sharp(spoke) {
            return self.average(&[self.vertex(), self.spoke(spoke)]);
        }
        let before = spoke + usize::from(self.class.faces) - 1;
        self.average(&[self.vertex(), self.spoke(spoke), self.face_point(before), self.face_point(spoke)])
    }

    /// Vertex point of the extraordinary vertex: OpenSubdiv's smooth, crease or corner rule.
    fn vertex_point(&self) -> Row {
        let n = usize::from(self.class.faces);
        match self.class.tip {
            Tip::Corner => self.vertex(),
            Tip::Crease => self.sum(&[(0.75, &self.vertex()), (0.125, &self.spoke(0)), (0.125, &self.spoke(n))]),
            Tip::Smooth => {
                let spokes = self.average(&(0..n).map(|i| self.spoke(i)).collect::<Vec<_>>());
                let faces = self.average(&(0..n).map(|i| self.face_point(i)).collect::<Vec<_>>());
                let n = n as f64;
                self.sum(&[((n - 2.0) / n, &self.vertex()), (1.0 / n, &spokes), (1.0 / n, &faces)])
            }
        }
    }

    /// Control point at grid position (i,j), the extraordinary vertex at (0,0), the patch between (0,0) and (1,1).
    fn grid(&self, i: isize, j: isize) -> Row {
        let own = usize::from(self.class.index);
        let n = usize::from(self.class.faces);
        match (i, j) {
            (0, 0) => self.vertex(),
            (1, 0) => self.spoke(own),
            (1, 1) => self.opposite(own),
            (0, 1) => self.spoke(own + 1),
            (-1, 1) => self.opposite(own + 1),
            (-1, 0) => self.spoke(own + 2),
            (1, -1) => self.opposite(own + n - 1),
            (0, -1) => self.spoke(own + self.class.spokes() - 1),
            _ => {
                let outer = self.outer.iter().position(|&point| point == (i, j));
                self.unit(self.size - self.outer.len() + outer.expect("rules stay within the support"))
            }
        }
    }

    /// Point (a,b) of the grid one level finer, a and b in -1..=3, not both -1.
    fn refined(&self, a: isize, b: isize) -> Row {
        let own = usize::from(self.class.index);
        let n = usize::from(self.class.faces);
        let [sharp_v0, sharp_u0] = self.class.own_spokes().map(|spoke| self.class.is_sharp(spoke));
        // Phantom points mirror the surface's own across a sharp edge, where it does not depend on the other side.
        if b == -1 && sharp_v0 {
            return self.sum(&[(2.0, &self.refined(a, 0)), (-1.0, &self.refined(a, 1))]);
        }
        if a == -1 && sharp_u0 {
            return self.sum(&[(2.0, &self.refined(0, b)), (-1.0, &self.refined(1, b))]);
        }
        match (a, b) {
            (0, 0) => self.vertex_point(),
            (1, 0) => self.spoke_point(own),
            (0, 1) => self.spoke_point((own + 1) % self.class.spokes()),
            (1, 1) => self.face_point(own),
            (-1, 1) => self.face_point(own + 1),
            (-1, 0) => self.spoke_point((own + 2) % self.class.spokes()),
            (1, -1) => self.face_point(own + n - 1),
            (0, -1) => self.spoke_point((own + self.class.spokes() - 1) % self.class.spokes()),
            _ => self.regular_point(a, b, sharp_v0, sharp_u0),
        }
    }

    /// A refined point whose parent is regular, or a crease along one of the patch's own spokes.
    fn regular_point(&self, a: isize, b: isize, sharp_v0: bool, sharp_u0: bool) -> Row {
        let (i, j) = (a.div_euclid(2), b.div_euclid(2));
        // Curve rule along one axis: midpoint of an edge, or 1/8, 3/4, 1/8 at a vertex.
        let line = |odd: bool, at: &dyn Fn(isize) -> Row| match odd {
            true => self.average(&[at(0), at(1)]),
            false => self.sum(&[(0.125, &at(-1)), (0.75, &at(0)), (0.125, &at(1))]),
        };
        let (odd_a, odd_b) = (a.rem_euclid(2) == 1, b.rem_euclid(2) == 1);
        if sharp_v0 && b == 0 {
            return line(odd_a, &|di| self.grid(i + di, 0));
        }
        if sharp_u0 && a == 0 {
            return line(odd_b, &|dj| self.grid(0, j + dj));
        }
        line(odd_b, &|dj| line(odd_a, &|di| self.grid(i + di, j + dj)))
    }
}

impl ClassTable {
    /// Memory that the matrices take.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|matrix| size_of_val(matrix.values())).sum()
    }

    /// Builds the matrices of a class.
    pub fn new(class: RingClass) -> Self {
        let rows = Rows::new(class);
        let spokes = (0..class.spokes()).map(|spoke| rows.spoke_point(spoke));
        let faces = (0..usize::from(class.faces)).map(|face| rows.face_point(face));
        let outer = rows.outer.iter().map(|&(i, j)| rows.refined(i, j));
        let step: Vec<Row> = std::iter::once(rows.vertex_point()).chain(spokes).chain(faces).chain(outer).collect();
        let step = Matrix::from_rows(&step);
        let windows: Vec<Row> = (1..=WINDOW_POINTS as isize).map(|k| rows.refined(k % 5 - 1, k / 5 - 1)).collect();
        let windows = Matrix::from_rows(&windows);

        let limit = left_eigenvector_of_one(&step);
        let deflated = step.map(|_, column, x| x - limit[column]);
        let lambda = spectral_radius(&deflated);
        let decay = deflated.map(|_, _, x| x / lambda);

        let mut power = deflated.map(|row, column, _| f64::from(u8::from(row == column)) - limit[column]);
        let mut levels = vec![windows.times(&power)];
        while levels.len() < LEVELS {
            power = decay.times(&power);
            levels.push(windows.times(&power));
        }
        Self { lambda, limit, levels }
    }
}

/// l0 with l0 A = l0 and sum 1: every row of A^m tends to it.
fn left_eigenvector_of_one(step: &Matrix) -> Row {
    let mut power = step.clone();
    // 2^10 steps: the second eigenvalue is below 0.66 for every valence.
    for _ in 0..10 {
        power = power.times(&power);
        let sums: Vec<f64> = (0..power.rows()).map(|row| power.row(row).iter().sum()).collect();
        power = power.map(|row, _, x| x / sums[row]);
    }
    // Steps with the exact matrix contract what rounding the squares left.
    let mut limit = Matrix::from_rows(&[power.row(0).to_vec()]);
    for _ in 0..4 {
        limit = limit.times(step);
    }
    let sum: f64 = limit.values().iter().sum();
    limit.values().iter().map(|x| x / sum).collect()
}

/// Largest absolute eigenvalue, by squaring: 2^40 steps, so that Jordan blocks (whose ratio of successive powers tends
/// to the eigenvalue like 1/m) have converged too.
fn spectral_radius(matrix: &Matrix) -> f64 {
    let mut power = matrix.clone();
    for _ in 0..40 {
        power = power.times(&power);
        let scale = power.largest();
        power = power.map(|_, _, x| x / scale);
    }
    let dot = |a: &Matrix, b: &Matrix| a.values().iter().zip(b.values()).map(|(x, y)| x * y).sum::<f64>();
    dot(&matrix.times(&power), &power) / dot(&power, &power)
}
