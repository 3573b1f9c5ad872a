//! Meshes of several schemes and rules in one scene: each has the surface that it has alone.

use std::fs;
use std::process::Command;

use catoptric::mesh::{self, Boundary, Scheme, SubdivMesh, TriangleRule};
use catoptric::osd::Refiner;
use catoptric::stam::LimitSurface;

use crate::{HEADER, HOUSE, SQUARE, accepted, prim};

/// A pentagon with a dent out of the plane, beside a quad and a triangle.
const PENTAGON: &str =
    "point3f[] points = [(0, 0, 0), (2, 0, 1), (3, 2, 0), (1, 3, 2), (-1, 2, 0), (4, 0, 1), (5, 2, 0), (2, 4, 1)]
    int[] faceVertexCounts = [5, 4, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 4, 1, 5, 6, 2, 3, 2, 7]\n";

/// A bumpy sheet of 5 x 5 quads.
fn sheet() -> String {
    let points: Vec<String> = (0..36).map(|k| format!("({}, {}, {})", k % 6, k / 6, (k * k) % 5)).collect();
    let corners = (0..25).map(|k| k % 5 + k / 5 * 6).flat_map(|k| [k, k + 1, k + 7, k + 6]);
    let corners: Vec<String> = corners.map(|k| k.to_string()).collect();
    format!(
        "point3f[] points = [{}]\nint[] faceVertexCounts = [{}]\nint[] faceVertexIndices = [{}]\n",
        points.join(", "),
        ["4"; 25].join(", "),
        corners.join(", ")
    )
}

fn scheme(name: &str) -> String {
    format!("uniform token subdivisionScheme = \"{name}\"\n")
}

fn boundary(name: &str) -> String {
    format!("uniform token interpolateBoundary = \"{name}\"\n")
}

/// Asserts that each mesh has in the scene of all the limit that it has alone, ptex face by ptex face. Gives the scene.
fn assert_as_alone(attributes: &[String]) -> SubdivMesh {
    let prims: Vec<String> = attributes.iter().enumerate().map(|(k, text)| prim(&format!("m{k}"), text)).collect();
    let scene = accepted(&prims.concat());
    assert_eq!(scene.parts.len(), prims.len());
    let whole = LimitSurface::new(&scene).expect("a surface");
    let (mut first, mut compared) = (0, 0);
    for text in prims {
        let alone = LimitSurface::new(&accepted(&text)).expect("a surface");
        for ptex in 0..alone.ptex_count() as u32 {
            for uv in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.3, 0.6], [0.5, 0.01], [0.125, 0.5]] {
                let [own, among] = [alone.evaluate_ptex(ptex, uv), whole.evaluate_ptex(first + ptex, uv)];
                assert_eq!(own.is_some(), among.is_some(), "ptex face {ptex} of {text}");
                let (Some((_, own)), Some((_, among))) = (own, among) else { continue };
                let off = own.position.distance(among.position);
                assert!(off <= 1e-14 * whole.diagonal(), "{off:e} at ptex face {ptex}, {uv:?} of {text}");
                compared += 1;
            }
        }
        first += alone.ptex_count() as u32;
    }
    assert_eq!(first as usize, whole.ptex_count());
    assert!(compared > 50, "only {compared} places");
    scene
}

#[test]
fn flat_meshes_stand_beside_smooth_ones() {
    let creases = "int[] creaseIndices = [1, 2]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = [3]\nint[] holeIndices = [0]\n";
    let scene = assert_as_alone(&[
        PENTAGON.to_owned(),
        format!("{PENTAGON}{}", scheme("bilinear")),
        format!("{HOUSE}{}{creases}", scheme("none")),
        format!("{PENTAGON}{creases}"),
        format!("{PENTAGON}{}uniform token orientation = \"leftHanded\"\n", scheme("bilinear")),
        format!("{HOUSE}{}{}", scheme("bilinear"), boundary("none")),
    ]);
    assert_eq!((scene.scheme, scene.notes.len()), (Scheme::CatmullClark, 0));
    // Those of the two flat schemes alone need no change.
    let scene = assert_as_alone(&[format!("{PENTAGON}{}", scheme("bilinear")), format!("{HOUSE}{}", scheme("none"))]);
    assert_eq!(scene.scheme, Scheme::Bilinear);
}

/// Copies of a mesh that is changed for the scene are still one in several places.
#[test]
fn copies_of_flat_meshes_are_shared() {
    let flat = format!("{PENTAGON}{}", scheme("bilinear"));
    let place = "double3 xformOp:translate = (9, 3, 0)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
    let scene = accepted(&(prim("a", PENTAGON) + &prim("b", &flat) + &prim("c", &format!("{flat}{place}"))));
    let repeats: Vec<_> = scene.parts.iter().map(|part| part.repeats.map(|repeat| repeat.part)).collect();
    assert_eq!(repeats, [None, None, Some(1)]);
}

#[test]
fn boundary_rules_stand_beside_each_other() {
    let sheet = sheet();
    // All boundary edges of face 0 are sharp, so that it has a surface under `none` too, where those at its vertices are.
    let crease = |vertices: &str, count: usize| {
        format!(
            "int[] creaseIndices = [{vertices}]\nint[] creaseLengths = [{count}]\nfloat[] creaseSharpnesses = [10]\n"
        )
    };
    let scene = assert_as_alone(&[
        format!("{sheet}{}", boundary("none")),
        format!("{sheet}{}", boundary("edgeOnly")),
        format!("{sheet}{}", boundary("edgeAndCorner")),
        format!("{sheet}{}{}", boundary("none"), crease("18, 12, 6, 0, 1, 2, 3", 7)),
        format!(
            "{sheet}{}{}",
            boundary("none"),
            crease("0, 1, 2, 3, 4, 5, 11, 17, 23, 29, 35, 34, 33, 32, 31, 30, 24, 18, 12, 6, 0", 21)
        ),
        format!("{PENTAGON}{}", scheme("bilinear")),
    ]);
    assert_eq!(scene.boundary, Boundary::EdgeOnly);
}

/// The holes are those that OpenSubdiv makes under its own rule.
#[test]
fn holes_at_boundaries_are_opensubdivs() {
    let sheet = format!("{}{}", sheet(), boundary("none"));
    let holes =
        |mesh: &SubdivMesh| Refiner::uniform(mesh, 1).and_then(|refiner| refiner.level(0)).expect("a level").face_holes;
    let alone = holes(&accepted(&prim("m", &sheet)));
    let scene = accepted(&(prim("m", &sheet) + &prim("n", SQUARE)));
    assert_eq!((scene.boundary, holes(&scene)[..25].to_vec()), (Boundary::EdgeOnly, alone.clone()));
    assert!(alone.iter().filter(|&&hole| hole != 0).count() == 16, "{alone:?}");
}

#[test]
fn meshes_that_have_no_common_rule_are_left_out_by_name() {
    let triangle = "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n";
    let loops = format!("{triangle}{}", scheme("loop"));
    let smooth = format!("{HOUSE}token triangleSubdivisionRule = \"smooth\"\n");
    let names = |mesh: &SubdivMesh| mesh.parts.iter().map(|part| part.name.clone()).collect::<Vec<_>>();
    let scene = accepted(&(prim("a", &loops) + &prim("b", HOUSE) + &prim("c", &loops) + &prim("d", SQUARE)));
    assert_eq!(names(&scene), ["/b", "/d"]);
    assert_eq!(
        scene.notes,
        [
            "2 meshes of the scheme loop are left out (first: /a), since a surface has one rule for all; read alone with --prim /a"
        ]
    );
    let scene = accepted(&(prim("a", &loops) + &prim("b", HOUSE) + &prim("c", &loops)));
    assert_eq!((names(&scene), scene.scheme), (vec!["/a".to_owned(), "/c".to_owned()], Scheme::Loop));
    let scene = accepted(&(prim("a", &smooth) + &prim("b", HOUSE) + &prim("c", SQUARE)));
    assert_eq!((names(&scene), scene.triangles), (vec!["/b".to_owned(), "/c".to_owned()], TriangleRule::CatmullClark));
    assert!(
        scene.notes[0].starts_with("1 mesh of triangleSubdivisionRule smooth is left out (first: /a)"),
        "{:?}",
        scene.notes
    );
    // Where there is no triangle, the rule is nobody's.
    let scene = accepted(&(prim("a", &smooth) + &prim("c", &format!("{SQUARE}{}", scheme("bilinear")))));
    assert_eq!((names(&scene).len(), scene.triangles), (2, TriangleRule::Smooth));
}

/// The smooth rule for triangles is another surface, in USD and in OBJ, and OpenSubdiv's.
#[test]
fn smooth_triangles_are_opensubdivs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let octahedron = "v 1 0 0\nv 0 1 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\nv 0 0 -1.5\n\
                      f 1 2 3\nf 2 4 3\nf 4 5 3\nf 5 1 3\nf 2 1 6\nf 4 2 6\nf 5 4 6\nf 1 5 6\nt crease 2/1/0 0 1 2.5\n";
    let smooth = format!("{octahedron}t smoothtriangles 0/0/1 smooth\n");
    fs::write(folder.path().join("smooth.obj"), &smooth).expect("a file");
    let text = "point3f[] points = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1.5)]
        int[] faceVertexCounts = [3, 3, 3, 3, 3, 3, 3, 3]
        int[] faceVertexIndices = [0, 1, 2, 1, 3, 2, 3, 4, 2, 4, 0, 2, 1, 0, 5, 3, 1, 5, 4, 3, 5, 0, 4, 5]
        int[] creaseIndices = [0, 1]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = [2.5]
        token triangleSubdivisionRule = \"smooth\"\n";
    fs::write(folder.path().join("smooth.usda"), HEADER.to_owned() + &prim("m", text)).expect("a file");
    let read = |name: &str| mesh::read(&folder.path().join(name)).expect("a mesh");
    let surfaces =
        [read("smooth.usda"), read("smooth.obj"), mesh::parse_obj(octahedron.as_bytes(), "plain").expect("a mesh")]
            .map(|mesh| LimitSurface::new(&mesh).expect("a surface"));
    let at = |surface: &LimitSurface| surface.evaluate_ptex(0, [0.7, 0.4]).expect("a point").1.position;
    let [usd, obj, plain] = surfaces.each_ref().map(at);
    assert!(usd.distance(obj) < 1e-14 && usd.distance(plain) > 1e-3, "{usd} {obj} {plain}");
    for name in ["smooth.usda", "smooth.obj"] {
        let mut verify = Command::new(env!("CARGO_BIN_EXE_catoptric"));
        let told =
            verify.args(["verify", name, "--size", "64x64"]).current_dir(folder.path()).output().expect("it starts");
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stdout));
    }
}

/// A concave polygon under `none` is covered as it is, by pieces; and one that crosses itself as it always was, with a note.
#[test]
fn concave_polygons_are_cut() {
    let outline = |points: &str, count: usize| {
        let corners: Vec<String> = (0..count).map(|k| k.to_string()).collect();
        format!(
            "point3f[] points = [{points}]\nint[] faceVertexCounts = [{count}]\nint[] faceVertexIndices = [{}]\n{}",
            corners.join(", "),
            scheme("none")
        )
    };
    let corner = outline("(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)", 6);
    let mesh = accepted(&prim("l", &corner));
    assert_eq!(
        mesh.notes,
        ["concave under the scheme none, and cut into convex pieces, which count as faces: face 0 of /l"]
    );
    let surface = LimitSurface::new(&mesh).expect("a surface");
    // Nothing beyond the outline, and all of its area: sums over small cells of each ptex face.
    let (mut area, steps) = (0.0, 16);
    let point = |ptex, i: usize, j: usize| {
        surface.evaluate_ptex(ptex, [i as f64, j as f64].map(|x| x / steps as f64)).expect("a point").1.position
    };
    for ptex in 0..surface.ptex_count() as u32 {
        for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| point(ptex, i + x, j + y));
            area += (c - a).cross(d - b).z / 2.0;
            let middle = (a + c) / 2.0;
            assert!(middle.x < 1.0 + 1e-12 || middle.y < 1.0 + 1e-12, "{middle} is beyond the corner");
        }
    }
    assert!((area - 3.0).abs() < 1e-12, "{area}");
    let bow = outline("(0, 0, 0), (1, 1, 0), (1, 0, 0), (0, 1, 0)", 4);
    let mesh = accepted(&prim("b", &bow));
    assert_eq!(
        mesh.notes,
        ["crossing themselves under the scheme none, and covered as by the scheme bilinear: face 0 of /b"]
    );
    let text =
        "v 0 0 0\nv 1 0 0\nv .3 .3 0\nv 0 1 0\nv -1 0 0\nf 1 4 5\nf 1 2 3 4\nt scheme 0/0/1 none\nt hole 1/0/0 1\n";
    let mesh = mesh::parse_obj(text.as_bytes(), "dent").expect("a mesh");
    assert_eq!((mesh.face_sizes, mesh.holes), (vec![3, 3, 3], vec![1, 2]));
    assert_eq!(mesh.notes, ["concave under the scheme none, and cut into convex pieces, which count as faces: line 7"]);
}
