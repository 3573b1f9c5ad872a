//! Surfaces whose control points move: the same as made anew, to the last bit.

mod common;
#[path = "common/rng.rs"]
mod rng;

use catoptric::mesh::{self, Boundary, Crease, SubdivMesh};
use catoptric::stam::{LimitSurface, MoveError, MovingSurface};
use glam::DVec3;
use rng::Rng;

fn shaken(mesh: &SubdivMesh, rng: &mut Rng, by: f64) -> SubdivMesh {
    let mut shake = || DVec3::from_array(std::array::from_fn(|_| by * (rng.unit() - 0.5)));
    let points = mesh.points.iter().map(|&point| point + shake()).collect();
    SubdivMesh { points, ..mesh.clone() }
}

/// Position, derivatives and normal everywhere, as bits.
fn bits(surface: &LimitSurface) -> Vec<[u64; 12]> {
    let uvs = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [0.2, 0.7], [1e-6, 2e-7]];
    let at = |patch: usize| {
        uvs.map(|uv| {
            let jet = surface.evaluate(patch, uv);
            let numbers = [jet.position, jet.du, jet.dv, jet.normal].map(|p| p.to_array().map(f64::to_bits));
            std::array::from_fn(|k| numbers[k / 3][k % 3])
        })
    };
    (0..surface.patches().len()).flat_map(at).collect()
}

#[test]
fn moved_surfaces_are_those_made_anew() {
    let mut rng = Rng::new(3);
    let mut compared = 0;
    for mesh in common::meshes() {
        let size = mesh.diagonal();
        let mut moving = MovingSurface::new(&mesh).expect("a surface");
        let before = moving.surface().clone();
        for _ in 0..2 {
            let moved = shaken(&mesh, &mut rng, 0.3 * size);
            let anew = LimitSurface::new(&moved).expect("a surface");
            let surface = moving.move_to(&moved).expect("the same topology");
            assert_eq!((surface.diagonal(), surface.bounds()), (anew.diagonal(), anew.bounds()), "{}", mesh.name);
            let (ours, theirs) = (bits(surface), bits(&anew));
            assert!(ours == theirs, "{}", mesh.name);
            compared += ours.len();
        }
        // What was handed out before stays, and the way back leads there.
        assert!(bits(&before) == bits(&LimitSurface::new(&mesh).expect("a surface")));
        assert!(bits(moving.move_to(&mesh).expect("the same")) == bits(&before));
    }
    assert!(compared > 40_000, "only {compared} places");
}

#[test]
fn other_topologies_are_refused_by_name() {
    let mesh = mesh::sample();
    let mut moving = MovingSurface::new(&mesh).expect("a surface");
    let mut refusal = |change: &dyn Fn(&mut SubdivMesh)| {
        let mut other = mesh.clone();
        change(&mut other);
        moving.move_to(&other).map(drop).expect_err("refused").to_string()
    };
    let other = "differ, so it is another surface; give frames of one topology";
    assert_eq!(refusal(&|mesh| mesh.points.push(DVec3::ZERO)), format!("numbers of points {other}"));
    assert_eq!(refusal(&|mesh| mesh.face_vertices.swap(0, 1)), format!("faces {other}"));
    assert_eq!(refusal(&|mesh| mesh.creases[0].sharpness = 1.25), format!("creases {other}"));
    assert_eq!(
        refusal(&|mesh| mesh.creases.push(Crease { vertices: [0, 1], sharpness: 2.0 })),
        format!("creases {other}")
    );
    assert_eq!(refusal(&|mesh| mesh.corners.clear()), format!("sharp vertices {other}"));
    assert_eq!(refusal(&|mesh| mesh.holes.push(0)), format!("holes {other}"));
    assert_eq!(refusal(&|mesh| mesh.boundary = Boundary::None), format!("subdivision rules {other}"));
    assert!(refusal(&|mesh| mesh.points[7].y = f64::NAN).contains("not finite"));
    // After a refusal it is as before.
    assert!(bits(moving.surface()) == bits(&LimitSurface::new(&mesh).expect("a surface")));
    assert!(matches!(moving.move_to(&SubdivMesh::default()), Err(MoveError::Topology(_))));
}
