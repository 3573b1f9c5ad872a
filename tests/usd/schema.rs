//! What counts, what is left out, and what an attribute that is not there means.

use catoptric::mesh::Boundary;
use glam::DVec3;

use crate::{HOUSE, SQUARE, accepted, prim};

#[test]
fn what_is_not_said_is_the_schemas() {
    let mesh = accepted(&prim("m", SQUARE));
    assert_eq!(mesh.name, "mesh");
    assert_eq!(mesh.boundary, Boundary::EdgeAndCorner);
    assert_eq!(mesh.up, Some(DVec3::Y));
    assert!(mesh.creases.is_empty() && mesh.corners.is_empty() && mesh.holes.is_empty());
}

#[test]
fn a_stage_says_what_is_up() {
    let mesh = accepted(&format!("(\n    upAxis = \"Z\"\n)\n{}", prim("m", SQUARE)));
    assert_eq!(mesh.up, Some(DVec3::Z));
}

/// A sharpness a crease holds for all its edges; a sharpness an edge does not.
#[test]
fn creases_have_a_sharpness_each_or_one_an_edge() {
    let with = |lengths: &str, sharpness: &str| {
        let creases = format!("int[] creaseIndices = [0, 1, 2, 3, 0]\nint[] creaseLengths = {lengths}\n");
        let mesh = accepted(&prim("m", &format!("{SQUARE}{creases}float[] creaseSharpnesses = {sharpness}")));
        mesh.creases.iter().map(|crease| (crease.vertices, crease.sharpness)).collect::<Vec<_>>()
    };
    assert_eq!(with("[3, 2]", "[1.5, 10]"), [([0, 1], 1.5), ([1, 2], 1.5), ([3, 0], 10.0)]);
    assert_eq!(with("[3, 2]", "[1, 2, 3]"), [([0, 1], 1.0), ([1, 2], 2.0), ([3, 0], 3.0)]);
    assert_eq!(with("[5]", "[1, 2, 3, 4]"), [([0, 1], 1.0), ([1, 2], 2.0), ([2, 3], 3.0), ([3, 0], 4.0)]);
}

#[test]
fn left_handed_faces_are_turned() {
    let mesh = accepted(&prim("m", &format!("{HOUSE}uniform token orientation = \"leftHanded\"")));
    assert_eq!(mesh.face_vertices, [0, 3, 2, 1, 2, 4, 1]);
}

/// Invisible and guide and proxy prims are left out, with all below them; a purpose below counts before one above.
#[test]
fn what_is_not_shown_is_left_out() {
    let of = |what: &str| {
        let text = format!("def Xform \"x\"\n{{\n{what}\n}}\n{}", prim("n", SQUARE));
        accepted(&text).face_count()
    };
    let below = prim("m", SQUARE);
    assert_eq!(of(&below), 2);
    assert_eq!(of(&format!("token visibility = \"invisible\"\n{below}")), 1);
    assert_eq!(of(&format!("uniform token purpose = \"guide\"\n{below}")), 1);
    assert_eq!(of(&format!("uniform token purpose = \"proxy\"\n{below}")), 1);
    assert_eq!(of(&format!("uniform token purpose = \"render\"\n{below}")), 2);
    let render = prim("m", &format!("{SQUARE}uniform token purpose = \"render\""));
    assert_eq!(of(&format!("uniform token purpose = \"guide\"\n{render}")), 2);
    assert_eq!(of(&prim("m", SQUARE).replace("def Mesh", "over Mesh")), 1);
    assert_eq!(of(&prim("m", SQUARE).replace("def Mesh", "class Mesh")), 1);
    assert_eq!(of(&prim("m", SQUARE).replace("\"m\"", "\"m\" (active = false)")), 1);
    // What is hidden is not even looked at.
    assert_eq!(of("def Mesh \"m\"\n{\n    token visibility = \"invisible\"\n}"), 1);
}

#[test]
fn instances_are_meshes_where_they_are() {
    let text = format!(
        "class \"kind\"\n{{\n{}\n}}
        def Xform \"one\" (\n    instanceable = true\n    inherits = </kind>\n)\n{{
            double3 xformOp:translate = (5, 0, 0)\n    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n}}
        def Xform \"two\" (\n    instanceable = true\n    inherits = </kind>\n)\n{{\n}}\n",
        prim("m", SQUARE)
    );
    let mesh = accepted(&text);
    assert_eq!(mesh.face_vertices, [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!([mesh.points[1], mesh.points[5]], [DVec3::new(6.0, 0.0, 0.0), DVec3::X]);
}

/// The default counts, and where there is none the first sample.
#[test]
fn samples_count_where_there_is_no_default() {
    let samples = "point3f[] points.timeSamples = {
        5: [(0, 0, 9), (1, 0, 9), (1, 1, 9), (0, 1, 9)],
        7: [(0, 0, 3), (1, 0, 3), (1, 1, 3), (0, 1, 3)],
    }\n";
    let height = |text: &str| accepted(&prim("m", text)).points[2].z;
    assert_eq!(height(&format!("{SQUARE}{samples}")), 0.0);
    let faces = SQUARE.split_once("int[]").map(|(_, faces)| format!("int[]{faces}")).expect("faces");
    assert_eq!(height(&format!("{faces}{samples}")), 9.0);
}

/// The rule of triangles says nothing of a mesh that has none.
#[test]
fn smooth_triangles_are_accepted_where_there_are_none() {
    let smooth = "token triangleSubdivisionRule = \"smooth\"";
    assert_eq!(accepted(&prim("m", &format!("{SQUARE}{smooth}"))).face_count(), 1);
}

/// Sharpness beyond 10 is as infinite as 10.
#[test]
fn sharpness_of_ten_and_more_is_infinite() {
    let of = |sharpness: f32| {
        let corners = format!("int[] cornerIndices = [1]\nfloat[] cornerSharpnesses = [{sharpness:?}]\n");
        let mesh = accepted(&prim("m", &format!("{HOUSE}{corners}")));
        let surface = catoptric::stam::LimitSurface::new(&mesh).expect("a surface");
        surface.evaluate_ptex(0, [1.0, 0.0]).expect("a point").1.position
    };
    assert_eq!(of(10.0), DVec3::X);
    assert_eq!(of(17.0), DVec3::X);
    assert_ne!(of(2.0), DVec3::X);
}
