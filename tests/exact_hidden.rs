//! Surfaces of so many patches that the pixel-exact pipeline leaves out those that nearer ones hide: pixel by pixel against
//! the ray caster.

mod caster;
mod common;
#[allow(dead_code, reason = "each test program uses its part")]
mod gpu_support;
mod pixels;

use caster::Caster;
use catoptric::field::{Camera, Projection, Scout};
use catoptric::gpu::View;
use catoptric::mesh::SubdivMesh;
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};
use gpu_support::gpu;
use pixels::{Judge, Limits, Pixels, Report};
use std::f64::consts::TAU;

/// A wavy torus of triangles: each is three quads, and every patch of those that has a corner at their middle or at a vertex
/// of the mesh is irregular.
fn torus(around: u32, across: u32) -> SubdivMesh {
    let point = |k: u32| {
        let (a, b) = (TAU * f64::from(k / across) / f64::from(around), TAU * f64::from(k % across) / f64::from(across));
        let r = 1.0 + 0.4 * b.cos() + 0.05 * (9.0 * a + 3.0 * b).sin();
        dvec3(r * a.cos(), r * a.sin(), 0.4 * b.sin() + 0.03 * (7.0 * a).cos())
    };
    let vertex = |i: u32, j: u32| i % around * across + j % across;
    let quads = (0..around * across).map(|k| (k / across, k % across));
    let triangles = |(i, j)| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        [a, b, c, a, c, d]
    };
    SubdivMesh {
        name: "torus".into(),
        points: (0..around * across).map(point).collect(),
        face_sizes: vec![3; 2 * (around * across) as usize],
        face_vertices: quads.flat_map(triangles).collect(),
        ..SubdivMesh::default()
    }
}

#[test]
fn what_is_hidden_is_left_out() {
    let surface = LimitSurface::new(&torus(40, 20)).expect("it has a surface");
    assert!(surface.patches().len() > 16_000);
    let tables = gpu().upload(&surface).expect("it fits");
    let caster = Caster::new(&surface);
    let scout = Scout::new(&surface).expect("it has patches");
    let fitted = |direction: DVec3| scout.camera_from([200, 180], DVec3::Z, direction, 26.0);
    let grazing = fitted(dvec3(-0.8, -0.6, 0.3));
    let cameras = [
        ("fit", fitted(dvec3(0.6, -0.7, 0.9))),
        ("grazing", grazing),
        ("orthographic", Camera { projection: Projection::Orthographic { height: 2.0 }, ..grazing }),
        ("from inside", Camera { eye: dvec3(1.0, 0.1, 0.0), target: dvec3(0.3, 0.95, 0.0), ..grazing }),
    ];
    println!("{}", Report::header());
    for (name, camera) in cameras {
        let view = View { samples: 1, ..View::new(camera, scout.light(&camera)) };
        let image = gpu().inspect(&tables, &view).expect("the adapter works");
        let report = Judge::new(&caster, camera).judge(name, &Pixels::from(&image));
        println!("{report}");
        let failures = report.failures(&Limits::EXACT);
        assert!(failures.is_empty(), "{failures:?}");
    }
}
