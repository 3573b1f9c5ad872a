//! Vertices of many faces, and faces of many corners, against OpenSubdiv.

use catoptric::mesh::{SubdivMesh, parse_obj};
use catoptric::osd::{Answer, Far, LimitStencils, Location, MAX_ISOLATION, ReferenceJet};
use catoptric::patch::PatchKind;
use catoptric::stam::LimitSurface;
use glam::DVec3;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Quads round a vertex of `faces` faces and a ring of quads round them; where it is not `closed` the boundary runs through the
/// vertex. The spokes in `sharp` are infinitely sharp.
fn fan(faces: u32, closed: bool, sharp: &[u32]) -> SubdivMesh {
    let count = 2 * faces + u32::from(!closed);
    let turn = if closed { TAU } else { 0.6 * TAU };
    let mut text = "v 0 0 0.3\n".to_owned();
    // Writing to a String cannot fail.
    for radius in [1.0, 2.0] {
        for i in 0..count {
            let angle = turn * f64::from(i) / f64::from(2 * faces);
            let height = 0.1 * (3.0 * angle).cos() - 0.2 * radius;
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

fn polygon(corners: u32) -> SubdivMesh {
    let mut text = String::new();
    for i in 0..corners {
        let angle = TAU * f64::from(i) / f64::from(corners);
        let _ = writeln!(text, "v {} {} {}", angle.cos(), angle.sin(), 0.1 * (3.0 * angle).cos());
    }
    let _ = writeln!(text, "f {}", (1..=corners).map(|i| i.to_string()).collect::<Vec<_>>().join(" "));
    parse_obj(text.as_bytes(), "polygon").expect("a valid mesh")
}

/// Places on some faces: dyadic ones, towards each corner, and others.
fn samples(mesh: &SubdivMesh, faces: impl Iterator<Item = u32>) -> Vec<Location> {
    let mut places = vec![[0.25, 0.5], [0.75, 0.75], [0.37, 0.61], [0.13, 0.08], [0.9, 0.2]];
    for k in [1, 2, 4, 7, 9] {
        let near = 0.5f64.powi(k);
        for [u, v] in [[near, near], [near, 0.0], [0.0, near]] {
            places.extend([[u, v], [1.0 - u, v], [1.0 - u, 1.0 - v], [u, 1.0 - v]]);
        }
    }
    places.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let count = mesh.ptex_count() as u32;
    faces.filter(|&face| face < count).flat_map(|face| places.iter().map(move |&[u, v]| (face, u, v))).collect()
}

/// The largest distance from a reference, in diagonals, and derivatives and normals where it answers exactly. Its end caps are exact at
/// dyadic points, but not beside darts.
fn assert_agree(mesh: &SubdivMesh, samples: &[Location], answers: &[ReferenceJet], what: &str) {
    let surface = LimitSurface::new(mesh).expect("it has a surface");
    let (mut worst, mut slope, mut regular) = (0.0f64, 0.0f64, 0);
    for (&(face, u, v), answer) in samples.iter().zip(answers) {
        let is_dyadic = [u, v].iter().all(|x| (x * 1024.0).fract() == 0.0);
        let is_exact = answer.answer == Answer::Regular;
        let (patch, jet) = surface.evaluate_ptex(face, [u, v]).expect("a surface");
        assert!(answer.answer != Answer::None, "{what}: {face} {u} {v}");
        if !is_exact && (surface.kind(patch) == PatchKind::Dart || !is_dyadic) {
            continue;
        }
        worst = worst.max(jet.position.distance(answer.position) / surface.diagonal());
        if is_exact {
            regular += 1;
            let rounding = answer.cell.min(1.0);
            slope =
                slope.max(rounding * jet.du.distance(answer.du).max(jet.dv.distance(answer.dv)) / surface.diagonal());
            assert!(
                jet.normal.dot(answer.du.cross(answer.dv).normalize_or_zero()) > 1.0 - 1e-9,
                "{what}: {face} {u} {v}"
            );
        }
    }
    println!("{what}: {worst:.1e}, derivatives {slope:.1e}, {regular} of {} regular", samples.len());
    assert!(worst < 1e-13 && slope < 1e-12, "{what}: {worst:e} {slope:e}");
    assert!(4 * regular > samples.len(), "{what}: {regular} of {}", samples.len());
}

/// Limit stencils take OpenSubdiv 1.4 s at a smooth vertex of 100 faces and 50 s at one of 360, so they are asked where they are
/// short, and Far's patches of the same isolation everywhere.
#[test]
fn surfaces_at_many_faces_are_those_of_opensubdiv() {
    for faces in [100, 200, 360] {
        let (third, half) = (faces / 3, faces / 2);
        let kinds = [
            ("smooth", fan(faces, true, &[])),
            ("dart", fan(faces, true, &[third])),
            ("crease", fan(faces, true, &[0, half])),
            ("corner", fan(faces, true, &[0, third, 2 * third])),
            ("boundary", fan(faces, false, &[])),
            ("polygon", polygon(faces)),
        ];
        for (kind, mesh) in kinds {
            let all = samples(&mesh, (0..faces).step_by(7).chain(faces..faces + 4));
            let far = Far::new(&mesh, MAX_ISOLATION).and_then(|far| far.evaluate(&all)).expect("OpenSubdiv answers");
            assert_agree(&mesh, &all, &far, &format!("{kind} {faces}, Far"));
            if faces == 100 && kind != "dart" || ["crease", "corner", "boundary"].contains(&kind) {
                let some = samples(&mesh, [0, 1, half - 1, half, faces - 1].into_iter());
                let stencils = LimitStencils::new(&mesh, MAX_ISOLATION).expect("a valid mesh");
                let answers = stencils.evaluate(&some).expect("OpenSubdiv answers");
                assert_agree(&mesh, &some, &answers, &format!("{kind} {faces}, limit stencils"));
            }
        }
    }
}

/// At the vertex itself: the limit that Halstead, Kass & DeRose 1993 give (section 3.1), N^2, 4 and 1 over N (N + 5), after a level that
/// makes all faces quads; up to a valence that no reference is asked about.
#[test]
fn vertices_of_many_faces_are_where_their_masks_put_them() {
    for faces in [100u32, 360, 1024, 3000] {
        let mesh = fan(faces, true, &[]);
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let valence = f64::from(faces);
        let ring = |first: usize| (0..faces as usize).map(|i| mesh.points[1 + first + 2 * i]).sum::<DVec3>();
        let sum = valence * valence * mesh.points[0] + 4.0 * ring(0) + ring(1);
        let expected = sum / (valence * (valence + 5.0));
        for face in [0, 1, faces / 2, faces - 1] {
            let (_, jet) = surface.evaluate_ptex(face, [0.0; 2]).expect("a surface");
            assert!(
                jet.position.distance(expected) < 1e-14 * surface.diagonal(),
                "{faces}: {} {expected}",
                jet.position
            );
            assert!((jet.normal.length() - 1.0).abs() < 1e-12, "{faces}: {}", jet.normal);
            let near = surface.evaluate_ptex(face, [1e-7, 2e-7]).expect("a surface").1;
            assert!(near.position.distance(expected) < 1e-4 * surface.diagonal() && near.normal.is_finite());
        }
    }
}
