//! Curves on the sample that no tracer made.

use catoptric::curves::{Curve, Place};
use catoptric::field::{Camera, Scout};
use catoptric::mesh;
use catoptric::output::{Lines, LinesFormat};
use catoptric::stam::LimitSurface;
use glam::DVec3;
use std::path::PathBuf;

/// Everything that a format may take for its own: quotes, tags, escapes, what ends lines and comments, and letters
/// beyond ASCII.
pub const HOSTILE: &str = "catoptric lines 'a <b>&amp; \"c\" */ --> ]]> %s \u{fc}\u{1f697} \\n\n\t\u{1}d.obj' \\";
/// What [`HOSTILE`] is in a comment of one line.
pub const HOSTILE_LINE: &str =
    "catoptric lines 'a <b>&amp; \"c\" */ --> ]]> %s \u{fc}\u{1f697} \\n\u{fffd}\u{fffd}\u{fffd}d.obj' \\.";

pub fn surface() -> LimitSurface {
    LimitSurface::new(&mesh::sample()).expect("the sample is valid")
}

/// A curve through places of one ptex face.
fn through(surface: &LimitSurface, face: u32, closed: bool, key: (i32, f64), uvs: &[[f64; 2]]) -> Curve {
    let point = |uv: &[f64; 2]| surface.evaluate_ptex(face, *uv).expect("it is no hole").1.position;
    Curve {
        value: key.1,
        light: key.0,
        closed,
        points: uvs.iter().map(point).collect(),
        places: uvs.iter().map(|&[u, v]| Place { face, u, v }).collect(),
    }
}

/// Circles and lines on faces all over the surface, lights -1 to 2, light 2 with two values; among them a closed curve
/// of two points, and one of a single point, which only JSON keeps.
pub fn curves(surface: &LimitSurface) -> Vec<Curve> {
    let circle = |n: u32, radius: f64| -> Vec<[f64; 2]> {
        (0..n)
            .map(|i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(n)).sin_cos();
                [0.5 + radius * cos, 0.5 + radius * sin]
            })
            .collect()
    };
    let across: Vec<[f64; 2]> = (0..=20).map(|i| [f64::from(i) / 20.0, 0.3 + f64::from(i) / 60.0]).collect();
    let faces: Vec<u32> =
        (0..surface.ptex_count() as u32).filter(|&face| surface.evaluate_ptex(face, [0.5; 2]).is_some()).collect();
    let mut curves = Vec::new();
    for (i, &face) in faces.iter().step_by(2).enumerate() {
        let key = [(2, 1.0 / 3.0), (-1, -0.1), (2, -1.0 / 3.0), (0, 0.0)][i % 4];
        curves.push(match i % 3 {
            0 => through(surface, face, true, key, &circle(40, 0.45)),
            1 => through(surface, face, false, key, &across),
            _ => through(surface, face, true, key, &circle(7, 0.2)),
        });
    }
    curves.push(through(surface, faces[1], true, (0, 0.0), &[[0.25, 0.25], [0.75, 0.5]]));
    curves.push(through(surface, faces[2], false, (7, 1e-9), &[[0.5, 0.5]]));
    curves
}

/// A camera so near that curves leave the picture on all sides.
pub fn close_camera(surface: &LimitSurface, size: [u32; 2]) -> Camera {
    let mut camera = Scout::new(surface).expect("it has faces").camera(size, DVec3::Z);
    camera.eye = camera.target + (camera.eye - camera.target) * 0.3;
    camera
}

/// The curves as a file in a folder of its own.
pub fn written(curves: &[Curve], camera: &Camera, format: LinesFormat, name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes(curves, camera, format)).expect("it is written");
    (folder, path)
}

pub fn bytes(curves: &[Curve], camera: &Camera, format: LinesFormat) -> Vec<u8> {
    let mut out = Vec::new();
    let lines = Lines { curves, field: "curve:x < y & \"z\"", camera, made_by: HOSTILE, parts: None };
    lines.write(format, &mut out).expect("memory takes it");
    out
}

/// Names of the groups of [`curves`] in order, with light and value.
pub const GROUPS: [(&str, i32, f64); 4] =
    [("light_minus_1", -1, -0.1), ("light_0", 0, 0.0), ("light_2_1", 2, -1.0 / 3.0), ("light_2_2", 2, 1.0 / 3.0)];

/// The curves of a group that formats keep.
pub fn of_group(curves: &[Curve], light: i32, value: f64) -> Vec<&Curve> {
    let kept = |curve: &&Curve| curve.light == light && curve.value == value && curve.points.len() > 1;
    let found: Vec<&Curve> = curves.iter().filter(kept).collect();
    assert!(found.len() > 1, "{light} {value}");
    found
}
