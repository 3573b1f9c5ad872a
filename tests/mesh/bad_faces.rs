//! Faces that cannot be part of a surface: left out as holes, with a note; refused by strict reading.

use std::ops::Range;

use catoptric::mesh::{BadFace, Fault, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::DVec3;

use crate::{QUAD, accepted, read_strictly, read_text, refusal};

const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";

/// The faces of the cube, the first one as it is given.
fn cube(first: &str, more: &str) -> String {
    format!("{CUBE}{first}\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n{more}")
}

fn bad(face: u32, fault: Fault) -> BadFace {
    BadFace { face, fault, creases: 0 }
}

/// The mesh has the surface that `without` has, whose ptex faces `gone` are not there: to the last bit, at other faces.
fn assert_same_surface(mesh: &SubdivMesh, without: &SubdivMesh, gone: Range<u32>) {
    mesh.validate().unwrap();
    assert_eq!(mesh.bounds(), without.bounds());
    let [one, other] = [mesh, without].map(|mesh| LimitSurface::new(mesh).unwrap());
    let mut compared = 0;
    for face in 0..one.ptex_count() as u32 {
        for uv in [[0.25, 0.5], [0.0, 0.0], [1.0, 0.125]] {
            let here = one.evaluate_ptex(face, uv).map(|(_, jet)| jet);
            if gone.contains(&face) {
                assert!(here.is_none(), "a hole");
                continue;
            }
            let before = if face < gone.start { 0 } else { gone.len() as u32 };
            let there = other.evaluate_ptex(face - before, uv).map(|(_, jet)| jet);
            let [here, there] = [here, there].map(|jet| jet.map(|jet| (jet.position, jet.du, jet.dv, jet.normal)));
            assert_eq!(here, there, "face {face}");
            compared += 1;
        }
    }
    assert!(compared > 0);
}

#[test]
fn a_collapsed_face_is_a_hole_of_its_own() {
    let text = cube("f 4 3 3 1", "");
    let mesh = accepted(&text);
    assert_eq!(mesh.bad_faces, [bad(0, Fault::RepeatedVertex { vertex: 2 })]);
    assert_eq!((mesh.face_count(), mesh.ptex_count(), &mesh.holes[..]), (6, 6, &[0][..]));
    assert_eq!(mesh.face_vertices[..8], [8, 9, 10, 11, 4, 5, 6, 7]);
    let corners = [3, 2, 2, 0].map(|vertex| mesh.points[vertex]);
    assert_eq!(mesh.points[8..], corners);
    let [note] = &mesh.notes[..] else { panic!("{:?}", mesh.notes) };
    let start = note.find("mesh.obj").unwrap();
    assert!(note.starts_with("1 of 6 faces is left out of the surface, as a hole; "), "{note}");
    assert_eq!(&note[start..], "mesh.obj:9: a face with vertex 3 twice; name each vertex of a face once");
    assert_eq!(refusal(&text), note[start..]);
    let without = text.replace("f 4 3 3 1\n", "");
    assert_same_surface(&mesh, &accepted(&without), 0..1);
}

#[test]
fn faces_of_less_than_three_vertices() {
    for (face, size) in [("f", 0), ("f 2", 1), ("f 2 7", 2)] {
        let text = cube("f 4 3 2 1", &format!("{face}\n"));
        let mesh = accepted(&text);
        assert_eq!(mesh.bad_faces, [bad(6, Fault::TooSmall { size })]);
        assert_eq!((mesh.face_sizes[6], mesh.points.len()), (3, 11));
        assert_same_surface(&mesh, &accepted(&text.replace(&format!("{face}\n"), "")), 6..9);
        assert!(refusal(&text).starts_with(&format!("mesh.obj:15: a face of size {size};")));
    }
}

#[test]
fn the_first_of_equal_faces_stays() {
    let text = cube("f 4 3 2 1", "f 6 7 8 5\nf 1 2 6 5\nf 2 6 5 1\nf 5 6 2 1\n");
    let mesh = accepted(&text);
    let copies = [(6, 1), (7, 2), (8, 2)].map(|(face, original)| bad(face, Fault::Duplicate { original }));
    assert_eq!(mesh.bad_faces, copies);
    // A face that runs the other way is another one.
    assert_eq!((mesh.face_count(), &mesh.face_vertices[36..]), (10, &[4, 5, 1, 0][..]));
    let note = &mesh.notes[0];
    assert!(note.starts_with("3 of 10 faces are left out of the surface, as holes; the first: "), "{note}");
    assert!(note.ends_with("mesh.obj:15: the same face as line 10; delete one of the two"), "{note}");
}

#[test]
fn a_bad_face_that_is_there_twice_is_bad_twice() {
    let mesh = accepted(&cube("f 4 3 3 1", "f 4 3 3 1\n"));
    let vertex = Fault::RepeatedVertex { vertex: 2 };
    assert_eq!(mesh.bad_faces, [bad(0, vertex), bad(6, vertex)]);
    mesh.validate().unwrap();
}

#[test]
fn a_mesh_without_any_other_face_is_refused() {
    for text in [format!("{QUAD}f 1 2 2 3\n"), format!("{QUAD}f 1 2\nf 1 2 2\n")] {
        let [lenient, strict] = [read_text(&text), read_strictly(&text)].map(|read| read.unwrap_err().to_string());
        let ends = [lenient, strict].map(|message| message.rsplit_once("mesh.obj").unwrap().1.to_owned());
        assert!(ends[0].starts_with(":5: ") && ends[0] == ends[1], "{ends:?}");
    }
}

#[test]
fn what_else_is_wrong_is_refused_all_the_same() {
    for (more, expected) in [
        ("f 1 2 99\n", "mesh.obj:15: a face with vertex 99, but"),
        ("f 1 99 99\n", "mesh.obj:15: a face with vertex 99, but the mesh has only 1 to 8"),
        // The vertices that the bad face gets are in nobody's reach.
        ("f 1 2 9\n", "mesh.obj:15: a face with vertex 9, but the mesh has only 1 to 8"),
        ("t crease 2/1/0 8 9 1\n", "mesh.obj:15: a crease with vertex 8, but the mesh has only 0 to 7"),
        ("t corner 1/1/0 8 1\n", "mesh.obj:15: a corner at vertex 8, but the mesh has only 0 to 7"),
        ("t crease 2/1/0 0 6 1\n", "mesh.obj:15: a crease from vertex 0 to 6, but no face has that edge"),
        ("t crease 2/1/0 2 2 1\n", "mesh.obj:15: a crease from vertex 2 to itself"),
        ("t hole 1/0/0 6\n", "mesh.obj:15: a hole at face 6"),
    ] {
        let message = read_text(cube("f 4 3 3 1", more)).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

/// Of the collapsed face 4 3 3 1, no other face has the edge from 3 to 1.
#[test]
fn creases_go_with_the_edges_that_only_bad_faces_have() {
    let text = |last: &str| {
        let tags = ["0 1 2", "2 0 3", "0 2 4", "3 0 5", format!("4 0 {last}").as_str()]
            .map(|tag| format!("t crease 2/1/0 {tag}\n"));
        cube("f 4 3 3 1", &tags.concat())
    };
    let message = read_text(text("-1")).unwrap_err().to_string();
    assert!(message.contains("mesh.obj:19: sharpness -1 is negative"), "lines stay with their creases: {message}");
    let mesh = accepted(&text("1"));
    let kept: Vec<f32> = mesh.creases.iter().map(|crease| crease.sharpness).collect();
    assert_eq!((&kept[..], mesh.bad_faces[0].creases), (&[2.0, 5.0, 1.0][..], 2));
    let with = "is left out of the surface, as a hole, with 2 creases on edges that no other face has; ";
    assert!(mesh.notes[0].contains(with), "{}", mesh.notes[0]);
    assert!(LimitSurface::new(&mesh).is_ok());
}

/// Vertices that only a bad face has: they may be sharp, and lie anywhere, without a change to the surface.
#[test]
fn what_only_a_bad_face_has_changes_nothing() {
    let text = cube("f 4 3 2 1", "v 50 60 70\nf 9 9 1\nt corner 1/1/0 8 3\n");
    let mesh = accepted(&text);
    assert_eq!(mesh.bounds(), Some((DVec3::splat(-1.0), DVec3::ONE)));
    assert_same_surface(&mesh, &accepted(&text.replace("f 9 9 1\n", "")), 6..9);
}

/// Numbers of ptex faces are the file's: a hexagon takes six, collapsed or not.
#[test]
fn n_gons_keep_their_ptex_faces() {
    let mesh = accepted(&format!("{QUAD}v 2 0 0\nv 2 1 0\nf 1 2 5 6 3 3\nf 1 2 3 4\n"));
    assert_eq!((mesh.ptex_count(), mesh.face_sizes[0]), (7, 6));
    let surface = LimitSurface::new(&mesh).unwrap();
    assert!((0..6).all(|face| surface.evaluate_ptex(face, [0.5; 2]).is_none()));
    assert!(surface.evaluate_ptex(6, [0.5; 2]).is_some());
}

#[test]
fn every_scheme_leaves_them_out() {
    let triangles = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    for (scheme, bad) in [("loop", "f 1 2 2"), ("loop", "f 1 2"), ("loop", "f 1 2 2 1"), ("bilinear", "f 1 2 1 3")] {
        let mesh = accepted(&format!("{triangles}{bad}\nt scheme 0/0/1 {scheme}\n"));
        assert_eq!((&mesh.holes[..], mesh.face_count()), (&[4][..], 5), "{scheme}, {bad}");
        assert!(LimitSurface::new(&mesh).is_ok(), "{scheme}, {bad}");
    }
    // A quadrilateral that crosses itself where it is set apart: under `none` only faces with a surface must be convex.
    let mesh = accepted(&format!("{QUAD}f 1 2 3 4\nf 1 3 2 4 1\nt scheme 0/0/1 none\n"));
    assert_eq!(mesh.bad_faces, [bad(1, Fault::RepeatedVertex { vertex: 0 })]);
    assert!(LimitSurface::new(&mesh).is_ok());
}

#[test]
fn good_faces_and_spare_ones_are_told_apart() {
    let mesh = accepted(&cube("f 4 3 3 1", "f 1 2\n"));
    assert_eq!(mesh.good_faces().map(|(face, _)| face).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    let is_bad: Vec<bool> = (0..7).map(|face| mesh.is_bad_face(face)).collect();
    assert_eq!(is_bad, [true, false, false, false, false, false, true]);
}

/// As many as a scan of a broken file may have: linear in their number.
#[test]
fn many_bad_faces_take_no_longer_than_good_ones() {
    let mut text = cube("f 4 3 2 1", "t crease 2/1/0 0 1 2\n");
    for _ in 0..200_000 {
        text += "f 1 2 2 3\nf 5 6 7 8\n";
    }
    let start = std::time::Instant::now();
    let mesh = accepted(&text);
    assert_eq!(mesh.bad_faces.len(), 400_000);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}
