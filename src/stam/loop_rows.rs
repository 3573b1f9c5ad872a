//! Loop's rules round an extraordinary vertex, as rows over the control points of a class (docs/LIMIT.md, section 8).
//!
//! Theory: Loop 1987, with the rules for creases and corners of Hoppe et al. 1994 in OpenSubdiv's choice of weights; Stam
//! 1999 for the patch. The vertex is at (0,0) of the triangle's lattice ([`box_spline`](super::box_spline)), the patch between
//! (0,0), (1,0) and (0,1).

use super::rows::{self, Row};
use crate::patch::{RingClass, Tip};

/// Points of the three windows of a level, (a,b) one level finer, row by row.
pub const LOOP_WINDOW: [[isize; 2]; 16] = [
    [1, -1],
    [2, -1],
    [3, -1],
    [0, 0],
    [1, 0],
    [2, 0],
    [3, 0],
    [-1, 1],
    [0, 1],
    [1, 1],
    [2, 1],
    [-1, 2],
    [0, 2],
    [1, 2],
    [-1, 3],
    [0, 3],
];

/// Writes subdivided points as rows over the K control points of a class.
pub(super) struct LoopRows {
    class: RingClass,
    outer: Vec<(isize, isize)>,
}

/// Weight of each spoke in the smooth vertex rule of valence `faces`: Loop 1987, and 1/16 for 6.
pub(super) fn spoke_weight(faces: f64) -> f64 {
    let beta = 0.375 + 0.25 * (std::f64::consts::TAU / faces).cos();
    (0.625 - beta * beta) / faces
}

fn sum(terms: &[(f64, Row)]) -> Row {
    let terms: Vec<_> = terms.iter().map(|(factor, row)| (*factor, row)).collect();
    rows::sum(&terms)
}

impl LoopRows {
    pub fn new(class: RingClass) -> Self {
        Self { class, outer: class.outer() }
    }

    fn vertex(&self) -> Row {
        vec![(0, 1.0)]
    }

    fn spoke(&self, spoke: usize) -> Row {
        vec![(1 + spoke % self.class.spokes(), 1.0)]
    }

    /// Control point at (i,j), which is of the ring or outside it.
    fn point(&self, i: isize, j: isize) -> Row {
        let own = usize::from(self.class.index);
        let count = self.class.spokes();
        match (i, j) {
            (0, 0) => self.vertex(),
            (1, 0) => self.spoke(own),
            (0, 1) => self.spoke(own + 1),
            (-1, 1) => self.spoke(own + 2),
            (1, -1) => self.spoke(own + count - 1),
            _ => {
                let outer = self.outer.iter().position(|&point| point == (i, j));
                vec![(1 + count + outer.expect("rules stay within the support"), 1.0)]
            }
        }
    }

    fn vertex_point(&self) -> Row {
        let last = self.class.spokes() - 1;
        match self.class.tip {
            Tip::Corner => self.vertex(),
            Tip::Crease => sum(&[(0.75, self.vertex()), (0.125, self.spoke(0)), (0.125, self.spoke(last))]),
            Tip::Smooth => {
                let valence = f64::from(self.class.faces);
                let weight = spoke_weight(valence);
                let spokes = (0..=last).map(|spoke| (weight, self.spoke(spoke)));
                let terms: Vec<_> = spokes.chain([(1.0 - valence * weight, self.vertex())]).collect();
                sum(&terms)
            }
        }
    }

    fn spoke_point(&self, spoke: usize) -> Row {
        if self.class.is_sharp(spoke) {
            return sum(&[(0.5, self.vertex()), (0.5, self.spoke(spoke))]);
        }
        let [before, after] = [spoke + self.class.spokes() - 1, spoke + 1];
        edge([self.vertex(), self.spoke(spoke)], [self.spoke(before), self.spoke(after)])
    }

    /// A: the control points one level finer.
    pub fn step(&self) -> Vec<Row> {
        let spokes = (0..self.class.spokes()).map(|spoke| self.spoke_point(spoke));
        let outer = self.outer.iter().map(|&(i, j)| self.refined(i, j));
        std::iter::once(self.vertex_point()).chain(spokes).chain(outer).collect()
    }

    /// A': the points of [`LOOP_WINDOW`].
    pub fn windows(&self) -> Vec<Row> {
        LOOP_WINDOW.iter().map(|&[a, b]| self.refined(a, b)).collect()
    }

    /// Point (a,b) of the lattice one level finer.
    pub fn refined(&self, a: isize, b: isize) -> Row {
        let own = usize::from(self.class.index);
        let count = self.class.spokes();
        let [sharp_v0, sharp_u0] = self.class.own_spokes().map(|spoke| self.class.is_sharp(spoke));
        // Phantom points beyond a sharp edge complete the parallelogram of its two ends and the corner opposite to it.
        if b == -1 && sharp_v0 {
            return sum(&[(1.0, self.refined(a - 1, 0)), (1.0, self.refined(a, 0)), (-1.0, self.refined(a - 1, 1))]);
        }
        if a == -1 && sharp_u0 {
            return sum(&[(1.0, self.refined(0, b - 1)), (1.0, self.refined(0, b)), (-1.0, self.refined(1, b - 1))]);
        }
        match (a, b) {
            (0, 0) => self.vertex_point(),
            (1, 0) => self.spoke_point(own),
            (0, 1) => self.spoke_point((own + 1) % count),
            (-1, 1) => self.spoke_point((own + 2) % count),
            (1, -1) => self.spoke_point((own + count - 1) % count),
            // The two other corners of the patch: regular, or on a crease along the own spoke.
            (2, 0) if sharp_v0 => self.on_crease([0, 0], [1, 0], [2, 0]),
            (0, 2) if sharp_u0 => self.on_crease([0, 0], [0, 1], [0, 2]),
            (2, 0) => self.regular_vertex(1, 0),
            (0, 2) => self.regular_vertex(0, 1),
            (3, 0) if sharp_v0 => self.middle([1, 0], [2, 0]),
            (0, 3) if sharp_u0 => self.middle([0, 1], [0, 2]),
            _ => self.regular_edge(a, b),
        }
    }

    fn middle(&self, [i, j]: [isize; 2], [k, l]: [isize; 2]) -> Row {
        sum(&[(0.5, self.point(i, j)), (0.5, self.point(k, l))])
    }

    fn on_crease(&self, before: [isize; 2], at: [isize; 2], after: [isize; 2]) -> Row {
        let [before, at, after] = [before, at, after].map(|[i, j]| self.point(i, j));
        sum(&[(0.125, before), (0.75, at), (0.125, after)])
    }

    fn regular_vertex(&self, i: isize, j: isize) -> Row {
        let neighbours = super::box_spline::NEIGHBOURS.iter().map(|[x, y]| (0.0625, self.point(i + x, j + y)));
        let terms: Vec<_> = neighbours.chain([(0.625, self.point(i, j))]).collect();
        sum(&terms)
    }

    /// The point on the edge whose middle is (a/2, b/2).
    fn regular_edge(&self, a: isize, b: isize) -> Row {
        let (i, j) = (a.div_euclid(2), b.div_euclid(2));
        let [ends, opposite] = match (a.rem_euclid(2), b.rem_euclid(2)) {
            (1, 0) => [[(0, 0), (1, 0)], [(0, 1), (1, -1)]],
            (0, _) => [[(0, 0), (0, 1)], [(1, 0), (-1, 1)]],
            _ => [[(1, 0), (0, 1)], [(0, 0), (1, 1)]],
        };
        let points = |two: [(isize, isize); 2]| two.map(|(x, y)| self.point(i + x, j + y));
        edge(points(ends), points(opposite))
    }
}

fn edge([a, b]: [Row; 2], [c, d]: [Row; 2]) -> Row {
    sum(&[(0.375, a), (0.375, b), (0.125, c), (0.125, d)])
}
