//! Meshes of OBJ files, written as USD and read back: every test mesh, in all three formats.

use std::fmt::Write;
use std::fs;

use catoptric::mesh::{self, Boundary, Creasing, Part, SubdivMesh};
use glam::DVec3;

use crate::{HEADER, common, converted, prim};

fn list<T>(values: impl IntoIterator<Item = T>, show: impl Fn(T) -> String) -> String {
    values.into_iter().map(show).collect::<Vec<_>>().join(", ")
}

/// The attributes of a mesh with points in 32 bits. `chains`: creases that follow each other become one, a sharpness an edge.
fn attributes(mesh: &SubdivMesh, chains: bool) -> String {
    let mut text = String::new();
    let mut say = |name: &str, value: String| writeln!(text, "    {name} = {value}").expect("it fits");
    let point = |p: &DVec3| format!("({:?}, {:?}, {:?})", p.x as f32, p.y as f32, p.z as f32);
    say("point3f[] points", format!("[{}]", list(&mesh.points, point)));
    say("int[] faceVertexCounts", format!("[{}]", list(&mesh.face_sizes, u32::to_string)));
    say("int[] faceVertexIndices", format!("[{}]", list(&mesh.face_vertices, u32::to_string)));
    let mut indices: Vec<u32> = Vec::new();
    let mut lengths: Vec<u32> = Vec::new();
    for crease in &mesh.creases {
        match lengths.last_mut() {
            Some(length) if chains && indices.last() == Some(&crease.vertices[0]) => {
                *length += 1;
                indices.push(crease.vertices[1]);
            }
            _ => {
                lengths.push(2);
                indices.extend(crease.vertices);
            }
        }
    }
    say("int[] creaseIndices", format!("[{}]", list(&indices, u32::to_string)));
    say("int[] creaseLengths", format!("[{}]", list(&lengths, u32::to_string)));
    say("float[] creaseSharpnesses", format!("[{}]", list(&mesh.creases, |c| format!("{:?}", c.sharpness))));
    say("int[] cornerIndices", format!("[{}]", list(&mesh.corners, |c| c.vertex.to_string())));
    say("float[] cornerSharpnesses", format!("[{}]", list(&mesh.corners, |c| format!("{:?}", c.sharpness))));
    say("int[] holeIndices", format!("[{}]", list(&mesh.holes, u32::to_string)));
    let rule = match mesh.boundary {
        Boundary::None => "none",
        Boundary::EdgeOnly => "edgeOnly",
        Boundary::EdgeAndCorner => "edgeAndCorner",
    };
    say("token interpolateBoundary", format!("\"{rule}\""));
    text
}

/// As the file is to be read: points rounded, named after it, with the unit and the up axis that a stage has by default.
fn expected(mesh: &SubdivMesh) -> SubdivMesh {
    let round = |p: &DVec3| p.as_vec3().as_dvec3();
    let [faces, points] = [mesh.face_count(), mesh.points.len()].map(|count| 0..count as u32);
    SubdivMesh {
        name: "twin".to_owned(),
        points: mesh.points.iter().map(round).collect(),
        up: Some(DVec3::Y),
        meters_per_unit: Some(0.01),
        parts: vec![Part { name: "/m".to_owned(), faces, points, repeats: None }],
        // A stage has no lines.
        face_lines: Vec::new(),
        ..mesh.clone()
    }
}

#[test]
fn every_test_mesh_comes_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("twin.usda");
    let mut compared = 0;
    // USD has no crease method: uniform is what it means.
    for mesh in common::meshes().iter().filter(|mesh| mesh.creasing == Creasing::Uniform) {
        for chains in [false, true] {
            fs::write(&path, HEADER.to_owned() + &prim("m", &attributes(mesh, chains))).expect("a file");
            let [crate_file, package] = converted(&path);
            for path in [&path, &crate_file, &package] {
                let read = mesh::read(path).unwrap_or_else(|error| panic!("{}: {error}", mesh.name));
                assert_eq!(read, expected(mesh), "{} as {}", mesh.name, path.display());
                compared += 1;
            }
        }
    }
    assert!(compared > 300, "only {compared} files");
}

/// Two meshes are one after the other, whatever their boundary rules.
#[test]
fn meshes_of_a_scene_are_one() {
    let pick = |name: &str| common::meshes().into_iter().find(|mesh| mesh.name == name).expect("a test mesh");
    let [first, second] = ["boundary_edge_only", "boundary_edge_and_corner"].map(|name| expected(&pick(name)));
    let text = prim("a", &attributes(&first, false)) + &prim("b", &attributes(&second, true));
    let both = crate::accepted(&text);
    assert_eq!(both.boundary, Boundary::EdgeOnly);
    assert_eq!(both.face_count(), first.face_count() + second.face_count());
    let surface = |mesh: &SubdivMesh| catoptric::stam::LimitSurface::new(mesh).expect("a surface");
    let [both, first, second] = [&both, &first, &second].map(surface);
    let mut compared = 0;
    let (one, other) = (first.ptex_count() as u32, second.ptex_count() as u32);
    for ptex in 0..one + other {
        for uv in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.3, 0.6], [0.5, 0.01]] {
            let alone = if ptex < one { first.evaluate_ptex(ptex, uv) } else { second.evaluate_ptex(ptex - one, uv) };
            let alone = alone.expect("a point").1.position;
            let together = both.evaluate_ptex(ptex, uv).expect("a point").1.position;
            assert!(alone.distance(together) <= 1e-14 * both.diagonal(), "{ptex} {uv:?}: {alone} {together}");
            compared += 1;
        }
    }
    assert!(compared >= 12, "only {compared} points");
}
