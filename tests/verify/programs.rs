//! Answers of other programs: whose they are is found out, at whatever setting, and nobody else's are taken for them.

use super::own;
use catoptric::mesh::{Boundary, Creasing, SubdivMesh, sample};
use catoptric::osd::{self, Bfr, EndCap, Far, FarOptions, Isolation, Location, Reference, ReferenceJet};
use catoptric::stam::LimitSurface;
use catoptric::verify::Sample;
use catoptric::verify::conformance::{Answer, DEFAULT_PER_FACE, Results, Terms, Tolerances, conformance, sample_set};
use glam::DVec3;
use opensubdiv_rs::far::{
    AdaptiveOptions, PatchMap, PatchTableFactory, PrimvarRefiner, TopologyDescriptor, TopologyRefinerFactory,
};
use opensubdiv_rs::sdc;

/// Enough for some to lie in the deepest end caps.
const PER_FACE: usize = DEFAULT_PER_FACE;

/// The standard samples.
fn asked(mesh: &SubdivMesh) -> Vec<Sample> {
    sample_set(&LimitSurface::new(mesh).expect("the mesh is valid"), PER_FACE).collect()
}

fn answer(at: Sample, jet: Option<[DVec3; 3]>) -> Answer {
    let nothing = [DVec3::NAN; 3];
    let [position, du, dv] = jet.unwrap_or(nothing);
    Answer { at, position: jet.map(|_| position), derivatives: Some([du, dv]), normal: Some(du.cross(dv)) }
}

/// Answers of one of OpenSubdiv's evaluators to the standard samples, asked through `round`.
fn of_osd(
    mesh: &SubdivMesh,
    round: impl Fn(f64) -> f64,
    evaluate: impl FnOnce(&[Location]) -> Result<Vec<ReferenceJet>, osd::Error>,
) -> Vec<Answer> {
    let asked = asked(mesh);
    let places: Vec<Location> = asked.iter().map(|s| (s.face, round(s.u), round(s.v))).collect();
    let jets = evaluate(&places).expect("it evaluates");
    let said = |jet: &ReferenceJet| (jet.answer != osd::Answer::None).then_some([jet.position, jet.du, jet.dv]);
    asked.into_iter().zip(&jets).map(|(at, jet)| answer(at, said(jet))).collect()
}

fn of_far(mesh: &SubdivMesh, options: FarOptions, round: impl Fn(f64) -> f64) -> Vec<Answer> {
    of_osd(mesh, round, |places| Far::with_options(mesh, options)?.evaluate(places))
}

fn gregory(level: u32) -> FarOptions {
    FarOptions::exact(Isolation::uniform(level), EndCap::Gregory)
}

fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

/// The public port of Far in Rust, which evaluates in 32 bits.
fn of_the_port(mesh: &SubdivMesh, level: usize) -> Vec<Answer> {
    let sizes: Vec<usize> = mesh.face_sizes.iter().map(|&size| size as usize).collect();
    let creases: Vec<[u32; 2]> = mesh.creases.iter().map(|c| c.vertices).collect();
    let crease_weights: Vec<f32> = mesh.creases.iter().map(|c| c.sharpness).collect();
    let corners: Vec<u32> = mesh.corners.iter().map(|c| c.vertex).collect();
    let corner_weights: Vec<f32> = mesh.corners.iter().map(|c| c.sharpness).collect();
    let topology = TopologyDescriptor::new(mesh.points.len(), &sizes, &mesh.face_vertices)
        .with_creases(&creases, &crease_weights)
        .with_corners(&corners, &corner_weights)
        .with_holes(&mesh.holes);
    let options = sdc::Options {
        vtx_boundary_interpolation: match mesh.boundary {
            Boundary::None => sdc::VtxBoundaryInterpolation::None,
            Boundary::EdgeOnly => sdc::VtxBoundaryInterpolation::EdgeOnly,
            Boundary::EdgeAndCorner => sdc::VtxBoundaryInterpolation::EdgeAndCorner,
        },
        creasing_method: match mesh.creasing {
            Creasing::Uniform => sdc::CreasingMethod::Uniform,
            Creasing::Chaikin => sdc::CreasingMethod::Chaikin,
        },
        ..sdc::Options::default()
    };
    let mut refiner =
        TopologyRefinerFactory::create(topology, sdc::SchemeType::Catmark, options).expect("the mesh is valid");
    refiner.refine_adaptive(AdaptiveOptions::new(level));
    let table = PatchTableFactory::create(&refiner).expect("it has patches");
    let map = PatchMap::new(&table);
    let mut points: Vec<[f64; 3]> = mesh.points.iter().map(|p| p.to_array()).collect();
    for level in PrimvarRefiner::new(&refiner).interpolate_all(&points.clone()) {
        points.extend(level);
    }
    let jet = |s: Sample| {
        let [u, v] = [s.u, s.v].map(|x| x as f32);
        let patch = map.find_patch(s.face as usize, u, v)?;
        let (position, du, dv) = table.evaluate(patch, u, v, &points);
        Some([position, du, dv].map(DVec3::from_array))
    };
    asked(mesh).into_iter().map(|at| answer(at, jet(at))).collect()
}

/// What 64 bits can do: the default lets the deepest end caps pass.
const OF_64_BITS: Tolerances = Tolerances { position: 1e-9, normal_deg: 1e-4, derivative: 1e-7 };

fn judged_within(tolerances: Tolerances, mesh: &SubdivMesh, answers: &[Answer]) -> Results {
    let terms = Terms { per_face: PER_FACE, tolerances, partial: false };
    let report = conformance(mesh, answers, &terms).expect("it can be judged");
    let results = report.results.expect("answers were judged");
    println!("{}: {results}", mesh.name);
    assert!(!report.pass, "{}: {results}", mesh.name);
    results
}

fn judged(mesh: &SubdivMesh, answers: &[Answer]) -> Results {
    judged_within(OF_64_BITS, mesh, answers)
}

/// What the answers are said to be; they are this to within `residual`, and all of them.
fn said(mesh: &SubdivMesh, answers: &[Answer], residual: f64) -> String {
    of_results(mesh, &judged(mesh, answers), residual)
}

fn of_results(mesh: &SubdivMesh, results: &Results, residual: f64) -> String {
    let [finding] = results.diagnosis.as_slice() else { panic!("{}: {results}", mesh.name) };
    assert!(finding.residual.is_some_and(|left| left <= residual), "{}: {finding}", mesh.name);
    let [fits, all] = finding.all.unwrap_or([finding.fits, finding.of]);
    assert!(fits as f64 >= 0.999 * all as f64 && finding.fits as f64 >= 0.999 * finding.of as f64, "{finding}");
    assert_eq!(results.nearest, None);
    finding.mistake.clone()
}

fn assert_said(mesh: &SubdivMesh, answers: &[Answer], residual: f64, beginning: &str) {
    let said = said(mesh, answers, residual);
    assert!(said.starts_with(beginning), "{}: {said}", mesh.name);
}

const PATCHES: &str = "the answers are those of OpenSubdiv's patches (Far) at isolation";

/// It sat the test as it is published.
#[test]
fn the_port_of_far_is_recognised() {
    for mesh in [sample(), own("cube"), own("pole_5")] {
        for level in [1, 2, 3, 5] {
            let results = judged_within(Tolerances::default(), &mesh, &of_the_port(&mesh, level));
            let said = of_results(&mesh, &results, 1e-6);
            assert!(said.starts_with(&format!("{PATCHES} {level} with Gregory end caps")), "{}: {said}", mesh.name);
            assert!(said.ends_with("to the rounding of 32-bit floats"), "{said}");
        }
    }
}

#[test]
fn patches_are_recognised_at_any_isolation() {
    for mesh in [own("cube"), own("n_gons"), own("pole_5")] {
        for level in 1..=10 {
            let answers = of_far(&mesh, gregory(level), |x| x);
            assert_said(&mesh, &answers, 1e-13, &format!("{PATCHES} {level} with Gregory end caps"));
        }
    }
}

/// Options, end caps, and levels that are not the same everywhere.
#[test]
fn patches_are_recognised_by_their_options() {
    let mesh = sample();
    for (end_cap, name) in [(EndCap::BSpline, "B-spline"), (EndCap::Bilinear, "bilinear")] {
        let options = FarOptions::exact(Isolation::uniform(3), end_cap);
        assert_said(&mesh, &of_far(&mesh, options, |x| x), 1e-13, &format!("{PATCHES} 3 with {name} end caps"));
    }
    let default = FarOptions { smoothed_creases: true, legacy_corners: true, ..gregory(4) };
    let said = said(&mesh, &of_far(&mesh, default, |x| x), 1e-13);
    assert!(
        said.starts_with(&format!("{PATCHES} 4 with Gregory end caps, useInfSharpPatch off, as is its default")),
        "{said}"
    );
    let pair = FarOptions::exact(Isolation { sharp: 5, smooth: 3 }, EndCap::Gregory);
    assert_said(&mesh, &of_far(&mesh, pair, |x| x), 1e-13, &format!("{PATCHES} 5, 3 round smooth features"));
}

#[test]
fn rounded_parameters_are_recognised() {
    let mesh = sample();
    let said_of = |answers: &[Answer]| said(&mesh, answers, 1e-6);
    let patches = of_far(&mesh, gregory(5), single);
    assert_eq!(said_of(&patches), format!("{PATCHES} 5 with Gregory end caps, at parameters rounded to 32 bits"));
    let surface = LimitSurface::new(&mesh).expect("the mesh is valid");
    let exact = |at: Sample| {
        let jet = surface.evaluate_ptex(at.face, [single(at.u), single(at.v)]);
        answer(at, jet.map(|(_, jet)| [jet.position, jet.du, jet.dv]))
    };
    let exact: Vec<Answer> = asked(&mesh).into_iter().map(exact).collect();
    assert_eq!(said_of(&exact), "the answers are those of the exact limit, at parameters rounded to 32 bits");
    // All of it in 32 bits, at the end.
    let vector = |p: DVec3| p.as_vec3().as_dvec3();
    let rough = of_far(&mesh, gregory(2), single).into_iter().map(|a| Answer {
        position: a.position.map(vector),
        derivatives: a.derivatives.map(|d| d.map(vector)),
        normal: a.normal.map(vector),
        ..a
    });
    let rough: Vec<Answer> = rough.collect();
    assert!(said_of(&rough).starts_with(&format!("{PATCHES} 2 with Gregory end caps")));
}

#[test]
fn bfr_is_recognised() {
    let mesh = sample();
    for (levels, name) in [
        (Bfr::DEFAULT_LEVELS, "Bfr at its default approximation levels (2 smooth, 6 sharp)"),
        ((4, 4), "Bfr at approximation levels 4 (smooth) and 4 (sharp)"),
    ] {
        let answers = of_osd(&mesh, |x| x, |places| Bfr::new(&mesh, levels)?.evaluate(places));
        let said = said(&mesh, &answers, 1e-7);
        assert!(said.contains(name), "{said}");
    }
}

/// A mesh refined so often and then taken for flat, with limit points at its vertices.
#[test]
fn facets_are_recognised() {
    let mesh = own("n_gons");
    let surface = LimitSurface::new(&mesh).expect("the mesh is valid");
    let on_part = |face: u32| {
        let mut next = 0;
        let parts = mesh.face_sizes.iter().find_map(|&size| {
            next += if size == 4 { 1 } else { size };
            (face < next).then_some(size != 4)
        });
        parts == Some(true)
    };
    let facet = |at: Sample| {
        let cells = if on_part(at.face) { 4.0 } else { 8.0 };
        let split = |x: f64| ((x * cells).floor().min(cells - 1.0), x * cells - (x * cells).floor().min(cells - 1.0));
        let ((i, s), (j, t)) = (split(at.u), split(at.v));
        let corner = |a: f64, b: f64| {
            surface.evaluate_ptex(at.face, [(i + a) / cells, (j + b) / cells]).map(|(_, jet)| jet.position)
        };
        let (a, b, c, d) = (corner(0.0, 0.0)?, corner(1.0, 0.0)?, corner(1.0, 1.0)?, corner(0.0, 1.0)?);
        let position = a * (1.0 - s) * (1.0 - t) + b * s * (1.0 - t) + c * s * t + d * (1.0 - s) * t;
        let du = cells * ((b - a) * (1.0 - t) + (c - d) * t);
        let dv = cells * ((d - a) * (1.0 - s) + (c - b) * s);
        Some([position, du, dv])
    };
    let answers: Vec<Answer> = asked(&mesh).into_iter().map(|at| answer(at, facet(at))).collect();
    assert_said(
        &mesh,
        &answers,
        1e-13,
        "the answers are those of the mesh refined 3 times, with its vertices moved to the limit",
    );
}

/// The same for the points as they are refined, which tells who takes uniformly refined stencils for the limit.
#[test]
fn refined_meshes_are_recognised() {
    let mesh = own("semi_sharp_crease");
    let level = 2;
    let refiner = osd::Refiner::uniform(&mesh, level).expect("it refines");
    let points = refiner.interpolate(&mesh.points).expect("it refines");
    let last = refiner.level(level as usize).expect("it has it");
    let points = &points[points.len() - last.vertex_count()..];
    // Corners of the ptex faces are vertices of the control mesh, whose descendants are known.
    let place = |vertex: u32| {
        (0..level as usize)
            .fold(vertex as usize, |v, l| refiner.level(l).expect("it has it").vertex_children[v] as usize)
    };
    assert!(mesh.face_sizes.iter().all(|&size| size == 4));
    let corner = |at: Sample| {
        let k = match [at.u, at.v] {
            [0.0, 0.0] => 0,
            [1.0, 0.0] => 1,
            [1.0, 1.0] => 2,
            [0.0, 1.0] => 3,
            _ => return None,
        };
        let position = points[place(mesh.face_vertices[4 * at.face as usize + k])];
        Some(Answer { at, position: Some(position), derivatives: None, normal: None })
    };
    let answers: Vec<Answer> = asked(&mesh).into_iter().filter_map(corner).collect();
    assert_said(
        &mesh,
        &answers,
        1e-13,
        &format!("the answers are those of the mesh refined {level} times and flat between its vertices"),
    );
}

/// A mistake and a program at once.
#[test]
fn a_mistake_beside_a_program_is_named() {
    let mesh = own("cube");
    let swapped = |s: &Sample| (s.face, s.v, s.u);
    let asked = asked(&mesh);
    let places: Vec<Location> = asked.iter().map(swapped).collect();
    let jets = Far::with_options(&mesh, gregory(3)).and_then(|far| far.evaluate(&places)).expect("it evaluates");
    let answers: Vec<Answer> =
        asked.into_iter().zip(jets).map(|(at, jet)| answer(at, Some([jet.position, jet.dv, jet.du]))).collect();
    assert_said(
        &mesh,
        &answers,
        1e-13,
        "u and v are swapped; but for that, the answers are those of OpenSubdiv's patches (Far) at isolation 3",
    );

    // Derivatives as OpenSubdiv hands them out.
    let mesh = own("n_gons");
    let surface = LimitSurface::new(&mesh).expect("the mesh is valid");
    let half = surface.ptex_count();
    assert!(half > mesh.face_sizes.len());
    let mut ptex = Vec::new();
    mesh.face_sizes
        .iter()
        .for_each(|&size| ptex.extend(std::iter::repeat_n(size, if size == 4 { 1 } else { size as usize })));
    let doubled = |a: Answer| {
        let by = if ptex[a.at.face as usize] == 4 { 1.0 } else { 2.0 };
        Answer { derivatives: a.derivatives.map(|d| d.map(|d| by * d)), ..a }
    };
    let answers: Vec<Answer> = of_far(&mesh, gregory(4), |x| x).into_iter().map(doubled).collect();
    let said = said(&mesh, &answers, 1e-13);
    assert!(
        said.starts_with(&format!("{PATCHES} 4 with Gregory end caps, with its derivatives on the parts of n-gons")),
        "{said}"
    );
}

/// Answers go on without the samples in holes, which have none.
#[test]
fn rows_that_slipped_are_named() {
    let mesh = own("hole");
    let right = of_far(&mesh, gregory(10), |x| x);
    let kept: Vec<Answer> = right.iter().filter(|a| a.position.is_some()).copied().collect();
    assert!(kept.len() < right.len());
    let slipped: Vec<Answer> = right.iter().zip(kept).map(|(row, answer)| Answer { at: row.at, ..answer }).collect();
    let results = judged(&mesh, &slipped);
    assert!(
        results.diagnosis[0].mistake.starts_with("samples in holes were left out, but not their rows"),
        "{results}"
    );
}

/// The search can fail: what is nearly a program's is not its, and how near it is is said.
#[test]
fn what_is_nobodys_is_not_given_to_anybody() {
    let mesh = own("cube");
    let near = |a: Answer| {
        let bump = 1e-4 * (31.0 * a.at.u + 17.0 * a.at.v).sin() * DVec3::new(0.3, -0.5, 0.7);
        Answer { position: a.position.map(|p| p + bump), ..a }
    };
    let answers: Vec<Answer> = of_far(&mesh, gregory(3), |x| x).into_iter().map(near).collect();
    let results = judged(&mesh, &answers);
    assert!(results.diagnosis.is_empty(), "{results}");
    // A fifth of the answers are another program's: more than the search forgives.
    let mixed: Vec<Answer> = of_far(&mesh, gregory(3), |x| x)
        .into_iter()
        .zip(of_far(&mesh, gregory(2), |x| x))
        .enumerate()
        .map(|(i, (three, two))| if i % 5 == 0 { two } else { three })
        .collect();
    let results = judged(&mesh, &mixed);
    assert!(results.diagnosis.iter().all(|finding| finding.all.is_none()), "{results}");
    let nearest = results.nearest.as_ref().expect("one is near");
    // On a cube Bfr at level 3 is the same surface.
    let is_third = ["isolation 3 with Gregory", "levels 3 (smooth)"].iter().any(|name| nearest.program.contains(name));
    assert!(is_third && nearest.part > 0.5 && nearest.part < 0.95, "{results}");
    assert!(nearest.missed > 1e-6 && results.to_string().contains("nearest: "), "{results}");
}
