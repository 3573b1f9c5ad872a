//! The subdivision rules round an extraordinary vertex, written as rows over the control points of a class.

use crate::patch::{RingClass, Tip};

/// A control point or a weighted sum of some: (control point, weight), each control point once, in order.
pub(super) type Row = Vec<(usize, f64)>;

/// Writes subdivided points as rows over the K control points of a class.
pub(super) struct Rows {
    class: RingClass,
    outer: Vec<(isize, isize)>,
    size: usize,
}

/// A weighted sum of rows.
pub(super) fn sum(terms: &[(f64, &Row)]) -> Row {
    let mut all: Row = terms.iter().flat_map(|(factor, row)| row.iter().map(move |&(k, w)| (k, factor * w))).collect();
    all.sort_unstable_by_key(|&(k, _)| k);
    all.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    all
}

impl Rows {
    pub fn new(class: RingClass) -> Self {
        Self { class, outer: class.outer(), size: class.support() }
    }

    fn sum(&self, terms: &[(f64, &Row)]) -> Row {
        sum(terms)
    }

    fn average(&self, rows: &[Row]) -> Row {
        let terms: Vec<_> = rows.iter().map(|row| (1.0 / rows.len() as f64, row)).collect();
        self.sum(&terms)
    }

    fn unit(&self, index: usize) -> Row {
        vec![(index, 1.0)]
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

    /// A: the control points one level finer.
    pub fn step(&self) -> Vec<Row> {
        let spokes = (0..self.class.spokes()).map(|spoke| self.spoke_point(spoke));
        let faces = (0..usize::from(self.class.faces)).map(|face| self.face_point(face));
        let outer = self.outer.iter().map(|&(i, j)| self.refined(i, j));
        std::iter::once(self.vertex_point()).chain(spokes).chain(faces).chain(outer).collect()
    }

    /// Point (a,b) of the grid one level finer, a and b in -1..=3, not both -1.
    pub fn refined(&self, a: isize, b: isize) -> Row {
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
