//! A mesh of any size with all that makes work: a wavy sheet of quads with a boundary; two faces in a hundred are two triangles or a
//! hexagon instead, so that there are extraordinary vertices of valence 3, 5 and 6 everywhere, and every fiftieth row and column is a
//! crease of sharpness 1, 2.5, 3.3 or infinite.

use crate::mesh::{Crease, SubdivMesh};
use glam::DVec3;
use std::fmt::Write;

/// About `faces` faces.
pub(super) fn sheet(faces: usize) -> SubdivMesh {
    const SHARPNESS: [f32; 4] = [1.0, 2.5, 3.3, 10.0];
    let side = faces.isqrt();
    let vertex = |i: usize, j: usize| (j * (side + 1) + i) as u32;
    let mut mesh = SubdivMesh { name: "sheet".to_owned(), ..SubdivMesh::default() };
    for j in 0..=side {
        for i in 0..=side {
            let [x, y] = [i, j].map(|k| k as f64 / side as f64 * 4.0 - 2.0);
            let wave = 0.3 * (3.0 * x).sin() * (2.5 * y).cos() + 0.05 * (17.0 * x + 11.0 * y).sin();
            mesh.points.push(DVec3::new(x, y, wave));
        }
    }
    let mut push = |face: &[u32]| {
        mesh.face_sizes.push(face.len() as u32);
        mesh.face_vertices.extend(face);
    };
    let mut seed = 1u64;
    for j in 0..side {
        let mut i = 0;
        while i < side {
            // A linear congruential generator (Knuth's MMIX constants).
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            let on_crease = (i + 1) % 50 == 0 || j % 50 == 0 || (j + 1) % 50 == 0;
            match seed >> 33 {
                x if x % 100 == 0 => [[a, b, c], [a, c, d]].iter().for_each(|face| push(face)),
                x if x % 100 == 1 && i + 2 <= side && !on_crease => {
                    push(&[a, b, vertex(i + 2, j), vertex(i + 2, j + 1), c, d]);
                    i += 1;
                }
                _ => push(&[a, b, c, d]),
            }
            i += 1;
        }
    }
    for at in (50..side).step_by(50) {
        let sharpness = SHARPNESS[at / 50 % 4];
        for i in 0..side {
            mesh.creases.push(Crease { vertices: [vertex(i, at), vertex(i + 1, at)], sharpness });
            mesh.creases.push(Crease { vertices: [vertex(at, i), vertex(at, i + 1)], sharpness });
        }
    }
    mesh
}

/// Its file.
pub(super) fn obj(mesh: &SubdivMesh) -> Result<String, std::fmt::Error> {
    let mut text = String::from("t interpolateboundary 1/0/0 1\n");
    for p in &mesh.points {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for (_, face) in mesh.faces() {
        text.push('f');
        face.iter().try_for_each(|vertex| write!(text, " {}", vertex + 1))?;
        text.push('\n');
    }
    for Crease { vertices: [a, b], sharpness } in &mesh.creases {
        writeln!(text, "t crease 2/1/0 {a} {b} {sharpness}")?;
    }
    Ok(text)
}
