//! Tier `vertex`: the limit at refined vertices against OpenSubdiv's limit masks.

use super::bin::{Bins, Difference, Key, Sample, Tolerance, angle_deg};
use super::{Subject, VerifyError};
use crate::osd::{INFINITE_SHARPNESS, Level, Refiner, Rule};

/// Positions: some 20 roundings of 1e-16 on each side, level by level. Normals: those of dyadic points.
const TOLERANCE: Tolerance = Tolerance { position: Some(1e-12), normal_deg: Some(1e-6), derivative: None };

/// Vertices that a uniform refinement may have: memory, and seconds.
const BUDGET: usize = 400_000;

pub(super) fn run(subject: &Subject<'_>, bins: &mut Bins) -> Result<(), VerifyError> {
    let depth = if subject.mesh.face_vertices.len() * 4 <= BUDGET { 2 } else { 1 };
    let refiner = Refiner::uniform(subject.mesh, depth)?;
    let levels = (0..refiner.level_count()).map(|i| refiner.level(i)).collect::<Result<Vec<_>, _>>()?;
    let Some(last) = levels.last() else { return Ok(()) };
    let points = refiner.interpolate(&subject.mesh.points)?;
    let [limits, first, second] = refiner.limit(&points[points.len() - last.vertex_count()..])?;
    let traits = Traits::of(last);
    for (vertex, sample) in locations(&levels) {
        let Some((patch, jet)) = subject.surface.evaluate_ptex(sample.face, [sample.u, sample.v]) else { continue };
        let smooth = last.vertex_rules[vertex] == Rule::Smooth;
        let known_wrong = traits.known_wrong(last, vertex);
        let normal_deg = if smooth { angle_deg(jet.normal, first[vertex].cross(second[vertex])) } else { None };
        let key = Key { tier: "vertex", reference: "limit masks", kind: subject.surface.kind(patch), known_wrong };
        let position = jet.position.distance(limits[vertex]);
        bins.add(key, TOLERANCE, sample, Difference { position, normal_deg, derivative: None });
    }
    Ok(())
}

/// What decides whether a limit mask is right.
struct Traits {
    valence: Vec<u32>,
    restless: Vec<bool>,
}

impl Traits {
    fn of(level: &Level) -> Self {
        let finite = |s: f32| s > 0.0 && s < INFINITE_SHARPNESS;
        let mut restless: Vec<bool> = level.vertex_sharpness.iter().map(|&s| finite(s)).collect();
        let mut valence = vec![0; level.vertex_count()];
        for face in 0..level.face_count() {
            let corners = level.corners(face);
            for i in corners.clone() {
                let [vertex, next] = [i, if i + 1 == corners.end { corners.start } else { i + 1 }]
                    .map(|i| level.face_vertices[i] as usize);
                valence[vertex] += 1;
                if finite(level.edge_sharpness[level.face_edges[i] as usize]) {
                    restless[vertex] = true;
                    restless[next] = true;
                }
            }
        }
        Self { valence, restless }
    }

    /// Measured on 3.5.0; see docs/ARCHITECTURE.md.
    fn known_wrong(&self, level: &Level, vertex: usize) -> Option<&'static str> {
        match level.vertex_rules[vertex] {
            _ if self.restless[vertex] => Some("limit masks ignore finite sharpness"),
            Rule::Dart => Some("limit mask of infinitely sharp darts"),
            Rule::Smooth if self.valence[vertex] == 2 => Some("limit mask of interior valence 2"),
            _ => None,
        }
    }
}

/// One place for each vertex of the last level that has a surface.
fn locations(levels: &[Level]) -> Vec<(usize, Sample)> {
    let mut found = vec![None; levels.last().map_or(0, Level::vertex_count)];
    let mut ptex = 0;
    for face in 0..levels[0].face_count() {
        let corners = levels[0].corners(face);
        if corners.len() == 4 {
            descend(levels, 0, face, Sample { face: ptex, u: 0.0, v: 0.0 }, 1.0, &mut found);
            ptex += 1;
            continue;
        }
        for i in corners {
            let child = levels[0].face_children[i] as usize;
            descend(levels, 1, child, Sample { face: ptex, u: 0.0, v: 0.0 }, 1.0, &mut found);
            ptex += 1;
        }
    }
    found.into_iter().enumerate().filter_map(|(vertex, place)| Some((vertex, place?))).collect()
}

fn descend(levels: &[Level], level: usize, face: usize, at: Sample, size: f64, found: &mut [Option<Sample>]) {
    const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let topology = &levels[level];
    if topology.face_holes[face] != 0 {
        return;
    }
    for (i, [du, dv]) in topology.corners(face).zip(CORNERS) {
        if level + 1 == levels.len() {
            let place = Sample { u: at.u + du * size, v: at.v + dv * size, ..at };
            found[topology.face_vertices[i] as usize].get_or_insert(place);
        } else {
            let half = size / 2.0;
            let origin = Sample { u: at.u + du * half, v: at.v + dv * half, ..at };
            descend(levels, level + 1, topology.face_children[i] as usize, origin, half, found);
        }
    }
}
