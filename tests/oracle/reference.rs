//! Where OpenSubdiv 3.5.0 is wrong: on these meshes its limit masks and the oracle disagree, and catoptric agrees with the
//! oracle.

use super::brute;
use super::common::meshes;
use catoptric::mesh::{self, SubdivMesh};
use catoptric::osd::{Far, LimitMasks, MAX_ISOLATION, Refiner};
use catoptric::stam::LimitSurface;
use std::path::Path;

/// An infinitely sharp crease that ends at an interior vertex between two faces.
pub fn valence_2_dart() -> SubdivMesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle/meshes/valence_2_dart.obj");
    mesh::read(&path).expect("it is valid")
}

/// Its patches of isolation 10 miss the limit even away from the dart, at a dyadic point where they should be exact.
#[test]
fn far_is_wrong_beside_darts_of_valence_2() {
    let mesh = valence_2_dart();
    let surface = LimitSurface::new(&mesh).expect("it has a surface");
    let near = 0.5f64.powi(MAX_ISOLATION as i32);
    let mut descent = None;
    let (cage, cells) = brute::refined(&mesh, 1);
    // Towards (0,1) of face 8.
    for cell in cells.iter().filter(|cell| cell.ptex == 8 && cell.parameters(3) == [0.0, 1.0]) {
        descent = Some(brute::Descent::new(&cage, *cell, 3));
    }
    let mut descent = descent.expect("face 8 is there");
    (1..MAX_ISOLATION).for_each(|_| descent.step());
    let vertex = descent.cage.at(descent.cell.face, 0);
    assert_eq!(descent.cell.parameters(0), [0.0, 1.0 - near]);
    let truth = descent.offset + descent.cage.limit(vertex).expect("a regular vertex");

    let (_, jet) = surface.evaluate_ptex(8, [0.0, 1.0 - near]).expect("no hole");
    let far = Far::new(&mesh, MAX_ISOLATION).expect("it refines");
    let reference = far.evaluate(&[(8, 0.0, 1.0 - near)]).expect("it evaluates");
    let [ours, theirs] = [jet.position, reference[0].position].map(|p| p.distance(truth) / surface.diagonal());
    println!("valence_2_dart: ours {ours:.1e}, OpenSubdiv's end cap {theirs:.1e} of the diagonal");
    assert!(ours <= 1e-14 && theirs > 1e-9, "{ours:e} {theirs:e}");
}

/// (mesh, control vertex, why).
const WRONG: [(&str, usize, &str); 8] = [
    ("valence_2_interior", usize::MAX, "limit mask of interior valence 2 is that of a corner"),
    ("valence_2_crease", usize::MAX, "limit mask of interior valence 2 is that of a corner"),
    ("dart", 12, "limit mask of an infinitely sharp dart is that of a smooth vertex"),
    ("dart_3", 0, "limit mask of an infinitely sharp dart is that of a smooth vertex"),
    ("dart_5", 0, "limit mask of an infinitely sharp dart is that of a smooth vertex"),
    ("dart_8", 0, "limit mask of an infinitely sharp dart is that of a smooth vertex"),
    ("semi_sharp_crease", 12, "limit masks ignore finite sharpness"),
    ("semi_sharp_corner", 0, "limit masks ignore finite sharpness"),
];

#[test]
fn opensubdiv_is_wrong_where_we_say_so() {
    let meshes = meshes();
    for (name, vertex, why) in WRONG {
        let mesh = meshes.iter().find(|mesh| mesh.name == name).expect("the mesh is there");
        let vertex = if vertex == usize::MAX { mesh.points.len() - 1 } else { vertex };
        let surface = LimitSurface::new(mesh).expect("it has a surface");
        let (cage, cells) = brute::refined(mesh, 1);
        let refiner = Refiner::uniform(mesh, 1).expect("it is refined");
        let child = refiner.level(0).expect("level 0").vertex_children[vertex] as usize;
        let points = refiner.interpolate(&mesh.points).expect("it interpolates");
        let limits = refiner.limit(&points[mesh.points.len()..]).expect("it has limits");
        let LimitMasks::Answered { positions: masks, .. } = limits else { panic!("{name}: not asked") };

        // The oracle's cage of level 1 numbers the children of the control vertices first, in order.
        let truth = cage.settle(vertex);
        let place = cells.iter().find_map(|cell| {
            let corner = (0..4).find(|&k| cage.at(cell.face, k) == vertex)?;
            Some((cell.ptex, cell.parameters(corner)))
        });
        let (ptex, uv) = place.expect("a face has the vertex");
        let (_, jet) = surface.evaluate_ptex(ptex, uv).expect("no hole");
        let [ours, theirs] = [jet.position, masks[child]].map(|position| position.distance(truth) / surface.diagonal());
        println!("{name}: ours {ours:.1e}, OpenSubdiv {theirs:.1e} of the diagonal: {why}");
        assert!(ours <= 1e-14, "{name}: {ours:e}");
        assert!(theirs > 1e-9, "{name}: OpenSubdiv is right after all: {theirs:e}");
    }
}
