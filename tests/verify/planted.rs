//! Every planted error is caught, and found where it is.

use super::{gpu, own};
use catoptric::gpu::Gpu;
use catoptric::mesh::{self, SubdivMesh};
use catoptric::stam::LimitSurface;
use catoptric::verify::{MeshReport, Plant, Settings, verify};

fn settings(plant: Plant) -> Settings {
    Settings { size: [16, 16], plant: Some(plant), ..Settings::default() }
}

fn planted(mesh: &SubdivMesh, gpu: &Gpu, plant: Plant) -> MeshReport {
    let report = verify(mesh, gpu, &settings(plant)).unwrap_or_else(|e| panic!("{}: {e}", mesh.name));
    assert!(!report.pass, "{}: {plant} was not caught\n{report}", mesh.name);
    report
}

/// A point of a patch's table that is 1e-6 of the diagonal off shows in that patch, and nowhere but in those that share it.
fn points(mesh: &SubdivMesh, gpu: &Gpu, stride: usize) {
    let surface = LimitSurface::new(mesh).expect("the mesh is valid");
    for patch in (0..surface.patches().len()).step_by(stride) {
        let report = planted(mesh, gpu, Plant::Point { patch, point: None });
        let failures = report.failures.as_ref().expect("it says where");
        let listed: Vec<_> = failures.worst.iter().filter_map(|failed| failed.patch).collect();
        let face = surface.patches()[patch].ptex;
        assert!(failures.worst.iter().all(|failed| failed.ptex_face == face), "{} {patch}: {report}", mesh.name);
        // Strips along a crease share their points; more of them than are listed may be worse.
        let is_strip = |patch: usize| {
            let [u, v] = surface.patches()[patch].depth;
            u != v
        };
        let found = listed.contains(&(patch as u32));
        let shared = listed.iter().filter(|&&listed| is_strip(listed as usize)).count() + 1 >= listed.len();
        assert!(found || failures.patches > listed.len(), "{} {patch}: {report}", mesh.name);
        assert!(failures.patches == 1 || shared, "{} {patch}: {report}", mesh.name);
        // The rows that judge what is inside the patch have their worst sample there.
        let rows: Vec<_> = report.tiers.iter().filter(|row| row.tier == "regular" && !row.pass).collect();
        assert!(rows.iter().any(|row| row.reference.starts_with("limit stencils")), "{} {patch}", mesh.name);
        assert!(rows.iter().any(|row| row.reference.starts_with("Far")), "{} {patch}", mesh.name);
        for row in rows {
            let worst = row.worst.expect("it names one");
            let (found, _) = surface.locate(worst.face, [worst.u, worst.v]).expect("no hole");
            assert!(listed.contains(&(found as u32)), "{} {patch}: worst in {found}", mesh.name);
        }
    }
}

#[test]
fn a_point_of_any_patch_is_caught_in_that_patch() {
    let gpu = gpu();
    for name in ["dart_5", "semi_sharp_pole_5", "ngon_at_crease", "cone", "boundary_pole_5"] {
        points(&own(name), &gpu, 1);
    }
    // Deep strips and isolated faces, some of 2^-9 of a face.
    points(&own("crease_9_5"), &gpu, 7);
    points(&mesh::sample(), &gpu, 97);
}

#[test]
fn every_point_of_a_table_is_caught() {
    let (gpu, mesh) = (gpu(), own("pole_5"));
    let surface = LimitSurface::new(&mesh).expect("the mesh is valid");
    let irregular = (0..surface.patches().len()).find(|&patch| surface.class(patch).is_some()).expect("a pole");
    let class = &surface.classes()[surface.class(irregular).expect("it has one")];
    for (patch, count) in [(irregular, class.support()), (0, 16)] {
        for point in 0..count {
            let report = planted(&mesh, &gpu, Plant::Point { patch, point: Some(point) });
            let failures = report.failures.expect("it says where");
            assert!(failures.patches == 1 && failures.worst[0].patch == Some(patch as u32), "{patch} {point}");
        }
    }
}

#[test]
fn a_wrong_crease_rule_is_caught_beside_the_crease() {
    let gpu = gpu();
    let meshes =
        [own("infinitely_sharp_crease"), own("crease_2_7"), own("chaikin_crossing"), own("crease_10"), mesh::sample()];
    for mesh in &meshes {
        for crease in (0..mesh.creases.len()).step_by(mesh.creases.len().div_ceil(3)) {
            let report = planted(mesh, &gpu, Plant::Crease(crease));
            let failures = report.failures.expect("it says where");
            let near = mesh.creases[crease].vertices;
            for failed in &failures.worst {
                let (_, face) = mesh.faces().nth(failed.control_face as usize).expect("a face");
                assert!(face.iter().any(|vertex| near.contains(vertex)), "{} crease {crease}: {failed}", mesh.name);
            }
        }
    }
}

#[test]
fn swapped_parameters_are_caught_by_every_tier() {
    let gpu = gpu();
    for mesh in [own("n_gons"), own("dart"), mesh::sample()] {
        let report = planted(&mesh, &gpu, Plant::Swap);
        for tier in ["vertex", "dyadic", "regular", "fragment"] {
            assert!(report.tiers.iter().any(|row| row.tier == tier && !row.pass), "{tier}: {report}");
        }
    }
}

#[test]
fn what_is_not_there_cannot_be_planted() {
    let (gpu, mesh) = (gpu(), own("cube"));
    for (plant, message) in [
        (Plant::Point { patch: 24, point: None }, "patch 24 cannot be planted: the mesh has 24"),
        (Plant::Point { patch: 0, point: Some(99) }, "control point 99"),
        (Plant::Crease(0), "crease 0 cannot be planted: the mesh has 0"),
    ] {
        let error = verify(&mesh, &gpu, &settings(plant)).expect_err("it is refused").to_string();
        assert!(error.contains(message), "{error}");
    }
    for word in ["point:x", "crease:1:2", "swap:1", "", "points"] {
        assert!(word.parse::<Plant>().is_err(), "{word}");
    }
    for word in ["point:3", "point:3:4", "crease:2", "swap"] {
        assert_eq!(word.parse::<Plant>().expect("it is one").to_string(), word);
    }
}
