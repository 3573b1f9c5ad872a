//! Seams: boundaries that lie beside each other, closely enough to be meant as a joint.
//!
//! Theory: a joint inside a mesh joins two patches by topology. Where faces were modelled apart, it is geometry that says what belongs
//! together, as in the connect checkers of CAD programs: two boundaries within a distance are a joint, and the distance is its gap.
//! Practice: points of each boundary look for the nearest other boundary ([`Boundary::beside`]); pairs are judged as pairs across a
//! joint are. Edges may be divided differently on the two sides, overlap in part, and run in either direction.

use super::boundary::{Boundary, Station, is_reversed};
use super::chain::Chain;
use super::control::{Control, Line};
use super::joint::{Gauge, PARTS, Piece, place};
use super::{Extremes, Feature, FeatureKind, Finding};
use crate::curves::Place;
use glam::DVec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::{BTreeMap, BTreeSet};

/// How many times the weld distance away a boundary is still spoken of.
const NEARBY: f64 = 50.0;
/// Most rims that look for such a boundary: it is a hint, and must not cost what measuring costs.
const MOST_HINTED: usize = 4096;
/// Vertices that are looked at round one for one that is not welded to it.
const MOST_VERTICES: usize = 64;

/// A boundary beside another one, too far away to be a seam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearby {
    /// The smallest distance that was found, model units.
    pub distance: f64,
    /// Where that is.
    pub place: Place,
    /// The point there, world space.
    pub position: DVec3,
}

/// Control vertices on boundaries that lie on others without being the same vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unwelded {
    /// How many vertices would vanish if all were welded.
    pub count: usize,
    /// The first two that are one point, the lower one first.
    pub first: [u32; 2],
    /// Their distance, model units.
    pub distance: f64,
}

/// A seam at a point.
struct Pair {
    /// Rims.
    own: usize,
    other: usize,
    finding: Finding,
    reversed: bool,
}

/// What boundaries do beside each other.
#[derive(Default)]
pub(super) struct Seams {
    pub features: Vec<Feature>,
    /// Control edges that two faces run along in the same direction, and that were judged as seams.
    pub edges: Vec<[u32; 2]>,
    pub nearby: Option<Nearby>,
    pub unwelded: Option<Unwelded>,
}

impl Seams {
    /// `weld`: how far apart boundaries may be, model units.
    pub fn new(gauge: &Gauge<'_>, boundary: &Boundary<'_>, weld: f64) -> Seams {
        if boundary.rims.is_empty() || weld <= 0.0 {
            return Seams::default();
        }
        let of_rim = |rim: usize| -> Vec<Pair> {
            let beside = |part: f64| {
                let own = boundary.station(rim, part)?;
                let (other, _) = boundary.beside(&own, weld)?;
                Some(pair(gauge, boundary, &own, &other))
            };
            PARTS.into_iter().filter_map(beside).collect()
        };
        let pairs: Vec<Pair> = (0..boundary.rims.len()).into_par_iter().flat_map_iter(of_rim).collect();
        let mut edges: Vec<[u32; 2]> = pairs
            .iter()
            .filter(|pair| boundary.rims[pair.own].edge == boundary.rims[pair.other].edge)
            .map(|pair| boundary.rims[pair.own].edge)
            .collect();
        edges.dedup();
        Seams {
            nearby: nearby(gauge, boundary, weld),
            unwelded: unwelded(gauge.control, boundary, &pairs, weld),
            features: features(gauge, boundary, pairs),
            edges,
        }
    }
}

fn pair(gauge: &Gauge<'_>, boundary: &Boundary<'_>, own: &Station, other: &Station) -> Pair {
    let reversed = is_reversed(own, other);
    let [first, second] = [own, other].map(|station| &boundary.rims[station.rim].piece);
    let at = [(first.patch as usize, own.uv), (second.patch as usize, other.uv)];
    Pair { own: own.rim, other: other.rim, finding: gauge.compare(at, first.edge, reversed), reversed }
}

/// The nearest boundary that is no seam, across an opening.
fn nearby(gauge: &Gauge<'_>, boundary: &Boundary<'_>, weld: f64) -> Option<Nearby> {
    let stride = boundary.rims.len().div_ceil(MOST_HINTED);
    let look = |rim: usize| {
        let own = boundary.station(rim, 0.5)?;
        let (other, distance) = boundary.beside(&own, NEARBY * weld)?;
        let is_apart = distance > weld && Boundary::is_opening(&own, &other);
        let patch = boundary.rims[rim].piece.patch as usize;
        let place = place(gauge.surface, patch, own.uv);
        is_apart.then_some(Nearby { distance, place, position: own.jet.position })
    };
    let rims = (0..boundary.rims.len()).step_by(stride).collect::<Vec<_>>();
    let found: Vec<Nearby> = rims.into_par_iter().filter_map(look).collect();
    found.into_iter().reduce(|a, b| if b.distance < a.distance { b } else { a })
}

/// Control vertices of the boundary that lie on others within `weld`. In one component a narrow strip has such vertices on its two
/// sides: there they count where they are the ends of a seam, or one point.
fn unwelded(control: &Control<'_>, boundary: &Boundary<'_>, pairs: &[Pair], weld: f64) -> Option<Unwelded> {
    /// Part of the weld distance that is one point: with the default, a few thousand roundings of the diagonal.
    const POINT: f64 = 1e-9;
    let of_seams: BTreeSet<u32> =
        pairs.iter().flat_map(|pair| [pair.own, pair.other]).flat_map(|rim| boundary.rims[rim].edge).collect();
    // Each vertex with one that it has a boundary edge to, and the component of the face there.
    let mut edges: BTreeMap<u32, (u32, u32)> = BTreeMap::new();
    for rim in &boundary.rims {
        let ([a, b], component) = (rim.edge, boundary.component(rim.face));
        edges.entry(a).or_insert((b, component));
        edges.entry(b).or_insert((a, component));
    }
    let point = |vertex: u32| control.mesh.points[vertex as usize];
    let entries = edges.keys().map(|&vertex| GeomWithData::new(point(vertex).to_array(), vertex));
    let tree = RTree::bulk_load(entries.collect());
    let mut found: Option<Unwelded> = None;
    for (&vertex, &(next, component)) in &edges {
        let near = tree.nearest_neighbor_iter(point(vertex).to_array()).take(MOST_VERTICES);
        let near = near.map(|entry| (entry.data, point(entry.data).distance(point(vertex))));
        let partner = near.take_while(|(_, distance)| *distance <= weld).find(|&(other, distance)| {
            let (beside, of_other) = edges[&other];
            let is_joined = component != of_other
                || distance <= POINT * weld
                || (of_seams.contains(&vertex) && of_seams.contains(&other));
            other < vertex && is_joined && boundary.is_apart([vertex, next], [other, beside], distance)
        });
        if let Some((other, distance)) = partner {
            let first = Unwelded { count: 0, first: [other, vertex], distance };
            found.get_or_insert(first).count += 1;
        }
    }
    found
}

/// Which pairs of rims belong together: those of the same two chains that follow each other.
fn features(gauge: &Gauge<'_>, boundary: &Boundary<'_>, pairs: Vec<Pair>) -> Vec<Feature> {
    // A rim by itself may be beside several others.
    type Node = ([usize; 2], usize);
    let key = |pair: &Pair| {
        let [a, b] = [pair.own, pair.other].map(|rim| boundary.chain(rim));
        [a.min(b), a.max(b)]
    };
    let mut nodes: BTreeMap<Node, usize> = BTreeMap::new();
    for pair in &pairs {
        for rim in [pair.own, pair.other] {
            let next = nodes.len();
            nodes.entry((key(pair), rim)).or_insert(next);
        }
    }
    let mut parent: Vec<usize> = (0..nodes.len()).collect();
    fn root(parent: &mut [usize], mut node: usize) -> usize {
        while parent[node] != node {
            parent[node] = parent[parent[node]];
            node = parent[node];
        }
        node
    }
    let mut join = |a: usize, b: usize| {
        let [a, b] = [root(&mut parent, a), root(&mut parent, b)];
        parent[a.max(b)] = a.min(b);
    };
    pairs.iter().for_each(|pair| join(nodes[&(key(pair), pair.own)], nodes[&(key(pair), pair.other)]));
    // Rims of one edge, and of edges that follow each other.
    let mut at: BTreeMap<([usize; 2], u32), usize> = BTreeMap::new();
    for (&(key, rim), &node) in &nodes {
        for vertex in boundary.rims[rim].edge {
            join(*at.entry((key, vertex)).or_insert(node), node);
        }
    }
    let mut groups: BTreeMap<usize, Vec<Pair>> = BTreeMap::new();
    for pair in pairs {
        let node = nodes[&(key(&pair), pair.own)];
        groups.entry(root(&mut parent, node)).or_default().push(pair);
    }
    groups.into_values().map(|group| feature(gauge, boundary, &group)).collect()
}

fn feature(gauge: &Gauge<'_>, boundary: &Boundary<'_>, group: &[Pair]) -> Feature {
    let rims: BTreeSet<usize> = group.iter().flat_map(|pair| [pair.own, pair.other]).collect();
    let mut edges: Vec<[u32; 2]> = rims.iter().map(|&rim| boundary.rims[rim].edge).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut chains = Chain::of(&edges);
    let mut extremes = Extremes::default();
    let mut worst = (f64::NEG_INFINITY, group[0].own);
    for pair in group {
        let one = Extremes::of(pair.finding, gauge.limits);
        if one.severity() > worst.0 {
            worst = (one.severity(), pair.own);
        }
        extremes = extremes.and(one);
    }
    let pieces: Vec<Piece> = rims.iter().map(|&rim| boundary.rims[rim].piece).collect();
    let beside = chains.split_off(chains.len().min(1));
    Feature {
        kind: FeatureKind::Seam,
        chain: chains.pop(),
        beside,
        reversed: group.iter().any(|pair| pair.reversed),
        line: Line::Edge(boundary.rims[worst.1].edge),
        sharpness: [0.0; 2],
        extremes,
        radius: None,
        pieces,
    }
}
