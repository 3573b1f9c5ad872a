//! What is refused, each case with its message.

use crate::{HOUSE, SQUARE, accepted, prim, refusal};

fn with(more: &str) -> String {
    refusal(&prim("m", &format!("{SQUARE}{more}")))
}

#[test]
fn schemes_that_usd_does_not_have() {
    assert_eq!(
        with("uniform token subdivisionScheme = \"doo\""),
        "mesh.usda: /m: subdivisionScheme 'doo' is none of USD's; use catmullClark, loop, bilinear or none"
    );
}

#[test]
fn faces_that_a_scheme_does_not_take() {
    assert_eq!(
        with("uniform token subdivisionScheme = \"loop\""),
        "mesh.usda: /m, face 0: a face with 4 vertices, but the scheme loop takes triangles; \
         triangulate it, or use catmullClark"
    );
}

#[test]
fn triangles_by_a_rule_that_usd_does_not_have() {
    let text = prim("m", &format!("{HOUSE}token triangleSubdivisionRule = \"smoother\""));
    let expected = "mesh.usda: /m: triangleSubdivisionRule 'smoother' is not supported; use catmullClark or smooth";
    assert_eq!(refusal(&text), expected);
}

#[test]
fn words_that_the_schema_does_not_have() {
    assert_eq!(
        with("token interpolateBoundary = \"edges\""),
        "mesh.usda: /m: interpolateBoundary 'edges' is not supported; use none, edgeOnly or edgeAndCorner"
    );
    assert_eq!(
        with("uniform token orientation = \"left\""),
        "mesh.usda: /m: orientation 'left' is not supported; use rightHanded or leftHanded"
    );
}

#[test]
fn attributes_that_are_missing_or_of_another_type() {
    let needed = "give it points, faceVertexCounts and faceVertexIndices";
    for name in ["points", "faceVertexCounts", "faceVertexIndices"] {
        let text = SQUARE.replace(&format!(" {name} ="), &format!(" {name}X ="));
        assert_eq!(refusal(&prim("m", &text)), format!("mesh.usda: /m: a Mesh prim without {name}; {needed}"));
    }
    let typed = "give it the type that the schema says";
    let text = SQUARE.replace("int[] faceVertexCounts = [4]", "float[] faceVertexCounts = [4]");
    assert_eq!(refusal(&prim("m", &text)), format!("mesh.usda: /m: faceVertexCounts is not int[]; {typed}"));
    assert_eq!(
        with("int interpolateBoundary = 1"),
        format!("mesh.usda: /m: interpolateBoundary is not token; {typed}")
    );
}

#[test]
fn lengths_that_do_not_agree() {
    let creases = |indices: &str, lengths: &str, sharpness: &str| {
        with(&format!(
            "int[] creaseIndices = {indices}\nint[] creaseLengths = {lengths}\nfloat[] creaseSharpnesses = {sharpness}"
        ))
    };
    assert_eq!(
        creases("[0, 1, 2]", "[2]", "[1]"),
        "mesh.usda: /m: creaseIndices has 3 values; write 2, the sum of creaseLengths"
    );
    assert_eq!(
        creases("[0, 1, 2]", "[3]", "[1, 1, 1]"),
        "mesh.usda: /m: creaseSharpnesses has 3 values; write 1, one for each crease, or 2, one for each edge"
    );
    assert_eq!(
        creases("[0, 1, 2]", "[2, 1]", "[1, 1]"),
        "mesh.usda: /m: creaseLengths has 1; a crease has at least 2 vertices"
    );
    assert_eq!(creases("[0, -1]", "[2]", "[1]"), "mesh.usda: /m: creaseIndices has -1; use 0 and above");
    assert_eq!(
        with("int[] cornerIndices = [0, 1]\nfloat[] cornerSharpnesses = [3]"),
        "mesh.usda: /m: cornerSharpnesses has 1 value; write 2, one for each of cornerIndices"
    );
}

/// The checks of every mesh, with the prim in front.
#[test]
fn meshes_that_no_surface_has() {
    let text = SQUARE.replace("[0, 1, 2, 3]", "[0, 1, 2, 4]");
    let expected = "mesh.usda: /m, face 0: a face with vertex 4, but the mesh has only 0 to 3; correct it";
    assert_eq!(refusal(&prim("m", &text)), expected);
    let text = SQUARE.replace("[4]", "[3]");
    assert!(refusal(&prim("m", &text)).starts_with("mesh.usda: /m: the face sizes add up to 3"));
    assert!(with("int[] holeIndices = [1]").starts_with("mesh.usda: /m, hole 0: a hole at face 1"));
    assert!(
        with("int[] cornerIndices = [0]\nfloat[] cornerSharpnesses = [-1]").starts_with("mesh.usda: /m, corner 0: ")
    );
    let text = SQUARE.replace("(1, 1, 0)", "(1, inf, 0)");
    assert_eq!(refusal(&prim("m", &text)), "mesh.usda: /m, vertex 2: coordinate inf is not finite; correct the vertex");
    // Matrices without an inverse leave no number.
    let flat = "float3 xformOp:scale = (1, 0, 1)\nuniform token[] xformOpOrder = [\"!invert!xformOp:scale\"]";
    assert!(with(flat).contains("is not finite"), "{}", with(flat));
}

#[test]
fn text_that_does_not_parse() {
    let message = refusal("def Mesh \"m\"\n{\n    int[] faceVertexCounts = [4, oops]\n}\n");
    assert!(message.starts_with("mesh.usda: not readable as USD (line 4: "), "{message}");
    assert!(message.ends_with("); export the file again"), "{message}");
}

#[test]
fn transforms_that_are_none() {
    for name in ["xformOp:shear", "rotate"] {
        let text = format!("float3 {name} = (1, 1, 1)\nuniform token[] xformOpOrder = [\"{name}\"]");
        let expected = format!("mesh.usda: /m: xformOpOrder has {name}, which is no transform of USD; correct it");
        assert_eq!(with(&text), expected);
    }
    assert_eq!(
        with("string xformOp:scale = \"big\"\nuniform token[] xformOpOrder = [\"xformOp:scale\"]"),
        "mesh.usda: /m: xformOp:scale is not three numbers; give it the type that the schema says"
    );
}

#[test]
fn scenes_that_have_no_mesh_or_not_all_of_it() {
    let none =
        "mesh.usda: the stage has no Mesh prim that is visible and of purpose default or render; give one that has";
    assert_eq!(refusal("def Xform \"x\"\n{\n}\n"), none);
    assert_eq!(refusal(""), none);
    let missing = refusal("def \"x\" (\n    references = @elsewhere.usda@</a>\n)\n{\n}\n");
    assert!(missing.starts_with("mesh.usda: a part of the stage is missing ("), "{missing}");
    assert!(missing.contains("elsewhere.usda"), "{missing}");
    let instancer = format!("def PointInstancer \"p\"\n{{\n{}\n}}\n", prim("m", SQUARE));
    assert_eq!(
        refusal(&instancer),
        "mesh.usda: /p: a PointInstancer without protoIndices; give it prototypes, protoIndices and positions"
    );
    let with = |what: &str| {
        let rel =
            "rel prototypes = [</p/m>]\nint[] protoIndices = [0, 0]\npoint3f[] positions = [(0, 0, 0), (5, 0, 0)]\n";
        refusal(&format!(
            "def PointInstancer \"p\"\n{{\n{}\n}}\n",
            prim("m", SQUARE) + &rel.replace(what, &what.replace(", 0]", ", 7]").replace("), (5", "), (1, 1, 1), (5"))
        ))
    };
    assert_eq!(with("[0, 0]"), "mesh.usda: /p: protoIndices has 7, but the number of prototypes is 1; correct it");
    assert_eq!(
        with("[(0, 0, 0), (5, 0, 0)]"),
        "mesh.usda: /p: positions has 3 values; write 2, one for each of protoIndices"
    );
}

/// Prims that are composed of themselves, through any arcs and prims above: openusd would not come back from them.
#[test]
fn arcs_that_lead_back() {
    let mesh = |name: &str, arcs: &str, more: &str| format!("def Mesh \"{name}\" ({arcs})\n{{\n{SQUARE}\n{more}}}\n");
    for text in [
        mesh("a", "inherits = </a>", ""),
        mesh("a", "inherits = </b>", "") + &mesh("b", "specializes = </a>", ""),
        mesh("a", "inherits = </a/b>", &mesh("b", "", "")),
        mesh("a", "", &mesh("b", "inherits = </a>", "")),
        mesh("a", "payload = @./mesh.usda@</b>", "") + &mesh("b", "", &mesh("c", "references = </a>", "")),
        mesh("a", "inherits = </b>", "") + &mesh("b", "", &mesh("c", "specializes = </a/c>", "")),
    ] {
        let message = refusal(&text);
        assert!(message.contains(" lead back to it; break the circle of its inherits"), "{text}{message}");
    }
    // Names that come back in another place are none of this.
    let fine = mesh("a", "inherits = </b>", &mesh("c", "references = </b/d>", ""));
    accepted(&(fine + &mesh("b", "", &mesh("d", "specializes = </e>", "")) + &mesh("e", "", "")));
}
