//! The peers of benchmarks answer what the references do: what is timed is right.

mod common;

use catoptric::bench::{self, Effort, Means, Work};
use catoptric::mesh::{SubdivMesh, sample};
use catoptric::osd::{Answer, Bfr, BfrPeer, Far, MAX_ISOLATION, OsdPeer, PeerSamples, Reference, ReferenceJet};
use common::meshes;
use glam::DVec3;

fn places(mesh: &SubdivMesh) -> Vec<(u32, f64, f64)> {
    let uv = [[0.5, 0.5], [0.25, 0.125], [0.3125, 0.9375], [0.71875, 0.40625]];
    (0..mesh.ptex_count() as u32).flat_map(|face| uv.map(|[u, v]| (face, u, v))).collect()
}

fn difference(jet: &[[f64; 3]; 3], reference: &ReferenceJet, doubled: f64) -> f64 {
    let [position, du, dv] = jet.map(DVec3::from_array);
    let off = |a: DVec3, b: DVec3| a.distance(b) / (1.0 + b.length());
    off(position, reference.position).max(off(du, doubled * reference.du)).max(off(dv, doubled * reference.dv))
}

#[test]
fn bfr_answers_what_the_reference_does() {
    for mesh in meshes() {
        let (Ok(mut reference), Ok(peer)) = (Bfr::new(&mesh, (2, 6)), BfrPeer::<f64>::new(&mesh, (2, 6))) else {
            continue;
        };
        let places = places(&mesh);
        let mut jets = vec![[[0.0; 3]; 3]; places.len()];
        peer.evaluate(&PeerSamples::new(&places, mesh.ptex_count()), &mut jets).expect("an answer");
        let references = reference.evaluate(&places).expect("an answer");
        for (jet, reference) in jets.iter().zip(&references) {
            assert!(difference(jet, reference, 1.0) < 1e-12, "{}: {jet:?} {reference:?}", mesh.name);
        }
    }
}

/// In single precision; derivatives of quadrants of n-gons come twice as long.
#[test]
fn osd_answers_what_far_does() {
    for mesh in meshes() {
        let (Ok(far), Ok(mut peer)) = (Far::new(&mesh, MAX_ISOLATION), OsdPeer::new(&mesh, MAX_ISOLATION)) else {
            continue;
        };
        let references = far.evaluate(&places(&mesh)).expect("an answer");
        // Those in holes are left out.
        let answered = places(&mesh).into_iter().zip(references).filter(|(_, jet)| jet.answer != Answer::None);
        let (places, references): (Vec<_>, Vec<_>) =
            answered.map(|((face, u, v), jet)| ((face, u as f32, v as f32), jet)).unzip();
        peer.place(&PeerSamples::new(&places, mesh.ptex_count())).expect("a place");
        let mut jets = vec![[[0.0f32; 3]; 3]; places.len()];
        peer.evaluate(&mut jets).expect("an answer");
        for (jet, reference) in jets.iter().zip(&references) {
            let jet = jet.map(|x| x.map(f64::from));
            // Stencils of many terms, and differences of 1/1024 of a face.
            let off = difference(&jet, reference, 1.0).min(difference(&jet, reference, 2.0));
            assert!(off < 2e-3, "{}: {off:e} {jet:?} {reference:?}", mesh.name);
        }
    }
}

/// After a move it is the peer of the moved mesh.
#[test]
fn osd_follows_control_points() {
    let mesh = sample();
    let bent: Vec<DVec3> = mesh.points.iter().map(|p| DVec3::new(p.x, p.y + 0.1 * p.x * p.x, 1.2 * p.z)).collect();
    let moved = SubdivMesh { points: bent, ..mesh.clone() };
    let places = PeerSamples::new(&[(0, 0.25, 0.5), (7, 0.5, 0.5), (40, 0.1, 0.9)], mesh.ptex_count());
    let [mut first, mut second] = [&mesh, &moved].map(|mesh| OsdPeer::new(mesh, 5).expect("a peer"));
    let single: Vec<[f32; 3]> = moved.points.iter().map(|p| p.as_vec3().to_array()).collect();
    first.update(&single).expect("it follows");
    let mut jets = [[[[0.0f32; 3]; 3]; 3]; 2];
    for (peer, jets) in [&mut first, &mut second].into_iter().zip(&mut jets) {
        peer.place(&places).expect("a place");
        peer.evaluate(jets).expect("an answer");
    }
    assert_eq!(jets[0], jets[1]);
}

/// Every row that needs no adapter has figures, and floors are below what is measured against them.
#[test]
fn rows_are_measured() {
    let works = Work::ALL.into_iter().filter(|work| !matches!(work, Work::Frame | Work::Scale));
    for work in works {
        let rows = bench::measure(work, &sample(), Effort::QUICK, Means::default()).expect("figures");
        assert!(!rows.is_empty());
        for row in rows {
            assert!(row.catoptric > 0.0 && row.peers["bfr"].or(row.peers["osd"]).is_some_and(|x| x > 0.0), "{row:?}");
        }
    }
}

/// The tessellation that frames are measured against shows the same surface in the same place, with stripes on it.
#[test]
fn the_tessellation_covers_what_the_limit_does() {
    use catoptric::field::Scout;
    use catoptric::gpu::{Gpu, NO_PATCH, View};
    use catoptric::stam::LimitSurface;
    const PARTS: u32 = 16;
    let surface = LimitSurface::new(&sample()).expect("a surface");
    let scout = Scout::new(&surface).expect("it has faces");
    let camera = scout.camera([256, 256], DVec3::Z);
    let view = View { samples: 1, ..View::new(camera, scout.light(&camera)) };
    let gpu = Gpu::new().expect("an adapter");
    let (mut corners, mut indices) = (Vec::new(), Vec::new());
    for face in 0..surface.ptex_count() as u32 {
        let first = corners.len() as u32;
        for k in 0..(PARTS + 1) * (PARTS + 1) {
            let uv = [k % (PARTS + 1), k / (PARTS + 1)].map(|k| f64::from(k) / f64::from(PARTS));
            let (_, jet) = surface.evaluate_ptex(face, uv).expect("no hole");
            corners.push([jet.position, jet.normal].map(|x| x.as_vec3().to_array()));
        }
        for k in 0..PARTS * PARTS {
            let a = first + k / PARTS * (PARTS + 1) + k % PARTS;
            indices.extend([a, a + 1, a + PARTS + 2, a, a + PARTS + 2, a + PARTS + 1]);
        }
    }
    let triangles = gpu.tessellate(&corners, &indices, &view).expect("room for it");
    gpu.draw_tessellated(&triangles).expect("it is drawn");
    let picture = gpu.read_tessellated(&triangles).expect("a picture");
    let seen = gpu.inspect(&gpu.upload(&surface).expect("room"), &view).expect("a picture");
    // Stripes are half dark, so what is light must be covered, and much of what is covered must be light.
    let (mut light, mut outside, mut covered) = (0, 0, 0);
    for (pixel, patch) in picture.iter().zip(&seen.patch) {
        covered += usize::from(*patch != NO_PATCH);
        if pixel[0] > 127 {
            light += 1;
            outside += usize::from(*patch == NO_PATCH);
        }
    }
    assert!(covered > 10_000 && light > covered / 4 && light < covered * 3 / 4, "{light} of {covered}");
    assert!(outside * 200 < light, "{outside} light pixels of {light} show no surface");
}
