//! What lies across every edge of every patch.

mod common;

use catoptric::patch::PatchKind;
use catoptric::stam::LimitSurface;
use common::{Shared, angle_deg, meshes, on_edge, shared_points};

/// Both sides of an edge are the same curve, with the same normal where no infinitely sharp edge lies between.
#[test]
fn neighbours_meet_in_position_and_normal() {
    let (mut pieces, mut worst) = (0, 0.0f64);
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for Shared { patch, edge, t, neighbour, here, there } in shared_points(&surface, &[0.1, 0.5, 0.83]) {
            let place = format!("{} patch {patch} edge {edge} t {t}", mesh.name);
            assert!(here.position.distance(there.position) < 1e-14 * surface.diagonal(), "{place}");
            // Near a vertex without a tangent plane normals need not agree along its spokes.
            let plain = |patch: usize| !matches!(surface.kind(patch), PatchKind::Corner);
            if !neighbour.sharp && plain(patch) && plain(neighbour.patch as usize) {
                let turned = angle_deg(here.normal, there.normal);
                assert!(turned < 1e-7, "{place}: {turned:e} degrees");
                worst = worst.max(turned);
            }
            pieces += 1;
        }
    }
    println!("{pieces} points on shared edges; largest angle {worst:e} degrees");
    assert!(pieces > 10_000, "{pieces}");
}

/// Every edge is covered once by its neighbours, or not at all, and the relation goes both ways.
#[test]
fn neighbours_cover_their_edge_and_know_each_other() {
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let adjacency = surface.adjacency();
        let closed = mesh.name == "cube" || mesh.name == "corner" || mesh.name == "n_gons";
        for patch in 0..surface.patches().len() {
            for edge in 0..4 {
                let across = adjacency.across(patch, edge);
                assert!(!(closed && across.is_empty()), "{}: a closed mesh has no boundary", mesh.name);
                let mut end = 0.0;
                for neighbour in across {
                    assert_eq!(neighbour.own[0], end, "{} patch {patch} edge {edge}", mesh.name);
                    end = neighbour.own[1];
                    let back = adjacency.across(neighbour.patch as usize, neighbour.edge);
                    let known = back
                        .iter()
                        .any(|n| n.patch as usize == patch && n.edge == edge && n.across == 1.0 / neighbour.across);
                    assert!(known, "{} patch {patch} edge {edge}", mesh.name);
                }
                assert!(across.is_empty() || end == 1.0, "{} patch {patch} edge {edge}: {end}", mesh.name);
            }
        }
    }
}

/// Between regular patches of quads the map is the change of parameters itself: the other patch continues this one's
/// polynomial to second order, so a step of h beyond the edge is off by no more than a third derivative times h^3.
#[test]
fn carried_parameters_continue_the_surface() {
    let mut checked = 0;
    for mesh in meshes().into_iter().filter(|mesh| mesh.face_sizes.iter().all(|&n| n == 4)) {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let adjacency = surface.adjacency();
        let regular = |patch: usize| surface.kind(patch) == PatchKind::Regular;
        for patch in (0..surface.patches().len()).filter(|&patch| regular(patch)) {
            for edge in 0..4 {
                for n in adjacency.across(patch, edge).iter().filter(|n| !n.sharp && regular(n.patch as usize)) {
                    const H: f64 = 1e-5;
                    let [u, v] = on_edge(edge, 0.5 * (n.own[0] + n.own[1]));
                    let [du, dv] = [[0.0, -H], [H, 0.0], [0.0, H], [-H, 0.0]][usize::from(edge)];
                    let beyond = n.carry(edge, [u + du, v + dv]);
                    let predicted = surface.evaluate(patch, [u + du, v + dv]).position;
                    let actual = surface.evaluate(n.patch as usize, beyond).position;
                    let error = predicted.distance(actual) / surface.diagonal();
                    assert!(error < 1e-13, "{} patch {patch} edge {edge}: {error:e}", mesh.name);
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 1000, "{checked}");
}
