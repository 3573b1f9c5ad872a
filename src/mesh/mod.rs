//! What comes in: a control mesh with the features of its subdivision scheme, validated before OpenSubdiv sees it.
//!
//! [`read`] is the way in from a file. A mesh made through the library passes [`SubdivMesh::validate`] instead; both
//! run the same checks, because OpenSubdiv 3.5.0 crashes on some invalid meshes and silently accepts others.
//!
//! # Default boundary rule
//! [`Boundary::default`] is `EdgeAndCorner`, as in USD. An **OBJ file** without an `interpolateboundary` tag gets `EdgeOnly`
//! instead, because that is what OpenSubdiv's own regression suite does with such a shape.

mod bad_faces;
mod concave;
mod error;
mod format;
mod linear;
mod measure;
mod obj;
mod orientation;
mod originals;
mod packed;
mod parts;
mod polygon;
mod sample;
mod scheme;
mod usd;
mod validate;

use std::borrow::Cow;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};
use tempfile::TempPath;

use crate::absent::problem;
use crate::memory;

pub use bad_faces::{BadFace, Fault};
pub use concave::CutFaces;
pub use error::{MeshError, Place, Spot};
pub use format::MeshFormat;
pub use orientation::{FacePlace, Orientation};
pub use originals::Originals;
pub use parts::{Part, PtexParts, Repeat};
pub use sample::sample;
pub use scheme::Scheme;
pub use validate::{MAX_COORDINATE, MAX_VALENCE};

/// Extensions of the files that [`read`] reads, in lower case. `.gz` may stand behind each ([`MeshFormat::of_path`]).
pub const EXTENSIONS: [&str; 5] = ["obj", "usd", "usda", "usdc", "usdz"];

/// Reads and validates a mesh file. The extension says the format: OBJ (`.obj`) or USD (`.usd`, `.usda`, `.usdc`, `.usdz`). With
/// `.gz` behind it the file is unpacked; a USD file is then read by itself, without others that it refers to.
///
/// The mesh is named after the file's stem. Vertices and faces keep the order of the file, whatever groups or objects
/// they are in, so a vertex that two groups share stays one vertex.
///
/// All Mesh prims of a USD stage that are shown (visible, purpose default or render) become one mesh, in the order of
/// the stage, with their points in world space and the stage's units; [`SubdivMesh::parts`] tells them apart. Values are those of
/// the default time, or the first sample where there is no default; an attribute that is not there has its schema's fallback.
///
/// A face that names a vertex twice, has less than three or doubles another one is left out as a hole, with a note
/// ([`SubdivMesh::bad_faces`]).
///
/// # Errors
/// A file that cannot be read, that is not of its format, or whose mesh does not pass [`SubdivMesh::validate`] without its bad
/// faces, or has no others.
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
    /// Refuse a mesh with a face that cannot be part of a surface, instead of leaving that face out
    /// ([`SubdivMesh::bad_faces`]).
    pub strict: bool,
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
    /// The text of an OBJ, what messages call it, and the name of the mesh.
    Text(Vec<u8>, String, String),
    Usd(Box<usd::File>),
    /// A stage whose file is ours, and is removed after it.
    Unpacked {
        file: Box<usd::File>,
        _path: TempPath,
    },
}

impl MeshFile {
    /// Opens the file; the extension says the format.
    ///
    /// # Errors
    /// A stage that cannot be read, or is not of its format, or a file too large for [`memory::limit`]. An OBJ is not looked
    /// at.
    pub fn open(path: &Path) -> Result<Self, MeshError> {
        let at = || Place::file(path);
        let size = match path.metadata() {
            Ok(found) if found.is_dir() => return Err(MeshError::IsFolder { at: at() }),
            Ok(found) => found.len(),
            // Before the extension is looked at: what is not there has no format.
            Err(error) => return Err(MeshError::Absent { at: at(), problem: problem(path, &error) }),
        };
        // The text and what it says take about as much; a stage is read into values first.
        memory::check(size.saturating_mul(2)).map_err(|needs| MeshError::Memory { at: at(), needs })?;
        let is_packed = matches!(packed::unpacked_path(path), Cow::Owned(_));
        match MeshFormat::of_path(path).ok_or_else(|| MeshError::UnsupportedFormat { at: at() })? {
            MeshFormat::Obj => Ok(Self(Format::Obj(path.to_owned()))),
            format if is_packed => {
                let bytes = fs::read(path).map_err(|error| match error.kind() {
                    ErrorKind::NotFound => MeshError::NotFound { at: at() },
                    _ => MeshError::Unreadable { at: at(), error },
                })?;
                Self::of_bytes(bytes, format, &path.display().to_string(), &stem(path))
            }
            _ => {
                let file = usd::File::open(path, &path.display().to_string(), &stem(path))?;
                Ok(Self(Format::Usd(Box::new(file))))
            }
        }
    }

    /// Takes the content of a file, which gzip may have packed. `source` is what messages call it, `name` the name of the mesh. A stage is
    /// read without other files that it refers to by paths.
    ///
    /// # Errors
    /// As [`open`](Self::open); content that cannot be unpacked; a stage that cannot be put into a temporary file.
    pub fn of_bytes(content: Vec<u8>, format: MeshFormat, source: &str, name: &str) -> Result<Self, MeshError> {
        let at = || Place::with(source, Spot::Whole);
        let content = packed::unpacked(content, at)?;
        if format == MeshFormat::Obj {
            return Ok(Self(Format::Text(content, source.to_owned(), name.to_owned())));
        }
        if content.is_empty() {
            return Err(MeshError::EmptyFile { at: at() });
        }
        let extension = format!(".{}", format.extension());
        let write = || -> io::Result<TempPath> {
            let mut file = tempfile::Builder::new().suffix(&extension).tempfile()?;
            file.write_all(&content)?;
            Ok(file.into_temp_path())
        };
        let path = write().map_err(|error| MeshError::Unreadable { at: at(), error })?;
        let file = usd::File::open(&path, source, name)?;
        Ok(Self(Format::Unpacked { file: Box::new(file), _path: path }))
    }

    /// Reads and validates what is chosen.
    ///
    /// # Errors
    /// As [`read`]; a prim that is not there, or has no mesh that is shown; prims or a time of an OBJ; with
    /// [`Choice::strict`] a face that cannot be part of a surface.
    pub fn read(&self, choice: &Choice) -> Result<SubdivMesh, MeshError> {
        match &self.0 {
            Format::Obj(path) => {
                check_obj_choice(choice, || Place::file(path))?;
                obj::read(path, &stem(path), choice.strict)
            }
            Format::Text(text, source, name) => {
                check_obj_choice(choice, || Place::with(source, Spot::Whole))?;
                obj::parse(text, source, name, choice.strict)
            }
            Format::Usd(file) | Format::Unpacked { file, .. } => {
                let mut mesh = file.read(choice)?;
                bad_faces::note(&mut mesh, choice.strict, |mesh, bad| file.fault(mesh, bad))?;
                Ok(mesh)
            }
        }
    }
}

/// Refuses what an OBJ cannot have.
fn check_obj_choice(choice: &Choice, at: impl Fn() -> Place) -> Result<(), MeshError> {
    match choice {
        Choice { prims, .. } if !prims.is_empty() => Err(MeshError::NoPrims { at: at() }),
        Choice { time: Some(_), .. } => Err(MeshError::NoTime { at: at() }),
        _ => Ok(()),
    }
}

/// What a mesh is called that is read from a file.
pub(crate) fn stem(path: &Path) -> String {
    packed::unpacked_path(path).file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads and validates the text of an OBJ that is in memory; `name` is the mesh's, and the file's in messages.
///
/// # Errors
/// As [`read`].
pub fn parse_obj(text: &[u8], name: &str) -> Result<SubdivMesh, MeshError> {
    obj::parse(text, name, name, false)
}

/// What the subdivision rules do at the boundary of the mesh (OpenSubdiv's `VtxBoundaryInterpolation`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Creasing {
    /// Sharpness decreases by one a level.
    #[default]
    Uniform,
    /// Sharpness is averaged along the crease before it decreases.
    Chaikin,
}

/// How Catmull and Clark's scheme places the vertices on edges of triangles (OpenSubdiv's `TriangleSubdivision`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum TriangleRule {
    /// As on edges of any other face.
    #[default]
    CatmullClark,
    /// By weights that leave surfaces of triangles smoother (OpenSubdiv's `TRI_SUB_SMOOTH`). They count in the first refinement alone,
    /// behind which there are only quads, so limits are as exact as under the other rule. Other schemes take no notice.
    Smooth,
}

/// An edge with a sharpness: 0 is smooth, 10 and above infinitely sharp.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Crease {
    /// The two vertices of the edge.
    pub vertices: [u32; 2],
    /// Sharpness, finite and not negative.
    pub sharpness: f32,
}

/// A vertex with a sharpness: 0 is smooth, 10 and above infinitely sharp.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
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
    /// Faces of the file that are left out of the surface, in ascending order: holes ([`holes`](Self::holes) names them too)
    /// whose vertices no other face has, and which are none of the file's.
    pub bad_faces: Vec<BadFace>,
    /// Rules of subdivision.
    pub scheme: Scheme,
    /// Boundary rule.
    pub boundary: Boundary,
    /// Decay of finite sharpness.
    pub creasing: Creasing,
    /// Rule for triangles.
    pub triangles: TriangleRule,
    /// Direction that points up, where the file says it (USD does); views are fitted to it.
    pub up: Option<DVec3>,
    /// Metres that a unit is long, where the file says it (USD does). Nothing is converted: results are in the file's units.
    pub meters_per_unit: Option<f64>,
    /// The meshes of a USD stage, in their order, covering all faces and points; empty for a mesh from elsewhere.
    pub parts: Vec<Part>,
    /// Line of the file that each face stands on, counted from 1; empty for a mesh that comes from no text of faces.
    pub face_lines: Vec<u32>,
    /// What the reader passed over or left out, in sentences.
    pub notes: Vec<String>,
}
