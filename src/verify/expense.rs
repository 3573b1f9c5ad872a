//! What OpenSubdiv takes at vertices of many faces, and which faces it is asked about there.
//!
//! Round a smooth vertex of N faces the stencil of each refined point has 2N terms, and OpenSubdiv's factory (3.5.0,
//! `StencilBuilder`) looks for each term that it adds among those that are there: 2N points of 2N terms in 2N steps, N^3 for each
//! of ten levels, however few of the faces are asked about. Bfr makes a dense matrix over the points round each face, or several
//! where each face of a fan has rules of its own: N^2 for each face. Far's patches, whose points are refined
//! once, answer at all samples in time linear in N. So limit stencils and Bfr are asked about as many faces at such vertices as
//! a bounded time suffices for. Faces elsewhere are not affected.

use super::failures::control_faces;
use crate::mesh::{Scheme, SubdivMesh};
use crate::osd::{INFINITE_SHARPNESS, Location};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Faces round a vertex, or corners of a face, beyond which it is dear. At 24 stencils take 20 ms.
const MANY: u32 = 24;

/// Seconds of limit stencils at dear vertices, in each set of samples, as the estimate below counts them.
const STENCIL_SECONDS: f64 = 2.0;

/// Seconds of Bfr: what it makes for each face it keeps, some 700 MB a second.
const BFR_SECONDS: f64 = 0.25;

/// Faces that stencils are made for at one dear vertex: they take a portion of their own, for each portion refines anew.
const FACES: usize = 128;

/// Seconds of processor time that limit stencils take round a smooth vertex. (Measured at N = 100 and 200, isolation 10: 1.4 and 9.)
fn stencil_seconds(valence: f64) -> f64 {
    1.4e-6 * valence.powi(3)
}

/// What a face counts at a vertex that is a corner, or that a crease or a boundary runs through: its own point is a sum of few control
/// points on all levels, so most stencils round it are shorter. (Measured: 0.3 s at 256 faces on two sides of a crease.)
const DIVIDED: f64 = 0.25;

/// Seconds of Bfr for a face at a vertex. (Measured at N = 512 on a boundary: 0.013, and 10 to 35 MB.)
fn bfr_seconds(valence: f64) -> f64 {
    5e-8 * valence.powi(2)
}

/// The dear vertices and n-gons of a mesh.
#[derive(Debug, Default)]
pub(super) struct Expense {
    control_faces: Vec<u32>,
    /// Faces round each dear vertex, or corners of the n-gon, as limit stencils count them: nine tenths of triangles, and as
    /// [`DIVIDED`] says.
    valences: Vec<f64>,
    /// Of control faces: the dear vertices that refining the face and its neighbours reaches.
    reached: HashMap<u32, Vec<u32>>,
    /// Of control faces: the largest valence at a corner, if it is dear.
    largest: HashMap<u32, u32>,
}

impl Expense {
    pub fn new(mesh: &SubdivMesh) -> Self {
        let mut faces_at = vec![0u32; mesh.points.len()];
        mesh.face_vertices.iter().for_each(|&vertex| faces_at[vertex as usize] += 1);
        let is_dear = |&vertex: &u32| faces_at[vertex as usize] > MANY;
        let is_large = |face: &[u32]| face.len() as u32 > MANY && !mesh.scheme.is_linear();
        if mesh.scheme.is_linear() || !mesh.faces().any(|(_, face)| is_large(face) || face.iter().any(is_dear)) {
            return Self::default();
        }
        let divided = Self::divided(mesh, &is_dear);
        let mut out = Self { control_faces: control_faces(mesh), ..Self::default() };
        let mut numbers: HashMap<u32, u32> = HashMap::new();
        // What faces that have the vertex reach.
        let mut reached_at: HashMap<u32, BTreeSet<u32>> = HashMap::new();
        let scheme = if mesh.scheme == Scheme::Loop { 0.9 } else { 1.0 };
        for (index, (_, face)) in mesh.faces().enumerate() {
            let mut own: Vec<u32> = Vec::new();
            if is_large(face) {
                own.push(out.valences.len() as u32);
                out.valences.push(face.len() as f64);
            }
            for &vertex in face.iter().filter(|vertex| is_dear(vertex)) {
                own.push(*numbers.entry(vertex).or_insert_with(|| {
                    let share = if divided.contains(&vertex) { DIVIDED } else { 1.0 };
                    out.valences.push(share * scheme * f64::from(faces_at[vertex as usize]));
                    out.valences.len() as u32 - 1
                }));
            }
            if !own.is_empty() {
                face.iter().for_each(|&vertex| reached_at.entry(vertex).or_default().extend(&own));
            }
            let largest = face.iter().filter(|vertex| is_dear(vertex)).map(|&vertex| faces_at[vertex as usize]).max();
            out.largest.extend(largest.map(|largest| (index as u32, largest)));
        }
        for (index, (_, face)) in mesh.faces().enumerate() {
            let reached: BTreeSet<u32> =
                face.iter().filter_map(|vertex| reached_at.get(vertex)).flatten().copied().collect();
            if !reached.is_empty() {
                out.reached.insert(index as u32, reached.into_iter().collect());
            }
        }
        out
    }

    /// The dear vertices that are corners, or that a crease or a boundary runs through.
    fn divided(mesh: &SubdivMesh, is_dear: &impl Fn(&u32) -> bool) -> BTreeSet<u32> {
        let mut edges: HashMap<u32, HashMap<u32, u32>> = HashMap::new();
        for (_, face) in mesh.faces() {
            for (k, &a) in face.iter().enumerate() {
                let b = face[(k + 1) % face.len()];
                for [from, to] in [[a, b], [b, a]] {
                    if is_dear(&from) {
                        *edges.entry(from).or_default().entry(to).or_default() += 1;
                    }
                }
            }
        }
        let mut sharp: HashMap<u32, u32> = HashMap::new();
        for crease in mesh.creases.iter().filter(|crease| crease.sharpness >= INFINITE_SHARPNESS) {
            crease.vertices.iter().for_each(|&vertex| *sharp.entry(vertex).or_default() += 1);
        }
        let corners = mesh.corners.iter().filter(|corner| corner.sharpness >= INFINITE_SHARPNESS);
        corners.for_each(|corner| *sharp.entry(corner.vertex).or_default() += 2);
        let is_divided = |(vertex, ends): &(&u32, &HashMap<u32, u32>)| {
            ends.values().any(|&faces| faces != 2) || sharp.get(*vertex).is_some_and(|&count| count >= 2)
        };
        edges.iter().filter(is_divided).map(|(&vertex, _)| vertex).collect()
    }

    fn control_face(&self, sample: &Location) -> Option<u32> {
        self.control_faces.get(sample.0 as usize).copied()
    }

    /// Samples, which come grouped by face, that limit stencils are asked about: those far from dear vertices; and portions of those
    /// near them, each to be asked about by itself.
    pub fn for_stencils(&self, samples: &[Location]) -> (Vec<Location>, Vec<Vec<Location>>) {
        let mut cheap = Vec::new();
        let mut groups: BTreeMap<&[u32], Vec<&[Location]>> = BTreeMap::new();
        for face in samples.chunk_by(|a, b| a.0 == b.0) {
            match self.control_face(&face[0]).and_then(|control| self.reached.get(&control)) {
                Some(reached) => groups.entry(reached).or_default().push(face),
                None => cheap.extend_from_slice(face),
            }
        }
        // In an order that has nothing to do with where they are, so that what the time suffices for is spread all over.
        let mut groups: Vec<_> = groups.into_iter().collect();
        let scattered = |key: &[u32]| {
            key.iter().fold(0u64, |hash, &k| (hash ^ u64::from(k + 1)).wrapping_mul(0x9e37_79b9_7f4a_7c15))
        };
        groups.sort_by_key(|(reached, _)| scattered(reached));
        let (mut portions, mut spent) = (Vec::new(), 0.0);
        for (reached, faces) in groups {
            let seconds: f64 = reached.iter().map(|&dear| stencil_seconds(self.valences[dear as usize])).sum();
            if spent + seconds <= STENCIL_SECONDS {
                spent += seconds;
                portions.push(faces.iter().step_by(faces.len().div_ceil(FACES)).copied().flatten().copied().collect());
            }
        }
        (cheap, portions)
    }

    /// Samples, which come grouped by face, that Bfr is asked about.
    pub fn for_bfr(&self, samples: &[Location]) -> Vec<Location> {
        let valence = |face: &[Location]| self.largest.get(&self.control_face(&face[0])?).copied();
        let faces = || samples.chunk_by(|a, b| a.0 == b.0);
        let seconds: f64 = faces().filter_map(valence).map(|valence| bfr_seconds(f64::from(valence))).sum();
        let stride = (seconds / BFR_SECONDS).ceil().max(1.0) as usize;
        let mut dear = 0..;
        let is_kept = |face: &&[Location]| valence(face).is_none() || dear.next().is_some_and(|i| i % stride == 0);
        faces().filter(is_kept).flatten().copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::fan;

    fn samples(mesh: &SubdivMesh) -> Vec<Location> {
        (0..mesh.ptex_count() as u32).flat_map(|face| [(face, 0.1, 0.2), (face, 0.3, 0.4)]).collect()
    }

    #[test]
    fn what_is_asked_is_bounded_at_dear_vertices_alone() {
        // Few faces: all are asked about, in the order in which they come.
        let mesh = fan(24, true, &[]);
        let all = samples(&mesh);
        let expense = Expense::new(&mesh);
        assert_eq!(expense.for_stencils(&all), (all.clone(), Vec::new()));
        assert_eq!(expense.for_bfr(&all), all);
        // More: all, but at the pole by themselves.
        let mesh = fan(40, true, &[]);
        let all = samples(&mesh);
        let (cheap, portions) = Expense::new(&mesh).for_stencils(&all);
        assert_eq!((cheap.len(), portions.len()), (0, 1));
        assert_eq!(portions[0].len(), all.len());
        // Many: none near the pole, or where creases shorten the stencils a part of the faces; and a part of them for Bfr.
        let mesh = fan(300, true, &[]);
        let all = samples(&mesh);
        assert_eq!(Expense::new(&mesh).for_stencils(&all), (Vec::new(), Vec::new()));
        let mesh = fan(600, true, &[]);
        let everything = samples(&mesh);
        let asked = Expense::new(&mesh).for_bfr(&everything).len();
        assert!(asked < everything.len() && asked >= everything.len() * 2 / 3, "{asked}");
        let mesh = fan(300, true, &[0, 100]);
        let (cheap, portions) = Expense::new(&mesh).for_stencils(&all);
        assert_eq!((cheap.len(), portions.len()), (0, 1));
        assert!(portions[0].len() > all.len() / 20 && portions[0].len() <= 2 * FACES, "{}", portions[0].len());
    }
}
