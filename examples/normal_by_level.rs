//! Why Stam tables are kept normalised: the error of the normal in f32, level by level.
//!
//! `cargo run --release --example normal_by_level`
//!
//! A patch with an extraordinary vertex of valence N on a curved mesh is evaluated in the middle of each of the three
//! windows of level n, from two f32 tables: *plain*, the points P(n) as Yasui & Kanai 2004 (eq. 8) store them, and
//! *normalised*, Phat(n) = (P(n) - s0) / lambda^(n-1) (docs/LIMIT.md, section 4). The reference is the normalised table in f64.

use catoptric::mesh::SubdivMesh;
use catoptric::stam::{LimitSurface, Net, weights};
use glam::{DVec3, Vec3};

fn main() {
    println!("largest error of the normal in degrees; plain tables at the origin and 100 units away");
    println!("{:>2} {:>10} {:>10} {:>10} {:>10}", "N", "n", "plain", "plain+100", "normalised");
    for valence in [3, 5, 8] {
        let here = errors(valence, DVec3::ZERO);
        let away = errors(valence, DVec3::new(100.0, 0.0, 0.0));
        for (i, (here, away)) in here.iter().zip(&away).enumerate() {
            let normalised = here[1].max(away[1]);
            println!("{valence:>2} {:>10} {:>10.2e} {:>10.2e} {normalised:>10.2e}", i + 1, here[0], away[0]);
        }
    }
}

/// For each level 1 to 20, the largest error in degrees of the plain and of the normalised table.
fn errors(valence: usize, offset: DVec3) -> Vec<[f64; 2]> {
    let mesh = pole(valence).translated(offset);
    let surface = LimitSurface::new(&mesh).expect("the pole is a valid mesh");
    let irregular = (0..surface.patches().len()).filter(|&patch| surface.class(patch).is_some());
    let nets: Vec<_> = irregular.map(|patch| surface.net(patch, 20)).collect();
    let mut worst = vec![[0.0f64; 2]; 20];
    for net in &nets {
        let Net::Irregular { limit, lambda, levels } = net else { continue };
        for (i, points) in levels.iter().enumerate() {
            let plain = points.map(|p| (*limit + lambda.powi(i as i32) * p).as_vec3());
            let normalised = points.map(|p| p.as_vec3());
            for first in [1, 6, 5] {
                let exact = normal_f64(points, first);
                for (error, table) in worst[i].iter_mut().zip([&plain, &normalised]) {
                    let normal = normal_f32(table, first);
                    *error = error.max(normal.cross(exact).length().atan2(normal.dot(exact)).to_degrees());
                }
            }
        }
    }
    worst
}

/// A cap of faces round a vertex of valence N, two rings of quads on a paraboloid.
fn pole(valence: usize) -> SubdivMesh {
    let sectors = 2 * valence;
    let rings = 3;
    let mut points = vec![DVec3::ZERO];
    for ring in 1..=rings {
        for k in 0..sectors {
            let angle = std::f64::consts::TAU * k as f64 / sectors as f64;
            let radius = ring as f64 * if k % 2 == 1 { 1.3 } else { 1.0 };
            let [x, y] = [radius * angle.cos(), radius * angle.sin()];
            points.push(DVec3::new(x, y, -0.1 * (x * x + 0.6 * y * y) + 0.02 * x));
        }
    }
    let at = |ring: usize, k: usize| (1 + (ring - 1) * sectors + k % sectors) as u32;
    let mut face_vertices = Vec::new();
    for k in (0..sectors).step_by(2) {
        face_vertices.extend([0, at(1, k), at(1, k + 1), at(1, k + 2)]);
    }
    for ring in 1..rings {
        for k in 0..sectors {
            face_vertices.extend([at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)]);
        }
    }
    let face_sizes = vec![4; face_vertices.len() / 4];
    SubdivMesh { name: format!("pole {valence}"), points, face_sizes, face_vertices, ..SubdivMesh::default() }
}

/// Normal in the middle of the window that starts at row `first` of a table of 5-point rows without their corner.
fn normal_f64(points: &[DVec3; 24], first: usize) -> DVec3 {
    let [du, dv] = tangents(|k| points[first + 5 * (k / 4) + k % 4 - 1]);
    du.cross(dv).normalize()
}

fn normal_f32(points: &[Vec3; 24], first: usize) -> DVec3 {
    let w = weights([0.5, 0.5]);
    let (mut du, mut dv) = (Vec3::ZERO, Vec3::ZERO);
    for (k, [_, wu, wv]) in w.iter().enumerate() {
        let point = points[first + 5 * (k / 4) + k % 4 - 1];
        du += *wu as f32 * point;
        dv += *wv as f32 * point;
    }
    du.cross(dv).normalize().as_dvec3().normalize()
}

fn tangents(point: impl Fn(usize) -> DVec3) -> [DVec3; 2] {
    let mut out = [DVec3::ZERO; 2];
    for (k, [_, wu, wv]) in weights([0.5, 0.5]).iter().enumerate() {
        out[0] += *wu * point(k);
        out[1] += *wv * point(k);
    }
    out
}
