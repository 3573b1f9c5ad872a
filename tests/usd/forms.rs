//! USDA in the forms that people and programs write it.

use std::fs;

use catoptric::mesh::{self, SubdivMesh};
use glam::DVec3;

use crate::{HEADER, SQUARE, accepted, prim, refusal};

/// The bounds of the points.
fn bounds(mesh: &SubdivMesh) -> [DVec3; 2] {
    let first = mesh.points[0];
    mesh.points.iter().fold([first, first], |[low, high], &p| [low.min(p), high.max(p)])
}

fn moved(by: &str) -> SubdivMesh {
    let place = format!("double3 xformOp:translate = {by}\nuniform token[] xformOpOrder = [\"xformOp:translate\"]");
    accepted(&prim("m", &format!("{SQUARE}{place}")))
}

#[test]
fn numbers_have_many_forms() {
    assert_eq!(moved("(.5, 5., +5)").points[0], DVec3::new(0.5, 5.0, 5.0));
    assert_eq!(moved("(1e3, -.5e-2, 1.E+0)").points[0], DVec3::new(1000.0, -0.005, 1.0));
    assert_eq!(moved("(-5., 007.25, +.5)").points[0], DVec3::new(-5.0, 7.25, 0.5));
    // Integers too; what is behind the point is cut off, as by usd-core.
    let text = SQUARE.replace("[4]", "[4.]").replace("[0, 1, 2, 3]", "[0., 1e0, 2.75, 3]");
    assert_eq!(accepted(&prim("m", &text)).face_vertices, [0, 1, 2, 3]);
    let layer =
        accepted(&format!("(\n    metersPerUnit = .01\n    timeCodesPerSecond = 25.\n)\n{}", prim("m", SQUARE)));
    assert_eq!(layer.meters_per_unit, Some(0.01));
    let weird = "double inf = inf\ndouble[] all = [-inf, nan, .5]\nhalf much = 1e9\n";
    assert_eq!(accepted(&prim("m", &format!("{weird}{SQUARE}"))).face_count(), 1);
}

#[test]
fn comments_may_be_anywhere() {
    let text = "# it's [\n/* { \" \n */ def Mesh \"m\" // ' (\n{ // <\n/*'*/ point3f[] points = [(0, 0, 0), # ]\n(1, 0, 0), // ]\n\
                (1, 1, 0), /* ] */ (0, 1, 0),]\nint[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0, 1, 2, 3]\n} # }\n";
    assert_eq!(accepted(text).face_count(), 1);
}

/// Attributes and metadata that a mesh does not need may hold anything.
#[test]
fn what_is_not_needed_may_be_anything() {
    let text = "def Mesh 'm' (\n    \"\"\"a comment (\"\"\"\n    kind = 'x'; nonsense = [1, (2)]\n    customData = { int a = 5. }\n\
                    doc = '''it's \"(\"'''\n)\n{\n    asset inputs:file = \"sky.png\"\n    custom foo bar = baz\n    \
                    int wrong = \"text\" (doc = \"\")\n    float3[] short.timeSamples = { 1.: [(1, 2)], }\n    token größe = 'x'\n";
    let mesh = accepted(&format!("{text}{SQUARE}}}\n"));
    assert_eq!((mesh.face_count(), mesh.notes.len()), (1, 0));
}

#[test]
fn operations_without_a_value_do_nothing() {
    let place = "double3 xformOp:translate = (1, 2, 3)\nfloat3 xformOp:scale\n\
                 uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateXYZ\", \"!invert!xformOp:scale\"]";
    assert_eq!(accepted(&prim("m", &format!("{SQUARE}{place}"))).points[0], DVec3::new(1.0, 2.0, 3.0));
}

/// Messages name the line of the file, whatever is above it.
#[test]
fn lines_keep_their_numbers() {
    let text = "/* \n\n */ def Mesh 'm' ( # x\n doc = '''\n\n'''\n)\n{\n    int[] faceVertexCounts = [4, oops]\n}\n";
    let message = refusal(text);
    assert!(message.starts_with("mesh.usda: not readable as USD (line 10: "), "{message}");
}

/// Layers and other formats that cannot be read are passed over; what they lack is said in one line.
#[test]
fn parts_that_are_missing_are_passed_over() {
    let arc = |what: &str| format!("def Scope \"l\" (\n    prepend references = {what}\n)\n{{\n}}\n");
    let there = prim("m", SQUARE);
    let mesh = accepted(&(there.clone() + &arc("@./gone.mtlx@</MaterialX>")));
    assert_eq!(mesh.notes.len(), 1);
    let note = &mesh.notes[0];
    assert!(
        note.starts_with("passed over: /l refers to /") && note.ends_with("gone.mtlx, which is not there"),
        "{note}"
    );
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.usda");
    fs::write(folder.path().join("mat.mtlx"), "<?xml version=\"1.0\"?>\n<materialx version=\"1.38\"/>\n")
        .expect("a file");
    fs::write(folder.path().join("light.usda"), "#usda 1.0\ndef SphereLight \"l\" { float r = . }\n").expect("a file");
    for other in ["@./mat.mtlx@</MaterialX>", "@./light.usda@</l>"] {
        fs::write(&path, format!("{HEADER}{there}{}", arc(other))).expect("a file");
        let mesh = mesh::read(&path).expect("a mesh");
        assert_eq!(mesh.face_count(), 1);
        assert!(mesh.notes.len() <= 1, "{:?}", mesh.notes);
    }
    fs::write(&path, format!("{HEADER}(\n    subLayers = [@./none.usda@]\n)\n{there}")).expect("a file");
    let notes = mesh::read(&path).expect("a mesh").notes;
    assert!(notes.len() == 1 && notes[0].contains("none.usda"), "{notes:?}");
}

/// A layer that is referred to is read in the same way.
#[test]
fn references_may_have_any_form_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let layer = format!(
        "#usda 1.0 and more\n( defaultPrim = 'm' )\n{}",
        prim("m", &SQUARE.replace("(1, 1, 0)", "(1., +1, .0)"))
    );
    fs::write(folder.path().join("part.usda"), layer).expect("a file");
    let path = folder.path().join("mesh.usda");
    let text = "def \"x\" (references = @./part.usda@ (offset = 1.; scale = .5)) {}\n";
    fs::write(&path, HEADER.to_owned() + text).expect("a file");
    let mesh = mesh::read(&path).expect("a mesh");
    assert_eq!(bounds(&mesh), [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)]);
    // And in packages, also in packages within packages.
    let package = |name: &str, inside: &str| {
        let bytes = fs::read(folder.path().join(inside)).expect("a file");
        let mut archive = openusd::usdz::ArchiveWriter::create(folder.path().join(name)).expect("a package");
        archive.add_layer(inside, &bytes).expect("a file in it");
        archive
    };
    package("inner.usdz", "part.usda").finish().expect("a whole package");
    let text = "def \"x\" (references = @./inner.usdz@) {}\ndef \"y\" (references = @inner.usdz[part.usda]@) {}\n";
    fs::write(folder.path().join("outer.usda"), HEADER.to_owned() + text).expect("a file");
    let mut outer = package("outer.usdz", "outer.usda");
    let inner = fs::read(folder.path().join("inner.usdz")).expect("a package");
    outer.add_layer("inner.usdz", &inner).expect("a package in it");
    outer.finish().expect("a whole package");
    for name in ["outer.usda", "outer.usdz"] {
        let mesh = mesh::read(&folder.path().join(name)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((mesh.parts.len(), mesh.face_count(), mesh.notes), (2, 2, Vec::<String>::new()), "{name}");
    }
}

/// Shapes that are no meshes are named, with their number.
#[test]
fn shapes_that_are_no_meshes_are_named() {
    let others = "def Sphere \"s\" {}\ndef NurbsPatch \"n\" {}\ndef Sphere \"t\" {}\ndef Xform \"x\" { def Cube \"c\" (active = false) {} }\n";
    let list = "1 NurbsPatch (/n), 2 Sphere (the first is /s)";
    let mesh = accepted(&(prim("m", SQUARE) + others));
    assert_eq!(mesh.notes, [format!("passed over, since meshes alone are read: {list}")]);
    let message = refusal(others);
    let expected = format!(
        "mesh.usda: the stage has no Mesh prim that is visible and of purpose default or render (passed over: {list}); give one that has"
    );
    assert_eq!(message, expected);
}
