//! tobj reads the same geometry: the same points at the corners of the same faces.
//!
//! tobj re-indexes vertices a group, so faces are compared by positions, to the last bit.

use std::path::{Path, PathBuf};

use catoptric::mesh::{self, SubdivMesh};

use crate::{manifest_path, obj_files};

type Polygon = Vec<[f64; 3]>;

/// The faces of all of tobj's models, as positions.
fn by_tobj(path: &Path) -> Vec<Polygon> {
    let (models, _) = tobj::load_obj(path, &tobj::LoadOptions::default()).expect("tobj reads it");
    let mut faces = Vec::new();
    for tobj::Model { mesh, .. } in &models {
        // tobj leaves out the sizes where all faces are triangles.
        let triangles = vec![3; mesh.indices.len() / 3];
        let sizes = if mesh.face_arities.is_empty() { &triangles } else { &mesh.face_arities };
        let mut rest = mesh.indices.as_slice();
        for &size in sizes {
            let (face, tail) = rest.split_at(size as usize);
            let point = |&v: &u32| [0, 1, 2].map(|axis| mesh.positions[3 * v as usize + axis]);
            faces.push(face.iter().map(point).collect());
            rest = tail;
        }
    }
    faces
}

fn by_us(mesh: &SubdivMesh) -> Vec<Polygon> {
    let point = |&v: &u32| mesh.points[v as usize].to_array();
    mesh.faces().map(|(_, face)| face.iter().map(point).collect()).collect()
}

fn assert_same(ours: &[Polygon], theirs: &[Polygon], name: &str) {
    assert_eq!(ours.len(), theirs.len(), "{name}");
    for (i, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert_eq!(a, b, "{name}, face {i}");
    }
}

fn files() -> Vec<PathBuf> {
    ["tests/meshes", "../shared/meshes/opensubdiv", "../shared/meshes/blender"]
        .iter()
        .flat_map(|folder| obj_files(&manifest_path(folder)))
        .collect()
}

#[test]
fn the_same_polygons() {
    let mut compared = 0;
    for file in files() {
        match mesh::read(&file) {
            Ok(mesh) => {
                assert_same(&by_us(&mesh), &by_tobj(&file), &mesh.name);
                compared += 1;
            }
            Err(error) => println!("skipped: {error}"),
        }
    }
    println!("{compared} files compared with tobj");
    assert!(compared >= 20, "the project's own meshes");
}

#[test]
fn the_same_polygons_in_every_form() {
    let text = "v 0.1 0.2 0.3\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
                g a\nf 1/1/1 2/1/1 3/1/1 4/1/1\ng b\nf 1//1 2//1 3//1\nv 2 3 4\nv 5 6 7\n\
                f -1 -2 -3\no c\nf 4/1 3/1 5/1 6/1 1/1\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("forms.obj");
    std::fs::write(&path, text).unwrap();
    let mesh = mesh::read(&path).unwrap();
    assert_eq!(mesh.face_vertices, [0, 1, 2, 3, 0, 1, 2, 5, 4, 3, 3, 2, 4, 5, 0]);
    assert_same(&by_us(&mesh), &by_tobj(&path), "forms");
}
