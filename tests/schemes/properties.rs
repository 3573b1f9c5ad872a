//! Properties of the limit of Loop's scheme that need no reference.

use super::{loop_meshes, named};
use crate::common::angle_deg as angle;
use catoptric::mesh::{self, SubdivMesh};
use catoptric::patch::Shape;
use catoptric::stam::LimitSurface;
use glam::DVec3;

/// None lies on an edge of a patch.
const PLACES: [[f64; 2]; 5] = [[0.3, 0.4], [0.71, 0.13], [0.1, 0.05], [0.23, 0.51], [0.02, 0.9]];

#[test]
fn parameters_map_to_one_patch_and_back() {
    let mut turned = 0;
    for mesh in loop_meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        assert_eq!(surface.ptex_count(), mesh.face_count());
        assert_eq!(surface.ptex_count(), mesh.ptex_count());
        for ptex in 0..surface.ptex_count() as u32 {
            for [i, j] in (0..=12).flat_map(|i| (0..=12 - i).map(move |j| [i, j])) {
                let uv = [i, j].map(|k| f64::from(k) / 12.0);
                let Some((patch, local)) = surface.locate(ptex, uv) else { continue };
                let patch = &surface.patches()[patch];
                assert_eq!(patch.ptex, ptex);
                turned += usize::from(patch.shape == Shape::TurnedTriangle);
                let back = patch.to_ptex(local);
                assert!((back[0] - uv[0]).abs() + (back[1] - uv[1]).abs() < 1e-15, "{}: {uv:?} {back:?}", mesh.name);
            }
        }
    }
    assert!(turned > 1000, "{turned}");
}

/// Derivatives against central differences of positions, second ones against those of the first: truncation h^2/6 of a third
/// derivative and rounding 1e-16/h are both near 1e-9 for h = 1e-5.
#[test]
fn derivatives_are_those_of_the_positions() {
    const STEP: f64 = 1e-5;
    for mesh in loop_meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for ptex in 0..surface.ptex_count() as u32 {
            for uv in PLACES {
                let Some((home, jet)) = surface.evaluate_second_ptex(ptex, uv) else { continue };
                let patch = &surface.patches()[home];
                let at = |du: f64, dv: f64| {
                    let local = patch.to_local([uv[0] + du, uv[1] + dv]);
                    patch.jet_to_ptex(surface.evaluate(home, local))
                };
                let difference = |of: fn(&catoptric::stam::Jet) -> DVec3, du: f64, dv: f64| {
                    (of(&at(STEP * du, STEP * dv)) - of(&at(-STEP * du, -STEP * dv))) / (2.0 * STEP)
                };
                let first = [
                    (difference(|jet| jet.position, 1.0, 0.0), jet.first.du),
                    (difference(|jet| jet.position, 0.0, 1.0), jet.first.dv),
                    (difference(|jet| jet.du, 1.0, 0.0), jet.duu),
                    (difference(|jet| jet.du, 0.0, 1.0), jet.duv),
                    (difference(|jet| jet.dv, 1.0, 0.0), jet.duv),
                    (difference(|jet| jet.dv, 0.0, 1.0), jet.dvv),
                ];
                for (k, (found, expected)) in first.into_iter().enumerate() {
                    let size = mesh.diagonal() * patch.scale()[0].powi(if k < 2 { 1 } else { 2 });
                    // Beside a line where the third derivative jumps, the difference is of first order.
                    let allowed = if k < 2 { 1e-8 } else { 2e-3 };
                    let error = found.distance(expected) / size;
                    assert!(error < allowed, "{} ptex {ptex} {uv:?} {k}: {error:e}", mesh.name);
                }
            }
        }
    }
}

/// Patches of a ptex face meet in position and normal; and so do ptex faces across smooth edges.
#[test]
fn patches_meet_with_equal_normals() {
    const AWAY: f64 = 1e-9;
    let mut compared = 0;
    for mesh in loop_meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for (index, patch) in surface.patches().iter().enumerate() {
            for t in [0.25, 0.6] {
                for [edge, beyond] in [[[t, 0.0], [0.0, -AWAY]], [[1.0 - t, t], [AWAY, AWAY]], [[0.0, t], [-AWAY, 0.0]]]
                {
                    let at = patch.to_ptex(edge);
                    let by = patch.local_by_ptex();
                    // The inverse of the derivatives takes the step to the ptex face.
                    let [[a, b], [c, d]] = by;
                    let det = a * d - b * c;
                    let step = [(d * beyond[0] - c * beyond[1]) / det, (a * beyond[1] - b * beyond[0]) / det];
                    let over = [at[0] + step[0], at[1] + step[1]];
                    if over[0] < 0.0 || over[1] < 0.0 || over[0] + over[1] > 1.0 {
                        continue;
                    }
                    let Some((other, _)) = surface.locate(patch.ptex, over) else { continue };
                    assert_ne!(other, index, "{} {edge:?}", mesh.name);
                    let [here, there] = [index, other].map(|k| {
                        let patch = &surface.patches()[k];
                        patch.jet_to_ptex(surface.evaluate(k, patch.to_local(at)))
                    });
                    let context = format!("{} ptex {} {at:?}", mesh.name, patch.ptex);
                    assert!(here.position.distance(there.position) < 1e-14 * mesh.diagonal(), "{context}");
                    assert!(here.du.distance(there.du) < 1e-10 * mesh.diagonal(), "{context}");
                    assert!(angle(here.normal, there.normal) < 1e-6, "{context}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 1000, "{compared}");
}

/// Triangles round vertex 0 over an angle, on a bumpy cap: closed or a boundary fan.
fn fan(faces: usize, closed: bool, boundary: mesh::Boundary) -> SubdivMesh {
    let spokes = if closed { faces } else { faces + 1 };
    let angle = if closed { std::f64::consts::TAU } else { 1.1 * std::f64::consts::PI } / faces as f64;
    let at = |k: usize| {
        let radius = 1.0 + 0.1 * (k as f64).cos();
        let (sin, cos) = (k as f64 * angle).sin_cos();
        let (x, y) = (radius * cos, radius * sin);
        DVec3::new(x, y, 0.2 * x * x - 0.13 * y * y + 0.1 * (3.0 * x + y).sin())
    };
    let mut points = vec![DVec3::ZERO];
    points.extend((0..spokes).map(at));
    let triangle = |k: usize| [0, 1 + k as u32, 1 + ((k + 1) % spokes) as u32];
    SubdivMesh {
        name: format!("fan {faces}"),
        points,
        face_sizes: vec![3; faces],
        face_vertices: (0..faces).flat_map(triangle).collect(),
        scheme: mesh::Scheme::Loop,
        boundary,
        ..SubdivMesh::default()
    }
}

/// At a smooth vertex, on a crease and at a dart all faces give the vertex the same normal, and the normals inside tend to it.
#[test]
fn faces_agree_on_the_normal_at_their_vertex() {
    for faces in (1..=12).chain([20, 40]) {
        let mut fans = vec![(fan(faces, false, mesh::Boundary::EdgeOnly), "crease")];
        if faces >= 3 {
            let mut dart = fan(faces, true, mesh::Boundary::EdgeOnly);
            dart.creases.push(mesh::Crease { vertices: [0, 1], sharpness: 10.0 });
            fans.extend([(fan(faces, true, mesh::Boundary::EdgeOnly), "smooth"), (dart, "dart")]);
        }
        for (mesh, name) in fans {
            let surface = LimitSurface::new(&mesh).expect("it has a surface");
            let normal = |face: usize, h: f64| surface.evaluate_ptex(face as u32, [h, h]).expect("no hole").1.normal;
            let first = normal(0, 0.0);
            assert!((first.length() - 1.0).abs() < 1e-12);
            for face in 0..faces {
                let spread = angle(normal(face, 0.0), first);
                assert!(spread < 1e-9, "{name} {faces} face {face}: {spread:e} degrees apart");
                if faces > 12 {
                    continue;
                }
                let [far, near] = [1e-6, 1e-15].map(|h| angle(normal(face, h), first));
                // Where one direction shrinks faster than the other, rounding keeps what is left of the angle.
                assert!(near < far.max(1e-6), "{name} {faces} face {face}: {far:e}, then {near:e} degrees");
            }
        }
    }
}

/// Parameters beyond any level, down to the smallest double, are answered with finite numbers.
#[test]
fn the_smallest_parameters_are_answered() {
    let surface = LimitSurface::new(&named("loop_pole_5")).expect("it has a surface");
    for h in [1e-15, 1e-100, 1e-300, 1e-302, 1e-305, f64::MIN_POSITIVE, 5e-324, 0.0] {
        for uv in [[h, h], [h, 0.0], [0.0, h]] {
            let jet = surface.evaluate_ptex(0, uv).expect("no hole").1;
            assert!(jet.position.is_finite() && jet.du.is_finite() && jet.dv.is_finite(), "{uv:?} {jet:?}");
            assert!((jet.normal.length() - 1.0).abs() < 1e-12, "{uv:?} {jet:?}");
        }
    }
}

/// An octahedron's limit has its symmetry, and lies inside it.
#[test]
fn symmetric_solids_have_symmetric_limits() {
    let axes = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
    let mesh = SubdivMesh {
        name: "octahedron".to_owned(),
        points: axes.to_vec(),
        face_sizes: vec![3; 8],
        face_vertices: faces.as_flattened().to_vec(),
        scheme: mesh::Scheme::Loop,
        ..SubdivMesh::default()
    };
    let surface = LimitSurface::new(&mesh).expect("it has a surface");
    for uv in PLACES {
        let radius = |ptex: u32, uv| surface.evaluate_ptex(ptex, uv).expect("no hole").1.position.length();
        let first = radius(0, uv);
        assert!(first > 0.3 && first < 1.0);
        for ptex in 1..8 {
            // All faces begin at an equator's vertex and end at a pole.
            assert!((radius(ptex, uv) - first).abs() < 1e-15);
        }
        let [u, v] = uv;
        for turned in [[v, 1.0 - u - v], [1.0 - u - v, u], [v, u]] {
            assert!((radius(0, turned) - first).abs() < 1e-15, "{uv:?} {turned:?}");
        }
    }
}
