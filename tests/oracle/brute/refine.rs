//! One step of Catmull-Clark refinement, by the book (Catmull & Clark 1978; DeRose, Kass & Truong 1998 for creases; the
//! blend at the last fractional level as OpenSubdiv defines it).

use super::cage::{Cage, pair};
use super::rules::{Rule, child_of_edge, decay, parent_weight};
use glam::DVec3;
use std::collections::HashMap;

/// What became of the parts of a cage.
pub struct Children {
    pub cage: Cage,
    /// Child of each face at each corner. The child's corners are: the vertex point, the edge point that follows, the face
    /// point, the edge point before; of a quad they are turned so that its (u,v) run as the parent's.
    pub faces: Vec<Vec<Option<usize>>>,
    /// Child of each complete vertex.
    pub vertices: Vec<Option<usize>>,
}

impl Cage {
    fn face_point(&self, face: usize) -> DVec3 {
        mean(self.faces[face].iter().map(|&v| self.points[v]))
    }

    /// Sharpness of the two children of an edge, at its two ends.
    fn edge_children(&self, edge: usize) -> [f32; 2] {
        let own = self.edges[edge].sharpness;
        self.edges[edge].ends.map(|v| child_of_edge(self.creasing, own, &self.sharpness_around(v)))
    }

    fn edge_point(&self, edge: usize) -> DVec3 {
        let own = f64::from(self.edges[edge].sharpness);
        let middle = mean(self.edges[edge].ends.iter().map(|&v| self.points[v]));
        if own > 0.0 && self.edge_children(edge).iter().all(|&s| s > 0.0) {
            return middle;
        }
        let smooth = 0.5 * (middle + mean(self.edges[edge].faces.iter().map(|&f| self.face_point(f))));
        // Not clamped, as in OpenSubdiv: by Chaikin, sharpness above 1 can end in one step.
        own * middle + (1.0 - own) * smooth
    }

    fn by_rule(&self, v: usize, rule: Rule, edges: &[f32]) -> DVec3 {
        let ends = || self.vertex_edges[v].iter().map(|&e| self.points[self.other(e, v)]);
        match rule {
            Rule::Corner => self.points[v],
            Rule::Crease => {
                let sharp = ends().zip(edges).filter(|(_, s)| **s > 0.0).map(|(p, _)| p);
                0.75 * self.points[v] + 0.125 * sharp.sum::<DVec3>()
            }
            Rule::Smooth | Rule::Dart => {
                let n = self.vertex_faces[v].len() as f64;
                let faces = mean(self.vertex_faces[v].iter().map(|&f| self.face_point(f)));
                ((n - 2.0) * self.points[v] + mean(ends()) + faces) / n
            }
        }
    }

    fn vertex_point(&self, v: usize) -> DVec3 {
        let edges = self.sharpness_around(v);
        let children: Vec<f32> = edges.iter().map(|&s| child_of_edge(self.creasing, s, &edges)).collect();
        let vertex = [self.sharpness[v], decay(self.sharpness[v])];
        let [parent, child] = [Rule::new(vertex[0], &edges), Rule::new(vertex[1], &children)];
        let own = self.by_rule(v, parent, &edges);
        if parent == child || matches!(parent, Rule::Smooth | Rule::Dart) {
            return own;
        }
        let weight = f64::from(parent_weight(self.creasing, vertex, &edges, &children));
        weight * own + (1.0 - weight) * self.by_rule(v, child, &children)
    }

    /// One level finer: every face that is known whole, which are the children round complete vertices with complete
    /// neighbours.
    pub fn refine(&self) -> Children {
        let (mut points, mut sharpness) = (Vec::new(), Vec::new());
        let mut add = |point: DVec3, sharp: f32| {
            points.push(point);
            sharpness.push(sharp);
            points.len() - 1
        };
        let vertices: Vec<Option<usize>> = (0..self.points.len())
            .map(|v| {
                let used = self.complete[v] && !self.vertex_faces[v].is_empty();
                used.then(|| add(self.vertex_point(v), decay(self.sharpness[v])))
            })
            .collect();
        let edge_points: Vec<Option<usize>> = (0..self.edges.len())
            .map(|e| self.edges[e].ends.iter().all(|&v| self.complete[v]).then(|| add(self.edge_point(e), 0.0)))
            .collect();
        let face_points: Vec<usize> = (0..self.faces.len()).map(|f| add(self.face_point(f), 0.0)).collect();

        let mut faces: Vec<Vec<usize>> = Vec::new();
        let mut missing = vec![false; points.len()];
        let mut children = Vec::with_capacity(self.faces.len());
        for (f, face) in self.faces.iter().enumerate() {
            let size = face.len();
            let mut own = Vec::with_capacity(size);
            for corner in 0..size {
                let [next, before] = [corner, corner + size - 1].map(|k| edge_points[self.face_edges[f][k % size]]);
                let vertex = vertices[face[corner]];
                let parts = [vertex, next, Some(face_points[f]), before];
                if parts.iter().any(Option::is_none) {
                    parts.iter().flatten().for_each(|&v| missing[v] = true);
                    own.push(None);
                    continue;
                }
                let mut child: Vec<usize> = parts.into_iter().flatten().collect();
                if size == 4 {
                    child.rotate_right(corner);
                }
                own.push(Some(faces.len()));
                faces.push(child);
            }
            children.push(own);
        }
        let mut edges = HashMap::new();
        for (e, edge) in self.edges.iter().enumerate().filter(|(_, edge)| edge.sharpness > 0.0) {
            let Some(middle) = edge_points[e] else { continue };
            for (v, child) in edge.ends.into_iter().zip(self.edge_children(e)) {
                let end = vertices[v].expect("the ends of a refined edge are complete");
                edges.insert(pair(end, middle), child);
            }
        }
        let complete = missing.into_iter().map(|missing| !missing).collect();
        let cage = Self::assemble(points, faces, sharpness, complete, &edges, self.creasing);
        Children { cage, faces: children, vertices }
    }
}

fn mean(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let (sum, count) = points.fold((DVec3::ZERO, 0.0), |(sum, count), p| (sum + p, count + 1.0));
    sum / count
}
