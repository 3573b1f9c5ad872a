//! What several tests need.
#![allow(dead_code, reason = "each test program uses its part")]

use catoptric::mesh::{self, SubdivMesh};
use catoptric::patch::Neighbour;
use catoptric::stam::{Jet, LimitSurface};
use glam::DVec3;
use std::path::Path;

/// The project's own meshes and the sample.
pub fn meshes() -> Vec<SubdivMesh> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .expect("the test meshes are there")
        .map(|entry| entry.expect("a readable entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "obj"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 60, "test meshes are missing");
    let mut meshes: Vec<_> = paths.iter().map(|path| mesh::read(path).expect("a test mesh is valid")).collect();
    meshes.push(mesh::sample());
    meshes
}

/// The valid meshes of the corpus; none where it is not beside the project.
pub fn corpus() -> Vec<SubdivMesh> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes");
    let inside = |path: &Path| std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<_> = inside(&folder).flat_map(|path| inside(&path).collect::<Vec<_>>()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "obj"));
    paths.sort();
    paths.iter().filter_map(|path| mesh::read(path).ok()).collect()
}

/// Angle in degrees, exact for small ones.
pub fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// A face and its mirror image: closed, four vertices of valence 2. Its surface folds along the edges: every control edge
/// is a line without a tangent plane, so it is none of [`meshes`].
pub fn pillow() -> SubdivMesh {
    SubdivMesh {
        name: "pillow".into(),
        points: vec![
            DVec3::new(0.05, 0.04, 0.08),
            DVec3::new(2.05, 0.06, 0.26),
            DVec3::new(2.04, 1.93, -0.05),
            DVec3::new(0.04, 1.94, 0.28),
        ],
        face_sizes: vec![4, 4],
        face_vertices: vec![0, 1, 2, 3, 3, 2, 1, 0],
        ..SubdivMesh::default()
    }
}

/// Local parameters of the point `t` of a patch's edge.
pub fn on_edge(edge: u8, t: f64) -> [f64; 2] {
    [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][usize::from(edge)]
}

/// A point on an edge between two patches, evaluated on both sides.
pub struct Shared {
    pub patch: usize,
    pub edge: u8,
    pub t: f64,
    pub neighbour: Neighbour,
    pub here: Jet,
    pub there: Jet,
}

/// Points at `parts` of every piece of edge that two patches share.
pub fn shared_points(surface: &LimitSurface, parts: &[f64]) -> Vec<Shared> {
    let adjacency = surface.adjacency();
    let mut points = Vec::new();
    for (patch, edge) in (0..surface.patches().len()).flat_map(|patch| (0..4).map(move |edge| (patch, edge))) {
        for &neighbour in adjacency.across(patch, edge) {
            for part in parts {
                let t = neighbour.own[0] + part * (neighbour.own[1] - neighbour.own[0]);
                let own = on_edge(edge, t);
                let here = surface.evaluate(patch, own);
                let there = surface.evaluate(neighbour.patch as usize, neighbour.carry(edge, own));
                points.push(Shared { patch, edge, t, neighbour, here, there });
            }
        }
    }
    points
}
