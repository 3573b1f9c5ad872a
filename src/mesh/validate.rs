//! Everything that OpenSubdiv 3.5.0 does not survive, or takes without a word, is refused here.
//!
//! One pass over each array, plus a sort of the faces (for duplicates) and of the creases (for their edges): a million
//! faces take a fraction of a second.
//!
//! # What is legal
//! * Non-manifold edges and vertices, unused vertices, several components, coincident points, all faces being holes.
//! * A face and its mirror image (the same vertices in reverse): a closed pillow of two sides, where each edge has its
//!   two faces. The same cyclic order twice is refused: it is one face counted twice, and the second copy would lie on
//!   the first and turn its edges non-manifold.
//! * The same edge or vertex sharpened more than once: the last one counts.

use std::ops::Range;

use super::bad_faces;
use super::error::{MeshError, Place, Spot};
use super::{BadFace, Scheme, SubdivMesh};

/// Largest number of edges at a vertex, and of vertices in a face: OpenSubdiv's `Vtr::VALENCE_LIMIT` (16-bit local
/// indices).
pub const MAX_VALENCE: usize = 65_535;

/// Largest coordinate, in the units of the file: squared lengths still fit into an f32 (1e36 of 3.4e38).
pub const MAX_COORDINATE: f64 = 1e18;

/// Lines of the file that the parts of a mesh come from, parallel to the mesh's own arrays.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub(super) vertices: Vec<u32>,
    pub(super) faces: Vec<u32>,
    pub(super) creases: Vec<u32>,
    pub(super) corners: Vec<u32>,
    pub(super) holes: Vec<u32>,
    /// Creases of each tag that may be a chain of vertices or pairs of them.
    pub(super) chains: Vec<Range<usize>>,
    /// Number of tags that were read as pairs.
    pub(super) pairs: usize,
}

/// How the messages about a mesh name its parts.
pub(super) struct Source<'a> {
    /// Path of the file, or name of the mesh.
    pub(super) name: &'a str,
    /// Lines of the parts, if they come from a file.
    pub(super) lines: Option<&'a Lines>,
    /// Number of the first vertex in the faces of the source: 1 in an OBJ, else 0.
    pub(super) first_vertex: u64,
}

/// A part of a mesh that can be the offender.
#[derive(Clone, Copy)]
enum Part {
    Vertex(usize),
    Face(usize),
    Crease(usize),
    Corner(usize),
    Hole(usize),
}

impl Source<'_> {
    fn whole(&self) -> Place {
        Place::with(self.name, Spot::Whole)
    }

    /// What is wrong with a face, as an error.
    pub(super) fn fault(&self, bad: &BadFace) -> MeshError {
        let spot = |face: usize| self.spot(Part::Face(face));
        bad.fault.error(self.place(Part::Face(bad.face as usize)), self.first_vertex, spot)
    }

    fn spot(&self, part: Part) -> Spot {
        let none = Lines::default();
        let lines = self.lines.unwrap_or(&none);
        let (table, name, index) = match part {
            Part::Vertex(i) => (&lines.vertices, "vertex", i),
            Part::Face(i) => (&lines.faces, "face", i),
            Part::Crease(i) => (&lines.creases, "crease", i),
            Part::Corner(i) => (&lines.corners, "corner", i),
            Part::Hole(i) => (&lines.holes, "hole", i),
        };
        table.get(index).map_or(Spot::Part(name, index), |&line| Spot::Line(line))
    }

    fn place(&self, part: Part) -> Place {
        Place::with(self.name, self.spot(part))
    }
}

impl SubdivMesh {
    /// Checks that OpenSubdiv can take this mesh, and that it says what it means.
    ///
    /// # Errors
    /// The first offender of the first check that fails; its place is the mesh's name and the part's index.
    pub fn validate(&self) -> Result<(), MeshError> {
        check(self, &Source { name: &self.name, lines: None, first_vertex: 0 })
    }
}

impl SubdivMesh {
    /// The checks of [`validate`](Self::validate) that depend on where the points are, of a mesh whose faces are valid.
    pub(crate) fn validate_points(&self) -> Result<(), MeshError> {
        let source = Source { name: &self.name, lines: None, first_vertex: 0 };
        check_points(self, &source)?;
        check_scheme(self, &source)
    }
}

/// As [`SubdivMesh::validate`], with places as the source names them.
pub(super) fn check(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    check_indices(mesh, source)?;
    check_points(mesh, source)?;
    check_faces(mesh, source)?;
    check_scheme(mesh, source)?;
    check_duplicates(mesh, source)?;
    check_features(mesh, source)
}

/// As [`check`], of a mesh that passed [`check_indices`] and whose bad faces are left out then: no face of it is there twice.
pub(super) fn check_left_out(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    check_counts(mesh, &source.whole())?;
    check_points(mesh, source)?;
    check_faces(mesh, source)?;
    check_scheme(mesh, source)?;
    check_features(mesh, source)
}

fn check_features(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    check_sharpness(mesh, source)?;
    check_creased_edges(mesh, source)?;
    check_holes(mesh, source)
}

/// Whether faces, creases and corners name vertices that are there: what [`bad_faces::leave_out`] asks for.
pub(super) fn check_indices(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    check_counts(mesh, &source.whole())?;
    let count = mesh.points.len();
    let first = source.first_vertex;
    for (i, face) in mesh.faces() {
        if let Some(&vertex) = face.iter().find(|&&vertex| vertex as usize >= count) {
            let (vertex, last) = (u64::from(vertex) + first, count as u64 - 1 + first);
            return Err(MeshError::VertexOutOfRange { at: source.place(Part::Face(i)), vertex, first, last });
        }
    }
    let last = count as u64 - 1;
    for (i, crease) in mesh.creases.iter().enumerate() {
        if let Some(&vertex) = crease.vertices.iter().find(|&&v| v as usize >= count) {
            return Err(MeshError::CreaseOutOfRange { at: source.place(Part::Crease(i)), vertex, last });
        }
    }
    match mesh.corners.iter().position(|corner| corner.vertex as usize >= count) {
        Some(i) => {
            let at = source.place(Part::Corner(i));
            Err(MeshError::CornerOutOfRange { at, vertex: mesh.corners[i].vertex, last })
        }
        None => Ok(()),
    }
}

/// Whether the numbers of vertices and faces agree, and OpenSubdiv can count them.
pub(super) fn check_counts(mesh: &SubdivMesh, at: &Place) -> Result<(), MeshError> {
    if mesh.points.is_empty() {
        return Err(MeshError::NoVertices { at: at.clone() });
    }
    if mesh.face_sizes.is_empty() {
        return Err(MeshError::NoFaces { at: at.clone() });
    }
    check_limit("vertices", mesh.points.len(), at)?;
    check_limit("face vertices", mesh.face_vertices.len(), at)?;
    let expected = mesh.face_sizes.iter().map(|&n| u64::from(n)).sum();
    let found = mesh.face_vertices.len();
    if expected != found as u64 {
        return Err(MeshError::FaceSizesDisagree { at: at.clone(), expected, found });
    }
    Ok(())
}

/// OpenSubdiv counts in `int`.
pub(super) fn check_limit(what: &'static str, count: usize, at: &Place) -> Result<(), MeshError> {
    if i32::try_from(count).is_err() {
        let at = at.clone();
        return Err(MeshError::TooMany { at, what, count });
    }
    Ok(())
}

fn check_points(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    for (i, point) in mesh.points.iter().enumerate() {
        for value in point.to_array() {
            let at = || source.place(Part::Vertex(i));
            if !value.is_finite() {
                return Err(MeshError::CoordinateNotFinite { at: at(), value });
            }
            if value.abs() > MAX_COORDINATE {
                return Err(MeshError::CoordinateTooLarge { at: at(), value });
            }
        }
    }
    Ok(())
}

fn check_faces(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    let count = mesh.points.len();
    // The face that used a vertex last, plus one: finds a repetition without comparing all pairs.
    let mut last_face = vec![0_u32; count];
    let mut faces_at = vec![0_u32; count];
    let mut stamp = 0_u32;
    for (i, face) in mesh.faces() {
        let at = || source.place(Part::Face(i));
        let size = face.len();
        if size < 3 {
            return Err(MeshError::FaceTooSmall { at: at(), size });
        }
        if size > MAX_VALENCE {
            return Err(MeshError::FaceTooLarge { at: at(), size });
        }
        stamp += 1;
        for &vertex in face {
            let last = &mut last_face[vertex as usize];
            if *last == stamp {
                let vertex = u64::from(vertex) + source.first_vertex;
                return Err(MeshError::RepeatedVertex { at: at(), vertex });
            }
            *last = stamp;
            faces_at[vertex as usize] += 1;
        }
    }
    for (vertex, &faces) in faces_at.iter().enumerate() {
        // A face brings two edges to each of its vertices, which neighbours usually share.
        if 2 * faces as usize > MAX_VALENCE {
            check_valence(mesh, vertex as u32, source)?;
        }
    }
    Ok(())
}

/// Counts the edges at a vertex and the faces at each of them.
///
/// The vertex that subdivision puts on an edge has an edge to either end and one into each face.
fn check_valence(mesh: &SubdivMesh, vertex: u32, source: &Source<'_>) -> Result<(), MeshError> {
    let mut neighbours = Vec::new();
    for (_, face) in mesh.faces() {
        if let Some(k) = face.iter().position(|&v| v == vertex) {
            neighbours.push(face[(k + 1) % face.len()]);
            neighbours.push(face[(k + face.len() - 1) % face.len()]);
        }
    }
    neighbours.sort_unstable();
    let edges = || neighbours.chunk_by(|a, b| a == b);
    let at = || source.place(Part::Vertex(vertex as usize));
    let valence = edges().count();
    if valence > MAX_VALENCE {
        return Err(MeshError::ValenceTooHigh { at: at(), valence });
    }
    let faces = edges().map(<[u32]>::len).max().unwrap_or(0);
    if faces + 2 > MAX_VALENCE {
        return Err(MeshError::TooManyFacesAtEdge { at: at(), faces });
    }
    Ok(())
}

fn check_duplicates(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    match bad_faces::duplicates(mesh.faces()).first() {
        Some(&[copy, original]) => Err(MeshError::DuplicateFace {
            at: source.place(Part::Face(copy)),
            original: source.spot(Part::Face(original)),
        }),
        None => Ok(()),
    }
}

/// Whether the scheme takes all faces.
fn check_scheme(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    let at = |face| source.place(Part::Face(face));
    match mesh.scheme {
        Scheme::CatmullClark | Scheme::Bilinear => Ok(()),
        Scheme::Loop => match mesh.face_sizes.iter().position(|&size| size != 3) {
            Some(face) => Err(MeshError::NotTriangle { at: at(face), size: mesh.face_sizes[face] as usize }),
            None => Ok(()),
        },
        Scheme::None => match mesh.first_concave_face() {
            Some(face) => Err(MeshError::FaceConcave { at: at(face) }),
            None => Ok(()),
        },
    }
}

fn check_sharpness(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    for (i, crease) in mesh.creases.iter().enumerate() {
        let at = || source.place(Part::Crease(i));
        let [a, b] = crease.vertices;
        if a == b {
            return Err(MeshError::CreaseOnOneVertex { at: at(), vertex: a });
        }
        check_sharpness_value(crease.sharpness, at)?;
    }
    for (i, corner) in mesh.corners.iter().enumerate() {
        check_sharpness_value(corner.sharpness, || source.place(Part::Corner(i)))?;
    }
    Ok(())
}

fn check_sharpness_value(value: f32, at: impl Fn() -> Place) -> Result<(), MeshError> {
    if !value.is_finite() {
        return Err(MeshError::SharpnessNotFinite { at: at(), value });
    }
    if value < 0.0 {
        return Err(MeshError::SharpnessNegative { at: at(), value });
    }
    Ok(())
}

/// Refuses a crease that is no edge of a face: OpenSubdiv warns and skips it, and the surface silently lacks it.
fn check_creased_edges(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    if mesh.creases.is_empty() {
        return Ok(());
    }
    let edge = |a: u32, b: u32| [a.min(b), a.max(b)];
    let mut wanted: Vec<_> = mesh.creases.iter().map(|c| edge(c.vertices[0], c.vertices[1])).collect();
    wanted.sort_unstable();
    wanted.dedup();
    let mut found = vec![false; wanted.len()];
    // Most edges of a mesh are not creased; two look-ups tell them apart without a search.
    let mut creased = vec![false; mesh.points.len()];
    for vertex in wanted.as_flattened() {
        creased[*vertex as usize] = true;
    }
    for (_, face) in mesh.faces() {
        let mut previous = face[face.len() - 1];
        for &vertex in face {
            if creased[previous as usize]
                && creased[vertex as usize]
                && let Ok(k) = wanted.binary_search(&edge(previous, vertex))
            {
                found[k] = true;
            }
            previous = vertex;
        }
    }
    for (i, crease) in mesh.creases.iter().enumerate() {
        let vertices = crease.vertices;
        let known = wanted.binary_search(&edge(vertices[0], vertices[1]));
        if known.is_ok_and(|k| !found[k]) {
            let at = source.place(Part::Crease(i));
            return Err(MeshError::CreaseWithoutEdge { at, vertices });
        }
    }
    Ok(())
}

fn check_holes(mesh: &SubdivMesh, source: &Source<'_>) -> Result<(), MeshError> {
    let count = mesh.face_count();
    for (i, &face) in mesh.holes.iter().enumerate() {
        if face as usize >= count {
            let at = source.place(Part::Hole(i));
            let last = count as u64 - 1;
            return Err(MeshError::HoleOutOfRange { at, face, last });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_end_where_opensubdivs_int_ends() {
        let at = Place::with("m", Spot::Whole);
        assert!(check_limit("vertices", i32::MAX as usize, &at).is_ok());
        let error = check_limit("vertices", i32::MAX as usize + 1, &at).unwrap_err();
        assert_eq!(
            error.to_string(),
            "m: 2147483648 vertices, but OpenSubdiv's indices end at 2147483647; split the mesh"
        );
    }
}
