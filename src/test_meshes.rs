//! Meshes that tests of several stations make.

use crate::mesh::{Scheme, SubdivMesh, parse_obj};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Quads round a vertex of `faces` faces and a ring of quads round them: a disk, or where it is not `closed` the part of one whose boundary
/// runs through the vertex. The spokes in `sharp` are infinitely sharp.
pub(crate) fn fan(faces: u32, closed: bool, sharp: &[u32]) -> SubdivMesh {
    let count = 2 * faces + u32::from(!closed);
    let turn = if closed { TAU } else { 0.6 * TAU };
    let mut text = "v 0 0 0.3\n".to_owned();
    // Writing to a String cannot fail.
    for radius in [1.0, 2.0] {
        for i in 0..count {
            let angle = turn * f64::from(i) / f64::from(2 * faces);
            let height = 0.1 * (3.0 * angle).cos() - 0.2 * radius;
            let radius = radius + 0.05 * (7.0 * angle).sin();
            let _ = writeln!(text, "v {} {} {height}", radius * angle.cos(), radius * angle.sin());
        }
    }
    for i in 0..faces {
        let _ = writeln!(text, "f 1 {} {} {}", 2 * i + 2, 2 * i + 3, (2 * i + 2) % count + 2);
    }
    for i in 0..2 * faces {
        let next = (i + 1) % count;
        let _ = writeln!(text, "f {} {} {} {}", i + 2, i + count + 2, next + count + 2, next + 2);
    }
    for spoke in sharp {
        let _ = writeln!(text, "t crease 2/1/0 0 {} 10", 2 * spoke + 1);
    }
    parse_obj(text.as_bytes(), "fan").expect("a valid mesh")
}

/// Triangles round a vertex and a ring of triangles round them, under Loop's rules.
pub(crate) fn triangle_fan(faces: u32, sharp: &[u32]) -> SubdivMesh {
    let quads = fan(faces, true, &[]);
    let corner = |k: u32| 1 + k % (2 * faces);
    let outer = |k: u32| corner(k) + 2 * faces;
    let mut text = String::new();
    quads.points.iter().for_each(|p| _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z));
    for i in (0..2 * faces).step_by(2) {
        let _ = writeln!(text, "f 1 {} {}", corner(i) + 1, corner(i + 2) + 1);
        let _ = writeln!(text, "f {} {} {}", corner(i) + 1, outer(i) + 1, outer(i + 2) + 1);
        let _ = writeln!(text, "f {} {} {}", corner(i) + 1, outer(i + 2) + 1, corner(i + 2) + 1);
    }
    for spoke in sharp {
        let _ = writeln!(text, "t crease 2/1/0 0 {} 10", 2 * spoke + 1);
    }
    let mesh = parse_obj(text.as_bytes(), "triangle fan").expect("a valid mesh");
    SubdivMesh { scheme: Scheme::Loop, ..mesh }
}
