//! The conformance test of other programs: right answers pass, every usual mistake fails and is named, bad files are refused.

use super::own;
use catoptric::mesh::{Boundary, Creasing, SubdivMesh};
use catoptric::stam::LimitSurface;
use catoptric::verify::conformance::{Answer, Results, Terms, Tolerances, conformance, sample_set};
use catoptric::verify::{MeshReport, Sample};
use glam::DVec3;

const PER_FACE: usize = 40;

/// A program that is right, but for what `change` does to the sample that it evaluates and `spoil` to its answer.
fn answers(
    asked: &SubdivMesh,
    evaluated: &SubdivMesh,
    change: impl Fn(Sample) -> Option<Sample>,
    spoil: impl Fn(Answer) -> Answer,
) -> Vec<Answer> {
    let surface = LimitSurface::new(evaluated).expect("the mesh is valid");
    let set = LimitSurface::new(asked).expect("the mesh is valid");
    let answer = |at: Sample| {
        let jet = change(at)
            .filter(|s| (s.face as usize) < surface.ptex_count())
            .and_then(|s| surface.evaluate_ptex(s.face, [s.u, s.v]));
        spoil(Answer {
            at,
            position: jet.map(|(_, jet)| jet.position),
            derivatives: Some(jet.map_or([DVec3::NAN; 2], |(_, jet)| [jet.du, jet.dv])),
            normal: Some(jet.map_or(DVec3::NAN, |(_, jet)| jet.normal)),
        })
    };
    sample_set(&set, PER_FACE).map(answer).collect()
}

fn judge(mesh: &SubdivMesh, answers: &[Answer]) -> MeshReport {
    let terms = Terms { per_face: PER_FACE, ..Terms::default() };
    conformance(mesh, answers, &terms).expect("it can be judged")
}

fn results(report: &MeshReport) -> &Results {
    report.results.as_ref().expect("answers were judged")
}

/// Right in 64 bits: passes at tolerances of 64 bits, everywhere, holes and folds included.
#[test]
fn right_answers_pass_on_every_mesh() {
    let terms = Terms {
        tolerances: Tolerances { position: 1e-11, normal_deg: 1e-6, derivative: 1e-9 },
        per_face: PER_FACE,
        partial: false,
    };
    for mesh in super::common::meshes() {
        let right = answers(&mesh, &mesh, Some, |answer| answer);
        let report = conformance(&mesh, &right, &terms).expect("it can be judged");
        let results = results(&report);
        assert!(report.pass && results.diagnosis.is_empty(), "{}: {results}", mesh.name);
        assert_eq!(results.standard, results.standard_answered);
        // Compared with OpenSubdiv too, not with ourselves alone.
        let against =
            |name: &str| report.tiers.iter().filter(|row| row.reference == name).map(|row| row.samples).sum::<usize>();
        assert!(against("limit") > 0 && against("Far level 10") > against("limit") / 2, "{}: {results}", mesh.name);
    }
}

/// What `verify` says about a mistake, which fails.
fn diagnosis(mesh: &SubdivMesh, answers: &[Answer]) -> Vec<String> {
    let report = judge(mesh, answers);
    let text = results(&report).to_string();
    assert!(!report.pass, "{text}");
    let found =
        results(&report).diagnosis.iter().map(|finding| format!("{}: {}", finding.quantity, finding.mistake)).collect();
    println!("{text}");
    found
}

fn turned(turns: u32, s: Sample) -> Sample {
    (0..turns).fold(s, |s, _| Sample { u: 1.0 - s.v, v: s.u, ..s })
}

#[test]
fn mistakes_about_parameters_are_named() {
    let mesh = own("semi_sharp_pole_5");
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, |s| Some(Sample { u: s.v, v: s.u, ..s }), |a| a));
    assert_eq!(found, ["position: u and v are swapped"]);
    for turns in 1..4 {
        let found = diagnosis(&mesh, &answers(&mesh, &mesh, |s| Some(turned(turns, s)), |a| a));
        assert_eq!(found, [format!("position: (u,v) start at corner {turns} of the ptex face instead of corner 0")]);
    }
    let mirrored = |s: Sample| Some(Sample { u: 1.0 - s.v, v: 1.0 - s.u, ..s });
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, mirrored, |a| a));
    assert_eq!(found, ["position: u and v are swapped, and start at corner 2 of the ptex face"]);
}

/// Ptex faces of each control face: first and number.
fn ptex(mesh: &SubdivMesh) -> Vec<(u32, u32)> {
    let mut next = 0;
    let mut faces = Vec::new();
    for &size in &mesh.face_sizes {
        let count = if size == 4 { 1 } else { size };
        faces.push((next, count));
        next += count;
    }
    faces
}

#[test]
fn mistakes_about_face_numbers_are_named() {
    let mesh = own("n_gons");
    let faces = ptex(&mesh);
    assert!(faces.iter().any(|f| f.1 == 1) && faces.iter().any(|f| f.1 > 1));
    // Quads by the numbers of the control mesh; what it takes for n-gons it does not answer.
    let control = |s: Sample| faces.get(s.face as usize).filter(|f| f.1 == 1).map(|f| Sample { face: f.0, ..s });
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, control, |a| a));
    assert_eq!(found, ["position: faces are counted as faces of the control mesh, not as ptex faces"]);
    let shifted = |s: Sample| {
        let (first, count) = *faces.iter().rfind(|f| f.0 <= s.face).expect("it has one");
        Some(Sample { face: first + (s.face - first + 1) % count, ..s })
    };
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, shifted, |a| a));
    assert_eq!(
        found,
        ["position: the sub-faces of n-gons are counted from corner 1 instead of corner 0, on the sub-faces of n-gons"]
    );
}

#[test]
fn mistakes_about_derivatives_and_normals_are_named() {
    let mesh = own("n_gons");
    let faces = ptex(&mesh);
    let on_n_gon = |face: u32| faces.iter().rfind(|f| f.0 <= face).is_some_and(|f| f.1 > 1);
    let scaled = |by: f64| move |a: Answer| Answer { derivatives: a.derivatives.map(|d| d.map(|d| by * d)), ..a };
    let half = |a: Answer| if on_n_gon(a.at.face) { scaled(0.5)(a) } else { a };
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, Some, half));
    assert_eq!(
        found,
        [
            "derivative: the derivatives are half as long as those by the u and v of the ptex face, on the sub-faces of n-gons"
        ]
    );
    let swapped = |a: Answer| Answer { derivatives: a.derivatives.map(|[du, dv]| [dv, du]), ..a };
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, Some, swapped));
    assert_eq!(found, ["derivative: the derivatives by u and by v are swapped"]);
    let flipped = |a: Answer| Answer { normal: a.normal.map(|n| -3.0 * n), ..a };
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, Some, flipped));
    assert_eq!(found, ["normal: the normals point the other way: they are to be du x dv"]);
    // By the parameters of patches, as our own evaluator has them inside.
    let semi_sharp = own("semi_sharp_corner");
    let surface = LimitSurface::new(&semi_sharp).expect("it is valid");
    let local = |a: Answer| {
        let patch = surface.locate(a.at.face, [a.at.u, a.at.v]).map(|(patch, _)| surface.patches()[patch]);
        let [u, v] = patch.map_or([1.0; 2], |patch| patch.scale());
        assert_eq!(u, v);
        scaled(1.0 / u)(a)
    };
    let found = diagnosis(&semi_sharp, &answers(&semi_sharp, &semi_sharp, Some, local));
    assert_eq!(
        found,
        ["derivative: the derivatives are by the u and v of sub-patches (powers of two), not of the ptex face"]
    );
}

#[test]
fn mistakes_about_rules_are_named() {
    let edge_only = own("boundary_edge_only");
    let other = SubdivMesh { boundary: Boundary::EdgeAndCorner, ..edge_only.clone() };
    let found = diagnosis(&edge_only, &answers(&edge_only, &other, Some, |a| a));
    assert_eq!(found, ["position: the boundary rule is edge and corner, the mesh asks for edge only"]);
    let found = diagnosis(&other, &answers(&other, &edge_only, Some, |a| a));
    assert_eq!(found, ["position: the boundary rule is edge only, the mesh asks for edge and corner"]);
    let creased = own("semi_sharp_crease");
    let smooth = SubdivMesh { creases: Vec::new(), ..creased.clone() };
    let found = diagnosis(&creased, &answers(&creased, &smooth, Some, |a| a));
    assert_eq!(found, ["position: creases and corners are ignored"]);
    let chaikin = own("chaikin_crease");
    let uniform = SubdivMesh { creasing: Creasing::Uniform, ..chaikin.clone() };
    let found = diagnosis(&chaikin, &answers(&chaikin, &uniform, Some, |a| a));
    assert_eq!(found, ["position: sharpness decays by the uniform rule, the mesh asks for Chaikin's"]);
    let holed = own("hole");
    let filled = SubdivMesh { holes: Vec::new(), ..holed.clone() };
    let found = diagnosis(&holed, &answers(&holed, &filled, Some, |a| a));
    assert_eq!(found, ["position: holes are filled"]);
}

#[test]
fn lack_of_digits_and_end_caps_are_named() {
    let far_off = own("pole_5").translated(DVec3::splat(1000.0));
    let single = |p: DVec3| p.as_vec3().as_dvec3();
    let rounded = |a: Answer| Answer { position: a.position.map(single), ..a };
    let found = diagnosis(&far_off, &answers(&far_off, &far_off, Some, rounded));
    assert!(
        found.len() == 1 && found[0].starts_with("position: the errors are as large as the rounding of 32-bit"),
        "{found:?}"
    );
    let mesh = own("pole_5");
    let surface = LimitSurface::new(&mesh).expect("it is valid");
    let capped = |a: Answer| match surface.locate(a.at.face, [a.at.u, a.at.v]) {
        Some((patch, [u, v])) if surface.class(patch).is_some() => {
            let bump = 1e-2 * (u * v * (1.0 - u) * (1.0 - v)) * DVec3::new(0.3, 0.5, 0.7);
            Answer { position: a.position.map(|p| p + bump), ..a }
        }
        _ => a,
    };
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, Some, capped));
    assert!(found.len() == 1 && found[0].contains("seem to be approximated (as by end caps)"), "{found:?}");
    // Nearly right derivatives are no scaled ones.
    let rough = |a: Answer| match surface.locate(a.at.face, [a.at.u, a.at.v]) {
        Some((patch, _)) if surface.class(patch).is_some() => {
            Answer { derivatives: a.derivatives.map(|d| d.map(|d| 1.003 * d)), ..a }
        }
        _ => a,
    };
    let found = diagnosis(&mesh, &answers(&mesh, &mesh, Some, rough));
    assert!(found.len() == 1 && found[0].contains("seem to be approximated"), "{found:?}");
    // And what is none of them is not called one.
    let noise = |a: Answer| Answer {
        position: a.position.map(|p| p + 0.1 * DVec3::splat((1e3 * a.at.u + 77.0 * a.at.v).sin())),
        ..a
    };
    assert!(diagnosis(&mesh, &answers(&mesh, &mesh, Some, noise)).is_empty());
}

#[test]
fn what_is_not_answered_is_no_pass() {
    let mesh = own("hole");
    let right = answers(&mesh, &mesh, Some, |a| a);
    let on_surface = right.iter().filter(|a| a.position.is_some()).count();
    assert!(on_surface < right.len());
    // Rows in holes may be left out: there is nothing to say.
    let without_holes: Vec<Answer> = right.iter().filter(|a| a.position.is_some()).copied().collect();
    assert!(judge(&mesh, &without_holes).pass);
    // One missing.
    let part = &without_holes[1..];
    let report = judge(&mesh, part);
    assert!(!report.pass && results(&report).standard_answered == on_surface - 1);
    assert!(results(&report).to_string().contains("1 of"), "{}", results(&report));
    let terms = Terms { per_face: PER_FACE, partial: true, ..Terms::default() };
    assert!(conformance(&mesh, part, &terms).expect("it can be judged").pass);
    assert!(!conformance(&mesh, &[], &terms).expect("it can be judged").pass);
    // One refused, which is an answer, and a wrong one: in a part too.
    let refused: Vec<Answer> = without_holes
        .iter()
        .enumerate()
        .map(|(i, a)| if i == 7 { Answer { position: None, ..*a } } else { *a })
        .collect();
    let report = conformance(&mesh, &refused, &terms).expect("it can be judged");
    assert!(!report.pass && results(&report).refused == 1);
    // A single wrong derivative or normal among many.
    for wrong in [
        Answer { derivatives: Some([DVec3::NAN; 2]), ..right[9] },
        Answer { normal: Some(DVec3::NAN), ..right[9] },
        Answer { normal: Some(DVec3::ZERO), ..right[9] },
        Answer { position: right[9].position.map(|p| p + 1e-3), ..right[9] },
    ] {
        let mut one = right.clone();
        one[9] = wrong;
        let report = judge(&mesh, &one);
        assert!(!report.pass, "{wrong:?}");
        let failed: usize = results(&report).quantities.iter().map(|q| q.failed).sum();
        assert!((1..=2).contains(&failed), "{}", results(&report));
        assert!(results(&report).quantities.iter().filter(|q| q.failed > 0).all(|q| q.worst == Some(right[9].at)));
    }
}
