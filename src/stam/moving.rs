//! A surface whose control points move: what depends on topology alone is kept.

use super::LimitSurface;
use crate::mesh::{MeshError, SubdivMesh};
use crate::patch::{PatchError, Refinement};

/// Why a surface was not moved.
#[derive(Debug, thiserror::Error)]
pub enum MoveError {
    /// Something other than the points is not what it was.
    #[error("{0} differ, so it is another surface; give frames of one topology")]
    Topology(&'static str),
    /// A point is not finite, or too far away.
    #[error(transparent)]
    Point(#[from] MeshError),
    /// OpenSubdiv reports an error.
    #[error(transparent)]
    Osd(#[from] crate::osd::Error),
}

/// A limit surface that follows the control points of its mesh.
///
/// Refinement, patches, classes with their tables, and [`adjacency`](LimitSurface::adjacency) stay; a move interpolates
/// the refined points again, which is linear in their number. The result is that of [`LimitSurface::new`], to the last bit if no
/// part repeats another: those are refined each by itself here.
#[derive(Debug)]
pub struct MovingSurface {
    refinement: Refinement,
    /// The mesh without its points.
    topology: SubdivMesh,
    vertices: usize,
    surface: LimitSurface,
}

impl MovingSurface {
    /// Refines the mesh and builds its patches and tables.
    ///
    /// # Errors
    /// As [`LimitSurface::new`].
    pub fn new(mesh: &SubdivMesh) -> Result<Self, PatchError> {
        let (surface, refinement) = LimitSurface::with_refinement(mesh)?;
        let topology = SubdivMesh { points: Vec::new(), notes: Vec::new(), face_lines: Vec::new(), ..mesh.clone() };
        Ok(Self { refinement, topology, vertices: mesh.points.len(), surface })
    }

    /// The surface of the mesh that came last. A clone of it stays what it is.
    pub fn surface(&self) -> &LimitSurface {
        &self.surface
    }

    /// Moves the points to where they are in `mesh`, whose topology must be the same: faces, creases and corners with their
    /// sharpness, holes, rules.
    ///
    /// # Errors
    /// The topology differs, or a point is none; the surface is as before.
    pub fn move_to(&mut self, mesh: &SubdivMesh) -> Result<&LimitSurface, MoveError> {
        if let Some(what) = self.difference(mesh) {
            return Err(MoveError::Topology(what));
        }
        mesh.validate_points()?;
        let points = self.refinement.interpolate(&mesh.points)?;
        self.surface = self.surface.moved(points, mesh.diagonal());
        Ok(&self.surface)
    }

    /// What makes it another surface, as the subject of a sentence.
    fn difference(&self, mesh: &SubdivMesh) -> Option<&'static str> {
        let topology = &self.topology;
        let rules = |mesh: &SubdivMesh| (mesh.scheme, mesh.boundary, mesh.creasing, mesh.triangles);
        let same = [
            (mesh.points.len() == self.vertices, "numbers of points"),
            (mesh.face_sizes == topology.face_sizes && mesh.face_vertices == topology.face_vertices, "faces"),
            (mesh.creases == topology.creases, "creases"),
            (mesh.corners == topology.corners, "sharp vertices"),
            (mesh.holes == topology.holes, "holes"),
            (rules(mesh) == rules(topology), "subdivision rules"),
        ];
        same.into_iter().find_map(|(same, what)| (!same).then_some(what))
    }
}
