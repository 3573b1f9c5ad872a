//! Which faces run against their neighbours.

use crate::{accepted, manifest_path};
use catoptric::mesh::{self, Orientation, SubdivMesh};

#[path = "../common/rng.rs"]
mod rng;

/// A grid of faces, `width` by `height`, flat.
fn grid(width: u32, height: u32) -> SubdivMesh {
    let mut text = String::new();
    for k in 0..(width + 1) * (height + 1) {
        text += &format!("v {} {} 0\n", k % (width + 1), k / (width + 1));
    }
    for k in 0..width * height {
        let a = k / width * (width + 1) + k % width + 1;
        text += &format!("f {a} {} {} {}\n", a + 1, a + width + 2, a + width + 1);
    }
    accepted(&text)
}

fn flip(mesh: &mut SubdivMesh, face: usize) {
    mesh.face_vertices[4 * face..4 * face + 4].reverse();
}

#[test]
fn the_smaller_side_is_named() {
    let mut mesh = grid(5, 4);
    assert_eq!(mesh.orientation(), Orientation::default());
    for face in [7, 3] {
        flip(&mut mesh, face);
    }
    assert_eq!(mesh.orientation().reversed, [3, 7]);
    // All but these are turned: still these.
    (0..20).for_each(|face| flip(&mut mesh, face));
    assert_eq!(mesh.orientation().reversed, [3, 7]);
    // Half and half: the side without the first face.
    let mut mesh = grid(2, 1);
    flip(&mut mesh, 0);
    assert_eq!(mesh.orientation().reversed, [1]);
    let sentences = mesh.orientation().sentences(&mesh);
    let [sentence] = &sentences[..] else { panic!("{sentences:?}") };
    assert!(sentence.starts_with("1 face runs against its neighbours, face 1 (line 8): "), "{sentence}");
}

/// A component that is inside out as a whole agrees with itself.
#[test]
fn components_are_judged_one_by_one() {
    let mut two = grid(3, 3);
    let other = grid(3, 3);
    two.face_sizes.extend(&other.face_sizes);
    two.face_vertices.extend(other.face_vertices.iter().map(|vertex| vertex + 16));
    two.points.extend(&other.points);
    (9..18).for_each(|face| flip(&mut two, face));
    assert_eq!(two.orientation(), Orientation::default());
    flip(&mut two, 12);
    flip(&mut two, 2);
    assert_eq!(two.orientation().reversed, [2, 12]);
    // Holes are no neighbours: the two that are left agree.
    let mut strip = grid(3, 1);
    flip(&mut strip, 1);
    strip.holes = vec![1];
    assert_eq!(strip.orientation(), Orientation::default());
}

/// A strip of faces closed with half a turn has one side, wherever faces are flipped.
#[test]
fn a_moebius_strip_has_one_side() {
    let count = 8;
    for flipped in [None, Some(3)] {
        let mut mesh = grid(count, 1);
        let last = count + 1;
        for vertex in &mut mesh.face_vertices {
            // The vertices of the far end are those of the near one, changed over.
            *vertex = if *vertex == count {
                last
            } else if *vertex == last + count {
                0
            } else {
                *vertex
            };
        }
        flipped.into_iter().for_each(|face| flip(&mut mesh, face));
        let orientation = mesh.orientation();
        assert_eq!(orientation, Orientation { reversed: vec![], one_sided: vec![0] });
        let sentences = orientation.sentences(&mesh);
        assert!(sentences.len() == 1 && sentences[0].contains("face 0 (line 19) have one side only"), "{sentences:?}");
    }
}

/// Edges of three faces join nothing, so that the sheets there are judged apart.
#[test]
fn edges_of_three_faces_join_nothing() {
    for name in ["non_manifold_edge", "non_manifold_crease", "bow_tie", "left_handed", "n_gons"] {
        let mesh = mesh::read(&manifest_path(&format!("tests/meshes/{name}.obj"))).expect("a test mesh is valid");
        assert_eq!(mesh.orientation(), Orientation::default(), "{name}");
    }
    let mesh = mesh::read(&manifest_path("tests/meshes/torn/one_face_flipped.obj")).expect("a test mesh is valid");
    assert_eq!(mesh.orientation().reversed, [1]);
}

/// Random faces of random grids: exactly the flipped ones are named, where they are fewer than half.
#[test]
fn flipped_faces_are_found() {
    let mut rng = rng::Rng::new(1);
    for _ in 0..200 {
        let size = [0, 1].map(|_| 1 + rng.below(9) as u32);
        let mut mesh = grid(size[0], size[1]);
        let chance = 0.45 * rng.unit();
        let flipped: Vec<u32> = (0..size[0] * size[1]).filter(|_| rng.chance(chance)).collect();
        flipped.iter().for_each(|&face| flip(&mut mesh, face as usize));
        if 2 * flipped.len() < mesh.face_count() {
            assert_eq!(mesh.orientation().reversed, flipped);
        }
    }
}
