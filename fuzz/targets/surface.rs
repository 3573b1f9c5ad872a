//! From a mesh to its limit: refinement, patches, tables, evaluation, and OpenSubdiv's own evaluators.

use super::check_message;
use super::draft::{Draft, Input};
use arbitrary::Unstructured;
use catoptric::adaptive::AdaptivePatches;
use catoptric::mesh::{Scheme, SubdivMesh};
use catoptric::osd::{
    Answer, Bfr, EndCap, Far, INFINITE_SHARPNESS, Isolation, LimitStencils, Location, Reference, ReferenceJet, Refiner,
};
use catoptric::stam::{LimitSurface, Net};
use glam::DVec3;

/// Where every face is looked at.
const PLACES: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [0.5, 0.5],
    [0.25, 1.0],
    [0.3, 0.9],
    [1e-9, 1e-12],
    [1.0 - 1e-9, 1.0],
];
/// Deepest isolation of the references: each level costs time.
const ISOLATION: u32 = 4;

/// Any mesh: what its validation accepts has a surface.
pub fn surface(data: &[u8]) {
    let mut input = Unstructured::new(data);
    if let Ok(mesh) = mesh(&mut input) {
        check_surface(&mesh);
    }
}

fn mesh(input: &mut Input<'_>) -> arbitrary::Result<SubdivMesh> {
    Draft::wild(input)?.mesh(input)
}

fn check_surface(mesh: &SubdivMesh) {
    if let Err(error) = mesh.validate() {
        return check_message(&error.to_string(), "draft");
    }
    let surface = match LimitSurface::new(mesh) {
        Ok(surface) => surface,
        Err(error) => panic!("a valid mesh without a surface: {error}\n{mesh:?}"),
    };
    check_evaluation(&surface, mesh);
    for patch in 0..surface.patches().len().min(100) {
        let finite = match surface.net(patch, 24) {
            Net::Regular(points) => points.iter().all(|p| p.is_finite()),
            Net::Irregular { limit, lambda, levels } => {
                limit.is_finite() && lambda < 1.0 && levels.iter().flatten().all(|p| p.is_finite())
            }
            Net::Triangle(points) => points.iter().all(|p| p.is_finite()),
            Net::IrregularTriangle { limit, lambda, levels } => {
                limit.is_finite() && lambda < 1.0 && levels.iter().flatten().all(|p| p.is_finite())
            }
        };
        assert!(finite, "the net of patch {patch}\n{mesh:?}");
    }
    if !surface.has_triangles() {
        surface.adjacency();
    }
    check_references(mesh, &surface);
}

/// Those of [`PLACES`] that lie on the faces of a surface.
fn places(surface: &LimitSurface) -> impl Iterator<Item = [f64; 2]> + Clone {
    let triangles = surface.has_triangles();
    PLACES.into_iter().filter(move |[u, v]| !triangles || u + v <= 1.0)
}

/// Numbers are numbers, normals have length 1 or 0, and points lie between those that control them.
fn check_evaluation(surface: &LimitSurface, mesh: &SubdivMesh) {
    let Some([low, high]) = surface.bounds() else { return assert!(surface.patches().is_empty()) };
    let size = mesh.points.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
    let slack = DVec3::splat(1e-12 * size);
    for ptex in 0..surface.ptex_count() as u32 {
        for uv in places(surface) {
            let Some((patch, second)) = surface.evaluate_second_ptex(ptex, uv) else { continue };
            let jet = second.first;
            let all = [jet.position, jet.du, jet.dv, jet.normal, second.duu, second.duv, second.dvv];
            assert!(all.iter().all(|x| x.is_finite()), "face {ptex} at {uv:?}, patch {patch}: {second:?}\n{mesh:?}");
            let length = jet.normal.length();
            assert!(length == 0.0 || (length - 1.0).abs() < 1e-9, "face {ptex} at {uv:?}: {jet:?}\n{mesh:?}");
            let inside = jet.position.cmpge(low - slack).all() && jet.position.cmple(high + slack).all();
            assert!(inside, "face {ptex} at {uv:?}: {jet:?} is outside {low} to {high}\n{mesh:?}");
            second.curvature();
        }
    }
}

/// Whether no finite sharpness is left at the isolation of the references.
fn is_resolved(mesh: &SubdivMesh) -> bool {
    let sharpness = mesh.creases.iter().map(|c| c.sharpness).chain(mesh.corners.iter().map(|c| c.sharpness));
    sharpness.into_iter().all(|sharpness| sharpness <= ISOLATION as f32 || sharpness >= INFINITE_SHARPNESS)
}

/// Whether no edge has more than two faces, or two that run the same way. Elsewhere Far draws its patches as along a crease, though refined
/// vertices stay where they are, as at a corner: what that is off halves with every level (1/6 of an edge at level 0).
fn is_manifold(mesh: &SubdivMesh) -> bool {
    let control = Refiner::adaptive(mesh, 1, 1, false).and_then(|refiner| refiner.level(0)).expect("the mesh is valid");
    control.edge_faces.iter().all(|&[face, _]| face != -2)
}

/// Where OpenSubdiv's own patch is a B-spline, it is at the same place.
fn check_positions(mesh: &SubdivMesh, surface: &LimitSurface, samples: &[Location], answers: &[ReferenceJet]) {
    let size = mesh.points.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
    for (&(ptex, u, v), answer) in samples.iter().zip(answers).filter(|(_, jet)| jet.answer == Answer::Regular) {
        let (_, jet) = surface.evaluate_ptex(ptex, [u, v]).expect("no hole");
        let off = jet.position.distance(answer.position);
        assert!(off <= 1e-12 * size, "face {ptex} at {u},{v}: {} and {}\n{mesh:?}", jet.position, answer.position);
    }
}

/// OpenSubdiv's evaluators survive, and answer with numbers.
fn check_references(mesh: &SubdivMesh, surface: &LimitSurface) {
    let faces = 0..surface.ptex_count() as u32;
    let samples: Vec<_> = faces.flat_map(|face| places(surface).map(move |[u, v]| (face, u, v))).collect();
    let mut answers = Far::new(mesh, ISOLATION).and_then(|far| far.evaluate(&samples)).expect("Far");
    if mesh.scheme == Scheme::CatmullClark && is_resolved(mesh) && is_manifold(mesh) {
        check_positions(mesh, surface, &samples, &answers);
    }
    answers.extend(LimitStencils::new(mesh, ISOLATION).and_then(|s| s.evaluate(&samples)).expect("limit stencils"));
    answers.extend(Bfr::new(mesh, (2, ISOLATION)).and_then(|mut bfr| bfr.evaluate(&samples)).expect("Bfr"));
    assert!(answers.iter().all(|jet| jet.position.is_finite()), "{mesh:?}");
    if mesh.scheme == Scheme::Loop {
        return;
    }
    for end_cap in [EndCap::Gregory, EndCap::BSpline] {
        let patches = AdaptivePatches::new(mesh, Isolation::uniform(2), end_cap).expect("adaptive patches");
        for patch in 0..patches.patches().len().min(20) {
            assert!(patches.evaluate(patch, [0.3, 0.6]).position.is_finite(), "{mesh:?}");
        }
    }
}
