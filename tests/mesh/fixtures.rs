//! The project's own test meshes: each has the feature that its name says.

use std::collections::HashMap;

use catoptric::mesh::{self, Boundary, Creasing, SubdivMesh};

use crate::{manifest_path, obj_files};

fn fixture(name: &str) -> SubdivMesh {
    mesh::read(&manifest_path(&format!("tests/meshes/{name}.obj"))).unwrap()
}

/// Number of faces at each vertex.
fn faces_at(mesh: &SubdivMesh) -> Vec<usize> {
    let mut faces = vec![0; mesh.vertex_count()];
    for &v in &mesh.face_vertices {
        faces[v as usize] += 1;
    }
    faces
}

/// Number of faces at each edge.
fn faces_at_edges(mesh: &SubdivMesh) -> HashMap<[u32; 2], usize> {
    let mut edges = HashMap::new();
    for (_, face) in mesh.faces() {
        for (k, &a) in face.iter().enumerate() {
            let b = face[(k + 1) % face.len()];
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    edges
}

fn edges_with(mesh: &SubdivMesh, faces: usize) -> usize {
    faces_at_edges(mesh).values().filter(|&&n| n == faces).count()
}

#[test]
fn all_are_read_and_listed() {
    let readme = std::fs::read_to_string(manifest_path("tests/meshes/README.md")).unwrap();
    let files = obj_files(&manifest_path("tests/meshes"));
    assert_eq!(files.len(), 67);
    for file in files {
        let mesh = mesh::read(&file).unwrap();
        assert!(readme.contains(&format!("`{}`", mesh.name)), "{} is not in the README", mesh.name);
        assert!(mesh.diagonal() > 1.0);
    }
}

#[test]
fn closed_meshes_have_two_faces_at_each_edge() {
    for name in ["cube", "corner", "n_gons", "groups_two_components", "negative_indices"] {
        let mesh = fixture(name);
        assert_eq!(edges_with(&mesh, 2), faces_at_edges(&mesh).len(), "{name}");
    }
}

#[test]
fn groups_share_their_vertices() {
    let mesh = fixture("groups_two_components");
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (16, 12));
    assert_eq!(faces_at(&mesh), [3; 16]);
}

#[test]
fn negative_indices_mean_the_same_cube() {
    assert_eq!(fixture("negative_indices").face_vertices, fixture("cube").face_vertices);
}

#[test]
fn poles_have_their_valence() {
    for valence in [3, 5, 8] {
        let mesh = fixture(&format!("pole_{valence}"));
        assert_eq!(mesh.face_count(), 9 * valence);
        assert_eq!(faces_at(&mesh)[0], valence);
        let others = faces_at(&mesh)[1..].iter().filter(|&&n| n > 4).count();
        assert_eq!(others, 0);
    }
    assert_eq!(faces_at(&fixture("n_gons"))[10], 5);
    assert_eq!(*faces_at(&fixture("valence_2_interior")).last().unwrap(), 2);
}

#[test]
fn features_are_what_the_names_say() {
    assert_eq!(fixture("plane_boundary").boundary, Boundary::EdgeOnly);
    assert_eq!(fixture("boundary_none").boundary, Boundary::None);
    assert_eq!(fixture("boundary_edge_only").boundary, Boundary::EdgeOnly);
    assert_eq!(fixture("boundary_edge_and_corner").boundary, Boundary::EdgeAndCorner);
    assert_eq!(fixture("boundary_none").points, fixture("boundary_edge_only").points);
    let sharpness = |name| fixture(name).creases.iter().map(|c| c.sharpness).collect::<Vec<_>>();
    assert_eq!(sharpness("semi_sharp_crease"), [2.3; 4]);
    assert_eq!(sharpness("infinitely_sharp_crease"), [10.0; 4]);
    assert_eq!(sharpness("dart"), [10.0; 2]);
    assert_eq!(sharpness("semi_sharp_dart"), [3.4, 1.7]);
    assert_eq!(sharpness("chaikin_crease"), [1.2, 2.7, 3.5, 0.8, 2.1]);
    assert_eq!(fixture("chaikin_crease").creasing, Creasing::Chaikin);
    assert_eq!(fixture("corner").corners.len(), 2);
    assert_eq!(fixture("hole").holes, [5, 10]);
    assert_eq!(edges_with(&fixture("non_manifold_edge"), 3), 2);
    let mut sizes = fixture("n_gons").face_sizes;
    sizes.dedup();
    assert_eq!(sizes, [5, 4, 3]);
}
