//! OpenSubdiv's regression shapes and Blender's export, where they lie beside the project.

use std::fs;
use std::path::PathBuf;

use catoptric::mesh::{self, Boundary, Choice, Creasing, SubdivMesh};

use crate::{manifest_path, obj_files, read_text};

/// Shapes that are refused, and rightly: their quads name a vertex twice.
const REFUSED: [(&str, &str); 2] = [
    ("catmark_nonman_edges", ".obj:141: a face with vertex 52 twice; name each vertex of a face once"),
    ("catmark_nonman_quadpole8", ".obj:19: a face with vertex 5 twice; name each vertex of a face once"),
];

/// Name, vertices, faces, creased edges, corners, holes.
const COUNTS: [(&str, [usize; 5]); 11] = [
    ("catmark_car", [1642, 1575, 314, 0, 0]),
    ("catmark_chaikin1", [24, 22, 28, 0, 0]),
    ("catmark_cube", [8, 6, 0, 0, 0]),
    ("catmark_cubes_semisharp", [32, 24, 14, 2, 0]),
    ("catmark_edgeonly", [40, 20, 0, 6, 0]),
    ("catmark_fan", [22, 13, 0, 0, 0]),
    ("catmark_hole_test2", [25, 16, 1, 0, 4]),
    ("catmark_nonman_bareverts", [25, 8, 0, 0, 0]),
    ("catmark_nonquads", [33, 17, 0, 0, 0]),
    ("catmark_rook", [768, 777, 280, 0, 0]),
    ("suzanne_and_cube", [515, 506, 0, 0, 0]),
];

fn corpus() -> Vec<PathBuf> {
    ["opensubdiv", "blender"]
        .iter()
        .flat_map(|folder| obj_files(&manifest_path(&format!("../shared/meshes/{folder}"))))
        .collect()
}

fn counts(mesh: &SubdivMesh) -> [usize; 5] {
    [mesh.vertex_count(), mesh.face_count(), mesh.creases.len(), mesh.corners.len(), mesh.holes.len()]
}

#[test]
fn all_load_or_are_refused_for_a_reason() {
    let (mut loaded, mut refused) = (0, 0);
    for file in corpus() {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let reason = REFUSED.iter().find(|(shape, _)| *shape == name);
        match (mesh::read_choice(&file, &Choice { strict: true, ..Choice::default() }), reason) {
            (Ok(mesh), None) => {
                loaded += 1;
                mesh.validate().unwrap();
                if let Some((_, expected)) = COUNTS.iter().find(|(shape, _)| *shape == name) {
                    assert_eq!(counts(&mesh), *expected, "{name}");
                }
            }
            (Err(error), Some((_, expected))) => {
                refused += 1;
                assert!(error.to_string().ends_with(expected), "{error}");
                let mesh = mesh::read(&file).unwrap_or_else(|error| panic!("{error}"));
                assert!(!mesh.bad_faces.is_empty() && mesh.notes.len() == 1, "{name}: {:?}", mesh.notes);
                mesh.validate().unwrap();
            }
            (result, _) => panic!("{name}: {result:?}"),
        }
    }
    println!("{loaded} loaded, {refused} refused");
}

#[test]
fn rules_are_those_of_the_tags() {
    for file in corpus() {
        let Ok(mesh) = mesh::read(&file) else {
            println!("skipped: {} is refused", file.display());
            continue;
        };
        let text = fs::read_to_string(&file).unwrap();
        let expected = if text.contains("t interpolateboundary 1/0/0 0") {
            Boundary::None
        } else if text.contains("t interpolateboundary 1/0/0 1") {
            Boundary::EdgeAndCorner
        } else {
            Boundary::EdgeOnly
        };
        assert_eq!(mesh.boundary, expected, "{}", mesh.name);
        assert_eq!(mesh.creasing == Creasing::Chaikin, mesh.name == "catmark_chaikin1");
    }
}

#[test]
fn truncated_files_do_not_panic() {
    let own = obj_files(&manifest_path("tests/meshes"));
    for file in own.into_iter().chain(corpus()) {
        let text = fs::read(&file).unwrap();
        for percent in (0..100).step_by(5) {
            if let Err(error) = read_text(&text[..text.len() * percent / 100]) {
                assert_eq!(error.to_string().lines().count(), 1, "{error}");
            }
        }
    }
}
