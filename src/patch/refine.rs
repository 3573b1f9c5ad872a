//! From a control mesh to its patches, a piece at a time.

use super::piece::{Division, PIECE, Piece};
use super::{Node, PatchError, Patches, RingClass, SupportKind, flat, forecast, loop_tree, tree};
use crate::memory;
use crate::mesh::{Scheme, SubdivMesh};
use crate::osd::{self, INFINITE_SHARPNESS, MAX_ISOLATION, Refiner};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// After two levels every face is a quad with at most one extraordinary vertex and no other feature than its spokes.
pub(super) const RINGS_STAND_ALONE: u32 = 2;

/// Levels after which no finite sharpness is left: it decreases by one a level (Chaikin averages first, which lowers the
/// largest).
pub(super) fn isolation(mesh: &SubdivMesh) -> u32 {
    let sharpness = mesh.creases.iter().map(|c| c.sharpness).chain(mesh.corners.iter().map(|c| c.sharpness));
    let finite = sharpness.filter(|&s| s < INFINITE_SHARPNESS).fold(0.0, f32::max);
    (finite.ceil() as u32).clamp(RINGS_STAND_ALONE, MAX_ISOLATION)
}

/// OpenSubdiv's refinement as deep as the patches of a mesh of quads and n-gons need it, in one piece.
///
/// # Errors
/// The mesh is not valid, or OpenSubdiv refuses it.
pub(crate) fn refiner(mesh: &SubdivMesh) -> Result<Refiner, osd::Error> {
    Refiner::adaptive(mesh, isolation(mesh), RINGS_STAND_ALONE, true)
}

/// Who is told how far refinement is: pieces that are done, and all pieces. It is called from several threads.
pub type Watch<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// What the pieces take that are done, and what all will take.
struct Ledger {
    /// Bytes of the mesh, which stays.
    mesh: u64,
    faces: u64,
    /// Pieces at work at the same time.
    workers: u64,
    /// Whether the refiners stay.
    keeps_refiners: bool,
    /// Faces and bytes of the pieces that are done.
    done: Mutex<(u64, u64)>,
}

impl Ledger {
    fn new(mesh: &SubdivMesh, pieces: usize, keeps_refiners: bool) -> Self {
        Self {
            mesh: mesh.bytes(),
            faces: mesh.face_sizes.len() as u64,
            workers: pieces.min(rayon::current_num_threads()) as u64,
            keeps_refiners,
            done: Mutex::default(),
        }
    }

    /// Pieces that are made before they are put together: enough to keep all cores busy when some take longer.
    fn at_once(&self) -> usize {
        2 * self.workers as usize
    }

    /// Refuses where what is kept of all pieces, judged by those that are done, and as many pieces as this one, whose faces take
    /// `working` bytes, exceed the limit. Then counts in a piece: its faces and bytes.
    fn check(&self, working: u64, piece: Option<(usize, u64)>) -> Result<(), PatchError> {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((faces, bytes)) = piece {
            done.0 += faces as u64;
            done.1 += bytes + if self.keeps_refiners { working } else { 0 };
        }
        let twice = if done.0 == self.faces { 0.0 } else { (self.at_once() * PIECE) as f64 };
        let kept = if done.0 == 0 { 0.0 } else { done.1 as f64 * (self.faces as f64 + twice) / done.0 as f64 };
        Ok(memory::check(self.mesh + kept as u64 + working.saturating_mul(self.workers))?)
    }
}

/// What makes refined points of control points, wherever these move: the refiners of a mesh.
#[derive(Debug)]
pub struct Refinement {
    pieces: Vec<Refined>,
}

/// A piece and its refiner.
#[derive(Debug)]
struct Refined {
    refiner: Refiner,
    /// As [`Piece::vertices`].
    vertices: Option<Vec<u32>>,
}

impl Refined {
    fn interpolate(&self, points: &[DVec3]) -> Result<Vec<DVec3>, osd::Error> {
        let Some(vertices) = &self.vertices else { return self.refiner.interpolate(points) };
        let own: Vec<DVec3> = vertices.iter().map(|&vertex| points[vertex as usize]).collect();
        self.refiner.interpolate(&own)
    }
}

impl Refinement {
    /// The refined points that patches name, of control points of the same topology.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    ///
    /// # Panics
    /// `points` is not one point for each control vertex.
    pub fn interpolate(&mut self, points: &[DVec3]) -> Result<Vec<DVec3>, osd::Error> {
        let pieces: Vec<_> = self.pieces.par_iter_mut().map(|piece| piece.interpolate(points)).collect();
        let mut all = Vec::new();
        for piece in pieces {
            join(&mut all, piece?);
        }
        Ok(all)
    }
}

/// Adds the points of the next piece.
fn join(all: &mut Vec<DVec3>, mut piece: Vec<DVec3>) {
    match all.is_empty() {
        true => *all = piece,
        false => all.append(&mut piece),
    }
}

impl Patches {
    /// Refines `mesh` as deep as its finite sharpness asks and collects the patches.
    ///
    /// # Errors
    /// The mesh is not valid, OpenSubdiv refuses it, or a face stays without a closed form.
    pub fn new(mesh: &SubdivMesh) -> Result<(Self, Refinement), PatchError> {
        let division = divide(mesh)?;
        let ledger = Ledger::new(mesh, division.as_ref().map_or(1, Division::count), true);
        let mut pieces = Vec::new();
        let patches = refine(mesh, division, &ledger, &|_, _| (), Ok, |piece| pieces.push(piece))?;
        Ok((patches, Refinement { pieces }))
    }

    /// The same with the refined points of the mesh, for those who will not move it: refiners are dropped as soon as they
    /// have served, so that only those at work take memory.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn with_points(mesh: &SubdivMesh, watch: Watch<'_>) -> Result<(Self, Vec<DVec3>), PatchError> {
        let division = divide(mesh)?;
        let ledger = Ledger::new(mesh, division.as_ref().map_or(1, Division::count), false);
        let mut points = Vec::new();
        let interpolated = |piece: Refined| Ok(piece.interpolate(&mesh.points)?);
        let patches = refine(mesh, division, &ledger, watch, interpolated, |piece| join(&mut points, piece))?;
        Ok((patches, points))
    }

    /// Adds the patches of the next piece; `vertices` refined vertices come before its own.
    fn append(
        &mut self,
        mut piece: Self,
        vertices: u32,
        classes: &mut HashMap<RingClass, u32>,
        lines: &mut HashMap<[u32; 2], u32>,
    ) {
        let [patches, listed, splits, strips, rows] =
            [self.patches.len(), self.vertices.len(), self.splits.len(), self.strips.len(), self.row_weights.len()]
                .map(|count| count as u32);
        let [rings, wedges] = [self.rings.len(), self.wedges.len()].map(|count| count as u32);
        let known: Vec<u32> = piece.classes.iter().map(|&class| self.class_index(classes, class)).collect();
        for support in &mut piece.supports {
            support.first += listed;
            match &mut support.kind {
                SupportKind::Net => (),
                SupportKind::Strip(row) => *row += rows,
                SupportKind::Class(class) => *class = known[*class as usize],
                SupportKind::Wedge(wedge) => *wedge += wedges,
            }
        }
        for wedge in &mut piece.wedges {
            wedge.class = known[wedge.class as usize];
            wedge.ring += rings;
        }
        piece.rings.iter_mut().for_each(|[first, _]| *first += listed);
        let moved = |node: &mut Node| match node {
            Node::Hole => (),
            Node::Leaf(patch) => *patch += patches,
            Node::Split(split) => *split += splits,
            Node::Strips(stack) => *stack += strips,
        };
        piece.roots.iter_mut().for_each(moved);
        piece.splits.as_flattened_mut().iter_mut().for_each(moved);
        piece.strips.iter_mut().for_each(|stack| stack.first += patches);
        piece.vertices.iter_mut().filter(|vertex| **vertex != tree::PHANTOM).for_each(|vertex| *vertex += vertices);
        self.patches.append(&mut piece.patches);
        self.supports.append(&mut piece.supports);
        self.vertices.append(&mut piece.vertices);
        self.rings.append(&mut piece.rings);
        self.wedges.append(&mut piece.wedges);
        self.roots.append(&mut piece.roots);
        self.splits.append(&mut piece.splits);
        self.strips.append(&mut piece.strips);
        self.row_weights.append(&mut piece.row_weights);
        self.ptex_edges.append(std::mem::take(&mut piece.ptex_edges), lines);
    }
}

/// How a mesh is divided; `None` if it is to be refined whole.
fn divide(mesh: &SubdivMesh) -> Result<Option<Division<'_>>, PatchError> {
    mesh.validate().map_err(osd::Error::from)?;
    Ok(Division::new(mesh))
}

/// Refines a mesh piece by piece, in parallel; `finish` says what is to be kept of each, and `keep` keeps it, in order.
fn refine<R: Send>(
    mesh: &SubdivMesh,
    division: Option<Division<'_>>,
    ledger: &Ledger,
    watch: Watch<'_>,
    finish: impl Fn(Refined) -> Result<R, PatchError> + Sync,
    mut keep: impl FnMut(R),
) -> Result<Patches, PatchError> {
    let isolation = isolation(mesh);
    let pieces = division.as_ref().map_or(1, Division::count);
    let finished = AtomicUsize::new(0);
    let one = |piece: Piece<'_>| {
        let working = forecast::working(&piece.mesh, isolation);
        ledger.check(working, None)?;
        let refine = |single| Refiner::adaptive(&piece.mesh, isolation, RINGS_STAND_ALONE, single);
        let (refiner, patches) = match mesh.scheme {
            scheme if scheme.is_linear() => {
                // One level, for the middles of faces that are no quads.
                let refiner = Refiner::adaptive(&piece.mesh, 1, 1, false)?;
                let patches = flat::build(&refiner, &piece)?;
                (refiner, patches)
            }
            Scheme::Loop => {
                let refiner = refine(false)?;
                let patches = loop_tree::build(&refiner, &piece)?;
                (refiner, patches)
            }
            _ => {
                // Along a single crease OpenSubdiv need not refine: strips have a closed form. Should it call a crease single
                // that we do not, everything is refined.
                let mut refiner = refine(true)?;
                let patches = match tree::build(&refiner, &piece) {
                    Err(PatchError::NotRefined { .. }) => {
                        refiner = refine(false)?;
                        tree::build(&refiner, &piece)?
                    }
                    patches => patches?,
                };
                (refiner, patches)
            }
        };
        let points = refiner.vertex_counts().iter().sum::<usize>();
        let bytes = patches.bytes() + (points * size_of::<DVec3>()) as u64;
        ledger.check(working, Some((piece.core.len(), bytes)))?;
        watch(finished.fetch_add(1, Ordering::Relaxed) + 1, pieces);
        Ok((patches, points, finish(Refined { refiner, vertices: piece.vertices })?))
    };
    let Some(division) = division else {
        let (patches, _, own) = one(Piece::whole(mesh))?;
        keep(own);
        return Ok(patches);
    };
    let mut out = Patches { triangles: mesh.scheme == Scheme::Loop, ..Patches::default() };
    let (mut classes, mut lines, mut vertices) = (HashMap::new(), HashMap::new(), 0usize);
    // A few at a time, so that what is put together is not there twice.
    let at_once = ledger.at_once();
    for batch in (0..pieces).step_by(at_once) {
        let batch: Vec<Result<_, PatchError>> = (batch..pieces.min(batch + at_once))
            .into_par_iter()
            .map_init(Vec::new, |local, index| one(division.piece(index, local)))
            .collect();
        for piece in batch {
            let (patches, points, own) = piece?;
            let before = u32::try_from(vertices + points).map_err(|_| PatchError::TooManyPoints)? - points as u32;
            out.append(patches, before, &mut classes, &mut lines);
            vertices += points;
            keep(own);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::{Adjacency, PHANTOM};
    use std::path::Path;

    /// What a patch is, with the positions of its control points.
    fn described(patches: &Patches, points: &[DVec3], patch: usize) -> String {
        let at = |&v: &u32| if v == PHANTOM { DVec3::NAN } else { points[v as usize] };
        let support: Vec<DVec3> = patches.support(patch).iter().map(at).collect();
        let class = patches.class(patch).map(|class| patches.classes()[class]);
        format!("{:?} {class:?} {:?} {support:?}", patches.all()[patch], patches.row_weights(patch))
    }

    fn refine_all(mesh: &SubdivMesh, division: Option<Division<'_>>) -> Result<(Patches, Vec<DVec3>), PatchError> {
        let (ledger, mut points) = (Ledger::new(mesh, 1, false), Vec::new());
        let interpolated = |piece: Refined| Ok(piece.interpolate(&mesh.points)?);
        let patches = refine(mesh, division, &ledger, &|_, _| (), interpolated, |piece| join(&mut points, piece))?;
        Ok((patches, points))
    }

    /// In pieces of five faces every mesh has the patches, points to the last bit, trees and neighbours that it has whole.
    #[test]
    fn pieces_make_the_whole() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
        let files = std::fs::read_dir(folder).expect("tests/meshes is there");
        let meshes = files.filter_map(|file| crate::mesh::read(&file.expect("an entry").path()).ok());
        let (mut divided, mut compared) = (0, 0);
        for mesh in meshes.chain([crate::mesh::sample()]) {
            let Ok((whole, whole_points)) = refine_all(&mesh, None) else {
                continue;
            };
            let parts = mesh.face_sizes.len().div_ceil(5).min(60);
            let division = Division::into_parts(&mesh, parts, f64::INFINITY);
            let (pieces, points) = refine_all(&mesh, division).expect("what the whole mesh has");
            assert_eq!(pieces.all().len(), whole.all().len(), "{}", mesh.name);
            assert_eq!(pieces.classes(), whole.classes(), "{}", mesh.name);
            let neighbours = [&pieces, &whole].map(Adjacency::new);
            for patch in 0..whole.all().len() {
                let [a, b] = [described(&pieces, &points, patch), described(&whole, &whole_points, patch)];
                assert_eq!(a, b, "{}", mesh.name);
                for edge in 0..if whole.are_triangles() { 0 } else { 4 } {
                    let [a, b] = neighbours.each_ref().map(|neighbours| neighbours.across(patch, edge));
                    assert_eq!(a, b, "{}: patch {patch}, edge {edge}", mesh.name);
                }
                compared += 1;
            }
            assert_eq!(pieces.ptex_count(), whole.ptex_count());
            for ptex in 0..whole.ptex_count() as u32 {
                for uv in [[0.0, 0.0], [0.3, 0.9], [0.51, 0.02], [1.0, 1.0], [0.99, 0.49]] {
                    assert_eq!(pieces.locate(ptex, uv), whole.locate(ptex, uv), "{}", mesh.name);
                }
            }
            divided += usize::from(parts > 1);
        }
        assert!(divided > 20 && compared > 4000, "{divided} meshes, {compared} patches");
    }
}
