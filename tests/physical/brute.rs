//! Against brute force on every mesh with boundaries, creases and poles: the smallest of |h| on a dense grid, polished.

use crate::bodies::{Rng, in_cube};
use catoptric::mesh;
use catoptric::physical::{Nature, PathEnd, stationary_points};
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::path::Path;

/// Nodes of the grid along a side of a patch.
const NODES: usize = 65;

/// The part of h along the surface, in an orthonormal frame that belongs to the patch's parameters.
fn along_surface(surface: &LimitSurface, ends: [DVec3; 2], patch: usize, uv: DVec2) -> (DVec2, DVec3) {
    let jet = surface.evaluate(patch, uv.to_array());
    let pull: DVec3 = ends.iter().map(|end| (end - jet.position).normalize()).sum();
    let first = jet.du.normalize_or_zero();
    let second = jet.normal.cross(first);
    (DVec2::new(pull.dot(first), pull.dot(second)), jet.position)
}

/// Newton's method with central differences, kept in the patch.
fn polished(surface: &LimitSurface, ends: [DVec3; 2], patch: usize, mut uv: DVec2) -> Option<DVec3> {
    let at = |uv: DVec2| along_surface(surface, ends, patch, uv);
    let inside = |uv: DVec2| uv.clamp(DVec2::ZERO, DVec2::ONE);
    for _ in 0..60 {
        let step = 1e-4 * uv.max_element().clamp(1e-9, 1.0);
        let column = |axis: DVec2| {
            let [a, b] = [inside(uv + step * axis), inside(uv - step * axis)];
            (at(a).0 - at(b).0) / (a - b).length()
        };
        let jacobian = glam::DMat2::from_cols(column(DVec2::X), column(DVec2::Y));
        let change = jacobian.inverse() * at(uv).0;
        if !change.is_finite() {
            return None;
        }
        uv = inside(uv - change.clamp_length_max((0.5 * uv.max_element()).min(2.0 / NODES as f64)));
    }
    let (rest, position) = at(uv);
    (rest.length() < 1e-9).then_some(position)
}

/// All stationary points: from every node where |h| along the surface is least among the neighbours.
fn by_force(surface: &LimitSurface, ends: [DVec3; 2]) -> Vec<DVec3> {
    let each: Vec<Vec<DVec3>> = (0..surface.patches().len())
        .into_par_iter()
        .map(|patch| {
            // Denser towards an extraordinary vertex, round which there may be as much in any ring.
            let power = if surface.class(patch).is_some() { 3 } else { 1 };
            let node = |k: usize| {
                let t = |i: usize| (i as f64 / (NODES - 1) as f64).powi(power);
                DVec2::new(t(k % NODES), t(k / NODES))
            };
            let values: Vec<f64> =
                (0..NODES * NODES).map(|k| along_surface(surface, ends, patch, node(k)).0.length()).collect();
            let is_least = |&k: &usize| {
                let near = |x: usize| x.saturating_sub(1)..=(x + 1).min(NODES - 1);
                near(k / NODES).all(|j| near(k % NODES).all(|i| values[k] <= values[NODES * j + i]))
            };
            let starts: Vec<usize> = (0..NODES * NODES).filter(is_least).collect();
            starts.into_iter().filter_map(|k| polished(surface, ends, patch, node(k))).collect()
        })
        .collect();
    let mut points: Vec<DVec3> = Vec::new();
    for position in each.into_iter().flatten() {
        if points.iter().all(|p| p.distance(position) > 1e-6 * surface.diagonal()) {
            points.push(position);
        }
    }
    points
}

#[test]
fn counts_are_those_of_brute_force() {
    let names = [
        "pole_3",
        "pole_5",
        "pole_8",
        "dart",
        "corner",
        "crease_sectors_1_3",
        "crease_sectors_5_6",
        "three_creases",
        "semi_sharp_crease",
        "boundary_pole_5",
        "ngon_sharp_edge",
        "semi_sharp_corner",
    ];
    let (mut count, mut mirroring) = (0, 0);
    for (k, name) in names.into_iter().enumerate() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj");
        let surface = LimitSurface::new(&mesh::read(&path).expect("a valid mesh")).expect("it has a surface");
        let [low, high] = surface.bounds().expect("it has patches");
        let mut rng = Rng::new(40 + k as u64);
        for case in 0..8 {
            // Above most sheets, so that they mirror.
            let middle = 0.5 * (low + high) + 0.3 * surface.diagonal() * DVec3::Z;
            let ends = [0.4, 0.6].map(|reach| middle + in_cube(&mut rng) * (reach * surface.diagonal()));
            let expected = by_force(&surface, ends);
            let found = stationary_points(&surface, PathEnd::Point(ends[0]), PathEnd::Point(ends[1]));
            let near = |a: DVec3, b: DVec3| a.distance(b) < 1e-5 * surface.diagonal();
            let missed: Vec<_> = expected.iter().filter(|p| found.iter().all(|q| !near(**p, q.position))).collect();
            let alone: Vec<_> = found.iter().filter(|q| expected.iter().all(|p| !near(*p, q.position))).collect();
            assert!(missed.is_empty() && alone.is_empty(), "{name} case {case}: missed {missed:?}, alone {alone:?}");
            assert!(found.iter().all(|point| !matches!(point.nature, Nature::Degenerate { .. })), "{found:?}");
            assert_eq!(found.len(), expected.len(), "{name} case {case}");
            count += found.len();
            mirroring += found.iter().filter(|point| point.mirrors).count();
        }
    }
    println!("{count} points, {mirroring} of them mirror");
    assert!(count > 60 && mirroring > 30);
}
