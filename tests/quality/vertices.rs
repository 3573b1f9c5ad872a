//! Extraordinary vertices, and a regular one to compare them with.

use crate::surfaces::grid;
use catoptric::field::{Method, Scout};
use catoptric::mesh;
use catoptric::patch::PatchKind;
use catoptric::quality::{Limits, Quality, RINGS, Reading, Ring, Spot, Vertex, Wedge, rings};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;
use std::path::Path;

fn vertices(name: &str) -> Vec<Vertex> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj");
    let mesh = mesh::read(&path).expect("a test mesh is valid");
    let surface = LimitSurface::new(&mesh).expect("it has a surface");
    let scout = Scout::new(&surface).expect("it has faces");
    let camera = scout.camera([640, 480], DVec3::Z);
    let field = scout.field(&Method::Isophote, &camera);
    let reading = Some(Reading { field: &field, camera: &camera });
    Quality::measure(&mesh, &surface, reading, &Limits::default()).vertices
}

/// The eigenvalues of Catmull & Clark's rules at a smooth vertex of n faces, the largest ones first (Ball & Storry 1988): those of the
/// Fourier modes k, and of the mode 0.
fn eigenvalues(n: usize) -> Vec<f64> {
    let mode = |k: usize, sign: f64| {
        let c = (TAU * k as f64 / n as f64).cos();
        (c + 5.0 + sign * ((c + 9.0) * (c + 1.0)).sqrt()) / 16.0
    };
    let (alpha, beta) = (1.0 - 7.0 / (4.0 * n as f64), 3.0 / (2.0 * n as f64));
    let trace = 4.0 * alpha - 1.0;
    let root = (trace * trace + 8.0 * beta - 4.0).sqrt();
    let mut values = vec![(trace + root) / 8.0, (trace - root) / 8.0];
    values.extend((1..n).flat_map(|k| [mode(k, 1.0), mode(k, -1.0)]));
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Smooth vertices of valence other than 4: a tangent plane, and no curvature. It grows or fades as the eigenvalues say.
#[test]
fn curvature_has_no_limit_at_extraordinary_vertices() {
    for n in [3, 5, 8] {
        let found = vertices(&format!("pole_{n}"));
        let [vertex] = &found[..] else { panic!("one pole: {found:?}") };
        assert_eq!((vertex.spot, vertex.kind, vertex.faces), (Spot::Vertex(0), PatchKind::Smooth, n));
        assert!(vertex.tangent_plane && vertex.rings.len() == RINGS);
        // Normals of all patches come from the same sums of points, in another order.
        assert!(vertex.angle_deg.expect("normals") < 1e-12, "{vertex:?}");
        let difference = vertex.difference().expect("a tangent plane");
        assert!(difference > 0.1, "{n}: {difference}");
        let last = vertex.rings[RINGS - 1];
        assert!(last.turn_deg.expect("a field") > 5.0, "{n}: {last:?}");
        // Second derivatives scale with the eigenvalues below lambda over its square, of which the largest wins as the radius
        // vanishes; the next one still counts at radius 2^-8.
        let values = eigenvalues(n);
        let lambda = values[0];
        assert_eq!(lambda, values[1].max(lambda));
        let mut below: Vec<f64> = values.into_iter().filter(|value| value / lambda < 1.0 - 1e-9).collect();
        below.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let [fast, slow] = [below[0], below[1]].map(|value| value / (lambda * lambda));
        let growth = vertex.growth.expect("it is curved");
        assert!(slow * 0.99 < growth && growth < fast * 1.01, "{n}: {growth}, not from {slow} to {fast}");
        assert_eq!(growth > 1.0, n > 4);
    }
}

/// A regular vertex has a curvature, so what differs on a ring vanishes with its radius.
#[test]
fn at_a_regular_vertex_differences_vanish_with_the_radius() {
    let bumps = |i: f64, j: f64| dvec3(i, j, 0.3 * (1.1 * i + 0.3).sin() * (0.9 * j).cos() + 0.05 * i * j);
    let mesh = grid([7, 7], bumps);
    let surface = LimitSurface::new(&mesh).expect("it has a surface");
    // Patches are faces, in rows of 6: round the vertex (3, 3).
    let wedges = [(21, 0), (20, 1), (14, 2), (15, 3)].map(|(patch, corner)| Wedge { patch, corner });
    let scout = Scout::new(&surface).expect("it has faces");
    let camera = scout.camera([640, 480], DVec3::Z);
    let field = scout.field(&Method::Isophote, &camera);
    let rings = rings(&surface, &wedges, Some(Reading { field: &field, camera: &camera }), 10.0);
    assert_eq!(rings.len(), RINGS);
    for pair in rings[3..].windows(2) {
        let ratio = |of: &dyn Fn(&Ring) -> f64| of(&pair[1]) / of(&pair[0]);
        let (spread, turn) = (ratio(&|ring| ring.spread), ratio(&|ring| ring.turn_deg.expect("a field")));
        // Linear in the radius, and a part that is linear in it again: some 2^-4 at the fourth ring.
        assert!((spread - 0.5).abs() < 0.06 && (turn - 0.5).abs() < 0.06, "{spread} {turn}");
        assert!((pair[1].curvature / pair[0].curvature - 1.0).abs() < 0.06);
        assert_eq!(pair[1].radius, 0.5 * pair[0].radius);
    }
    // Below the limit of 2 %, at which extraordinary vertices are far above it.
    assert!(rings[RINGS - 1].spread < 0.02, "{rings:?}");
}

/// Sectors stand apart, whatever their rule, and say where there is no tangent plane.
#[test]
fn sectors_are_judged_one_by_one() {
    let faces = |name: &str| -> Vec<(PatchKind, usize, bool)> {
        vertices(name).iter().map(|vertex| (vertex.kind, vertex.faces, vertex.tangent_plane)).collect()
    };
    let crease = PatchKind::Crease;
    assert_eq!(faces("crease_sectors_1_3"), [(crease, 1, true), (crease, 3, true)]);
    assert_eq!(faces("crease_sectors_2_4"), [(crease, 4, true)]);
    assert_eq!(faces("crease_sectors_5_6"), [(crease, 5, false), (crease, 6, false)]);
    assert_eq!(faces("dart_5"), [(PatchKind::Dart, 5, true)]);
    assert_eq!(faces("cone"), [(PatchKind::Corner, 5, false)]);
    // One sector at the end of the crease, whichever of its faces have a surface.
    let dart = PatchKind::Dart;
    assert_eq!(faces("boundary_none_crease"), [(dart, 2, true), (dart, 2, true)]);
    let [cone] = &vertices("cone")[..] else { panic!("one vertex") };
    assert!(cone.angle_deg.expect("normals") > 10.0 && cone.difference().is_none(), "{cone:?}");
    // Where normals agree at the vertex itself, that is no tangent plane; unless the sheet is flat.
    for vertex in vertices("crease_sectors_5_6") {
        assert!(vertex.angle_deg.expect("normals") < 1e-9, "{vertex:?}");
        assert_eq!(vertex.ratios(&Limits::default())[1].1, f64::INFINITY);
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/boundary_corner_3.obj");
    let mut mesh = mesh::read(&path).expect("a test mesh is valid");
    mesh.points.iter_mut().for_each(|point| point.z = 0.0);
    let surface = LimitSurface::new(&mesh).expect("it has a surface");
    let quality = Quality::measure(&mesh, &surface, None, &Limits::default());
    assert!(quality.vertices.iter().any(|vertex| !vertex.tangent_plane && vertex.kind == PatchKind::Corner));
    let ranked = quality.ranked(&Limits::default());
    assert!(!ranked.is_empty() && ranked.iter().all(|ranked| !ranked.is_over()), "{:?}", ranked[0].ratios);
    let hexagon = vertices("ngon_at_crease");
    assert!(hexagon.iter().any(|vertex| matches!(vertex.spot, Spot::Centre(_)) && vertex.faces == 6));
}
