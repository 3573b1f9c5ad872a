//! The built-in sample has the features that it promises, and is sound as a mesh.

use catoptric::mesh::{Boundary, SubdivMesh, sample};
use std::collections::{BTreeMap, BTreeSet};

const INFINITE: f32 = 10.0;

/// Topology of a mesh, from nothing but its faces.
struct Topology {
    faces: Vec<Vec<u32>>,
    /// Number of faces on each side of each edge (smaller vertex first): one way round and the other.
    edges: BTreeMap<(u32, u32), [usize; 2]>,
    neighbours: Vec<BTreeSet<u32>>,
    boundary: BTreeSet<u32>,
}

impl Topology {
    fn new(mesh: &SubdivMesh) -> Self {
        let mut rest = mesh.face_vertices.as_slice();
        let mut faces = Vec::new();
        for &size in &mesh.face_sizes {
            let (face, tail) = rest.split_at(size as usize);
            faces.push(face.to_vec());
            rest = tail;
        }
        assert!(rest.is_empty());
        let mut edges: BTreeMap<_, [usize; 2]> = BTreeMap::new();
        let mut neighbours = vec![BTreeSet::new(); mesh.points.len()];
        for face in &faces {
            for (k, &a) in face.iter().enumerate() {
                let b = face[(k + 1) % face.len()];
                edges.entry((a.min(b), a.max(b))).or_default()[usize::from(a > b)] += 1;
                neighbours[a as usize].insert(b);
                neighbours[b as usize].insert(a);
            }
        }
        let boundary =
            edges.iter().filter(|(_, s)| s[0] + s[1] == 1).flat_map(|(&(a, b), _)| [a, b]).collect::<BTreeSet<_>>();
        Self { faces, edges, neighbours, boundary }
    }

    /// Interior vertices of each valence.
    fn valences(&self) -> BTreeMap<usize, usize> {
        let mut histogram = BTreeMap::new();
        for (v, around) in self.neighbours.iter().enumerate() {
            if !self.boundary.contains(&(v as u32)) {
                *histogram.entry(around.len()).or_default() += 1;
            }
        }
        histogram
    }
}

/// Interior vertices that exactly one crease edge touches, with the sharpness of that edge: darts.
fn darts(mesh: &SubdivMesh, topology: &Topology) -> Vec<(u32, f32)> {
    let mut touching: BTreeMap<u32, Vec<f32>> = BTreeMap::new();
    for crease in &mesh.creases {
        for v in crease.vertices {
            touching.entry(v).or_default().push(crease.sharpness);
        }
    }
    touching
        .into_iter()
        .filter(|(v, sharp)| sharp.len() == 1 && !topology.boundary.contains(v))
        .map(|(v, sharp)| (v, sharp[0]))
        .collect()
}

#[test]
fn the_faces_form_one_oriented_disc() {
    let mesh = sample();
    let topology = Topology::new(&mesh);
    assert_eq!(mesh.name, "sample");
    assert!((200..=500).contains(&topology.faces.len()), "{} faces", topology.faces.len());
    for face in &topology.faces {
        assert_eq!(face.iter().collect::<BTreeSet<_>>().len(), face.len(), "a vertex twice in {face:?}");
    }
    for (edge, sides) in &topology.edges {
        assert!(sides[0] <= 1 && sides[1] <= 1, "edge {edge:?} has {sides:?} faces, by direction");
    }
    let euler = mesh.points.len() as i64 - topology.edges.len() as i64 + topology.faces.len() as i64;
    assert_eq!(euler, 1);
    // With one boundary loop, no boundary vertex is touched twice.
    let loops = topology.edges.values().filter(|s| s[0] + s[1] == 1).count();
    assert_eq!(loops, topology.boundary.len());
    assert!(topology.neighbours.iter().all(|n| !n.is_empty()), "unused vertex");
}

#[test]
fn every_vertex_is_one_fan_of_faces() {
    let topology = Topology::new(&sample());
    for v in 0..topology.neighbours.len() as u32 {
        let fan: Vec<_> = topology.faces.iter().filter(|f| f.contains(&v)).collect();
        let spokes = topology.neighbours[v as usize].len();
        assert_eq!(spokes, fan.len() + usize::from(topology.boundary.contains(&v)), "vertex {v}");
    }
}

#[test]
fn faces_look_outwards() {
    let mesh = sample();
    let topology = Topology::new(&mesh);
    let point = |v: u32| mesh.points[v as usize];
    let (mut area, mut seen) = (0.0, 0.0);
    for face in &topology.faces {
        let normal = (point(face[2]) - point(face[0])).cross(point(face[3]) - point(face[1]));
        assert!(normal.length() > 1e-6, "{face:?} has no area");
        area += normal.length();
        seen += normal.dot(glam::DVec3::new(0.0, 0.8, 0.6));
    }
    // The faces turn the same way (tested above), so one sum tells which: outwards (y) and upwards (z).
    assert!(seen > 0.7 * area, "{seen} of {area}");
}

#[test]
fn it_has_poles_and_an_n_gon() {
    let topology = Topology::new(&sample());
    let valences = topology.valences();
    assert!(valences[&3] >= 1 && valences[&5] >= 1, "{valences:?}");
    assert!(valences.keys().any(|n| *n >= 6), "{valences:?}");
    assert!(!valences.contains_key(&2), "{valences:?}");
    let n_gons = topology.faces.iter().filter(|f| f.len() != 4).count();
    assert_eq!(n_gons, 1, "all the others are quads");
}

#[test]
fn a_semi_sharp_and_an_infinitely_sharp_crease_end_inside() {
    let mesh = sample();
    let topology = Topology::new(&mesh);
    for crease in &mesh.creases {
        let [a, b] = crease.vertices;
        assert!(topology.edges.contains_key(&(a.min(b), a.max(b))), "{crease:?} is no edge");
    }
    let darts = darts(&mesh, &topology);
    assert_eq!(darts.iter().filter(|(_, s)| *s < INFINITE).count(), 1, "{darts:?}");
    assert_eq!(darts.iter().filter(|(_, s)| *s >= INFINITE).count(), 1, "{darts:?}");
    // The semi-sharp one fades: its sharpness falls along the chain to the dart.
    let semi: Vec<f32> = mesh.creases.iter().map(|c| c.sharpness).filter(|s| *s < INFINITE).collect();
    assert!(semi.len() >= 5 && semi.is_sorted() && semi[0] < semi[semi.len() - 1], "{semi:?}");
}

#[test]
fn corners_are_where_three_sharp_edges_meet() {
    let mesh = sample();
    assert_eq!(mesh.boundary, Boundary::EdgeAndCorner);
    assert!(!mesh.corners.is_empty());
    for corner in &mesh.corners {
        let sharp = mesh.creases.iter().filter(|c| c.vertices.contains(&corner.vertex) && c.sharpness >= INFINITE);
        assert_eq!(sharp.count(), 3, "{corner:?}");
    }
}

#[test]
fn the_arch_is_round() {
    // The fold is a circle in side view, around the wheel.
    let mesh = sample();
    let lip: BTreeSet<u32> = mesh
        .creases
        .iter()
        .flat_map(|c| c.vertices)
        .filter(|&v| (mesh.points[v as usize].x - 0.60).hypot(mesh.points[v as usize].z) < 0.33)
        .collect();
    assert!(lip.len() > 20, "{}", lip.len());
    for v in lip {
        let p = mesh.points[v as usize];
        let radius = (p.x - 0.60).hypot(p.z);
        // Control points of a circle of 0.31 by 21 sections lie outside it by h^2 / (6 r) = 1.5 mm, and by 1 mm more
        // where the section leans.
        assert!((radius - 0.31).abs() < 2.5e-3, "vertex {v}: {radius}");
    }
}

#[test]
fn no_two_points_are_close_and_the_result_is_repeatable() {
    let mesh = sample();
    for (k, p) in mesh.points.iter().enumerate() {
        assert!(p.is_finite());
        for q in &mesh.points[..k] {
            assert!(p.distance(*q) > 2e-3, "{p} and {q}");
        }
    }
    assert_eq!(mesh, sample());
}
