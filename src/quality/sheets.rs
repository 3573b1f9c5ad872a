//! How the faces round a control vertex hang together, and where they do not as a manifold.

use super::Unjudged;
use super::control::Control;
use crate::stam::LimitSurface;
use std::collections::{BTreeMap, HashMap, HashSet};

/// A face at a vertex, and the two edges of it that meet there, the lower vertex first.
type Sector = (u32, [[u32; 2]; 2]);

/// Faces round vertices.
pub(super) struct Fans(BTreeMap<u32, Vec<Sector>>);

impl Fans {
    /// Round the vertices that are wanted; holes too.
    pub fn new(control: &Control<'_>, is_wanted: impl Fn(u32) -> bool) -> Fans {
        let mut fans: BTreeMap<u32, Vec<Sector>> = BTreeMap::new();
        for (face, &size) in control.mesh.face_sizes.iter().enumerate() {
            let face = face as u32;
            for (k, &vertex) in control.corners(face).iter().enumerate().filter(|&(_, &vertex)| is_wanted(vertex)) {
                let k = k as u32;
                let edges = [control.edge(face, (k + size - 1) % size), control.edge(face, k)];
                fans.entry(vertex).or_default().push((face, edges));
            }
        }
        Fans(fans)
    }

    /// The faces round a vertex, in groups that hang together by edges which `joins` accepts.
    pub fn at(&self, vertex: u32, joins: impl Fn([u32; 2]) -> bool) -> Vec<Vec<u32>> {
        let Some(fan) = self.0.get(&vertex) else { return Vec::new() };
        let mut along: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for (i, (_, edges)) in fan.iter().enumerate() {
            edges.iter().filter(|edge| joins(**edge)).for_each(|&edge| along.entry(edge).or_default().push(i));
        }
        let mut is_left = vec![true; fan.len()];
        let mut groups = Vec::new();
        for first in 0..fan.len() {
            let mut group = Vec::new();
            let mut next = vec![first];
            while let Some(i) = next.pop() {
                if std::mem::take(&mut is_left[i]) {
                    group.push(fan[i].0);
                    // Nobody has to go along an edge twice.
                    next.extend(fan[i].1.iter().filter_map(|edge| along.remove(edge)).flatten());
                }
            }
            groups.extend((!group.is_empty()).then_some(group));
        }
        groups
    }

    fn vertices(&self) -> impl Iterator<Item = u32> {
        self.0.keys().copied()
    }
}

impl Control<'_> {
    /// What is not judged. `judged`: edges with joints on them, sorted.
    pub fn unjudged(&self, surface: &LimitSurface, judged: &[[u32; 2]]) -> Unjudged {
        let bearing: HashSet<u32> = surface.patches().iter().map(|patch| self.face(patch)).collect();
        let holes: HashSet<u32> = self.mesh.holes.iter().copied().collect();
        // Faces along each edge, and those with a surface.
        let mut along: BTreeMap<[u32; 2], [usize; 2]> = BTreeMap::new();
        for face in (0..self.mesh.face_count() as u32).filter(|face| !holes.contains(face)) {
            for k in 0..self.mesh.face_sizes[face as usize] {
                let count = along.entry(self.edge(face, k)).or_default();
                count[0] += 1;
                count[1] += usize::from(bearing.contains(&face));
            }
        }
        let mut unjudged = Unjudged::default();
        for (edge, [all, with]) in along {
            match (all > 1 && judged.binary_search(&edge).is_err(), with) {
                (false, _) => {}
                (true, 0 | 1) => unjudged.edges_without_surface.push(edge),
                (true, _) => unjudged.nonmanifold_edges.push(edge),
            }
        }
        let fans = Fans::new(self, |_| true);
        unjudged.nonmanifold_vertices.extend(fans.vertices().filter(|&vertex| {
            let sheets = fans.at(vertex, |_| true);
            sheets.iter().filter(|sheet| sheet.iter().any(|face| bearing.contains(face))).count() > 1
        }));
        unjudged
    }
}
