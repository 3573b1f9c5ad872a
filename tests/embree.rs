//! What Embree answers where it is a peer of benchmarks: what is timed is right.
#![cfg(feature = "peers")]

mod common;

use catoptric::mesh::{Boundary, SubdivMesh, sample};
use catoptric::osd::{EmbreeCamera, EmbreeSamples, EmbreeSubdivision, EmbreeTriangles, INFINITE_SHARPNESS};
use catoptric::stam::LimitSurface;
use common::meshes;
use glam::DVec3;

/// Largest differences of position and of derivatives from the exact limit, as parts of the surface's diagonal.
fn differences(mesh: &SubdivMesh) -> [f64; 2] {
    let surface = LimitSurface::new(mesh).expect("a surface");
    let [low, high] = surface.bounds().expect("it has faces");
    let uv = [[0.5, 0.5], [0.25, 0.125], [0.3125, 0.9375], [0.71875, 0.40625]];
    let all = (0..mesh.ptex_count() as u32).flat_map(|face| uv.map(|[u, v]| (face, u, v)));
    let places: Vec<(u32, f32, f32)> =
        all.filter(|&(face, u, v)| surface.locate(face, [u, v].map(f64::from)).is_some()).collect();
    let samples = EmbreeSamples::new(mesh, &places);
    let mut out = vec![0.0; samples.room()];
    EmbreeSubdivision::new(mesh).expect("it takes the mesh").evaluate(&samples, &mut out).expect("an answer");
    let mut worst = [0.0f64; 2];
    for (index, &(face, u, v)) in places.iter().enumerate() {
        let (_, exact) = surface.evaluate_ptex(face, [u, v].map(f64::from)).expect("a place with a surface");
        let [position, du, dv] = samples.jet(&out, index).map(|x| DVec3::from_array(x.map(f64::from)));
        worst[0] = worst[0].max(position.distance(exact.position));
        worst[1] = worst[1].max(du.distance(exact.du)).max(dv.distance(exact.dv));
    }
    worst.map(|off| off / low.distance(high))
}

/// Whether Embree's rules are OpenSubdiv's: holes have boundaries there, finite sharpness decays otherwise, corners of one face
/// are never smooth, and vertices of valence 2 or that are not manifold have rules of their own.
fn same_rules(mesh: &SubdivMesh) -> bool {
    const OTHERWISE: [&str; 6] =
        ["mixed_orientation", "non_manifold_edge", "non_manifold_crease", "valence_2", "bow_tie", "boundary_pole_1"];
    let infinite = |sharpness: f32| sharpness >= INFINITE_SHARPNESS;
    let sharp = mesh.creases.iter().all(|crease| infinite(crease.sharpness))
        && mesh.corners.iter().all(|corner| infinite(corner.sharpness));
    let corners_agree = mesh.boundary != Boundary::EdgeOnly || mesh.creases.len() + mesh.corners.len() > 0;
    let named = OTHERWISE.iter().any(|name| mesh.name.starts_with(name));
    EmbreeSubdivision::takes(mesh) && sharp && corners_agree && mesh.holes.is_empty() && !named
}

/// In single precision: sums of sixteen products of numbers up to the diagonal round by less than 16 times 2^-24 of it;
/// five times that for derivatives.
#[test]
fn embree_answers_the_limit_where_its_rules_are_the_same() {
    const POSITION: f64 = 16.0 / (1 << 24) as f64;
    let compared: Vec<SubdivMesh> = meshes().into_iter().filter(same_rules).collect();
    assert!(compared.len() >= 30, "only {} meshes are compared", compared.len());
    for mesh in compared {
        let [position, derivative] = differences(&mesh);
        assert!(position < POSITION && derivative < 5.0 * POSITION, "{}: {position:e} {derivative:e}", mesh.name);
    }
}

/// Where creases of finite sharpness cross, Embree has another rule: not the limit, but near it.
#[test]
fn embree_is_near_the_limit_of_the_sample() {
    let [position, derivative] = differences(&sample());
    assert!(position < 1e-4 && derivative < 1e-3, "{position:e} {derivative:e}");
}

/// A prism over a polygon of so many sides.
fn prism(sides: u32) -> SubdivMesh {
    let ring = |z: f64| {
        (0..sides).map(move |i| {
            let (y, x) = (std::f64::consts::TAU * f64::from(i) / f64::from(sides)).sin_cos();
            DVec3::new(x, y, z)
        })
    };
    let walls = (0..sides).flat_map(|i| {
        let next = (i + 1) % sides;
        [i, next, sides + next, sides + i]
    });
    SubdivMesh {
        name: "prism".into(),
        points: ring(0.0).chain(ring(1.0)).collect(),
        face_sizes: [sides; 2].into_iter().chain((0..sides).map(|_| 4)).collect(),
        face_vertices: (0..sides).rev().chain(sides..2 * sides).chain(walls).collect(),
        ..SubdivMesh::default()
    }
}

/// Debian's Embree has assertions, which would end the process.
#[test]
fn meshes_that_embree_aborts_on_are_refused() {
    let [position, _] = differences(&prism(15));
    assert!(position < 1e-3, "{position:e}");
    assert!(!EmbreeSubdivision::takes(&prism(16)));
    let refusal = EmbreeSubdivision::new(&prism(16)).expect_err("a face of 16 edges").to_string();
    assert!(refusal.contains("15 edges"), "{refusal}");
}

/// A unit square seen from above, by pictures whose sides are no multiple of a packet's.
#[test]
fn rays_meet_a_square_where_it_is() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let square = EmbreeTriangles::new(&points, &[[0, 1, 2], [0, 2, 3]], 1).expect("two triangles");
    for (width, height) in [(37, 23), (16, 16), (1, 1), (5, 130)] {
        // Rays go from the eye to points of the plane of the square, one length of their direction away.
        let (w, h) = (width as f32, height as f32);
        let camera = EmbreeCamera {
            eye: [0.5, 0.5, 2.0],
            first: [-0.5 + 1.0 / w, 0.5 / h, 0.0],
            right: [2.0 / w, 0.0, 0.0],
            down: [0.0, 1.0 / h, 0.0],
            width,
            height,
        };
        for threads in [1, 2] {
            let mut depths = vec![-1.0; (width * height) as usize];
            let hits = square.trace(&camera, threads, &mut depths).expect("an answer");
            let mut met = 0;
            for (pixel, &depth) in depths.iter().enumerate() {
                let x = camera.first[0] + (pixel as i32 % width) as f32 * camera.right[0];
                let inside = (0.0..=1.0).contains(&x);
                met += u64::from(inside);
                assert!(if inside { (depth - 1.0).abs() < 1e-6 } else { depth.is_infinite() }, "{pixel}: {depth}");
            }
            assert_eq!(hits, met);
        }
    }
}
