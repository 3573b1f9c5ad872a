//! Properties of the exact limit that need no reference: patches meet, derivatives are derivatives, parameters map.

#[path = "../common/mod.rs"]
mod common;
mod poles;

use catoptric::mesh::{self, SubdivMesh};
use catoptric::patch::PatchKind;
use catoptric::stam::LimitSurface;
use common::{angle_deg as angle, meshes};
use glam::DVec3;

/// Every point of a ptex face lies in one patch, and parameters go there and back.
#[test]
fn parameters_map_to_one_patch_and_back() {
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for ptex in 0..surface.ptex_count() as u32 {
            for i in 0..49 {
                let uv = [f64::from(i % 7) / 6.0, f64::from(i / 7) / 6.0];
                let Some((patch, local)) = surface.locate(ptex, uv) else { continue };
                assert_eq!(surface.patches()[patch].ptex, ptex);
                let back = surface.patches()[patch].to_ptex(local);
                assert!((back[0] - uv[0]).abs() + (back[1] - uv[1]).abs() < 1e-15, "{}: {uv:?} {back:?}", mesh.name);
            }
        }
    }
}

/// Inside a ptex face the surface is at least C1 away from its corners and edges: patches that share a point agree on
/// position, derivatives and normal, whatever their depth and kind.
#[test]
fn patches_of_a_ptex_face_meet_with_equal_derivatives() {
    let mut shared = 0;
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let unit = surface.diagonal();
        for (i, patch) in surface.patches().iter().enumerate() {
            let size = patch.depth.map(|depth| 0.5f64.powi(i32::from(depth)));
            let [u0, v0] = [0, 1].map(|k| f64::from(patch.origin[k]) * size[k]);
            // The lower and left neighbours across this patch's own sides, at its own parameters.
            for t in [0.25, 0.5, 0.8] {
                for (uv, step) in [([u0 + t * size[0], v0], [0.0, -1e-12]), ([u0, v0 + t * size[1]], [-1e-12, 0.0])] {
                    let beyond = [uv[0] + step[0], uv[1] + step[1]];
                    if beyond[0] < 0.0 || beyond[1] < 0.0 {
                        continue;
                    }
                    let (other, _) = surface.locate(patch.ptex, beyond).expect("no hole inside a ptex face");
                    let [a, b] = [i, other].map(|k| {
                        let patch = &surface.patches()[k];
                        let local = patch.to_local(uv).map(|x| x.clamp(0.0, 1.0));
                        patch.jet_to_ptex(surface.evaluate(k, local))
                    });
                    let context = format!("{} ptex {} {uv:?}", mesh.name, patch.ptex);
                    assert!(a.position.distance(b.position) < 1e-14 * unit, "{context}");
                    assert!(a.du.distance(b.du) + a.dv.distance(b.dv) < 1e-11 * unit, "{context}");
                    assert!(angle(a.normal, b.normal) < 1e-7, "{context}: {}", angle(a.normal, b.normal));
                    shared += 1;
                }
            }
        }
    }
    assert!(shared > 1000, "only {shared} points compared");
}

/// Derivatives against central differences of positions. The truncation error of step h is h^2/6 of a third derivative
/// (some ten diagonals here, more near extraordinary vertices), rounding 1e-16/h: both near 1e-9 for h = 1e-5.
#[test]
fn derivatives_are_those_of_the_positions() {
    const STEP: f64 = 1e-5;
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for i in 0..surface.patches().len() {
            for uv in [[0.3, 0.4], [0.71, 0.13], [0.52, 0.52]] {
                let jet = surface.evaluate(i, uv);
                let at = |du: f64, dv: f64| surface.evaluate(i, [uv[0] + du, uv[1] + dv]).position;
                let du = (at(STEP, 0.0) - at(-STEP, 0.0)) / (2.0 * STEP);
                let dv = (at(0.0, STEP) - at(0.0, -STEP)) / (2.0 * STEP);
                let error = du.distance(jet.du).max(dv.distance(jet.dv)) / surface.diagonal();
                assert!(error < 1e-8, "{} patch {i} {uv:?}: {error:e}", mesh.name);
            }
        }
    }
}

/// Quads round vertex 0 over an angle, on a bumpy cap: closed or a boundary fan.
fn fan(faces: usize, closed: bool) -> SubdivMesh {
    let spokes = if closed { faces } else { faces + 1 };
    let angle = if closed { std::f64::consts::TAU } else { 1.1 * std::f64::consts::PI } / faces as f64;
    let bump = |x: f64, y: f64| DVec3::new(x, y, 0.2 * x * x - 0.13 * y * y + 0.1 * (3.0 * x + y).sin());
    let at = |place: f64, radius: f64| {
        let (sin, cos) = (place * angle).sin_cos();
        bump(radius * cos, radius * sin)
    };
    let mut points = vec![bump(0.0, 0.0)];
    points.extend((0..spokes).map(|i| at(i as f64, 1.0 + 0.1 * (i as f64).cos())));
    points.extend((0..faces).map(|i| at(i as f64 + 0.5, 1.5 + 0.1 * (2.0 * i as f64).sin())));
    let quad = |i: usize| [0, 1 + i, 1 + spokes + i, 1 + (i + 1) % spokes].map(|v| v as u32);
    SubdivMesh {
        name: format!("fan {faces}"),
        points,
        face_sizes: vec![4; faces],
        face_vertices: (0..faces).flat_map(quad).collect(),
        boundary: mesh::Boundary::EdgeOnly,
        ..SubdivMesh::default()
    }
}

/// At a smooth vertex, on a crease and at a dart all faces give the vertex the same normal, and the normals inside tend to
/// it.
#[test]
fn faces_agree_on_the_normal_at_their_vertex() {
    let mut worst = 0.0f64;
    for faces in (1..=12).chain([20, 40]) {
        let mut fans = vec![(fan(faces, false), "crease")];
        if faces >= 3 {
            let mut dart = fan(faces, true);
            dart.creases.push(mesh::Crease { vertices: [0, 1], sharpness: 10.0 });
            fans.extend([(fan(faces, true), "smooth"), (dart, "dart")]);
        }
        for (mesh, name) in fans {
            let surface = LimitSurface::new(&mesh).expect("it has a surface");
            let normal = |face: usize, h: f64| surface.evaluate_ptex(face as u32, [h, h]).expect("no hole").1.normal;
            let first = normal(0, 0.0);
            for face in 0..faces {
                let spread = angle(normal(face, 0.0), first);
                assert!(spread < 1e-9, "{name} {faces} face {face}: {spread:e} degrees apart");
                worst = worst.max(spread);
                // Towards the vertex the angle shrinks at last; how fast is the class's affair: at 1/n for one face, by
                // ratios so close to 1 for many that 50 levels do not show it (stam::class tests go further).
                if faces > 12 {
                    continue;
                }
                let [far, near] = [1e-6, 1e-15].map(|h| angle(normal(face, h), first));
                assert!(near < far.max(1e-9), "{name} {faces} face {face}: {far:e}, then {near:e} degrees");
            }
        }
    }
    println!("largest spread {worst:e} degrees");
}

/// Parameters beyond any level, down to the smallest double, are answered with finite numbers.
#[test]
fn the_smallest_parameters_are_answered() {
    let surface = LimitSurface::new(&fan(5, true)).expect("it has a surface");
    for h in [1e-15, 1e-100, 1e-300, 1e-302, 1e-305, f64::MIN_POSITIVE, 5e-324, 0.0] {
        for uv in [[h, h], [h, 0.0], [0.0, h]] {
            let jet = surface.evaluate_ptex(0, uv).expect("no hole").1;
            assert!(jet.position.is_finite() && jet.du.is_finite() && jet.dv.is_finite(), "{uv:?} {jet:?}");
            assert!((jet.normal.length() - 1.0).abs() < 1e-12, "{uv:?} {jet:?}");
        }
    }
}

/// A folded sheet: along its fold a derivative vanishes; the normal there is the limit of those inside.
#[test]
fn normals_exist_where_derivatives_vanish() {
    let mut pillow = fan(1, false);
    pillow.points =
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.2], [1.2, 0.9, 0.5], [0.1, 1.0, 0.1]].map(DVec3::from_array).to_vec();
    pillow.face_sizes = vec![4; 2];
    pillow.face_vertices = vec![0, 1, 2, 3, 0, 3, 2, 1];
    let surface = LimitSurface::new(&pillow).expect("it has a surface");
    for t in [0.1, 0.35, 0.5, 0.8] {
        for (on, near) in [([0.0, t], [1e-7, t]), ([t, 0.0], [t, 1e-7]), ([1.0, t], [1.0 - 1e-7, t])] {
            let [a, b] = [on, near].map(|uv| surface.evaluate_ptex(0, uv).expect("no hole").1.normal);
            assert!(a == DVec3::ZERO || angle(a, b) < 1e-3, "{on:?}: {a} {b}");
        }
    }
}

/// A boundary that runs straight through the only face of a vertex: no osculating plane, but a tangent plane.
#[test]
fn straight_corners_have_a_normal() {
    let mut corner = fan(1, false);
    corner.points =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.1, 1.0, 0.4], [-0.9, 0.0, 0.0]].map(DVec3::from_array).to_vec();
    let surface = LimitSurface::new(&corner).expect("it has a surface");
    let [tip, near] = [0.0, 1e-4].map(|h| surface.evaluate_ptex(0, [h, h]).expect("no hole").1.normal);
    assert!(angle(tip, near) < 0.1, "{tip} {near}");
}

/// Second derivatives against central differences of the first ones.
#[test]
fn second_derivatives_are_those_of_the_first() {
    const STEP: f64 = 1e-6;
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for i in 0..surface.patches().len() {
            let uv = [0.37, 0.58];
            let jet = surface.evaluate_second(i, uv);
            let at = |du: f64, dv: f64| surface.evaluate(i, [uv[0] + du, uv[1] + dv]);
            let half = 0.5 / STEP;
            let duu = (at(STEP, 0.0).du - at(-STEP, 0.0).du) * half;
            let duv = (at(0.0, STEP).du - at(0.0, -STEP).du) * half;
            let dvv = (at(0.0, STEP).dv - at(0.0, -STEP).dv) * half;
            let error = duu.distance(jet.duu).max(duv.distance(jet.duv)).max(dvv.distance(jet.dvv));
            // Rounding of the first derivatives over the step, 1e-16 / 1e-6, and a fourth derivative times its square.
            assert!(error < 1e-8 * surface.diagonal(), "{} patch {i}: {error:e}", mesh.name);
        }
    }
}

/// Towards an extraordinary vertex the normal tends to the one given there, the position to the limit position.
#[test]
fn the_vertex_is_the_limit_of_its_patch() {
    let mut vertices = 0;
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for (i, patch) in surface.patches().iter().enumerate() {
            if patch.kind == PatchKind::Regular {
                continue;
            }
            let vertex = surface.evaluate(i, [0.0, 0.0]);
            let near = surface.evaluate(i, [1e-9, 1e-9]);
            assert!(vertex.position.distance(near.position) < 1e-4 * surface.diagonal(), "{} {i}", mesh.name);
            assert!(vertex.du.is_finite() && vertex.dv.is_finite() && near.normal.is_finite());
            let class = surface.classes()[surface.class(i).expect("an irregular patch has a class")];
            // Towards a pole of 40 faces the normal hardly turns in 30 levels: the ratio is 0.99 (0.6473 / 0.6527).
            if patch.kind == PatchKind::Smooth && class.faces <= 12 && vertex.normal != DVec3::ZERO {
                // 30 levels in, the ratio of the next eigenvalue to lambda (0.82 at most for valence 8) is below 3e-3.
                let turned = angle(vertex.normal, near.normal);
                assert!(turned < 0.5, "{} patch {i}: {turned} degrees", mesh.name);
                vertices += 1;
            }
        }
    }
    assert!(vertices > 100);
}

/// Tiny, huge and far-off models lose no digits: the surface scales and moves with its points.
#[test]
fn the_surface_follows_its_points() {
    let mesh = mesh::sample();
    let surface = LimitSurface::new(&mesh).expect("it has a surface");
    for (scale, offset) in
        [(2f64.powi(-60), DVec3::ZERO), (2f64.powi(40), DVec3::ZERO), (1.0, DVec3::new(1000.0, -500.0, 200.0))]
    {
        let mut other = mesh.clone();
        other.points.iter_mut().for_each(|p| *p = *p * scale + offset);
        let moved = LimitSurface::new(&other).expect("it has a surface");
        for patch in 0..surface.patches().len() {
            let [a, b] = [&surface, &moved].map(|s| s.evaluate(patch, [0.37, 0.61]));
            let expected = a.position * scale + offset;
            // Moved points were rounded to 1e-13 of the offset before we saw them.
            let rounding = 1e-15 * (scale * surface.diagonal() + offset.length());
            assert!(b.position.distance(expected) <= rounding, "{patch} {scale}");
            assert!(angle(a.normal, b.normal) < if offset == DVec3::ZERO { 1e-12 } else { 1e-6 }, "{patch} {scale}");
        }
    }
}
