//! Degenerate but legal input: whatever the points, every answer is finite and every normal is a unit vector or zero.

#[path = "common/mod.rs"]
mod common;

use catoptric::mesh::SubdivMesh;
use catoptric::stam::LimitSurface;
use common::{meshes, pillow};
use glam::DVec3;

/// Corners, edges, the inside, and points next to (0,0) of every patch.
const PLACES: [[f64; 2]; 10] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [0.5, 0.0],
    [0.0, 0.3],
    [0.4, 0.7],
    [1e-9, 2e-9],
    [1e-15, 0.0],
    [1e-300, 1e-300],
];

/// Evaluates every patch; counts samples and normals that are zero.
fn sweep(mesh: &SubdivMesh) -> [usize; 2] {
    let surface = LimitSurface::new(mesh).unwrap_or_else(|error| panic!("{}: {error}", mesh.name));
    let mut counts = [0, 0];
    for patch in 0..surface.patches().len() {
        for uv in PLACES {
            let jet = surface.evaluate(patch, uv);
            let place = || format!("{} patch {patch} ({:?}) {uv:?}: {jet:?}", mesh.name, surface.kind(patch));
            assert!(jet.position.is_finite() && jet.du.is_finite() && jet.dv.is_finite(), "{}", place());
            let length = jet.normal.length();
            assert!(length == 0.0 || (length - 1.0).abs() < 1e-15, "{}", place());
            counts[0] += 1;
            counts[1] += usize::from(length == 0.0);
        }
    }
    counts
}

/// Sweeps every mesh with its points changed; gives the share of zero normals.
fn change(what: &str, change: impl Fn(&mut SubdivMesh)) -> f64 {
    let mut total = [0, 0];
    for mut mesh in meshes().into_iter().chain([pillow()]) {
        change(&mut mesh);
        let counts = sweep(&mesh);
        total = [0, 1].map(|k| total[k] + counts[k]);
    }
    println!("{what}: {} of {} normals are zero", total[1], total[0]);
    total[1] as f64 / total[0] as f64
}

#[test]
fn ordinary_meshes_have_hardly_any_zero_normal() {
    assert!(change("as they are", |_| ()) < 1e-3);
}

#[test]
fn zero_area_faces() {
    change("one face on a line", |mesh| {
        let size = mesh.face_sizes[0] as usize;
        let [a, b] = [0, size - 1].map(|k| mesh.points[mesh.face_vertices[k] as usize]);
        for k in 1..size - 1 {
            mesh.points[mesh.face_vertices[k] as usize] = a.lerp(b, k as f64 / size as f64);
        }
    });
    change("every other face at one point", |mesh| {
        let faces: Vec<Vec<u32>> = mesh.faces().step_by(2).map(|(_, face)| face.to_vec()).collect();
        for face in faces {
            let to = mesh.points[face[0] as usize];
            face.iter().for_each(|&v| mesh.points[v as usize] = to);
        }
    });
}

#[test]
fn zero_length_edges_and_coincident_points() {
    change("one edge of length zero", |mesh| {
        let [a, b] = [0, 1].map(|k| mesh.face_vertices[k] as usize);
        mesh.points[a] = mesh.points[b];
    });
    change("points coincide in pairs", |mesh| {
        let from = mesh.points.clone();
        mesh.points.iter_mut().zip((0..from.len()).map(|i| from[i & !1])).for_each(|(p, q)| *p = q);
    });
    change("points that round to few places", |mesh| {
        mesh.points.iter_mut().for_each(|p| *p = p.round());
    });
}

#[test]
fn all_points_at_one_place_or_on_one_line() {
    // Sums of equal points round differently, so what should be zero can be 1e-16 long, and has a direction.
    change("all points equal", |mesh| mesh.points.fill(DVec3::new(0.1, -3.7, 11.3)));
    assert_eq!(change("all points zero", |mesh| mesh.points.fill(DVec3::ZERO)), 1.0);
    change("all points on a line", |mesh| {
        mesh.points.iter_mut().for_each(|p| *p = DVec3::new(0.3, -1.1, 0.7) * p.x);
    });
    assert_eq!(change("all points on an axis", |mesh| mesh.points.iter_mut().for_each(|p| *p *= DVec3::X)), 1.0);
    change("all points in a plane", |mesh| mesh.points.iter_mut().for_each(|p| p.z = 0.0));
}

/// The surface follows its points: where rounding allows no other result, there are as few zero normals as before.
#[test]
fn huge_tiny_and_far_off_coordinates() {
    for scale in [1e17, 1e-30, 1e-150, 1e-300, 5e-324] {
        let zero = change(&format!("times {scale:e}"), |mesh| mesh.points.iter_mut().for_each(|p| *p *= scale));
        // Squares of derivatives leave the range of f64 below 1e-150.
        assert!(scale < 1e-100 || zero < 1e-3, "{scale:e}: {zero}");
    }
    for offset in [1e6, 1e12, 1e17] {
        let zero = change(&format!("moved by {offset:e}"), |mesh| {
            mesh.points.iter_mut().for_each(|p| *p += DVec3::new(offset, -0.5 * offset, 0.1 * offset));
        });
        assert!(offset > 1e6 || zero < 1e-3, "{offset:e}: {zero}");
    }
    change("flat to 1e-17", |mesh| mesh.points.iter_mut().for_each(|p| *p *= DVec3::new(1.0, 1.0, 1e-17)));
    change("one spike of 1e17", |mesh| mesh.points[0] = DVec3::new(1e17, -1e17, 1e17));
}
