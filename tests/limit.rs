//! Properties of the exact limit that need no reference: patches meet, derivatives are derivatives, parameters map.

mod common;

use catoptric::mesh;
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
