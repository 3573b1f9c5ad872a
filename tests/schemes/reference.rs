//! Compared with OpenSubdiv, which subdivides by the same scheme.

use super::{loop_corpus, meshes};
use catoptric::gpu::Gpu;
use catoptric::mesh::{Scheme, SubdivMesh};
use catoptric::osd::{Far, LimitStencils};
use catoptric::patch::PatchKind;
use catoptric::verify::verify;
use std::collections::BTreeSet;

fn assert_verified(mesh: &SubdivMesh, gpu: &Gpu) -> BTreeSet<String> {
    let report = verify(mesh, gpu, [128, 128]).expect("it is verified");
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

#[test]
fn opensubdivs_own_shapes_are_verified() {
    let gpu = Gpu::new().expect("an adapter");
    loop_corpus().iter().for_each(|mesh| drop(assert_verified(mesh, &gpu)));
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
