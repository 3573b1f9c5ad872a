//! On smooth closed surfaces, extrema less saddles are the Euler characteristic, wherever light and eye are (Poincare and Hopf): an
//! independent count of all stationary points. One missed or invented point changes it.

use crate::bodies::{Rng, ball, bumpy_ball, in_cube, torus};
use catoptric::mesh::{self, SubdivMesh};
use catoptric::physical::{Nature, PathEnd, stationary_points};
use catoptric::stam::LimitSurface;
use glam::DVec3;
use std::path::Path;

fn bodies() -> Vec<(SubdivMesh, i32)> {
    let read = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj");
        mesh::read(&path).expect("a test mesh is valid")
    };
    let mut bodies =
        vec![(read("cube"), 2), (read("n_gons"), 2), (read("groups_two_components"), 4), (torus(9, 6, [2.0, 0.8]), 0)];
    bodies.extend((0..12).map(|seed| (bumpy_ball(seed, 2 + seed as usize % 4, 0.9), 2)));
    bodies
}

/// A light or an eye: near, far or infinitely far.
fn end(rng: &mut Rng, middle: DVec3, diagonal: f64) -> PathEnd {
    let offset = in_cube(rng);
    match rng.below(4) {
        0 => PathEnd::Direction(offset),
        1 => PathEnd::Point(middle + offset * (20.0 * diagonal)),
        _ => PathEnd::Point(middle + offset * (1.2 * diagonal)),
    }
}

#[test]
fn extrema_less_saddles_are_the_euler_characteristic() {
    let (mut points, mut mirroring, mut most) = (0, 0, 0);
    for (k, (mesh, euler)) in bodies().into_iter().enumerate() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let [low, high] = surface.bounds().expect("it has patches");
        let (middle, diagonal) = (0.5 * (low + high), surface.diagonal());
        let mut rng = Rng::new(100 + k as u64);
        for case in 0..50 {
            let [light, eye] = [0; 2].map(|_| end(&mut rng, middle, diagonal));
            let found = stationary_points(&surface, light, eye);
            let sum: i32 = found
                .iter()
                .map(|point| match point.nature {
                    Nature::Extremum => 1,
                    Nature::Saddle => -1,
                    other => panic!("{} case {case}: {light:?} {eye:?} {other:?}", mesh.name),
                })
                .sum();
            assert_eq!(sum, euler, "{} case {case}: {light:?} {eye:?} {} points", mesh.name, found.len());
            for point in &found {
                assert!(point.residual < 1e-12, "{} case {case}: {light:?} {eye:?} {point:?}", mesh.name);
            }
            points += found.len();
            mirroring += found.iter().filter(|point| point.mirrors).count();
            most = most.max(found.len());
        }
    }
    println!("{points} points, {mirroring} of them mirror; at most {most} at a time");
    assert!(points > 3000 && most > 20);
}

/// The same answer again, in the same order.
#[test]
fn answers_are_the_same_again() {
    let surface = LimitSurface::new(&bumpy_ball(3, 4, 0.6)).expect("it has a surface");
    let ends = [DVec3::new(0.3, 2.0, 1.0), DVec3::new(2.0, 0.1, -0.4)].map(PathEnd::Point);
    let [first, second] = [0; 2].map(|_| stationary_points(&surface, ends[0], ends[1]));
    assert_eq!(first, second);
    // And with light and eye exchanged.
    let exchanged = stationary_points(&surface, ends[1], ends[0]);
    assert_eq!(first.len(), exchanged.len());
    for (a, b) in first.iter().zip(&exchanged) {
        assert!(a.position.distance(b.position) < 1e-12 && a.mirrors == b.mirrors && a.nature == b.nature);
    }
}

/// Points where patches meet, four in the middle of a side, three at a corner, are reported once.
#[test]
fn shared_points_are_one() {
    let surface = LimitSurface::new(&ball("cube", 1, |_| 1.0)).expect("it has a surface");
    // The height over a direction has a maximum, a minimum, and no saddle without two more extrema.
    let along =
        |direction: DVec3| stationary_points(&surface, PathEnd::Direction(direction), PathEnd::Direction(direction));
    for axis in DVec3::AXES {
        let found = along(axis);
        let top: Vec<_> = found.iter().filter(|point| point.normal.dot(axis).abs() > 1.0 - 1e-12).collect();
        assert_eq!(top.len(), found.len());
        assert_eq!(found.iter().filter(|point| point.position.dot(axis) > 0.0).count(), 1, "{found:?}");
    }
    // The corners of the cube: extraordinary vertices of valence 3, light and eye straight above.
    for corner in [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0)] {
        let found = along(corner);
        let at_vertex = found.iter().filter(|point| point.nature == Nature::Vertex);
        assert_eq!(at_vertex.clone().count(), 2, "{found:?}");
        for point in at_vertex {
            assert!(point.position.cross(corner.normalize()).length() < 1e-14 && point.residual < 1e-12);
        }
        assert_eq!(found.len(), 2, "{found:?}");
    }
    // The middle of an edge, which two faces share.
    let found = along(DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(found.len(), 2, "{found:?}");
}
