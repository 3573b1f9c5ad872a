//! Faces that cannot be part of a surface, in stages: holes of their own part, at every time, in every instance.

use std::fs;
use std::path::Path;

use catoptric::mesh::{self, Choice, Fault, MeshError, SubdivMesh};
use catoptric::stam::{LimitSurface, MovingSurface};

use crate::{HEADER, SQUARE, accepted, prim, read_text, refusal};

const POINTS: &str =
    "[(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]";

/// A cube whose first face has the vertices 3 2 2 0.
fn cube(points: &str) -> String {
    format!(
        "{points}\n    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]\n    \
         int[] faceVertexIndices = [3, 2, 2, 0, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7]\n"
    )
}

fn still() -> String {
    cube(&format!("point3f[] points = {POINTS}"))
}

const TWICE: &str = "a face with vertex 2 twice; name each vertex of a face once";

fn strictly(text: &str) -> Result<SubdivMesh, MeshError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.usda");
    fs::write(&path, format!("{HEADER}{text}")).expect("a temporary file");
    mesh::read_choice(&path, &Choice { strict: true, ..Choice::default() })
}

fn holes(mesh: &SubdivMesh) -> Vec<bool> {
    let surface = LimitSurface::new(mesh).expect("it has a surface");
    (0..surface.ptex_count() as u32).map(|face| surface.evaluate_ptex(face, [0.5; 2]).is_none()).collect()
}

#[test]
fn each_part_has_its_own() {
    let text = prim("a", &still()) + &prim("b", SQUARE) + &prim("c", &still());
    let mesh = accepted(&text);
    let parts: Vec<_> = mesh.parts.iter().map(|part| (part.faces.clone(), part.points.clone())).collect();
    assert_eq!(parts, [(0..6, 0..12), (6..7, 12..16), (7..13, 16..28)]);
    let bad: Vec<_> = mesh.bad_faces.iter().map(|bad| (bad.face, bad.fault)).collect();
    assert_eq!(bad, [0, 7].map(|face| (face, Fault::RepeatedVertex { vertex: 2 })));
    assert_eq!((&mesh.holes[..], &mesh.face_vertices[..4]), (&[0, 7][..], &[8, 9, 10, 11][..]));
    let [note] = &mesh.notes[..] else { panic!("{:?}", mesh.notes) };
    assert!(note.starts_with("2 of 13 faces are left out of the surface, as holes; the first: "), "{note}");
    assert!(note.ends_with(&format!("mesh.usda: /a, face 0: {TWICE}")), "{note}");
    assert_eq!(holes(&mesh), (0..13).map(|face| [0, 7].contains(&face)).collect::<Vec<_>>());
    // The third is the first in the same place: they share patches.
    assert_eq!(mesh.parts[2].repeats.map(|repeat| repeat.part), Some(0));
    let message = strictly(&(prim("b", SQUARE) + &prim("a", &still()))).expect_err("a strict reader").to_string();
    assert!(message.ends_with(&format!("mesh.usda: /a, face 0: {TWICE}")), "{message}");
}

#[test]
fn the_rule_of_the_boundary_is_that_of_the_good_faces() {
    // A closed cube with a face twice has no boundary, so the other mesh alone says the rule.
    let closed = still().replace("3, 2, 2, 0", "3, 2, 1, 0").replace("4, 4, 4, 4, 4, 4]", "4, 4, 4, 4, 4, 4, 4]");
    let closed = closed.replace("3, 0, 4, 7]", "3, 0, 4, 7, 0, 4, 7, 3]");
    let square = format!("{SQUARE}token interpolateBoundary = \"none\"");
    let mesh = accepted(&(prim("a", &closed) + &prim("b", &square)));
    assert_eq!(mesh.bad_faces.len(), 1);
    assert_eq!(mesh.boundary, catoptric::mesh::Boundary::None);
    // Under two rules vertices with one face become sharp; those of bad faces do not.
    let square = format!("{SQUARE}token interpolateBoundary = \"edgeOnly\"");
    let mesh = accepted(&(prim("a", &still()) + &prim("b", &square)));
    assert!(mesh.corners.iter().all(|corner| !(8..12).contains(&corner.vertex)), "{:?}", mesh.corners);
}

#[test]
fn a_prim_without_any_other_face_is_all_holes() {
    let alone = SQUARE.replace("[0, 1, 2, 3]", "[0, 1, 1, 3]");
    let expected = "mesh.usda: /a, face 0: a face with vertex 1 twice; name each vertex of a face once";
    assert_eq!(refusal(&prim("a", &alone)), expected);
    let mesh = accepted(&(prim("a", &alone) + &prim("b", SQUARE)));
    assert_eq!((holes(&mesh), mesh.notes.len()), (vec![true, false], 1));
}

#[test]
fn instances_have_it_each() {
    let text = format!(
        "def PointInstancer \"p\"\n{{\n{}rel prototypes = [</p/m>]\nint[] protoIndices = [0, 0]\n\
         point3f[] positions = [(0, 0, 0), (5, 0, 0)]\n}}\n",
        prim("m", &still())
    );
    let mesh = accepted(&text);
    assert_eq!((mesh.parts.len(), mesh.bad_faces.len()), (2, 2));
    assert_eq!(mesh.parts[1].repeats.map(|repeat| repeat.part), Some(0));
    assert_eq!(holes(&mesh).iter().filter(|&&hole| hole).count(), 2);
}

/// Points move, the topology stays: the vertices of the bad face move with those that it names.
#[test]
fn moving_meshes_keep_it() {
    let moved = POINTS.replace("-1)", "-3)");
    let text = cube(&format!("point3f[] points.timeSamples = {{ 1: {POINTS}, 2: {moved} }}"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.usda");
    fs::write(&path, format!("{HEADER}{}", prim("m", &text))).expect("a temporary file");
    let at = |path: &Path, time: f64| {
        mesh::read_choice(path, &Choice { time: Some(time), ..Choice::default() }).expect("a mesh")
    };
    let [first, last] = [1.0, 2.0].map(|time| at(&path, time));
    assert_eq!(last.points[8..], [3, 2, 2, 0].map(|vertex| last.points[vertex]));
    let mut surface = MovingSurface::new(&first).expect("it has a surface");
    let there = surface.move_to(&last).expect("the same topology").evaluate_ptex(1, [0.25, 0.5]);
    let expected = LimitSurface::new(&last).expect("it has a surface").evaluate_ptex(1, [0.25, 0.5]);
    assert_eq!(there.map(|(_, jet)| jet.position), expected.map(|(_, jet)| jet.position));
}

#[test]
fn what_else_is_wrong_is_refused() {
    // Vertex 8 is not the prim's, though its bad face gets one with that number.
    let text = still().replace("4, 5, 6, 7, 0", "4, 5, 6, 8, 0");
    let expected = "mesh.usda: /m, face 1: a face with vertex 8, but the mesh has only 0 to 7; correct it";
    assert_eq!(refusal(&prim("m", &text)), expected);
    assert!(read_text(&prim("m", &still())).is_ok());
}
