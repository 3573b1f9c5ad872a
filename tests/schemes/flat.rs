//! Schemes that leave faces where they are.

use super::{meshes, named};
use catoptric::mesh::SubdivMesh;
use catoptric::stam::LimitSurface;
use glam::DVec3;

/// The corners of each ptex face: a quad's own, or those of a quarter of a face.
fn corners(mesh: &SubdivMesh) -> Vec<[DVec3; 4]> {
    let mut all = Vec::new();
    for (_, face) in mesh.faces() {
        let size = face.len();
        let point = |k: usize| mesh.points[face[k % size] as usize];
        if size == 4 {
            all.push(std::array::from_fn(point));
            continue;
        }
        let mean = (0..size).map(point).sum::<DVec3>() / size as f64;
        let middle = |k: usize| (point(k) + point(k + 1)) / 2.0;
        all.extend((0..size).map(|k| [point(k), middle(k), mean, middle(k + size - 1)]));
    }
    all
}

/// The bilinear map of the corners, and its derivatives.
#[test]
fn every_ptex_face_is_the_bilinear_map_of_its_corners() {
    let mut compared = 0;
    for mesh in meshes().iter().filter(|mesh| mesh.scheme.is_linear()) {
        let surface = LimitSurface::new(mesh).expect("it has a surface");
        let corners = corners(mesh);
        assert_eq!((corners.len(), mesh.ptex_count()), (surface.ptex_count(), surface.ptex_count()));
        for (ptex, [a, b, c, d]) in corners.into_iter().enumerate() {
            for [u, v] in [[0.0, 0.0], [1.0, 0.0], [0.3, 0.8], [1.0, 1.0], [0.62, 0.11]] {
                let Some((_, jet)) = surface.evaluate_ptex(ptex as u32, [u, v]) else {
                    assert!(mesh.holes.contains(&(ptex as u32)), "{} ptex {ptex}", mesh.name);
                    continue;
                };
                let expected = [a.lerp(b, u).lerp(d.lerp(c, u), v), (b - a).lerp(c - d, v), (d - a).lerp(c - b, u)];
                for (found, expected) in [jet.position, jet.du, jet.dv].into_iter().zip(expected) {
                    assert!(found.distance(expected) < 1e-15 * mesh.diagonal(), "{} {ptex}", mesh.name);
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 100, "{compared}");
}

/// Convex faces in a plane are covered as they are: every normal is the plane's, and the areas add up.
#[test]
fn plane_polygons_are_covered_exactly() {
    const GRID: usize = 8;
    let mesh = named("none");
    let surface = LimitSurface::new(&mesh).expect("it has a surface");
    let mut ptex = 0;
    for (_, face) in mesh.faces() {
        let point = |k: usize| mesh.points[face[k % face.len()] as usize];
        let double = (0..face.len()).map(|k| point(k).cross(point(k + 1))).sum::<DVec3>();
        let mut area = 0.0;
        for quadrant in 0..face.len() {
            for cell in 0..GRID * GRID {
                // The density is linear in u and in v: the midpoint rule is exact.
                let uv = [cell % GRID, cell / GRID].map(|k| (k as f64 + 0.5) / GRID as f64);
                let (_, jet) = surface.evaluate_ptex((ptex + quadrant) as u32, uv).expect("no hole");
                assert!(jet.normal.distance(double.normalize()) < 1e-14);
                area += jet.du.cross(jet.dv).length() / (GRID * GRID) as f64;
            }
        }
        assert!((area - double.length() / 2.0).abs() < 1e-13, "{area} {double}");
        ptex += face.len();
    }
}

/// Every line between ptex faces is a crease.
#[test]
fn faces_meet_in_creases() {
    let surface = LimitSurface::new(&named("bilinear_n_gons")).expect("it has a surface");
    let adjacency = surface.adjacency();
    let edges = (0..surface.patches().len()).flat_map(|patch| (0..4).map(move |edge| (patch, edge)));
    let neighbours: Vec<_> = edges.flat_map(|(patch, edge)| adjacency.across(patch, edge)).collect();
    assert!(neighbours.len() > 50 && neighbours.iter().all(|neighbour| neighbour.sharp));
}
