//! The exact limit against brute-force refinement that comes from neither OpenSubdiv nor catoptric.

mod brute;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/random_mesh.rs"]
mod random_mesh;
mod reference;

use brute::{Cage, Cell, Descent};
use catoptric::mesh::{Creasing, SubdivMesh};
use catoptric::patch::PatchKind;
use catoptric::stam::LimitSurface;
use common::{angle_deg, meshes, pillow};
use std::collections::BTreeMap;

/// The largest of something, by kind of patch.
#[derive(Default)]
struct Worst(BTreeMap<&'static str, (f64, usize, String)>);

impl Worst {
    fn add(&mut self, kind: PatchKind, error: f64, place: impl Fn() -> String) {
        let entry = self.0.entry(kind.name()).or_insert_with(|| (0.0, 0, String::new()));
        entry.1 += 1;
        // A NaN must not hide.
        if error > entry.0 || error.is_nan() {
            *entry = (error, entry.1, place());
        }
    }

    fn check(&self, what: &str, tolerance: f64) {
        for (kind, (error, count, place)) in &self.0 {
            println!("{what}, {kind}: {error:.1e} of {count} points, at {place}");
        }
        for (kind, (error, _, place)) in &self.0 {
            assert!(*error <= tolerance, "{what}, {kind}: {error:e} at {place}");
        }
    }
}

/// The project's meshes, and those on which OpenSubdiv is wrong or a surface has no normals, so that other tests cannot
/// take them.
fn judged() -> impl Iterator<Item = SubdivMesh> {
    meshes().into_iter().chain([pillow(), reference::valence_2_dart()])
}

/// Whether Chaikin's average is taken over more than two edges somewhere: then the order of OpenSubdiv's f32 sum decides
/// the last bits of the sharpness, which weigh the geometry.
fn rounds_sharpness(mesh: &SubdivMesh) -> bool {
    mesh.creasing == Creasing::Chaikin && Cage::new(mesh).finite_edges_at_a_vertex() > 2
}

/// Every point i/4 (i/2 in the quadrants of n-gons) of every face of every mesh.
///
/// Some 30 levels of rounding, 1e-16 of the coordinates each, which are of the size of the diagonal.
#[test]
fn positions_agree_everywhere() {
    let mut worst = Worst::default();
    let mut rounded = Worst::default();
    // Every tenth random mesh beside them: 20 combinations of features that nobody chose.
    for mesh in judged().chain((0..200).step_by(10).map(random_mesh::mesh)) {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        // The sample is large; its features are among those of the others.
        let (cage, cells) = brute::refined(&mesh, if cells_of(&mesh) > 500 { 1 } else { 2 });
        let mut limits: Vec<Option<glam::DVec3>> = vec![None; cage.points.len()];
        for cell in &cells {
            for corner in 0..4 {
                let uv = cell.parameters(corner);
                let Some((patch, jet)) = surface.evaluate_ptex(cell.ptex, uv) else { continue };
                let vertex = cage.at(cell.face, corner);
                let limit =
                    *limits[vertex].get_or_insert_with(|| cage.limit(vertex).unwrap_or_else(|| cage.settle(vertex)));
                let error = jet.position.distance(limit) / surface.diagonal();
                let bin = if rounds_sharpness(&mesh) { &mut rounded } else { &mut worst };
                bin.add(surface.kind(patch), error, || format!("{} ptex {} {uv:?}", mesh.name, cell.ptex));
            }
        }
    }
    worst.check("position / diagonal", 1e-14);
    // f32 sharpness: 2^-24 of weights that move a point by some hundredths of the diagonal.
    rounded.check("position / diagonal, rounded sharpness", 1e-8);
}

fn cells_of(mesh: &SubdivMesh) -> usize {
    mesh.face_vertices.len()
}

/// Levels of a descent: 1 - 2^-50 is exact in f64, and the tables have 52 levels below that of the patch.
const DEPTH: usize = 50;

/// Towards every corner of every face where something is irregular: position, derivatives and normal at (2^-n, 0),
/// (0, 2^-n) and (2^-n, 2^-n), n up to 51.
///
/// Positions and derivatives keep 1e-16 of the cage's size at each level, times the condition: derivatives shrink like
/// lambda^n next to modes that shrink faster, and near 9.5 levels of sharpness they bend by that much. Normals in degrees.
#[test]
fn descents_agree_at_every_depth() {
    let (mut positions, mut derivatives, mut normals) = (Worst::default(), Worst::default(), Worst::default());
    let meshes = judged();
    for mesh in &meshes.filter(|mesh| !rounds_sharpness(mesh) && cells_of(mesh) <= 500).collect::<Vec<_>>() {
        let surface = LimitSurface::new(mesh).expect("it has a surface");
        let (cage, cells) = brute::refined(mesh, 1);
        for cell in &cells {
            for corner in 0..4 {
                if !is_start(&cage, cell, corner, &surface) {
                    continue;
                }
                let mut descent = Descent::new(&cage, *cell, corner);
                for _ in 0..DEPTH {
                    descent.step();
                    for other in 1..4 {
                        let vertex = descent.cage.at(descent.cell.face, corner + other);
                        let uv = descent.cell.parameters((corner + other) % 4);
                        let Some((patch, jet)) = surface.evaluate_ptex(descent.cell.ptex, uv) else { continue };
                        let place = || format!("{} ptex {} {uv:?}", mesh.name, descent.cell.ptex);
                        let kind = surface.kind(patch);
                        if let Some(limit) = descent.cage.limit(vertex) {
                            let error = jet.position.distance(descent.offset + limit) / surface.diagonal();
                            positions.add(kind, error, place);
                        }
                        if let Some([du, dv]) = descent.cage.derivatives(descent.cell.face, vertex) {
                            let [du, dv] = [du, dv].map(|x| x / descent.cell.size);
                            let scale = du.length().max(dv.length());
                            derivatives.add(kind, jet.du.distance(du).max(jet.dv.distance(dv)) / scale, place);
                            // Rounding of the longer derivative turns the shorter one, most where they fold together:
                            // at valence 2 their lengths part by a power of the level.
                            let condition = du.cross(dv).length() / (scale * scale);
                            normals.add(kind, angle_deg(jet.normal, du.cross(dv)) * condition, place);
                        }
                    }
                }
            }
        }
    }
    positions.check("position / diagonal", 1e-14);
    derivatives.check("derivative, relative", 1e-12);
    normals.check("normal, degrees times condition", 1e-10);
}

/// A corner of a ptex face, and an irregular one.
fn is_start(cage: &Cage, cell: &Cell, corner: usize, surface: &LimitSurface) -> bool {
    let uv = cell.parameters(corner);
    let vertex = cage.at(cell.face, corner);
    let inside = surface.evaluate_ptex(cell.ptex, uv).is_some();
    // Centres of n-gons and edge points are corners too where they are extraordinary.
    inside && (uv.iter().all(|x| x.fract() == 0.0)) && cage.derivatives(cell.face, vertex).is_none()
}
