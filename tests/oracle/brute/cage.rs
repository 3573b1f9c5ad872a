//! A mesh of any level, and what its sharp features are.

use super::rules::{INFINITE, is_finite};
use catoptric::mesh::{Boundary, Creasing, SubdivMesh};
use glam::DVec3;
use std::collections::HashMap;

/// An edge and the faces that use it.
#[derive(Debug, Clone)]
pub struct Edge {
    pub ends: [usize; 2],
    pub sharpness: f32,
    pub faces: Vec<usize>,
}

/// A mesh, or the part of one round a point.
#[derive(Debug, Clone, Default)]
pub struct Cage {
    pub points: Vec<DVec3>,
    /// Vertices of each face.
    pub faces: Vec<Vec<usize>>,
    /// Edge from each corner of each face to the next.
    pub face_edges: Vec<Vec<usize>>,
    pub edges: Vec<Edge>,
    /// Sharpness of each vertex.
    pub sharpness: Vec<f32>,
    pub vertex_faces: Vec<Vec<usize>>,
    pub vertex_edges: Vec<Vec<usize>>,
    /// All faces of the vertex are here, so it can be refined.
    pub complete: Vec<bool>,
    pub creasing: Creasing,
}

impl Cage {
    /// Edges and incidences of faces; `edge_sharpness` of a pair in ascending order, smooth where it has none.
    pub fn assemble(
        points: Vec<DVec3>,
        faces: Vec<Vec<usize>>,
        sharpness: Vec<f32>,
        complete: Vec<bool>,
        edge_sharpness: &HashMap<[usize; 2], f32>,
        creasing: Creasing,
    ) -> Self {
        let empty = vec![Vec::new(); points.len()];
        let mut cage = Self {
            points,
            sharpness,
            complete,
            creasing,
            vertex_faces: empty.clone(),
            vertex_edges: empty,
            ..Self::default()
        };
        let mut known: HashMap<[usize; 2], usize> = HashMap::new();
        for (f, face) in faces.iter().enumerate() {
            let mut edges = Vec::with_capacity(face.len());
            for (k, &a) in face.iter().enumerate() {
                let ends = pair(a, face[(k + 1) % face.len()]);
                let edge = *known.entry(ends).or_insert_with(|| {
                    let sharpness = edge_sharpness.get(&ends).copied().unwrap_or(0.0);
                    cage.edges.push(Edge { ends, sharpness, faces: Vec::new() });
                    ends.iter().for_each(|&v| cage.vertex_edges[v].push(cage.edges.len() - 1));
                    cage.edges.len() - 1
                });
                cage.edges[edge].faces.push(f);
                edges.push(edge);
                cage.vertex_faces[a].push(f);
            }
            cage.face_edges.push(edges);
        }
        cage.faces = faces;
        cage
    }

    /// The control mesh. Every topological feature becomes sharpness, as in OpenSubdiv: boundary and non-manifold edges
    /// are infinitely sharp, so are non-manifold vertices and, by the boundary rule, those of a single face.
    pub fn new(mesh: &SubdivMesh) -> Self {
        let faces = mesh.faces().map(|(_, face)| face.iter().map(|&v| v as usize).collect()).collect();
        let creased =
            mesh.creases.iter().map(|c| (pair(c.vertices[0] as usize, c.vertices[1] as usize), c.sharpness)).collect();
        let count = mesh.points.len();
        let mut cage =
            Self::assemble(mesh.points.clone(), faces, vec![0.0; count], vec![true; count], &creased, mesh.creasing);
        for corner in &mesh.corners {
            cage.sharpness[corner.vertex as usize] = corner.sharpness.min(INFINITE);
        }
        let manifold: Vec<bool> = (0..cage.edges.len()).map(|e| cage.is_manifold(e)).collect();
        for (edge, &manifold) in cage.edges.iter_mut().zip(&manifold) {
            let open = edge.faces.len() < 2 || !manifold;
            edge.sharpness = if open { INFINITE } else { edge.sharpness.min(INFINITE) };
        }
        for v in 0..count {
            let [faces, edges] = [cage.vertex_faces[v].len(), cage.vertex_edges[v].len()];
            let corner = faces == 1 && mesh.boundary == Boundary::EdgeAndCorner;
            if corner || cage.is_pinched(v, &manifold, faces > edges) {
                cage.sharpness[v] = INFINITE;
            }
        }
        cage
    }

    /// At most two faces, which run along the edge in opposite directions.
    fn is_manifold(&self, edge: usize) -> bool {
        let [a, b] = self.edges[edge].ends;
        let forward = |f: usize| (0..self.faces[f].len()).any(|k| self.faces[f][k] == a && self.at(f, k + 1) == b);
        match self.edges[edge].faces[..] {
            [f, g] => forward(f) != forward(g),
            [_] => true,
            _ => false,
        }
    }

    /// A vertex that is not manifold and so a corner; `fins`: it has more faces than edges.
    fn is_pinched(&self, v: usize, manifold: &[bool], fins: bool) -> bool {
        let not_manifold = self.vertex_edges[v].iter().filter(|&&e| !manifold[e]).count();
        let boundary = self.vertex_edges[v].iter().any(|&e| self.edges[e].faces.len() == 1);
        if not_manifold > 0 {
            // Two opposite edges with more than two faces each are a crease.
            return !(not_manifold == 2 && !boundary && fins);
        }
        // Faces that hang together across edges; more than one group means a bow tie.
        let Some(&first) = self.vertex_faces[v].first() else { return false };
        let mut reached = vec![first];
        let mut next = 0;
        while next < reached.len() {
            let here = reached[next];
            for &e in self.vertex_edges[v].iter().filter(|&&e| self.edges[e].faces.contains(&here)) {
                for &f in &self.edges[e].faces {
                    if !reached.contains(&f) {
                        reached.push(f);
                    }
                }
            }
            next += 1;
        }
        reached.len() < self.vertex_faces[v].len()
    }

    /// Vertex of a face at corner `corner`, counted round and round.
    pub fn at(&self, face: usize, corner: usize) -> usize {
        self.faces[face][corner % self.faces[face].len()]
    }

    /// Sharpness of the edges of a vertex.
    pub fn sharpness_around(&self, v: usize) -> Vec<f32> {
        self.vertex_edges[v].iter().map(|&e| self.edges[e].sharpness).collect()
    }

    /// Most edges of finite sharpness that meet in one vertex.
    pub fn finite_edges_at_a_vertex(&self) -> usize {
        let count = |v| self.sharpness_around(v).into_iter().filter(|&s| is_finite(s)).count();
        (0..self.points.len()).map(count).max().unwrap_or(0)
    }

    /// The other end of an edge.
    pub fn other(&self, edge: usize, v: usize) -> usize {
        let [a, b] = self.edges[edge].ends;
        if a == v { b } else { a }
    }

    /// Only the faces within three rings of the seeds, relative to `origin`. Gives the cage and the new index of each
    /// face. Three rings are what refinement itself keeps: then all vertices within two are complete again.
    pub fn crop(&self, seeds: &[usize], origin: DVec3) -> (Self, HashMap<usize, usize>) {
        let mut seen: Vec<usize> = seeds.to_vec();
        let mut rim = 0;
        let mut kept: HashMap<usize, usize> = HashMap::new();
        let mut vertices: HashMap<usize, usize> = seeds.iter().enumerate().map(|(i, &v)| (v, i)).collect();
        let mut order = Vec::new();
        for _ in 0..3 {
            let end = seen.len();
            for i in rim..end {
                for &f in &self.vertex_faces[seen[i]] {
                    if kept.contains_key(&f) {
                        continue;
                    }
                    kept.insert(f, order.len());
                    order.push(f);
                    for &v in &self.faces[f] {
                        vertices.entry(v).or_insert_with(|| {
                            seen.push(v);
                            seen.len() - 1
                        });
                    }
                }
            }
            rim = end;
        }
        let faces = order.iter().map(|&f| self.faces[f].iter().map(|v| vertices[v]).collect()).collect();
        let edges = order.iter().flat_map(|&f| &self.face_edges[f]).map(|&e| {
            let edge = &self.edges[e];
            (pair(vertices[&edge.ends[0]], vertices[&edge.ends[1]]), edge.sharpness)
        });
        let complete =
            seen.iter().map(|&v| self.complete[v] && self.vertex_faces[v].iter().all(|f| kept.contains_key(f)));
        let cage = Self::assemble(
            seen.iter().map(|&v| self.points[v] - origin).collect(),
            faces,
            seen.iter().map(|&v| self.sharpness[v]).collect(),
            complete.collect(),
            &edges.collect(),
            self.creasing,
        );
        (cage, kept)
    }
}

/// An edge's name.
pub fn pair(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}
