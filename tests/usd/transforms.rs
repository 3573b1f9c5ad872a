//! Points in world space, as usd-core 25 computes them (`UsdGeom.XformCache`, `Gf.Matrix4d.Transform`).

use glam::DVec3;

use crate::{SQUARE, accepted};

/// Every kind of operation but single translations and scales along y and z.
fn scene(mesh: &str) -> String {
    format!(
        r#"def Xform "a"
{{
    double3 xformOp:translate = (1, -2, 0.5)
    float3 xformOp:rotateZXY = (20, -35, 70)
    float3 xformOp:scale:size = (1.5, 0.75, -2)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZXY", "xformOp:scale:size"]
    def Xform "b"
    {{
        double3 xformOp:translate:pivot = (0.25, 0.5, 1)
        quatf xformOp:orient = (0.5, 0.5, -0.5, 0.5)
        float xformOp:rotateY:turn = 33
        double xformOp:scaleX = 3
        float3 xformOp:rotateYZX = (5, 6, 7)
        matrix4d xformOp:transform = ( (0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 2, 0), (7, 8, 9, 1) )
        uniform token[] xformOpOrder = ["xformOp:translate:pivot", "xformOp:orient", "xformOp:rotateY:turn", "xformOp:scaleX",
            "xformOp:transform", "xformOp:rotateYZX", "!invert!xformOp:translate:pivot"]
        def Mesh "m"
        {{
            {mesh}
        }}
    }}
}}
"#
    )
}

fn assert_points(text: &str, expected: [[f64; 3]; 4], faces: [u32; 4]) {
    let mesh = accepted(text);
    assert_eq!(mesh.face_vertices, faces);
    for (point, expected) in mesh.points.iter().zip(expected.map(DVec3::from)) {
        // Some ten products, each rounded, of numbers up to 50.
        assert!(point.distance(expected) < 1e-12, "{point} {expected}");
    }
}

/// The scale mirrors (the determinant is -13.5), so faces are turned over.
#[test]
fn operations_are_those_of_usd() {
    let expected = [
        [21.030773854795683, 5.87385853251255, -43.16747052095827],
        [20.46150425307181, 4.2598910759074435, -43.1695280145762],
        [19.003926029609286, 2.3596424239815645, -38.81550449353055],
        [19.573195631333157, 3.9736098805866704, -38.813446999912614],
    ];
    assert_points(&scene(SQUARE), expected, [0, 3, 2, 1]);
    // Twice is not at all.
    assert_points(&scene(&format!("{SQUARE}uniform token orientation = \"leftHanded\"")), expected, [0, 1, 2, 3]);
}

/// What comes before a reset does not count, nor what is above.
#[test]
fn a_reset_leaves_the_parents_out() {
    let mesh = format!(
        "{SQUARE}
        float3 xformOp:rotateXYZ = (10, 20, 30)
        float xformOp:rotateX = 12
        double xformOp:translateY = 2
        uniform token[] xformOpOrder = [\"xformOp:rotateX\", \"!resetXformStack!\", \"xformOp:translateY\", \"xformOp:rotateXYZ\"]"
    );
    let expected = [
        [0.0, 2.0, 0.0],
        [0.8137976813493738, 2.469846310392954, -0.34202014332566877],
        [0.37282807081949143, 3.35241042965234, -0.17884423215913395],
        [-0.44096961052988237, 2.882564119259386, 0.16317591116653482],
    ];
    assert_points(&scene(&mesh), expected, [0, 1, 2, 3]);
}
