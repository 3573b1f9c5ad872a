//! What comes in: a control mesh with Catmull-Clark features, validated before OpenSubdiv sees it.

mod sample;

use glam::DVec3;

pub use sample::sample;

/// What the subdivision rules do at the boundary of the mesh (OpenSubdiv's `VtxBoundaryInterpolation`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// No interpolation: faces that touch the boundary have no limit surface.
    None,
    /// Boundary edges are infinitely sharp, boundary corners are smooth.
    EdgeOnly,
    /// Boundary edges are infinitely sharp, and so are vertices with a single face.
    #[default]
    EdgeAndCorner,
}

/// How finite sharpness decays from level to level (OpenSubdiv's `CreasingMethod`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Creasing {
    /// Sharpness decreases by one a level.
    #[default]
    Uniform,
    /// Sharpness is averaged along the crease before it decreases.
    Chaikin,
}

/// An edge with a sharpness: 0 is smooth, 10 and above infinitely sharp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crease {
    /// The two vertices of the edge.
    pub vertices: [u32; 2],
    /// Sharpness, finite and not negative.
    pub sharpness: f32,
}

/// A vertex with a sharpness: 0 is smooth, 10 and above infinitely sharp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// The vertex.
    pub vertex: u32,
    /// Sharpness, finite and not negative.
    pub sharpness: f32,
}

/// A Catmull-Clark control mesh: polygons, points and features.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SubdivMesh {
    /// Name for messages and reports (file stem, or `sample`).
    pub name: String,
    /// Control points.
    pub points: Vec<DVec3>,
    /// Vertices of each face.
    pub face_sizes: Vec<u32>,
    /// Vertex indices (0-based, file order), face after face.
    pub face_vertices: Vec<u32>,
    /// Sharp and semi-sharp edges.
    pub creases: Vec<Crease>,
    /// Sharp and semi-sharp vertices.
    pub corners: Vec<Corner>,
    /// Faces that take part in subdivision but have no surface.
    pub holes: Vec<u32>,
    /// Boundary rule.
    pub boundary: Boundary,
    /// Decay of finite sharpness.
    pub creasing: Creasing,
}
