//! Meshes of the schemes `bilinear` and `none` as meshes of Catmull and Clark's, with the same surface.

use std::collections::HashMap;

use glam::DVec3;

use super::{BadFace, Boundary, Corner, Crease, Scheme, SubdivMesh};

/// Sharpness from which an edge or vertex never decays.
const INFINITE: f32 = 10.0;

impl SubdivMesh {
    /// Makes this mesh of a scheme that [is linear](Scheme::is_linear) one of Catmull and Clark's that has the same limit, to rounding.
    ///
    /// Each face that is no quad becomes the quads of its ptex faces: from a corner to the middle of the next edge, the mean of all
    /// corners, and the middle of the edge before. So ptex faces keep their numbers and parameters; faces do not. Then all edges and
    /// vertices are infinitely sharp, which leaves each quad the bilinear patch of its corners.
    pub(crate) fn linear_to_catmull_clark(&mut self) {
        let sizes = std::mem::take(&mut self.face_sizes);
        let vertices = std::mem::take(&mut self.face_vertices);
        let mut is_hole = vec![false; sizes.len()];
        std::mem::take(&mut self.holes).into_iter().for_each(|face| is_hole[face as usize] = true);
        let mut bad_faces = std::mem::take(&mut self.bad_faces).into_iter().peekable();
        let mut middles = HashMap::new();
        let mut rest = vertices.as_slice();
        for ((&size, is_hole), index) in sizes.iter().zip(is_hole).zip(0..) {
            let (face, more) = rest.split_at(size as usize);
            rest = more;
            let first = self.face_sizes.len() as u32;
            match face {
                [_, _, _, _] => self.face_vertices.extend(face),
                _ => self.push_quads(face, &mut middles),
            }
            self.face_sizes.resize(self.face_vertices.len() / 4, 4);
            if is_hole {
                self.holes.extend(first..self.face_sizes.len() as u32);
            }
            if let Some(bad) = bad_faces.next_if(|bad| bad.face == index) {
                let quads = first..self.face_sizes.len() as u32;
                self.bad_faces.extend(quads.map(|face| BadFace { face, ..bad }));
            }
        }
        let edge = |a: u32, b: u32| Crease { vertices: [a.min(b), a.max(b)], sharpness: INFINITE };
        let quads = self.face_vertices.chunks_exact(4);
        self.creases = quads.flat_map(|quad| (0..4).map(|k| edge(quad[k], quad[(k + 1) % 4]))).collect();
        self.creases.sort_unstable_by_key(|crease| crease.vertices);
        self.creases.dedup();
        self.corners = (0..self.points.len() as u32).map(|vertex| Corner { vertex, sharpness: INFINITE }).collect();
        // Said already; and faces at the boundary have a surface, whatever the rule was.
        self.boundary = Boundary::EdgeOnly;
        self.scheme = Scheme::CatmullClark;
    }

    /// Adds the quads of a face; `middles` has the vertices in the middle of edges.
    fn push_quads(&mut self, face: &[u32], middles: &mut HashMap<[u32; 2], u32>) {
        let corners = face.iter().map(|&vertex| self.points[vertex as usize]);
        let centre = corners.sum::<DVec3>() / face.len() as f64;
        let ends = |k: usize| [face[k], face[(k + 1) % face.len()]];
        let first = ends(face.len() - 1);
        let mut before = self.middle(first, middles);
        let middle_vertex = self.points.len() as u32;
        self.points.push(centre);
        for (k, &corner) in face.iter().enumerate() {
            let after = self.middle(ends(k), middles);
            self.face_vertices.extend([corner, after, middle_vertex, before]);
            before = after;
        }
    }

    /// The vertex in the middle of an edge.
    fn middle(&mut self, [a, b]: [u32; 2], middles: &mut HashMap<[u32; 2], u32>) -> u32 {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let middle = (self.points[a as usize] + self.points[b as usize]) / 2.0;
            self.points.push(middle);
            self.points.len() as u32 - 1
        })
    }
}
