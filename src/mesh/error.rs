//! What can be wrong with a mesh, and the one line that says so.

use std::fmt;
use std::io;
use std::path::Path;

use thiserror::Error;

use crate::line::count;
use crate::memory::TooMuch;

use super::validate::{MAX_COORDINATE, MAX_VALENCE};

/// Longest piece of the input that a message quotes, in characters.
const QUOTE_LENGTH: usize = 40;

/// Where in the input something is: a file and line, or a mesh and one of its parts.
///
/// Shown as `panel.obj:12`, or `panel, face 3` for a mesh that came from no file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Path of the file, or name of the mesh.
    pub source: String,
    /// Where in the source.
    pub spot: Spot,
}

/// The spot within a file or mesh that a [`Place`] names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spot {
    /// The source as a whole.
    Whole,
    /// A line of a file, counted from 1.
    Line(u32),
    /// A part of a mesh (`face`, `vertex`, `crease`, `corner` or `hole`) and its index, counted from 0.
    Part(&'static str, usize),
}

impl Place {
    /// The whole file.
    pub(super) fn file(path: &Path) -> Self {
        Self { source: path.display().to_string(), spot: Spot::Whole }
    }

    /// Another spot in the same source.
    pub(super) fn with(source: &str, spot: Spot) -> Self {
        Self { source: source.to_owned(), spot }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A path may hold a line break; a message is one line.
        for c in self.source.chars() {
            if c.is_control() {
                write!(f, "{}", c.escape_default())?;
            } else {
                write!(f, "{c}")?;
            }
        }
        match self.spot {
            Spot::Whole => Ok(()),
            Spot::Line(line) => write!(f, ":{line}"),
            Spot::Part(part, index) => write!(f, ", {part} {index}"),
        }
    }
}

impl fmt::Display for Spot {
    /// The spot alone, for a message that has named the source already.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => write!(f, "the whole"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Part(part, index) => write!(f, "{part} {index}"),
        }
    }
}

/// A piece of the input as a message quotes it: printable, and no longer than a message can bear.
pub(super) fn quote(token: &[u8]) -> String {
    let text = String::from_utf8_lossy(&token[..token.len().min(4 * QUOTE_LENGTH)]);
    let mut quoted: String = text
        .chars()
        .take(QUOTE_LENGTH)
        .flat_map(|c| {
            let escaped = c.is_control().then(|| c.escape_default());
            let plain = (!c.is_control()).then_some(c);
            escaped.into_iter().flatten().chain(plain)
        })
        .collect();
    if text.chars().count() > QUOTE_LENGTH || token.len() > 4 * QUOTE_LENGTH {
        quoted.push_str("...");
    }
    quoted
}

/// Why a mesh is refused. Displays as one line: `where: what; what to do`.
///
/// Vertex numbers of faces are the file's own (an OBJ counts from 1); indices in tags and in meshes that came from no
/// file count from 0.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message says what its variant and its fields are")]
pub enum MeshError {
    #[error("{at}: no such file; check the path")]
    NotFound { at: Place },
    #[error("{at}: {problem}; check the path")]
    Absent { at: Place, problem: String },
    #[error("{at}: it is a folder, and one mesh is wanted; name a file in it")]
    IsFolder { at: Place },
    #[error("{at}: cannot be read ({error}); give a file that you may read")]
    Unreadable { at: Place, error: io::Error },
    #[error("{at}: to be read {needs}")]
    Memory { at: Place, needs: TooMuch },
    #[error("{at}: not a file that gzip wrote ({error}); pack it again, or give it unpacked")]
    NotPacked { at: Place, error: io::Error },
    #[error(
        "{at}: only .obj, .usd, .usda, .usdc and .usdz are read, also with .gz behind; export the mesh as one of these"
    )]
    UnsupportedFormat { at: Place },
    #[error("{at}: the file is empty; export the mesh again")]
    EmptyFile { at: Place },
    #[error("{at}: a NUL byte, so this is not text; give an OBJ in ASCII or UTF-8")]
    NotText { at: Place },

    #[error("{at}: '{found}' is not {expected}; correct it")]
    NotANumber { at: Place, found: String, expected: &'static str },
    #[error("{at}: a vertex with {found} of 3 coordinates; write v x y z")]
    MissingCoordinates { at: Place, found: usize },
    #[error("{at}: a face with vertex 0; OBJ counts vertices from 1")]
    VertexZero { at: Place },
    #[error(
        "{at}: a face with vertex {index} (vertices so far: {defined}); \
         -1 is the latest, use -{defined} to -1"
    )]
    VertexBeforeStart { at: Place, index: i64, defined: usize },
    #[error(
        "{at}: a face with vertex {index} (vertices so far: 0); \
         move the face behind its vertices"
    )]
    NegativeBeforeVertices { at: Place, index: i64 },

    #[error("{at}: the mesh has no vertices; give a mesh with polygons")]
    NoVertices { at: Place },
    #[error("{at}: the mesh has no faces; give a mesh with polygons, not points or curves alone")]
    NoFaces { at: Place },
    #[error("{at}: the mesh has no {missing}, but {found}, which is not read; give a mesh with polygons")]
    NothingRead { at: Place, missing: &'static str, found: String },
    #[error(
        "{at}: {count} {what}, but OpenSubdiv's indices end at {limit}; split the mesh",
        limit = i32::MAX
    )]
    TooMany { at: Place, what: &'static str, count: usize },
    #[error(
        "{at}: the face sizes add up to {expected}, but there are {found} face vertices; \
         make both agree"
    )]
    FaceSizesDisagree { at: Place, expected: u64, found: usize },

    #[error(
        "{at}: coordinate '{found}' is not a number, the program that wrote it {cause}; correct the vertex, or export the mesh again"
    )]
    CoordinateNoNumber { at: Place, found: String, cause: &'static str },
    #[error("{at}: coordinate {value} is not finite; correct the vertex")]
    CoordinateNotFinite { at: Place, value: f64 },
    #[error(
        "{at}: coordinate {value:e} is larger than {MAX_COORDINATE:e}, \
         where squares overflow; scale the mesh down"
    )]
    CoordinateTooLarge { at: Place, value: f64 },

    #[error("{at}: a face of size {size}; a face needs at least 3 vertices")]
    FaceTooSmall { at: Place, size: usize },
    #[error("{at}: a face with {size} vertices, but OpenSubdiv takes at most {MAX_VALENCE}; split it")]
    FaceTooLarge { at: Place, size: usize },
    #[error(
        "{at}: a face with {size} vertices, but the scheme loop takes triangles; triangulate it, or use catmullClark"
    )]
    NotTriangle { at: Place, size: usize },
    #[error("{at}: a face that is concave under the scheme none; cut it into convex faces")]
    FaceConcave { at: Place },
    #[error("{at}: a face with vertex {vertex}, but the mesh has only {first} to {last}; correct it")]
    VertexOutOfRange { at: Place, vertex: u64, first: u64, last: u64 },
    #[error("{at}: a face with vertex {vertex} twice; name each vertex of a face once")]
    RepeatedVertex { at: Place, vertex: u64 },
    #[error("{at}: the same face as {original}; delete one of the two")]
    DuplicateFace { at: Place, original: Spot },
    #[error(
        "{at}: {valence} edges meet at this vertex, but OpenSubdiv takes at most {MAX_VALENCE}; \
         split the vertex"
    )]
    ValenceTooHigh { at: Place, valence: usize },
    #[error(
        "{at}: an edge of this vertex has {faces} faces, but OpenSubdiv takes at most {limit}; \
         split the edge",
        limit = MAX_VALENCE - 2
    )]
    TooManyFacesAtEdge { at: Place, faces: usize },

    #[error("{at}: sharpness {value} is not finite; use 0 (smooth) to 10 (infinitely sharp)")]
    SharpnessNotFinite { at: Place, value: f32 },
    #[error("{at}: sharpness {value} is negative; use 0 (smooth) to 10 (infinitely sharp)")]
    SharpnessNegative { at: Place, value: f32 },
    #[error("{at}: a crease with vertex {vertex}, but the mesh has only 0 to {last}; count from 0")]
    CreaseOutOfRange { at: Place, vertex: u32, last: u64 },
    #[error("{at}: a crease from vertex {vertex} to itself; name the two ends of an edge")]
    CreaseOnOneVertex { at: Place, vertex: u32 },
    #[error("{at}: a crease from vertex {} to {}, but no face has that edge; count from 0", .vertices[0], .vertices[1])]
    CreaseWithoutEdge { at: Place, vertices: [u32; 2] },
    #[error("{at}: a corner at vertex {vertex}, but the mesh has only 0 to {last}; count from 0")]
    CornerOutOfRange { at: Place, vertex: u32, last: u64 },
    #[error("{at}: a hole at face {face}, but the mesh has only 0 to {last}; count from 0")]
    HoleOutOfRange { at: Place, face: u32, last: u64 },

    #[error(
        "{at}: a tag without a name and counts; \
         write t NAME INTS/FLOATS/STRINGS and then as many values"
    )]
    TagWithoutHeader { at: Place },
    #[error("{at}: tag '{name}' is unknown; use crease, corner, hole, interpolateboundary, creasemethod or scheme")]
    UnknownTag { at: Place, name: String },
    #[error("{at}: the {name} tag announces {} and has {found}; correct its counts", count(*.announced, "value"))]
    TagCountMismatch { at: Place, name: String, announced: usize, found: usize },
    #[error("{at}: the {name} tag has {ints}/{floats}/{strings} ints/floats/strings; it takes {expected}")]
    TagShape { at: Place, name: &'static str, ints: usize, floats: usize, strings: usize, expected: &'static str },
    #[error("{at}: the {name} tag has index {index}; use 0 to {limit}", limit = i32::MAX)]
    TagIndex { at: Place, name: &'static str, index: i64 },
    #[error("{at}: {name} '{value}' is not supported; use {expected}")]
    TagValue { at: Place, name: &'static str, value: String, expected: &'static str },

    #[error("{at}: the path is not UTF-8; rename the file")]
    PathNotText { at: Place },
    #[error("{at}: not readable as USD ({reason}); export the file again")]
    UsdUnreadable { at: Place, reason: String },
    #[error("{at}: a part of the stage is missing ({reason}); put the files that it refers to beside it")]
    UsdIncomplete { at: Place, reason: String },
    #[error(
        "{at}: the arcs of {prim} lead back to it; break the circle of its inherits, specializes, references and payloads"
    )]
    ArcsInCircle { at: Place, prim: String },
    #[error(
        "{at}: the stage has no Mesh prim that is visible and of purpose default or render{passed}; give one that has"
    )]
    NoMeshPrims { at: Place, passed: String },
    #[error("{at}: an OBJ has no prims; leave --prim out, or give a USD file")]
    NoPrims { at: Place },
    #[error(
        "{at}: an OBJ has no time; leave --time out, give a USD file, \
         or have #### in the name for the number of the frame"
    )]
    NoTime { at: Place },
    #[error("{at}: no prim {prim} with a Mesh that is shown; there are {found}")]
    PrimUnknown { at: Place, prim: String, found: String },
    #[error("{at}: a Mesh prim without {name}; give it points, faceVertexCounts and faceVertexIndices")]
    AttributeMissing { at: Place, name: &'static str },
    #[error("{at}: {name} is not {expected}; give it the type that the schema says")]
    AttributeType { at: Place, name: String, expected: &'static str },
    #[error("{at}: {name} is a spline, which is not read; give it time samples")]
    AttributeSpline { at: Place, name: String },
    #[error("{at}: {name} has {value}; use 0 and above")]
    AttributeNegative { at: Place, name: &'static str, value: i32 },
    #[error("{at}: {name} has {}; write {expected}", count(*.found, "value"))]
    AttributeLength { at: Place, name: &'static str, found: usize, expected: String },
    #[error("{at}: creaseLengths has {length}; a crease has at least 2 vertices")]
    CreaseTooShort { at: Place, length: u32 },
    #[error("{at}: subdivisionScheme '{scheme}' is none of USD's; use catmullClark, loop, bilinear or none")]
    SchemeUnknown { at: Place, scheme: String },
    #[error("{at}: xformOpOrder has {op}, which is no transform of USD; correct it")]
    TransformUnknown { at: Place, op: String },
    #[error("{at}: a PointInstancer without {name}; give it prototypes, protoIndices and positions")]
    InstancerIncomplete { at: Place, name: &'static str },
    #[error("{at}: a PointInstancer that is in a prototype of its own; give it other prototypes")]
    InstancerInCircle { at: Place },
    #[error("{at}: protoIndices has {index}, but the number of prototypes is {count}; correct it")]
    PrototypeUnknown { at: Place, index: u32, count: usize },
}
