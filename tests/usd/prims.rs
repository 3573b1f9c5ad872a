//! Meshes keep the names of their prims, and can be chosen by them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use catoptric::mesh::{self, Choice, Part, SubdivMesh};
use serde_json::Value;

use crate::{HEADER, HOUSE, SQUARE, accepted, prim, refusal};

/// A square, a group with a house and a square in it, and a prim whose name begins like the group's.
fn scene() -> String {
    let group = prim("house", HOUSE) + &prim("square", SQUARE);
    prim("floor", SQUARE) + &format!("def Xform \"group\"\n{{\n{group}\n}}\n") + &prim("group2", SQUARE)
}

fn chosen(text: &str, prims: &[&str]) -> Result<SubdivMesh, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.usda");
    fs::write(&path, format!("{HEADER}{text}")).expect("a temporary file");
    let choice = Choice { prims: prims.iter().map(|&prim| prim.to_owned()).collect(), ..Choice::default() };
    mesh::read_choice(&path, &choice).map_err(|error| {
        let message = error.to_string();
        message[message.find("mesh.usda").expect("the name of the file")..].to_owned()
    })
}

fn names(mesh: &SubdivMesh) -> Vec<&str> {
    mesh.parts.iter().map(|part| part.name.as_str()).collect()
}

#[test]
fn parts_are_the_prims_in_order() {
    let mesh = accepted(&scene());
    assert_eq!(names(&mesh), ["/floor", "/group/house", "/group/square", "/group2"]);
    let [_, house, ..] = &mesh.parts[..] else { panic!("four parts") };
    assert_eq!(*house, Part { name: "/group/house".to_owned(), faces: 1..3, points: 4..9, repeats: None });
    // A quad is one ptex face, a triangle three.
    let parts = mesh.ptex_parts();
    let of: Vec<_> = (0..8).map(|ptex| parts.name(ptex)).collect();
    let (floor, house) = (Some("/floor"), Some("/group/house"));
    assert_eq!(of, [floor, house, house, house, house, Some("/group/square"), Some("/group2"), None]);
    assert_eq!(parts.iter().map(|(_, ptex)| ptex).collect::<Vec<_>>(), [0..1, 1..5, 5..6, 6..7]);
}

#[test]
fn prims_are_chosen_with_what_is_below() {
    let of = |prims: &[&str]| chosen(&scene(), prims).map(|mesh| names(&mesh).join(" "));
    assert_eq!(of(&["/group"]).as_deref(), Ok("/group/house /group/square"));
    assert_eq!(of(&["/group/"]).as_deref(), Ok("/group/house /group/square"));
    assert_eq!(of(&["/group2", "/floor"]).as_deref(), Ok("/floor /group2"));
    assert_eq!(of(&["/"]).as_deref(), Ok("/floor /group/house /group/square /group2"));
    let unknown = "no prim /grou with a Mesh that is shown; there are /floor, /group/house, /group/square, /group2";
    assert_eq!(of(&["/floor", "/grou"]), Err(format!("mesh.usda: {unknown}")));
    // What was not asked for may be wrong.
    let wrong = scene() + &prim("wrong", &format!("{SQUARE}uniform token subdivisionScheme = \"doo\""));
    assert!(chosen(&wrong, &["/floor"]).is_ok() && chosen(&wrong, &[]).is_err());
}

#[test]
fn an_obj_has_no_prims() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/cube.obj");
    let choice = Choice { prims: vec!["/cube".to_owned()], ..Choice::default() };
    let message = mesh::read_choice(&path, &choice).expect_err("refused").to_string();
    assert!(message.ends_with("cube.obj: an OBJ has no prims; leave --prim out, or give a USD file"), "{message}");
}

/// Exporters leave meshes without faces behind. One that is alone is refused for what it lacks.
#[test]
fn prims_without_faces_are_passed_over_beside_others() {
    let empties = [
        "point3f[] points = []\nint[] faceVertexCounts = []\nint[] faceVertexIndices = []",
        "point3f[] points = [(0, 0, 0)]\nint[] faceVertexCounts = []",
        "",
    ];
    for (empty, reason) in
        empties.into_iter().zip(["the mesh has no vertices", "without faceVertexIndices", "without points"])
    {
        assert_eq!(names(&accepted(&(prim("none", empty) + &prim("m", SQUARE)))), ["/m"]);
        let message = refusal(&prim("none", empty));
        assert!(message.starts_with("mesh.usda: /none: ") && message.contains(reason), "{message}");
    }
}

#[test]
fn rest_poses_are_noted() {
    let skinned = format!("{SQUARE}int[] primvars:skel:jointIndices = [0, 0, 0, 0]");
    let shaped = format!("{SQUARE}uniform token[] skel:blendShapes = [\"smile\"]");
    let mesh = accepted(&(prim("a", SQUARE) + &prim("b", &skinned) + &prim("c", &shaped)));
    let note = "/b and 1 more: skeletons and blend shapes are not applied; points are those of the rest pose";
    assert_eq!(mesh.notes, [note]);
    assert!(accepted(&prim("a", SQUARE)).notes.is_empty());
}

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

fn json(told: &Output, path: Option<&Path>) -> Value {
    let text = path.map_or_else(|| told.stdout.clone(), |path| fs::read(path).expect("a file"));
    serde_json::from_slice(&text).unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&told.stderr)))
}

#[test]
fn the_program_names_prims() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let bumps = "point3f[] points = [(0, 0, 0), (1, 0, 0.2), (1, 1, 0), (0, 1, 0.3), (2, 0.5, 0)]
        int[] faceVertexCounts = [4, 3]\nint[] faceVertexIndices = [0, 1, 2, 3, 2, 1, 4]
        int[] creaseIndices = [1, 2]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = [10]\n";
    let moved = "double3 xformOp:translate = (0, 0, 2)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
    let header = "#usda 1.0\n(\n    metersPerUnit = 0.001\n    upAxis = \"Z\"\n)\n";
    let scene = prim("a", bumps) + &prim("b", &format!("{bumps}{moved}"));
    fs::write(folder.join("mesh.usda"), header.to_owned() + &scene).expect("a file");

    let info = json(&run(folder, &["info", "mesh.usda", "--json"]), None);
    assert_eq!(info["prims"][1]["prim"], "/b");
    assert_eq!(
        (&info["meters_per_unit"], &info["prims"][1]["ptex_faces"]),
        (&0.001.into(), &serde_json::json!([4, 4]))
    );
    let text = String::from_utf8(run(folder, &["info", "mesh.usda"]).stdout).expect("text");
    assert!(text.contains("/b (faces: 2; ptex faces: 4 to 7; shared with /a)") && text.contains("0.001 m"), "{text}");
    let alone = json(&run(folder, &["info", "mesh.usda", "--json", "--prim", "/b"]), None);
    assert_eq!((&alone["faces"], alone["prims"].as_array().map(Vec::len)), (&2.into(), Some(1)));

    let told = run(folder, &["lines", "mesh.usda", "-o", "lines.json"]);
    let lines = json(&told, Some(&folder.join("lines.json")));
    let curves = lines["curves"].as_array().expect("curves");
    let named = |prim: &str| curves.iter().filter(|curve| curve["prim"] == prim).count();
    assert!(named("/a") > 0 && named("/b") > 0 && named("/a") + named("/b") == curves.len());
    for curve in curves {
        let face = curve["params"][0][0].as_u64().expect("a face");
        assert_eq!(curve["prim"], if face < 4 { "/a" } else { "/b" });
    }
    let told = run(folder, &["lines", "mesh.usda", "-o", "lines.json", "--prim", "/b"]);
    let command = json(&told, Some(&folder.join("lines.json")))["made_by"].to_string();
    assert!(command.contains("mesh.usda --prim=/b "), "{command}");

    let told = run(folder, &["quality", "mesh.usda", "--json", "quality.json"]);
    let quality = json(&told, Some(&folder.join("quality.json")));
    let places = quality["places"].as_array().expect("places");
    assert!(!places.is_empty() && places.iter().all(|place| place["prim"] == "/a" || place["prim"] == "/b"));
    assert!(String::from_utf8_lossy(&told.stdout).contains(" of /b"));

    fs::write(folder.join("samples.csv"), "face,u,v\n0,0,0\n").expect("a file");
    let told = run(folder, &["eval", "mesh.usda", "--samples", "samples.csv", "--prim", "/c"]);
    assert_eq!(told.status.code(), Some(2));
    let message = String::from_utf8_lossy(&told.stderr);
    assert_eq!(message, "catoptric: mesh.usda: no prim /c with a Mesh that is shown; there are /a, /b\n");
}

/// An error that was planted is found, and its prim named, in the report and in the command that shows it.
#[test]
fn verify_names_prims() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join("mesh.usda"), HEADER.to_owned() + &scene()).expect("a file");
    let planted = ["--plant", "point:16", "--prim", "/group"];
    let told =
        run(folder, &[&["verify", "mesh.usda", "--json", "report.json", "--size", "64x64"][..], &planted].concat());
    assert_eq!(told.status.code(), Some(1), "{}", String::from_utf8_lossy(&told.stderr));
    let report = json(&told, Some(&folder.join("report.json")));
    assert_eq!(report["meshes"][0]["failures"]["worst"][0]["prim"], "/group/square");
    let tiers = report["meshes"][0]["tiers"].as_array().expect("tiers");
    let failed: Vec<_> = tiers.iter().filter(|tier| tier["pass"] == false).collect();
    assert!(!failed.is_empty());
    for tier in failed {
        assert_eq!(tier["prim"], "/group/square");
        let command = tier["reproduce"].as_str().expect("a command");
        assert!(command.starts_with("catoptric verify --prim=/group --plant"), "{command}");
    }
    assert!(String::from_utf8_lossy(&told.stdout).contains("control face 2 of /group/square"));
}
