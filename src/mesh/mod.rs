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
mod originals;
mod parts;
mod polygon;
mod sample;
mod scheme;
mod tags;
mod usd;
mod validate;

use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::absent::problem;
use crate::memory;

pub use error::{MeshError, Place, Spot};
pub use originals::Originals;
pub use parts::{Part, PtexParts, Repeat};
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
/// the stage, with their points in world space and the stage's units; [`SubdivMesh::parts`] tells them apart. Values are those of
/// the default time, or the first sample where there is no default; an attribute that is not there has its schema's fallback.
///
/// # Errors
/// A file that cannot be read, that is not of its format, or whose mesh does not pass [`SubdivMesh::validate`].
/// The message is one line: `file:line: what; what to do`, or `file: /Prim/Path: what; what to do`.
pub fn read(path: &Path) -> Result<SubdivMesh, MeshError> {
    read_choice(path, &Choice::default())
}

/// What of a file is read; by default all that is shown.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Choice {
    /// Paths of prims: their meshes, and those of the prims below them; all if there are none.
    pub prims: Vec<String>,
    /// Time code at which attributes are read: between two samples numbers are interpolated, all else is that of the sample
    /// before. `None`: the default time, and the first sample of what has samples alone.
    pub time: Option<f64>,
}

/// As [`read`], a part of the file, at a time.
///
/// # Errors
/// As [`MeshFile::open`] and [`MeshFile::read`].
pub fn read_choice(path: &Path, choice: &Choice) -> Result<SubdivMesh, MeshError> {
    MeshFile::open(path)?.read(choice)
}

/// A mesh file that is read more than once: a stage stays open between times.
#[derive(Debug)]
pub struct MeshFile(Format);

#[derive(Debug)]
enum Format {
    Obj(PathBuf),
    Usd(Box<usd::File>),
}

impl MeshFile {
    /// Opens the file; the extension says the format.
    ///
    /// # Errors
    /// A stage that cannot be read, or is not of its format, or a file too large for [`memory::limit`]. An OBJ is not looked
    /// at.
    pub fn open(path: &Path) -> Result<Self, MeshError> {
        let size = match path.metadata() {
            Ok(found) if found.is_dir() => return Err(MeshError::IsFolder { at: Place::file(path) }),
            Ok(found) => found.len(),
            // Before the extension is looked at: what is not there has no format.
            Err(error) => {
                return Err(MeshError::Absent { at: Place::file(path), problem: problem(path, &error) });
            }
        };
        // The text and what it says take about as much; a stage is read into values first.
        memory::check(size.saturating_mul(2)).map_err(|needs| MeshError::Memory { at: Place::file(path), needs })?;
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("obj") => Ok(Self(Format::Obj(path.to_owned()))),
            Some("usd" | "usda" | "usdc" | "usdz") => Ok(Self(Format::Usd(Box::new(usd::File::open(path)?)))),
            _ => Err(MeshError::UnsupportedFormat { at: Place::file(path) }),
        }
    }

    /// Reads and validates what is chosen.
    ///
    /// # Errors
    /// As [`read`]; a prim that is not there, or has no mesh that is shown; prims or a time of an OBJ.
    pub fn read(&self, choice: &Choice) -> Result<SubdivMesh, MeshError> {
        match &self.0 {
            Format::Obj(path) if !choice.prims.is_empty() => Err(MeshError::NoPrims { at: Place::file(path) }),
            Format::Obj(path) if choice.time.is_some() => Err(MeshError::NoTime { at: Place::file(path) }),
            Format::Obj(path) => obj::read(path),
            Format::Usd(file) => file.read(choice),
        }
    }
}

/// Reads and validates the text of an OBJ that is in memory; `name` is the mesh's, and the file's in messages.
///
/// # Errors
/// As [`read`].
pub fn parse_obj(text: &[u8], name: &str) -> Result<SubdivMesh, MeshError> {
    obj::parse(text, name, name)
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
    /// Metres that a unit is long, where the file says it (USD does). Nothing is converted: results are in the file's units.
    pub meters_per_unit: Option<f64>,
    /// The meshes of a USD stage, in their order, covering all faces and points; empty for a mesh from elsewhere.
    pub parts: Vec<Part>,
    /// What the reader passed over that shapes would show, in sentences.
    pub notes: Vec<String>,
}
