//! Surfaces made in code, some of them with closed forms.
#![allow(dead_code, reason = "each test program uses its part")]

#[path = "rng.rs"]
mod rng;

use catoptric::mesh::{Boundary, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};
use std::collections::HashMap;
use std::f64::consts::TAU;

pub use rng::Rng;

/// A mesh of quads without features.
pub fn quads(name: &str, points: Vec<DVec3>, faces: &[[u32; 4]], boundary: Boundary) -> SubdivMesh {
    SubdivMesh {
        name: name.into(),
        points,
        face_sizes: vec![4; faces.len()],
        face_vertices: faces.concat(),
        boundary,
        ..SubdivMesh::default()
    }
}

/// A rectangular net of uniform bicubics: control point (i,j) at `point(i, j)`, i and j from -1 to `size` + 1. Faces whose net is cut off
/// have no surface, so what is left is `size` x `size` whole bicubics; face (i,j) has its corner (0,0) at knot (i,j).
pub fn bicubics(name: &str, size: usize, point: impl Fn(f64, f64) -> DVec3) -> SubdivMesh {
    let side = size + 3;
    let points = (0..side * side).map(|k| point((k % side) as f64 - 1.0, (k / side) as f64 - 1.0)).collect();
    let faces: Vec<[u32; 4]> = (0..(side - 1) * (side - 1))
        .map(|k| {
            let first = k / (side - 1) * side + k % (side - 1);
            [first, first + 1, first + side + 1, first + side].map(|v| v as u32)
        })
        .collect();
    quads(name, points, &faces, Boundary::None)
}

/// The graph z = (xx x^2 + 2 xy x y + yy y^2) / 2 over a square of side 2 `half` round the origin.
///
/// Uniform cubic B-splines reproduce quadratics: with knots h apart the coefficients of x^2 are x_i^2 - h^2/3, because
/// ((x-h)^2 + 4 x^2 + (x+h)^2) / 6 = x^2 + h^2/3; those of x and of x y are the values themselves. So the limit is the graph.
#[derive(Debug, Clone, Copy)]
pub struct Graph {
    pub xx: f64,
    pub xy: f64,
    pub yy: f64,
    pub half: f64,
}

impl Graph {
    /// Bicubics along a side.
    const SIZE: usize = 6;

    pub fn surface(&self) -> LimitSurface {
        LimitSurface::new(&self.mesh()).expect("it has a surface")
    }

    pub fn mesh(&self) -> SubdivMesh {
        let step = 2.0 * self.half / Self::SIZE as f64;
        bicubics("graph", Self::SIZE, |i, j| {
            let [x, y] = [i, j].map(|k| k * step - self.half);
            let [x2, y2] = [x, y].map(|c| c * c - step * step / 3.0);
            dvec3(x, y, 0.5 * (self.xx * x2 + 2.0 * self.xy * x * y + self.yy * y2))
        })
    }

    pub fn position(&self, x: f64, y: f64) -> DVec3 {
        dvec3(x, y, 0.5 * (self.xx * x * x + 2.0 * self.xy * x * y + self.yy * y * y))
    }

    /// The upper unit normal.
    pub fn normal(&self, x: f64, y: f64) -> DVec3 {
        dvec3(-self.xx * x - self.xy * y, -self.xy * x - self.yy * y, 1.0).normalize()
    }

    pub fn holds(&self, x: f64, y: f64) -> bool {
        x.abs().max(y.abs()) <= self.half
    }
}

/// A cube-like sphere: `size` x `size` faces on each side of a cube, points at the distance that `radius` gives for their direction.
pub fn ball(name: &str, size: usize, radius: impl Fn(DVec3) -> f64) -> SubdivMesh {
    let mut points: Vec<DVec3> = Vec::new();
    let mut known: HashMap<[i64; 3], u32> = HashMap::new();
    let mut faces = Vec::new();
    let at = |k: usize| 2.0 * k as f64 / size as f64 - 1.0;
    for side in 0..6 {
        let axis = [DVec3::X, DVec3::Y, DVec3::Z][side % 3] * if side < 3 { 1.0 } else { -1.0 };
        let along = [DVec3::Y, DVec3::Z, DVec3::X][side % 3];
        let up = axis.cross(along);
        let mut index = |i: usize, j: usize| {
            let on_cube = axis + along * at(i) + up * at(j);
            *known.entry((on_cube * 1e6).round().to_array().map(|x| x as i64)).or_insert_with(|| {
                let direction = on_cube.normalize();
                points.push(direction * radius(direction));
                points.len() as u32 - 1
            })
        };
        for (i, j) in (0..size * size).map(|k| (k % size, k / size)) {
            faces.push([index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]);
        }
    }
    quads(name, points, &faces, Boundary::EdgeAndCorner)
}

/// A ball of random bumps.
pub fn bumpy_ball(seed: u64, size: usize, height: f64) -> SubdivMesh {
    let rng = std::cell::RefCell::new(Rng::new(seed));
    ball(&format!("bumpy ball {seed}"), size, |_| 1.0 + height * (rng.borrow_mut().unit() - 0.5))
}

/// A torus of regular faces.
pub fn torus(around: usize, across: usize, radii: [f64; 2]) -> SubdivMesh {
    let point = |k: usize| {
        let [a, b] = [(k % around) as f64 / around as f64, (k / around) as f64 / across as f64].map(|t| t * TAU);
        let reach = radii[0] + radii[1] * b.cos();
        dvec3(reach * a.cos(), reach * a.sin(), radii[1] * b.sin())
    };
    let index = |i: usize, j: usize| (j % across * around + i % around) as u32;
    let faces: Vec<_> = (0..around * across)
        .map(|k| (k % around, k / around))
        .map(|(i, j)| [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)])
        .collect();
    quads("torus", (0..around * across).map(point).collect(), &faces, Boundary::EdgeAndCorner)
}

/// A random point in the cube of side 2.
pub fn in_cube(rng: &mut Rng) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| 2.0 * rng.unit() - 1.0))
}
