//! Tier `vertex`: the limit at refined vertices against OpenSubdiv's limit masks.

use super::bin::Bins;
use super::difference::{Check, Difference, Normal, Sample};
use super::flaw::Flaw;
use super::key::{Against, Key, TierName};
use super::references::{ReferenceError, References};
use super::{NORMAL_LIMIT, Subject, rounding};
use crate::mesh::SubdivMesh;
use crate::osd::{Level, LimitMasks, Rule};
use glam::DVec3;

/// Some 20 roundings of 1e-16 on each side, level by level. Normals: OpenSubdiv's tangents are differences of world
/// coordinates. Rounding of world coordinates comes on top ([`Rounding`](super::rounding::Rounding)).
pub(super) const POSITION: f64 = 1e-12;
pub(super) const NORMAL_DEG: f64 = 1e-6;

/// Vertices that a uniform refinement may have: memory, and seconds.
const BUDGET: usize = 400_000;

/// The level of the uniform refinement at whose vertices limit masks are asked.
fn depth(mesh: &SubdivMesh) -> u32 {
    if mesh.face_vertices.len() * 4 <= BUDGET { 2 } else { 1 }
}

pub(super) fn run(subject: &Subject<'_>, references: &References<'_>, bins: &mut Bins) {
    let answers = references.limit_masks(depth(subject.mesh));
    let Some(masks) = bins.answered(TierName::Vertex, Against::LimitMasks, answers) else { return };
    let (limits, first, second) = match &masks.limits {
        LimitMasks::Answered { positions, tangents: [first, second] } => (positions, first, second),
        LimitMasks::NotAsked { crowded } => {
            bins.crowded = *crowded;
            return;
        }
    };
    let traits = Traits::of(masks.last(), &masks.points);
    let (last, traits) = (masks.last(), &traits);
    let locations = locations(&masks.levels);
    bins.fill(locations.len(), |bins, i| {
        let (vertex, sample) = locations[i];
        let known_wrong = traits.known_wrong(last, vertex);
        let ours = subject.evaluate(sample);
        let patch = ours.map(|(patch, _)| patch);
        let key = Key {
            known_wrong,
            ..Key::new(TierName::Vertex, Against::LimitMasks, patch.and_then(|patch| subject.kind(patch)))
        };
        let place = subject.place(sample, patch);
        let Some((_, jet)) = ours else {
            bins.mismatch(key, place);
            return;
        };
        let rounding = &subject.rounding;
        let allowed = match known_wrong {
            None => POSITION + rounding.position(),
            Some(_) => 2.0 * traits.reach[vertex] / rounding.unit + rounding.position(),
        };
        let normal = match last.vertex_rules[vertex] {
            // Where faces stay flat, each has a normal of its own.
            Rule::Smooth if known_wrong.is_none() && !subject.mesh.scheme.is_linear() => {
                // Tangent masks are cosines times at most 4 + 2 x 1.6 for each face, on average 2/pi of that.
                let weights = 5.0 * f64::from(traits.valence[vertex]);
                let turn = rounding::turn_deg(first[vertex], second[vertex], weights * rounding.point);
                let reference = first[vertex].cross(second[vertex]);
                Normal::judge(jet.normal, reference, turn, NORMAL_LIMIT, NORMAL_DEG + turn)
            }
            _ => Normal::Unknown,
        };
        let error = jet.position.distance(limits[vertex]) / rounding.unit;
        bins.add(key, place, Difference { position: Check { error, allowed }, normal, derivative: None });
    });
}

/// What decides whether a limit mask is right.
struct Traits {
    valence: Vec<u32>,
    restless: Vec<bool>,
    /// Distance to the farthest point of the faces round each vertex. A limit mask is a convex combination of these
    /// points, and so is the limit: however wrong a mask, the two are at most twice as far apart.
    reach: Vec<f64>,
}

impl Traits {
    fn of(level: &Level, points: &[DVec3]) -> Self {
        let mut valence = vec![0; level.vertex_count()];
        let mut reach = vec![0f64; level.vertex_count()];
        for face in 0..level.face_count() {
            for [vertex, ..] in level.edges_of_face(face) {
                valence[vertex] += 1;
                for [other, ..] in level.edges_of_face(face) {
                    reach[vertex] = reach[vertex].max(points[vertex].distance(points[other]));
                }
            }
        }
        Self { valence, restless: level.restless(), reach }
    }

    fn known_wrong(&self, level: &Level, vertex: usize) -> Option<Flaw> {
        match level.vertex_rules[vertex] {
            _ if self.restless[vertex] => Flaw::FiniteSharpnessInMasks.in_use(),
            Rule::Dart => Flaw::DartMask.in_use(),
            Rule::Smooth if self.valence[vertex] == 2 => Flaw::MaskOfValence2.in_use(),
            _ => None,
        }
    }
}

/// One place for each vertex of the last level that has a surface.
fn locations(levels: &[Level]) -> Vec<(usize, Sample)> {
    let mut found = vec![None; levels.last().map_or(0, Level::vertex_count)];
    visit(levels, &mut |vertex, place| {
        found[vertex].get_or_insert(place);
    });
    found.into_iter().enumerate().filter_map(|(vertex, place)| Some((vertex, place?))).collect()
}

/// Calls `see` with every corner of every face of the last level that has a surface.
fn visit(levels: &[Level], see: &mut dyn FnMut(usize, Sample)) {
    let mut ptex = 0;
    let triangles = levels[0].face_middles.iter().any(|&middle| middle >= 0);
    for face in 0..levels[0].face_count() {
        if triangles {
            let face = face as u32;
            descend_triangle(levels, 0, face as usize, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &mut |vertex, [u, v]| {
                see(vertex, Sample { face, u, v });
            });
            continue;
        }
        let corners = levels[0].corners(face);
        if corners.len() == 4 {
            descend(levels, 0, face, Sample { face: ptex, u: 0.0, v: 0.0 }, 1.0, see);
            ptex += 1;
            continue;
        }
        for i in corners {
            let child = levels[0].face_children[i] as usize;
            descend(levels, 1, child, Sample { face: ptex, u: 0.0, v: 0.0 }, 1.0, see);
            ptex += 1;
        }
    }
}

fn descend(levels: &[Level], level: usize, face: usize, at: Sample, size: f64, see: &mut dyn FnMut(usize, Sample)) {
    const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let topology = &levels[level];
    if topology.face_holes[face] != 0 {
        return;
    }
    for (i, [du, dv]) in topology.corners(face).zip(CORNERS) {
        if level + 1 == levels.len() {
            let place = Sample { u: at.u + du * size, v: at.v + dv * size, ..at };
            see(topology.face_vertices[i] as usize, place);
        } else {
            let half = size / 2.0;
            let origin = Sample { u: at.u + du * half, v: at.v + dv * half, ..at };
            descend(levels, level + 1, topology.face_children[i] as usize, origin, half, see);
        }
    }
}

/// The same for triangles, with the parameters of the corners.
fn descend_triangle(
    levels: &[Level],
    level: usize,
    face: usize,
    corners: [[f64; 2]; 3],
    see: &mut dyn FnMut(usize, [f64; 2]),
) {
    let topology = &levels[level];
    if topology.face_holes[face] != 0 {
        return;
    }
    let own = topology.corners(face);
    if level + 1 == levels.len() {
        own.zip(corners).for_each(|(i, at)| see(topology.face_vertices[i] as usize, at));
        return;
    }
    let middle = |i: usize, j: usize| [0, 1].map(|k| 0.5 * (corners[i][k] + corners[j][k]));
    let ([a, b, c], [ab, bc, ca]) = (corners, [middle(0, 1), middle(1, 2), middle(2, 0)]);
    let children = own.map(|i| topology.face_children[i]).chain([topology.face_middles[face]]);
    for (child, corners) in children.zip([[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]) {
        descend_triangle(levels, level + 1, child as usize, corners, see);
    }
}

/// What the limit mask says at a sample, if a mask is there.
pub(super) struct Mask {
    pub position: DVec3,
    pub tangents: [DVec3; 2],
    pub known_wrong: Option<Flaw>,
}

/// The limit mask at a point of the surface; `None` where no vertex of the masks' level lies, or OpenSubdiv has no room for one.
pub(super) fn mask(mesh: &SubdivMesh, references: &References<'_>, at: Sample) -> Result<Option<Mask>, ReferenceError> {
    let masks = references.limit_masks(depth(mesh))?;
    let LimitMasks::Answered { positions, tangents } = &masks.limits else { return Ok(None) };
    let mut found = None;
    visit(&masks.levels, &mut |vertex, place| {
        if place == at {
            found = Some(vertex);
        }
    });
    let traits = Traits::of(masks.last(), &masks.points);
    Ok(found.map(|vertex| Mask {
        position: positions[vertex],
        tangents: tangents.each_ref().map(|tangents| tangents[vertex]),
        known_wrong: traits.known_wrong(masks.last(), vertex),
    }))
}
