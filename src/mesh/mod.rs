//! What comes in: a control mesh with the features of its subdivision scheme, validated before OpenSubdiv sees it.
//!
//! [`read`] is the way in from a file. A mesh made through the library passes [`SubdivMesh::validate`] instead; both
//! run the same checks, because OpenSubdiv 3.5.0 crashes on some invalid meshes and silently accepts others.
//!
//! # Default boundary rule
//! [`Boundary::default`] is `EdgeAndCorner`, as in USD. An **OBJ file** without an `interpolateboundary` tag gets `EdgeOnly`
//! instead, because that is what OpenSubdiv's own regression suite does with such a shape.

mod error;
mod lines;
mod measure;
mod obj;
mod polygon;
mod sample;
mod scheme;
mod tags;
mod usd;
mod validate;

use std::path::Path;

use glam::DVec3;

pub use error::{MeshError, Place, Spot};
pub use sample::sample;
pub use scheme::Scheme;
pub use validate::{MAX_COORDINATE, MAX_VALENCE};

/// Extensions of the files that [`read`] reads, in lower case.
pub const EXTENSIONS: [&str; 5] = ["obj", "usd", "usda", "usdc", "usdz"];

/// Reads and validates a mesh file. The extension says the format: OBJ (`.obj`) or USD (`.usd`, `.usda`, `.usdc`, `.usdz`).
///
/// The mesh is named after the file's stem. Vertices and faces keep the order of the file, whatever groups or objects
/// they are in, so a vertex that two groups share stays one vertex.
///
/// All Mesh prims of a USD stage that are shown (visible, purpose default or render) become one mesh, in the order of
/// the stage, with their points in world space and the stage's units. Values are those of the default time, or the first sample
/// where there is no default; an attribute that is not there has its schema's fallback.
///
/// # Errors
/// A file that cannot be read, that is not of its format, or whose mesh does not pass [`SubdivMesh::validate`].
/// The message is one line: `file:line: what; what to do`, or `file: /Prim/Path: what; what to do`.
pub fn read(path: &Path) -> Result<SubdivMesh, MeshError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("obj") => obj::read(path),
        Some("usd" | "usda" | "usdc" | "usdz") => usd::read(path),
        _ => Err(MeshError::UnsupportedFormat { at: Place::file(path) }),
    }
}

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

/// A control mesh: polygons, points, features, and the rules that subdivide it.
///
/// Faces are counter-clockwise seen from outside; edges may be shared by more than two faces (non-manifold meshes are
/// legal). If an edge has several creases or a vertex several corners, the last one counts, as in OpenSubdiv.
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
    /// Rules of subdivision.
    pub scheme: Scheme,
    /// Boundary rule.
    pub boundary: Boundary,
    /// Decay of finite sharpness.
    pub creasing: Creasing,
    /// Direction that points up, where the file says it (USD does); views are fitted to it.
    pub up: Option<DVec3>,
}
