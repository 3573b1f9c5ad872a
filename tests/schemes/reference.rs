//! Compared with OpenSubdiv, which subdivides by the same scheme.

use super::{meshes, triangulated};
use catoptric::gpu::Gpu;
use catoptric::mesh::{Scheme, SubdivMesh};
use catoptric::osd::{Far, LimitStencils};
use catoptric::patch::PatchKind;
use catoptric::verify::{Settings, VerifyError, verify};
use std::collections::BTreeSet;

fn assert_verified(mesh: &SubdivMesh, gpu: &Gpu) -> BTreeSet<String> {
    let report = match verify(mesh, gpu, &Settings { size: [128, 128], ..Settings::default() }) {
        // Boundary rule none may leave no face.
        Err(VerifyError::NoSurface) => return BTreeSet::new(),
        report => report.expect("it is verified"),
    };
    assert!(report.pass, "{report}");
    let judged = report.tiers.iter().filter(|row| row.samples > 0 && ["dyadic", "regular"].contains(&row.tier));
    judged.map(|row| row.kind.to_owned()).collect()
}

/// Every mesh, every tier, and all kinds of patches among them.
#[test]
fn every_mesh_is_verified_against_opensubdiv() {
    let gpu = Gpu::new().expect("an adapter");
    let (mut kinds, mut failed) = (BTreeSet::new(), Vec::new());
    for mesh in meshes() {
        match std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| assert_verified(&mesh, &gpu))) {
            Ok(found) => kinds.extend(found),
            Err(_) => failed.push(mesh.name),
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
    for kind in PatchKind::ALL {
        assert!(kinds.contains(kind.name()), "{kind:?} was not compared");
    }
}

/// Meshes of quads and other polygons, random ones and those of the other tests, in triangles: features meet in ways that nobody
/// thought of.
#[test]
fn triangulated_meshes_are_verified() {
    let gpu = Gpu::new().expect("an adapter");
    let random = (0..60).map(crate::random_mesh::mesh);
    let (mut verified, mut failed) = (0, Vec::new());
    for mesh in random.chain(crate::common::meshes()).chain(crate::common::corpus()) {
        // Larger ones take minutes: without strips a triangle beside a crease of sharpness 9 is a thousand.
        if mesh.face_count() > 400 {
            continue;
        }
        let triangles = triangulated(&mesh);
        // Quads that share three vertices make a triangle twice.
        if triangles.validate().is_err() {
            continue;
        }
        let name = triangles.name.clone();
        match std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| assert_verified(&triangles, &gpu))) {
            Ok(_) => verified += 1,
            Err(_) => failed.push(name),
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
    assert!(verified > 100, "{verified}");
}

/// The reference follows the scheme: a triangle's limit is another one under each.
#[test]
fn the_reference_follows_the_scheme() {
    let mesh = super::named("loop_tetrahedron");
    let at = (0, 0.25, 0.25);
    let mut answers = Vec::new();
    for scheme in [Scheme::CatmullClark, Scheme::Loop, Scheme::Bilinear] {
        let mesh = SubdivMesh { scheme, ..mesh.clone() };
        let stencil = LimitStencils::new(&mesh, 10).and_then(|s| s.evaluate(&[at])).expect("it evaluates")[0];
        let far = Far::new(&mesh, 10).and_then(|far| far.evaluate(&[at])).expect("it evaluates")[0];
        assert!(stencil.position.distance(far.position) < 1e-12 * mesh.diagonal(), "{scheme:?}");
        answers.push(stencil.position);
    }
    assert!(answers[0].distance(answers[1]) > 1e-3 && answers[1].distance(answers[2]) > 1e-3, "{answers:?}");
}
