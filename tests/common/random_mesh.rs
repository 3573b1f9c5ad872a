//! Random meshes: one seed, one mesh, the same on every machine.

#[path = "rng.rs"]
mod rng;

use catoptric::mesh::{Boundary, Corner, Crease, Creasing, SubdivMesh};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

pub use rng::Rng;

/// Polygons under construction.
#[derive(Default)]
struct Draft {
    points: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
}

/// Quads (and sometimes triangles) in two rings round a pole, closed or open.
fn fan(rng: &mut Rng) -> Draft {
    let closed = rng.chance(0.7);
    let n = if closed { 3 + rng.below(8) } else { 1 + rng.below(6) };
    let spokes = if closed { n } else { n + 1 };
    let turn = if closed { TAU / n as f64 } else { 0.8 * TAU / n.max(3) as f64 };
    let mut points = vec![DVec3::new(0.0, 0.0, 0.3)];
    // Ring r: spokes at even places, corners of the quads between them at odd ones.
    for radius in [1.0, 2.0, 3.0] {
        for i in 0..2 * spokes - usize::from(!closed) {
            let angle = 0.5 * turn * i as f64;
            let reach = radius * if i % 2 == 0 { 1.0 } else { 1.3 };
            points.push(DVec3::new(reach * angle.cos(), reach * angle.sin(), 0.3 - 0.1 * reach * reach));
        }
    }
    let per_ring = (points.len() - 1) / 3;
    let at = |ring: usize, i: usize| (1 + (ring - 1) * per_ring + i % per_ring) as u32;
    let mut faces: Vec<Vec<u32>> = (0..n).map(|i| vec![0, at(1, 2 * i), at(1, 2 * i + 1), at(1, 2 * i + 2)]).collect();
    for ring in 1..3 {
        for i in 0..2 * n {
            let quad = [at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)];
            if rng.chance(0.1) {
                faces.push(quad[..3].to_vec());
                faces.push(vec![quad[0], quad[2], quad[3]]);
            } else {
                faces.push(quad.to_vec());
            }
        }
    }
    Draft { points, faces }
}

/// The surface of a box of cells, some of them missing: closed or with openings, never pinched on purpose.
fn boxes(rng: &mut Rng) -> Draft {
    let size = [1, 2, 3].map(|_| 1 + rng.below(3) as i32);
    let mut draft = Draft::default();
    let mut known: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    for axis in 0..3 {
        let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
        for (side, i, j) in
            [0, size[axis]].into_iter().flat_map(|s| (0..size[b]).flat_map(move |i| (0..3).map(move |j| (s, i, j))))
        {
            if j >= size[c] || rng.chance(0.06) {
                continue;
            }
            let mut face: Vec<u32> = [[0, 0], [1, 0], [1, 1], [0, 1]]
                .map(|[di, dj]| {
                    let mut at = [0; 3];
                    (at[axis], at[b], at[c]) = (side, i + di, j + dj);
                    *known.entry(at).or_insert_with(|| {
                        draft.points.push(DVec3::from_array(at.map(f64::from)));
                        draft.points.len() as u32 - 1
                    })
                })
                .to_vec();
            if side == 0 {
                face.reverse();
            }
            draft.faces.push(face);
        }
    }
    draft
}

/// A grid, some of whose quads are merged to hexagons or split to triangles.
fn grid(rng: &mut Rng) -> Draft {
    let [width, height] = [3 + rng.below(3), 3 + rng.below(2)];
    let at = |i: usize, j: usize| (j * (width + 1) + i) as u32;
    let height_at = |i: usize, j: usize| 0.3 * (i as f64 + 0.7 * j as f64).sin();
    let points = (0..(width + 1) * (height + 1))
        .map(|k| (k % (width + 1), k / (width + 1)))
        .map(|(i, j)| DVec3::new(i as f64, j as f64, height_at(i, j)));
    let points = points.collect();
    let mut faces = Vec::new();
    for j in 0..height {
        let mut i = 0;
        while i < width {
            if i + 1 < width && rng.chance(0.15) {
                faces.push(vec![
                    at(i, j),
                    at(i + 1, j),
                    at(i + 2, j),
                    at(i + 2, j + 1),
                    at(i + 1, j + 1),
                    at(i, j + 1),
                ]);
                i += 2;
                continue;
            }
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if rng.chance(0.1) {
                faces.push(quad[..3].to_vec());
                faces.push(vec![quad[0], quad[2], quad[3]]);
            } else {
                faces.push(quad.to_vec());
            }
            i += 1;
        }
    }
    Draft { points, faces }
}

/// From 0.1 to 10; finite sharpness takes as many levels, so small ones are commoner.
fn sharpness(rng: &mut Rng) -> f32 {
    match rng.below(20) {
        0..8 => 10.0,
        8..17 => (0.1 + 2.9 * rng.unit()) as f32,
        17..19 => (3.0 + 2.0 * rng.unit()) as f32,
        _ => (5.0 + 4.9 * rng.unit()) as f32,
    }
}

/// A run of edges that never meets a vertex twice, each of its own sharpness or all of one.
fn crease_run(rng: &mut Rng, neighbours: &[BTreeSet<u32>], creases: &mut Vec<Crease>) {
    let mut at = rng.below(neighbours.len()) as u32;
    let mut seen = BTreeSet::from([at]);
    let same = rng.chance(0.5);
    let mut value = sharpness(rng);
    for _ in 0..1 + rng.below(4) {
        let ways: Vec<u32> = neighbours[at as usize].iter().copied().filter(|v| !seen.contains(v)).collect();
        if ways.is_empty() {
            break;
        }
        let next = ways[rng.below(ways.len())];
        if !same {
            value = sharpness(rng);
        }
        creases.push(Crease { vertices: [at, next], sharpness: value });
        seen.insert(next);
        at = next;
    }
}

/// The mesh of a seed: a fan, a box or a grid, points jittered, features at random.
pub fn mesh(seed: u64) -> SubdivMesh {
    let mut rng = Rng::new(seed + 1);
    let Draft { mut points, faces } = match seed % 3 {
        0 => fan(&mut rng),
        1 => boxes(&mut rng),
        _ => grid(&mut rng),
    };
    points.iter_mut().for_each(|p| *p += 0.2 * (DVec3::new(rng.unit(), rng.unit(), rng.unit()) - 0.5));
    let mut neighbours = vec![BTreeSet::new(); points.len()];
    for face in &faces {
        for (k, &a) in face.iter().enumerate() {
            let b = face[(k + 1) % face.len()];
            neighbours[a as usize].insert(b);
            neighbours[b as usize].insert(a);
        }
    }
    let mut creases = Vec::new();
    (0..rng.below(4)).for_each(|_| crease_run(&mut rng, &neighbours, &mut creases));
    let corners = (0..rng.below(3))
        .map(|_| Corner { vertex: rng.below(points.len()) as u32, sharpness: sharpness(&mut rng) })
        .collect();
    let holes = if rng.chance(0.25) { vec![rng.below(faces.len()) as u32] } else { Vec::new() };
    SubdivMesh {
        name: format!("random_{seed}"),
        points,
        face_sizes: faces.iter().map(|face| face.len() as u32).collect(),
        face_vertices: faces.concat(),
        creases,
        corners,
        holes,
        boundary: [Boundary::None, Boundary::EdgeOnly, Boundary::EdgeAndCorner, Boundary::EdgeAndCorner][rng.below(4)],
        creasing: if rng.chance(0.35) { Creasing::Chaikin } else { Creasing::Uniform },
        ..SubdivMesh::default()
    }
}
