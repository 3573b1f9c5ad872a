//! The boundary of a surface: where its patches end, and what of it lies beside what.

use super::chain::Chain;
use super::control::{Control, Line};
use super::joint::{Piece, on_edge, tangent};
use crate::patch::Adjacency;
use crate::stam::{Jet, LimitSurface};
use glam::DVec3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use std::collections::{BTreeMap, HashMap};

/// Chords that stand in for a rim while near ones are looked for.
const CHORDS: usize = 4;
/// Most rims that are looked at round one point: where a boundary crowds at one place, time stays bounded.
const MOST_LOOKED_AT: usize = 256;
/// A boundary that comes near itself must be so many times longer than the distance that it spans: neighbours along a boundary, the two
/// edges of a corner and opposite points of a round opening (pi / 2 times) are no seam.
const DETOUR: f64 = 8.0;
/// Cosine of the largest angle between two boundaries that run along each other: 20 degrees. Two sheets that meet at an angle have
/// boundaries which leave their common corner at that angle, and are no seam there.
const ALONG: f64 = 0.94;
/// Sine of the angle by which the line between two boundary points may lean towards a surface or along the other boundary: 30 degrees.
const ASIDE: f64 = 0.5;

/// A piece of a patch's edge that nothing lies across, on an edge of the control mesh.
#[derive(Debug, Clone)]
pub(super) struct Rim {
    pub piece: Piece,
    /// The control edge, the lower vertex first.
    pub edge: [u32; 2],
    /// Control face that it bounds.
    pub face: u32,
    /// Parts of the control edge at the ends of the piece, counted from the lower vertex.
    parts: [f64; 2],
    points: [DVec3; CHORDS + 1],
    /// How far the curve may be from the chords, about.
    bulge: f64,
}

/// A point of a rim, and what is needed to see whether another rim lies beside it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Station {
    /// Index of the rim.
    pub rim: usize,
    /// Patch-local parameters.
    pub uv: [f64; 2],
    pub jet: Jet,
    /// Unit tangent, counter-clockwise round the patch.
    pub tangent: DVec3,
    /// Part of the control edge.
    part: f64,
}

impl Station {
    /// Unit vector in the tangent plane, from the boundary into the surface; zero where there is no normal.
    fn inward(&self) -> DVec3 {
        self.jet.normal.cross(self.tangent)
    }
}

/// Where a control edge lies along its chain.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    chain: usize,
    /// Length along the chain at the lower vertex and at the higher one.
    ends: [f64; 2],
}

/// How long a chain is, and where it ends.
#[derive(Debug)]
struct Reach {
    length: f64,
    /// The vertices at its ends; `None` where it is closed.
    ends: Option<[u32; 2]>,
}

/// All rims of a surface but those on edges that three or more faces have.
#[derive(Debug)]
pub(super) struct Boundary<'a> {
    surface: &'a LimitSurface,
    pub rims: Vec<Rim>,
    stretches: HashMap<[u32; 2], Stretch>,
    chains: Vec<Reach>,
    tree: RTree<Entry>,
    /// A number for each control face; the same for faces that hang together. Empty where there are no rims.
    components: Vec<u32>,
}

/// A rim in the tree.
#[derive(Debug, Clone)]
struct Entry {
    rim: usize,
    points: [DVec3; CHORDS + 1],
    bulge: f64,
}

impl RTreeObject for Entry {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let low = self.points.into_iter().fold(self.points[0], DVec3::min) - self.bulge;
        let high = self.points.into_iter().fold(self.points[0], DVec3::max) + self.bulge;
        AABB::from_corners(low.to_array(), high.to_array())
    }
}

impl PointDistance for Entry {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from_array(*point);
        let chords = self.points.windows(2).map(|ends| to_segment(point, [ends[0], ends[1]]));
        (chords.fold(f64::INFINITY, f64::min) - self.bulge).max(0.0).powi(2)
    }
}

fn to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let part = (point - a).dot(along) / along.length_squared();
    point.distance(a + along * if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.0 })
}

impl<'a> Boundary<'a> {
    pub fn new(surface: &'a LimitSurface, control: &Control<'_>, adjacency: &Adjacency) -> Boundary<'a> {
        let mut rims = Vec::new();
        for patch in 0..surface.patches().len() {
            for edge in 0..4u8 {
                if let Line::Edge(_) = control.line(&surface.patches()[patch], edge) {
                    let open = gaps(adjacency.across(patch, edge).iter().map(|n| n.own));
                    rims.extend(open.map(|own| Rim::new(surface, control, Piece { patch: patch as u32, edge, own })));
                }
            }
        }
        let mut faces: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for rim in &rims {
            let along = faces.entry(rim.edge).or_default();
            if !along.contains(&rim.face) {
                along.push(rim.face);
            }
        }
        rims.retain(|rim| faces[&rim.edge].len() < 3);
        let edges: Vec<[u32; 2]> =
            faces.into_iter().filter(|(_, along)| along.len() < 3).map(|(edge, _)| edge).collect();
        let mut boundary = Boundary {
            surface,
            stretches: HashMap::with_capacity(edges.len()),
            chains: Vec::new(),
            tree: RTree::bulk_load(rims.iter().enumerate().map(Entry::new).collect()),
            components: if rims.is_empty() { Vec::new() } else { control.components() },
            rims,
        };
        for (index, chain) in Chain::of(&edges).iter().enumerate() {
            let mut length = 0.0;
            let next = chain.vertices.iter().cycle().skip(1);
            for ((&a, &b), edge) in chain.vertices.iter().zip(next).zip(chain.edges()) {
                let [start, end] = [length, length + distance(control, a, b)];
                let ends = if edge[0] == a { [start, end] } else { [end, start] };
                boundary.stretches.insert(edge, Stretch { chain: index, ends });
                length = end;
            }
            let ends = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]];
            boundary.chains.push(Reach { length, ends: (!chain.closed).then_some(ends) });
        }
        boundary
    }

    /// Which chain of the boundary a rim is of.
    pub fn chain(&self, rim: usize) -> usize {
        self.stretches[&self.rims[rim].edge].chain
    }

    /// The point of a rim at a part of its length, 0 to 1; `None` where the boundary has no tangent.
    pub fn station(&self, rim: usize, part: f64) -> Option<Station> {
        let Rim { piece, parts, .. } = &self.rims[rim];
        let uv = on_edge(piece.edge, piece.own[0] + part * (piece.own[1] - piece.own[0]));
        let jet = self.surface.evaluate(piece.patch as usize, uv);
        let tangent = tangent(&jet, piece.edge).try_normalize()?;
        Some(Station { rim, uv, jet, tangent, part: parts[0] + part * (parts[1] - parts[0]) })
    }

    /// The nearest point within `reach` of a boundary that runs beside a station. Of several that are as near, within a millionth of the
    /// reach, the one that goes on most smoothly.
    pub fn beside(&self, own: &Station, reach: f64) -> Option<(Station, f64)> {
        let point = own.jet.position;
        let tie = 1e-6 * reach;
        let mut found: Vec<(Station, f64)> = Vec::new();
        let mut least = reach;
        for (entry, least_2) in self.tree.nearest_neighbor_iter_with_distance_2(point.to_array()).take(MOST_LOOKED_AT) {
            if least_2.sqrt() > least + tie {
                break;
            }
            if let Some((other, distance)) = self.foot(entry, own).filter(|(_, distance)| *distance <= reach)
                && self.is_seam(own, &other, distance)
            {
                least = least.min(distance);
                found.push((other, distance));
            }
        }
        let bend = |other: &Station| {
            let normal = if is_reversed(own, other) { -other.jet.normal } else { other.jet.normal };
            -own.jet.normal.dot(normal)
        };
        found.retain(|(_, distance)| *distance <= least + tie);
        found.into_iter().reduce(|a, b| if bend(&b.0) < bend(&a.0) { b } else { a })
    }

    /// The point of a rim that is nearest to a station, and how far away it is; `None` where that is an end, and the rim goes off
    /// sideways there.
    fn foot(&self, entry: &Entry, own: &Station) -> Option<(Station, f64)> {
        if self.rims[entry.rim].piece.patch == self.rims[own.rim].piece.patch {
            return None;
        }
        let point = own.jet.position;
        let nearest = (0..CHORDS)
            .map(|k| (k, to_segment(point, [entry.points[k], entry.points[k + 1]])))
            .reduce(|a, b| if b.1 < a.1 { b } else { a })?;
        let place = |k: usize| k as f64 / CHORDS as f64;
        let (low, high) = (place(nearest.0.saturating_sub(1)), place((nearest.0 + 2).min(CHORDS)));
        let lean = |station: &Station| (station.jet.position - point).dot(station.tangent);
        let probe = |part: f64| self.station(entry.rim, part).map(|station| (part, lean(&station), station));
        let (mut a, mut b) = (probe(low)?, probe(high)?);
        // Regula falsi, of which an end that stays again counts for half as much (the Illinois method).
        let (mut weights, mut was_low) = ([1.0, 1.0], None);
        for _ in 0..60 {
            if !(a.1 < 0.0 && b.1 > 0.0) {
                break;
            }
            let (of_a, of_b) = (weights[0] * a.1, weights[1] * b.1);
            let part = (a.0 + (b.0 - a.0) * (of_a / (of_a - of_b))).clamp(a.0, b.0);
            if part == a.0 || part == b.0 {
                break;
            }
            let middle = probe(part)?;
            let is_low = middle.1 < 0.0;
            let stays = if was_low == Some(is_low) { 0.5 } else { 1.0 };
            was_low = Some(is_low);
            match is_low {
                true => (a, weights) = (middle, [1.0, stays * weights[1]]),
                false => (b, weights) = (middle, [stays * weights[0], 1.0]),
            }
        }
        let at = if a.1.abs() < b.1.abs() { a.2 } else { b.2 };
        let distance = at.jet.position.distance(point);
        (lean(&at).abs() <= ASIDE * distance + rounding(point)).then_some((at, distance))
    }

    /// Whether two points of the boundary are those of a seam: the boundaries run along each other, are not neighbours along one
    /// boundary, and no surface lies between them.
    fn is_seam(&self, own: &Station, other: &Station, distance: f64) -> bool {
        if own.tangent.dot(other.tangent).abs() < ALONG {
            return false;
        }
        let [a, b] = [own, other].map(|station| &self.rims[station.rim]);
        let is_one_edge = a.edge == b.edge && a.face != b.face;
        if !is_one_edge && self.detour(own, other) <= DETOUR * distance {
            return false;
        }
        // A narrow strip lies between its own boundaries, and a fold brings the boundaries of its two leaves together. Sheets of two
        // components may overlap.
        let is_apart = distance > rounding(own.jet.position);
        let is_own = is_apart && (spans_surface(own, other) || is_folded(own, other));
        !(is_own && self.is_one_component(own, other))
    }

    /// Whether a gap between two points of the boundary lies outside of the surface on both sides.
    pub fn is_opening(own: &Station, other: &Station) -> bool {
        let line = other.jet.position - own.jet.position;
        line.dot(own.inward()) < 0.0 && line.dot(other.inward()) > 0.0
    }

    fn is_one_component(&self, own: &Station, other: &Station) -> bool {
        let [a, b] = [own, other].map(|station| self.component(self.rims[station.rim].face));
        a == b
    }

    /// A number for a control face: the same for faces that hang together.
    pub fn component(&self, face: u32) -> u32 {
        self.components[face as usize]
    }

    /// The way from one point to another along the boundary; infinite where there is none.
    fn detour(&self, own: &Station, other: &Station) -> f64 {
        let [a, b] = [own, other].map(|station| {
            let stretch = self.stretches[&self.rims[station.rim].edge];
            (stretch.chain, stretch.ends[0] + station.part * (stretch.ends[1] - stretch.ends[0]))
        });
        self.way(a, b)
    }

    /// Whether two control vertices of the boundary are farther from each other along it than neighbours are. Each comes with another
    /// vertex that it has an edge of the boundary to.
    pub fn is_apart(&self, [a, of_a]: [u32; 2], [b, of_b]: [u32; 2], distance: f64) -> bool {
        let at = |vertex: u32, other: u32| {
            let stretch = self.stretches[&[vertex.min(other), vertex.max(other)]];
            (stretch.chain, stretch.ends[usize::from(vertex > other)])
        };
        self.way(at(a, of_a), at(b, of_b)) > DETOUR * distance
    }

    fn way(&self, a: (usize, f64), b: (usize, f64)) -> f64 {
        let [first, second] = [a.0, b.0].map(|chain| &self.chains[chain]);
        let mut least = f64::INFINITY;
        if a.0 == b.0 {
            least = (a.1 - b.1).abs();
            if first.ends.is_none() {
                least = least.min(first.length - least);
            }
        }
        // Chains that end at the same vertex go on in each other.
        if let (Some(ends), Some(others)) = (first.ends, second.ends) {
            let to = |end: usize, reach: &Reach, at: f64| if end == 0 { at } else { reach.length - at };
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                if ends[i] == others[j] {
                    least = least.min(to(i, first, a.1) + to(j, second, b.1));
                }
            }
        }
        least
    }
}

/// How far a point may be off by rounding: some sixteen units in the last place of its largest coordinate.
fn rounding(point: DVec3) -> f64 {
    16.0 * f64::EPSILON * point.abs().max_element()
}

/// Whether the line from one point of the boundary to another runs into the surface on both sides.
fn spans_surface(own: &Station, other: &Station) -> bool {
    let line = (other.jet.position - own.jet.position).normalize_or_zero();
    line.dot(own.inward()) > ASIDE && -line.dot(other.inward()) > ASIDE
}

/// Whether the surfaces at two points of the boundary lie on each other, like the leaves of a fold.
fn is_folded(own: &Station, other: &Station) -> bool {
    own.inward().dot(other.inward()) > ALONG
}

/// Whether the faces on the two sides of a seam run against each other: then one normal points to the other side.
pub(super) fn is_reversed(own: &Station, other: &Station) -> bool {
    own.tangent.dot(other.tangent) > 0.0
}

impl Rim {
    fn new(surface: &LimitSurface, control: &Control<'_>, piece: Piece) -> Rim {
        let patch = &surface.patches()[piece.patch as usize];
        let points: [DVec3; CHORDS + 1] = std::array::from_fn(|k| piece.point(surface, k as f64 / CHORDS as f64));
        let bend = |p: &[DVec3]| (p[0] - 2.0 * p[1] + p[2]).length();
        let (edge, from) = control.along(patch, piece.edge, piece.own[0]);
        let (_, to) = control.along(patch, piece.edge, piece.own[1]);
        Rim {
            piece,
            edge,
            face: control.face(patch),
            parts: [from, to],
            // A parabola is an eighth of its second difference from its chord.
            bulge: points.windows(3).map(bend).fold(0.0, f64::max) / 4.0,
            points,
        }
    }
}

impl Entry {
    fn new((rim, Rim { points, bulge, .. }): (usize, &Rim)) -> Entry {
        Entry { rim, points: *points, bulge: *bulge }
    }
}

/// What some intervals, sorted, leave of 0 to 1.
fn gaps(covered: impl Iterator<Item = [f64; 2]>) -> impl Iterator<Item = [f64; 2]> {
    let mut start = 0.0;
    let ends = covered.chain([[1.0, 1.0]]);
    ends.filter_map(move |[from, to]| {
        let gap = [start, from];
        start = to.max(start);
        (gap[1] > gap[0]).then_some(gap)
    })
}

fn distance(control: &Control<'_>, a: u32, b: u32) -> f64 {
    let [a, b] = [a, b].map(|vertex| control.mesh.points[vertex as usize]);
    a.distance(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_covered_is_open() {
        let left = |covered: &[[f64; 2]]| gaps(covered.iter().copied()).collect::<Vec<_>>();
        assert_eq!(left(&[]), [[0.0, 1.0]]);
        assert!(left(&[[0.0, 1.0]]).is_empty() && left(&[[0.0, 0.5], [0.5, 1.0]]).is_empty());
        assert_eq!(left(&[[0.25, 0.5]]), [[0.0, 0.25], [0.5, 1.0]]);
    }
}
