//! Meshes that come from no file, and what they measure.

use catoptric::mesh::{Corner, Crease, SubdivMesh};
use glam::DVec3;

fn quad() -> SubdivMesh {
    SubdivMesh {
        name: "quad".to_owned(),
        points: vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 2.0, 0.0), DVec3::Y, DVec3::splat(9.0)],
        face_sizes: vec![4],
        face_vertices: vec![0, 1, 2, 3],
        ..SubdivMesh::default()
    }
}

fn refused(change: impl FnOnce(&mut SubdivMesh)) -> String {
    let mut mesh = quad();
    change(&mut mesh);
    mesh.validate().expect_err("a mesh that is refused").to_string()
}

#[test]
fn the_place_is_the_part() {
    quad().validate().unwrap();
    assert_eq!(
        refused(|m| m.face_vertices[3] = 5),
        "quad, face 0: a face with vertex 5, but the mesh has only 0 to 4; correct it"
    );
    assert_eq!(
        refused(|m| m.face_vertices[3] = u32::MAX),
        "quad, face 0: a face with vertex 4294967295, but the mesh has only 0 to 4; correct it"
    );
    assert_eq!(
        refused(|m| m.points[4].y = f64::NAN),
        "quad, vertex 4: coordinate NaN is not finite; correct the vertex"
    );
    assert_eq!(
        refused(|m| m.holes = vec![0, 1]),
        "quad, hole 1: a hole at face 1, but the mesh has only 0 to 0; count from 0"
    );
    assert_eq!(
        refused(|m| m.corners.push(Corner { vertex: 0, sharpness: f32::NAN })),
        "quad, corner 0: sharpness NaN is not finite; use 0 (smooth) to 10 (infinitely sharp)"
    );
    assert_eq!(
        refused(|m| m.creases.push(Crease { vertices: [0, 2], sharpness: 1.0 })),
        "quad, crease 0: a crease from vertex 0 to 2, but no face has that edge; count from 0"
    );
    assert_eq!(
        refused(|m| {
            m.face_sizes = vec![4, 4];
            m.face_vertices.extend([1, 2, 3, 0]);
        }),
        "quad, face 1: the same face as face 0; delete one of the two"
    );
}

#[test]
fn sizes_that_do_not_add_up() {
    for size in [3, 5, u32::MAX] {
        assert_eq!(
            refused(|m| m.face_sizes[0] = size),
            format!(
                "quad: the face sizes add up to {size}, but there are 4 face vertices; \
                 make both agree"
            )
        );
    }
}

#[test]
fn the_default_mesh_is_refused_without_a_panic() {
    assert!(SubdivMesh::default().validate().is_err());
    assert_eq!(SubdivMesh::default().diagonal(), 0.0);
    assert_eq!(SubdivMesh::default().bounds(), None);
}

#[test]
fn measures() {
    let mesh = quad();
    assert_eq!((mesh.face_count(), mesh.vertex_count()), (1, 5));
    let faces: Vec<_> = mesh.faces().collect();
    assert_eq!(faces, [(0, [0, 1, 2, 3].as_slice())]);
    // Point 4 belongs to no face.
    assert_eq!(mesh.bounds(), Some((DVec3::ZERO, DVec3::new(1.0, 2.0, 0.0))));
    assert_eq!(mesh.diagonal(), 5.0_f64.sqrt());
    let moved = mesh.translated(DVec3::new(1000.0, -500.0, 200.0));
    assert_eq!(moved.points[2], DVec3::new(1001.0, -498.0, 200.0));
    assert_eq!(moved.face_vertices, mesh.face_vertices);
}
