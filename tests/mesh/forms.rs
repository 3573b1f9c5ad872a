//! The forms an OBJ can have, and what its tags say.

use catoptric::mesh::{Boundary, Corner, Crease, Creasing};
use glam::DVec3;

use crate::{QUAD, accepted, read_text, refusal};

fn crease(a: u32, b: u32, sharpness: f32) -> Crease {
    Crease { vertices: [a, b], sharpness }
}

#[test]
fn every_form_of_a_face_vertex() {
    let mesh = accepted(&format!("{QUAD}vt 0 0\nvn 0 0 1\nf 1 2/1 3//1 4/1/1\n"));
    assert_eq!(mesh.face_sizes, [4]);
    assert_eq!(mesh.face_vertices, [0, 1, 2, 3]);
    assert_eq!(mesh.points[2], DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(mesh.name, "mesh");
}

#[test]
fn everything_else_is_passed_over() {
    let text = "# by hand\nmtllib x.mtl\no one\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\n\tv   1e0 1. +0\n\n\
                g a b\nusemtl #1\ns off\nvp 1 2\nf\t1 2 3 # first\np 1\nl 1 2\ncstype bezier\nv 5 5 5\n";
    let mesh = accepted(text);
    assert_eq!((mesh.face_count(), mesh.vertex_count()), (1, 4));
    assert_eq!(mesh.points[2], DVec3::new(1.0, 1.0, 0.0));
}

#[test]
fn line_ends_continuations_and_a_byte_order_mark() {
    let plain = accepted(&format!("{QUAD}f 1 2 3 4\nt corner 1/1/0 2 3\n"));
    let dos = format!("{QUAD}f 1 2 3 4\nt corner 1/1/0 2 3").replace('\n', "\r\n");
    assert_eq!(accepted(&dos), plain);
    assert_eq!(accepted(&dos.replace("\r\n", "\r")), plain);
    assert_eq!(accepted(&format!("\u{feff}{dos}")), plain);
    let split = format!("{QUAD}f 1 \\\n2 3\\\r\n 4\nt corner 1/1/0 \\\n 2 3");
    assert_eq!(accepted(&split), plain);
}

#[test]
fn lines_are_counted_through_continuations() {
    let error = refusal(format!("{QUAD}f 1 2 \\\n3 4\nf 1 \\\n 2\n"));
    assert!(error.starts_with("mesh.obj:7: a face of size 2"), "{error}");
}

#[test]
fn latin_1_in_names_and_comments() {
    let mut text = b"# K\xf6rper\ng T\xfcr\n".to_vec();
    text.extend_from_slice(QUAD.as_bytes());
    text.extend_from_slice(b"f 1 2 3 4\n");
    assert_eq!(read_text(text).unwrap().face_count(), 1);
}

#[test]
fn faces_and_tags_before_their_vertices() {
    let text = format!("t crease 2/1/0 3 0 2.5\nt hole 1/0/0 1\nf 1 2 3 4\nf 4 3 5\n{QUAD}v 0 2 0\n");
    let mesh = accepted(&text);
    assert_eq!(mesh.creases, [crease(3, 0, 2.5)]);
    assert_eq!(mesh.holes, [1]);
}

#[test]
fn a_crease_is_a_chain_with_one_sharpness_or_one_an_edge() {
    let one = accepted(&format!("{QUAD}f 1 2 3 4\nt crease 4/1/0 0 1 2 3 4\n"));
    assert_eq!(one.creases, [crease(0, 1, 4.0), crease(1, 2, 4.0), crease(2, 3, 4.0)]);
    let each = accepted(&format!("{QUAD}f 1 2 3 4\nt crease 3/2/0 1 0 3 0.5 10\n"));
    assert_eq!(each.creases, [crease(1, 0, 0.5), crease(0, 3, 10.0)]);
}

#[test]
fn corners_share_a_sharpness_or_have_their_own() {
    let corner = |vertex, sharpness| Corner { vertex, sharpness };
    let one = accepted(&format!("{QUAD}f 1 2 3 4\nt corner 2/1/0 0 2 1.5\n"));
    assert_eq!(one.corners, [corner(0, 1.5), corner(2, 1.5)]);
    let each = accepted(&format!("{QUAD}f 1 2 3 4\nt corner 2/2/0 0 2 1 2\n"));
    assert_eq!(each.corners, [corner(0, 1.0), corner(2, 2.0)]);
}

#[test]
fn boundary_and_creasing_rules() {
    let with = |tag: &str| accepted(&format!("{QUAD}f 1 2 3 4\n{tag}\n"));
    assert_eq!(with("").boundary, Boundary::EdgeOnly);
    assert_eq!(with("t interpolateboundary 1/0/0 0").boundary, Boundary::None);
    assert_eq!(with("t interpolateboundary 1/0/0 1").boundary, Boundary::EdgeAndCorner);
    assert_eq!(with("t interpolateboundary 1/0/0 2").boundary, Boundary::EdgeOnly);
    assert_eq!(with("t interpolateboundary 0/1/0 1.0").boundary, Boundary::EdgeAndCorner);
    assert_eq!(with("").creasing, Creasing::Uniform);
    assert_eq!(with("t creasemethod 0/0/1 normal").creasing, Creasing::Uniform);
    assert_eq!(with("t creasemethod 0/0/1 uniform").creasing, Creasing::Uniform);
    assert_eq!(with("t creasemethod 0/0/1 chaikin").creasing, Creasing::Chaikin);
}

#[test]
fn tags_that_do_not_change_this_surface_are_ignored() {
    let plain = accepted(&format!("{QUAD}f 1 2 3 4\n"));
    for tag in [
        "facevaryinginterpolateboundary 1/0/0 1",
        "facevaryingpropagatecorners 1/0/0 0",
        "smoothtriangles 0/0/1 catmark",
        "hole 0/0/0",
    ] {
        assert_eq!(accepted(&format!("{QUAD}f 1 2 3 4\nt {tag}\n")), plain, "{tag}");
    }
}

#[test]
fn what_is_unusual_and_legal() {
    for (what, text) in [
        ("two sides of one sheet", "f 1 2 3 4\nf 4 3 2 1\n"),
        ("the same vertices in another order", "f 1 2 3 4\nf 1 3 2 4\n"),
        ("an edge with three faces", "v 2 2 2\nv 3 3 3\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"),
        ("vertices that no face uses", "v 9 9 9\nf 1 2 3\n"),
        ("an edge creased twice", "f 1 2 3\nt crease 2/1/0 0 1 2\nt crease 2/1/0 1 0 3\n"),
        ("nothing but holes", "f 1 2 3\nt hole 2/0/0 0 0\n"),
    ] {
        assert!(read_text(format!("{QUAD}{text}")).is_ok(), "{what}");
    }
    assert!(read_text("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n").is_ok(), "all points equal");
}
