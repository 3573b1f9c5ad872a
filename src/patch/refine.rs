//! From a control mesh to its patches, a piece at a time.

use super::piece::{Division, Piece};
use super::{Node, PatchError, Patches, RingClass, SupportKind, flat, loop_tree, tree};
use crate::mesh::{Scheme, SubdivMesh};
use crate::osd::{self, INFINITE_SHARPNESS, MAX_ISOLATION, Refiner};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// After two levels every face is a quad with at most one extraordinary vertex and no other feature than its spokes.
const RINGS_STAND_ALONE: u32 = 2;

/// Levels after which no finite sharpness is left: it decreases by one a level (Chaikin averages first, which lowers the
/// largest).
fn isolation(mesh: &SubdivMesh) -> u32 {
    let sharpness = mesh.creases.iter().map(|c| c.sharpness).chain(mesh.corners.iter().map(|c| c.sharpness));
    let finite = sharpness.filter(|&s| s < INFINITE_SHARPNESS).fold(0.0, f32::max);
    (finite.ceil() as u32).clamp(RINGS_STAND_ALONE, MAX_ISOLATION)
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
        joined(pieces)
    }
}

/// The points of all pieces.
fn joined<E>(pieces: Vec<Result<Vec<DVec3>, E>>) -> Result<Vec<DVec3>, E> {
    let mut out = Vec::new();
    for points in pieces {
        let mut points = points?;
        match out.is_empty() {
            true => out = points,
            false => out.append(&mut points),
        }
    }
    Ok(out)
}

impl Patches {
    /// Refines `mesh` as deep as its finite sharpness asks and collects the patches.
    ///
    /// # Errors
    /// The mesh is not valid, OpenSubdiv refuses it, or a face stays without a closed form.
    pub fn new(mesh: &SubdivMesh) -> Result<(Self, Refinement), PatchError> {
        let (patches, pieces) = refine(mesh, divide(mesh)?, Ok)?;
        Ok((patches, Refinement { pieces }))
    }

    /// The same with the refined points of the mesh, for those who will not move it: refiners are dropped as soon as they
    /// have served, so that only those at work take memory.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn with_points(mesh: &SubdivMesh) -> Result<(Self, Vec<DVec3>), PatchError> {
        let (patches, pieces) = refine(mesh, divide(mesh)?, |piece| Ok(piece.interpolate(&mesh.points)?))?;
        Ok((patches, joined::<PatchError>(pieces.into_iter().map(Ok).collect())?))
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
        let known: Vec<u32> = piece
            .classes
            .iter()
            .map(|&class| {
                let next = classes.len() as u32;
                let index = *classes.entry(class).or_insert(next);
                if index == next {
                    self.classes.push(class);
                }
                index
            })
            .collect();
        for support in &mut piece.supports {
            support.first += listed;
            match &mut support.kind {
                SupportKind::Net => (),
                SupportKind::Strip(row) => *row += rows,
                SupportKind::Class(class) => *class = known[*class as usize],
            }
        }
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

/// Refines a mesh piece by piece, in parallel; `finish` says what is to be kept of each.
fn refine<R: Send>(
    mesh: &SubdivMesh,
    division: Option<Division<'_>>,
    finish: impl Fn(Refined) -> Result<R, PatchError> + Sync,
) -> Result<(Patches, Vec<R>), PatchError> {
    let isolation = isolation(mesh);
    let one = |piece: Piece<'_>| {
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
        Ok((patches, points, finish(Refined { refiner, vertices: piece.vertices })?))
    };
    let Some(division) = division else {
        let (patches, _, kept) = one(Piece::whole(mesh))?;
        return Ok((patches, vec![kept]));
    };
    let pieces: Vec<Result<_, PatchError>> = (0..division.count())
        .into_par_iter()
        .map_init(Vec::new, |local, index| one(division.piece(index, local)))
        .collect();
    let (mut kept, mut vertices) = (Vec::new(), 0usize);
    let mut out = Patches { triangles: mesh.scheme == Scheme::Loop, ..Patches::default() };
    let (mut classes, mut lines) = (HashMap::new(), HashMap::new());
    for piece in pieces {
        let (patches, points, own) = piece?;
        let before = u32::try_from(vertices + points).map_err(|_| PatchError::TooManyPoints)? - points as u32;
        out.append(patches, before, &mut classes, &mut lines);
        vertices += points;
        kept.push(own);
    }
    Ok((out, kept))
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

    /// In pieces of five faces every mesh has the patches, points to the last bit, trees and neighbours that it has whole.
    #[test]
    fn pieces_make_the_whole() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
        let files = std::fs::read_dir(folder).expect("tests/meshes is there");
        let meshes = files.filter_map(|file| crate::mesh::read(&file.expect("an entry").path()).ok());
        let (mut divided, mut compared) = (0, 0);
        for mesh in meshes.chain([crate::mesh::sample()]) {
            let Ok((whole, whole_points)) = refine(&mesh, None, |piece| Ok(piece.interpolate(&mesh.points)?)) else {
                continue;
            };
            let whole_points = whole_points.concat();
            let parts = mesh.face_sizes.len().div_ceil(5).min(60);
            let division = Division::into_parts(&mesh, parts, f64::INFINITY);
            let (pieces, points) =
                refine(&mesh, division, |piece| Ok(piece.interpolate(&mesh.points)?)).expect("what the whole mesh has");
            let points = points.concat();
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
