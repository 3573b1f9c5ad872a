//! One patch at a time: f64 and WGSL against `Far::PatchTable::EvaluateBasis`.

use crate::common::{angle_deg, corpus, meshes};
use crate::gpu_support::{Random, gpu};
use catoptric::adaptive::AdaptivePatches;
use catoptric::gpu::Sample;
use catoptric::mesh::SubdivMesh;
use catoptric::osd::{Answer, EndCap, Far, Isolation};
use catoptric::stam::Jet;

/// Positions in f32 are sums of 16 products of numbers of the size of the patch, which is at most the diagonal: 20 roundings
/// of 2^-24 each.
const POSITION: f64 = 2e-6;
/// Normals in degrees at the 99.99th percentile: 1/100 pixel of reflection line is 1.4e-3.
const NORMAL_DEGREES: f64 = 1e-3;

/// Parameters of a patch that no other one answers for in the table: its first corner and edges, and its inside.
fn parameters(seed: u64) -> Vec<[f32; 2]> {
    let mut random = Random::new(seed);
    let mut uv = vec![[0.0, 0.0], [1e-6, 1e-6], [0.999, 0.999], [0.5, 0.5]];
    for _ in 0..4 {
        let mut next = || 0.999 * random.next() as f32;
        let (a, b, c) = (next(), next(), next());
        uv.extend([[a, 0.0], [0.0, a], [0.999, b], [b, 0.999], [a, b], [b, c], [c, a]]);
    }
    uv
}

/// What one mesh and table showed.
#[derive(Debug, Default)]
struct Worst {
    position: f64,
    derivative: f64,
    gpu_position: f64,
    gpu_normals: Vec<f64>,
    samples: usize,
    gregory: usize,
}

/// Compares every patch of a table with what `Far` says at the same place.
fn compare(mesh: &SubdivMesh, isolation: Isolation, end_cap: EndCap, worst: &mut Worst) {
    let ours = AdaptivePatches::new(mesh, isolation, end_cap).expect("the mesh is valid");
    let far = Far::with(mesh, isolation, end_cap).expect("the mesh is valid");
    assert_eq!(ours.patches().len() as u64, far.patch_count());
    let samples: Vec<Sample> = (0..ours.patches().len() as u32)
        .flat_map(|patch| parameters(u64::from(patch)).into_iter().map(move |uv| Sample { patch, uv }))
        .collect();
    let places: Vec<(u32, f64, f64)> = samples
        .iter()
        .map(|s| {
            let patch = &ours.patches()[s.patch as usize];
            let [u, v] = patch.to_ptex(s.uv.map(f64::from));
            (patch.ptex, u, v)
        })
        .collect();
    let theirs = far.evaluate(&places).expect("the faces exist");
    let tables = gpu().upload_patches(&ours).expect("they fit");
    let shader = gpu().evaluate(&tables, &samples).expect("the adapter works");
    let unit = mesh.diagonal();
    for ((s, theirs), shader) in samples.iter().zip(&theirs).zip(&shader) {
        let patch = &ours.patches()[s.patch as usize];
        let expected = if patch.is_end_cap { Answer::EndCap } else { Answer::Regular };
        assert_eq!(theirs.answer, expected, "{}: patch {}", mesh.name, s.patch);
        worst.samples += 1;
        worst.gregory += usize::from(patch.is_end_cap && end_cap == EndCap::Gregory);
        let cell = 0.5f64.powi(i32::from(patch.depth));
        assert_eq!(theirs.cell, cell, "{}: patch {}", mesh.name, s.patch);
        let theirs = Jet::new(theirs.position, theirs.du * cell, theirs.dv * cell);
        let here = ours.evaluate(s.patch as usize, s.uv.map(f64::from));
        worst.position = worst.position.max(here.position.distance(theirs.position) / unit);
        let derivative = here.du.distance(theirs.du).max(here.dv.distance(theirs.dv));
        worst.derivative = worst.derivative.max(derivative / unit);
        worst.gpu_position = worst.gpu_position.max(shader.position.distance(theirs.position) / unit);
        // Derivatives are off by 20 roundings of the control points' distances: judged where that is less than the bound.
        let points = patch.net.points();
        let size = points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max);
        let [du, dv] = [theirs.du, theirs.dv].map(|d| d.length());
        if theirs.du.cross(theirs.dv).length() / du.max(dv) > 20.0 * 2f64.powi(-24) * size / NORMAL_DEGREES.to_radians()
        {
            worst.gpu_normals.push(angle_deg(shader.normal, theirs.normal));
        }
    }
}

fn judge(name: &str, worst: &mut Worst) {
    worst.gpu_normals.sort_by(f64::total_cmp);
    let count = worst.gpu_normals.len();
    let normal = worst.gpu_normals[(count as f64 * 0.9999).ceil() as usize - 1];
    println!(
        "{name}: f64 position {:.1e}, derivative {:.1e}; WGSL position {:.1e} of the diagonal, normal {normal:.1e} degrees \
         ({} samples, {} on Gregory patches; normals of {count})",
        worst.position, worst.derivative, worst.gpu_position, worst.samples, worst.gregory
    );
    // Both sides sum 16 or 20 products in f64.
    assert!(
        worst.position <= 1e-14 && worst.derivative <= 1e-13,
        "{name}: {:e} {:e}",
        worst.position,
        worst.derivative
    );
    assert!(worst.gpu_position <= POSITION, "{name}: {:e}", worst.gpu_position);
    assert!(normal <= NORMAL_DEGREES, "{name}: {normal:e}");
    // At a pole of 64 slivers f32 tells one in twelve.
    assert!(count > worst.samples / 20, "{name}: {count} normals of {} samples", worst.samples);
}

const TABLES: [(Isolation, EndCap); 6] = [
    (Isolation { sharp: 1, smooth: 1 }, EndCap::Gregory),
    (Isolation { sharp: 2, smooth: 2 }, EndCap::Gregory),
    (Isolation::DEFAULT, EndCap::Gregory),
    (Isolation { sharp: 5, smooth: 5 }, EndCap::Gregory),
    (Isolation { sharp: 1, smooth: 1 }, EndCap::BSpline),
    (Isolation::DEFAULT, EndCap::BSpline),
];

#[test]
fn patches_are_evaluated_as_opensubdiv_does() {
    let mut gregory = 0;
    for (isolation, end_cap) in TABLES {
        let mut worst = Worst::default();
        for mesh in meshes() {
            compare(&mesh, isolation, end_cap, &mut worst);
        }
        judge(&format!("own meshes, {end_cap} {isolation}"), &mut worst);
        gregory += worst.gregory;
    }
    assert!(gregory > 10_000, "{gregory} samples on Gregory patches");
}

/// Every mesh of the corpus, where it is beside the project.
#[test]
fn patches_of_the_corpus_are_evaluated_as_opensubdiv_does() {
    for mesh in corpus() {
        let mut worst = Worst::default();
        for (isolation, end_cap) in TABLES {
            compare(&mesh, isolation, end_cap, &mut worst);
        }
        judge(&mesh.name, &mut worst);
    }
}

/// The derivatives that OpenSubdiv gives are not those of its surface: a fact of 3.5.0 that pictures of its end caps show.
#[test]
fn derivatives_of_gregory_patches_are_approximate() {
    let mesh = catoptric::mesh::sample();
    let ours = AdaptivePatches::new(&mesh, Isolation::uniform(1), EndCap::Gregory).expect("the sample is valid");
    let mut largest = 0.0f64;
    for patch in (0..ours.patches().len()).filter(|&patch| ours.patches()[patch].is_end_cap) {
        let at = |u: f64| ours.evaluate(patch, [u, 0.3]);
        const STEP: f64 = 1e-5;
        let difference = (at(0.2 + STEP).position - at(0.2 - STEP).position) / (2.0 * STEP);
        let du = at(0.2).du;
        largest = largest.max(difference.distance(du) / du.length());
    }
    assert!(largest > 1e-4 && largest < 0.2, "{largest:e}");
}
