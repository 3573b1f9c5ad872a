//! The limit at a vertex of a cage: by the masks of the uniform cubic B-spline where the vertex is regular, else by going
//! on until it moves no more.

use super::cage::Cage;
use super::rules::{Rule, is_finite};
use glam::DVec3;

impl Cage {
    /// The rule of a vertex, once nothing at it changes any more and all its faces are quads.
    fn lasting_rule(&self, v: usize) -> Option<Rule> {
        let edges = self.sharpness_around(v);
        let settled = self.complete[v]
            && !edges.iter().any(|&s| is_finite(s))
            && !is_finite(self.sharpness[v])
            && self.vertex_faces[v].iter().all(|&f| self.faces[f].len() == 4);
        settled.then(|| Rule::new(self.sharpness[v], &edges))
    }

    /// Limit position of a vertex whose mask is elementary: corners, creases (a cubic B-spline curve each), and smooth
    /// vertices of valence 4.
    pub fn limit(&self, v: usize) -> Option<DVec3> {
        let ends = || self.vertex_edges[v].iter().map(|&e| (self.points[self.other(e, v)], self.edges[e].sharpness));
        match self.lasting_rule(v)? {
            Rule::Corner => Some(self.points[v]),
            Rule::Crease => {
                let sharp: DVec3 = ends().filter(|(_, s)| *s > 0.0).map(|(p, _)| p).sum();
                Some((4.0 * self.points[v] + sharp) / 6.0)
            }
            Rule::Smooth if self.vertex_faces[v].len() == 4 => {
                let spokes: DVec3 = ends().map(|(p, _)| p).sum();
                let opposites: DVec3 = self.vertex_faces[v].iter().map(|&f| self.points[self.opposite(f, v)]).sum();
                Some((16.0 * self.points[v] + 4.0 * spokes + opposites) / 36.0)
            }
            _ => None,
        }
    }

    fn opposite(&self, face: usize, v: usize) -> usize {
        self.at(face, self.corner(face, v) + 2)
    }

    fn corner(&self, face: usize, v: usize) -> usize {
        self.faces[face].iter().position(|&x| x == v).expect("a corner of the face")
    }

    /// Spokes and opposite corners of the sector of the surface at a vertex that `face` lies in, counter-clockwise;
    /// where it starts, how many faces before `face`; and whether it goes all the way round.
    pub fn sector(&self, face: usize, v: usize) -> (Vec<usize>, Vec<usize>, usize, bool) {
        let stops = |e: usize| self.edges[e].sharpness > 0.0 || self.edges[e].faces.len() != 2;
        let incoming =
            |f: usize| self.face_edges[f][(self.corner(f, v) + self.faces[f].len() - 1) % self.faces[f].len()];
        let outgoing = |f: usize| self.face_edges[f][self.corner(f, v)];
        let across = |e: usize, f: usize| self.edges[e].faces.iter().copied().find(|&g| g != f).expect("two faces");
        let (mut first, mut before) = (face, 0);
        while !stops(outgoing(first)) {
            first = across(outgoing(first), first);
            before += 1;
            if first == face {
                before = 0;
                break;
            }
        }
        let (mut spokes, mut opposites, mut at) = (vec![self.other(outgoing(first), v)], Vec::new(), first);
        loop {
            opposites.push(self.opposite(at, v));
            if !stops(incoming(at)) && across(incoming(at), at) == first {
                return (spokes, opposites, before, true);
            }
            spokes.push(self.other(incoming(at), v));
            if stops(incoming(at)) {
                return (spokes, opposites, before, false);
            }
            at = across(incoming(at), at);
        }
    }

    /// Limit derivatives at a vertex by the (u,v) of a quad `face` of it, if the vertex is regular there: four faces, two
    /// in the sector beside a crease, or one in a corner. Beyond sharp edges the net goes on by 2a - b.
    pub fn derivatives(&self, face: usize, v: usize) -> Option<[DVec3; 2]> {
        let rule = self.lasting_rule(v)?;
        let (spokes, opposites, before, closed) = self.sector(face, v);
        let s = |k: usize| self.points[spokes[(before + k) % spokes.len()]];
        let d = |k: usize| self.points[opposites[(before + k) % opposites.len()]];
        let p = self.points[v];
        // Towards the next corner of the face, and towards the one before.
        let [a, b] = match (rule, closed, opposites.len()) {
            (Rule::Smooth, true, 4) => [
                (4.0 * (s(0) - s(2)) + (d(0) - d(1)) + (d(3) - d(2))) / 12.0,
                (4.0 * (s(1) - s(3)) + (d(0) - d(3)) + (d(1) - d(2))) / 12.0,
            ],
            (Rule::Crease, false, 2) => {
                let [first, inner, last] = [0, 1, 2].map(|k| self.points[spokes[k]] - p);
                let [left, right] = [0, 1].map(|k| self.points[opposites[k]] - p);
                let inwards = ((left - first) + 4.0 * inner + (right - last)) / 6.0;
                let along = 0.5 * (first - last);
                if before == 0 { [along, inwards] } else { [inwards, -along] }
            }
            (Rule::Corner, false, 1) => [s(0) - p, s(1) - p],
            _ => return None,
        };
        Some(match self.corner(face, v) {
            0 => [a, b],
            1 => [-b, a],
            2 => [-a, -b],
            _ => [b, -a],
        })
    }

    /// Limit position of any complete vertex: refined until its mask is elementary, or it stands still. It moves by at
    /// most (6 + sqrt 20) / 16 = 0.655 of the step before, so what is left is less than twice the last step.
    pub fn settle(&self, v: usize) -> DVec3 {
        let size = self.vertex_edges[v].iter().map(|&e| self.points[v].distance(self.points[self.other(e, v)]));
        let still = 1e-18 * size.fold(0.0, f64::max);
        let (mut cage, _) = self.crop(&[v], self.points[v]);
        let mut offset = self.points[v];
        for _ in 0..300 {
            if let Some(limit) = cage.limit(0) {
                return offset + limit;
            }
            let refined = cage.refine();
            let child = refined.vertices[0].expect("the vertex is complete");
            let moved = refined.cage.points[child];
            let settled = cage.lasting_rule(0).is_some();
            cage = refined.cage.crop(&[child], moved).0;
            offset += moved;
            if settled && moved.length() <= still {
                return offset;
            }
        }
        panic!("a vertex that does not converge")
    }
}
