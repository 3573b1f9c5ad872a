//! OBJ, read directly: a subdivision mesh needs the vertices exactly as the file indexes them.
//!
//! Readers made for drawing re-index vertices and split them between groups, which would cut seams into the surface.
//! Here `v`, `f`, OpenSubdiv's `t` tags and Embree's `ec` lines count. Texture coordinates and normals (the limit
//! surface has its own), groups, objects, materials and smoothing groups are passed over, for they change no surface.
//! Everything else is passed over with a note that names it: points, lines, free-form geometry, other files, and what
//! no version of the format knows. Text may be ASCII, UTF-8 or Latin-1, and packed by gzip; only numbers and tag names
//! are interpreted.

mod lines;
mod number;
mod passed;
mod tags;

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use glam::DVec3;

use super::error::{MeshError, Place, Spot, quote};
use super::validate::{Lines, Source, check_indices, check_left_out};
use super::{Boundary, Crease, SubdivMesh, bad_faces, packed};
use crate::line::count;
use lines::LogicalLines;
use passed::Passed;

/// Sharpness of an edge that stays sharp for ever.
const INFINITE: f32 = 10.0;

/// Reads and validates the file; see [`super::read`].
pub(super) fn read(path: &Path, name: &str, is_strict: bool) -> Result<SubdivMesh, MeshError> {
    let at = || Place::file(path);
    let text = fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => MeshError::NotFound { at: at() },
        _ => MeshError::Unreadable { at: at(), error },
    })?;
    let text = packed::unpacked(text, at)?;
    parse(&text, &path.display().to_string(), name, is_strict)
}

/// Reads and validates the text of an OBJ. `source` is the file's name in messages; strict as in [`super::Choice`].
pub(super) fn parse(text: &[u8], source: &str, name: &str, is_strict: bool) -> Result<SubdivMesh, MeshError> {
    if text.is_empty() {
        let at = Place::with(source, Spot::Whole);
        return Err(MeshError::EmptyFile { at });
    }
    if let Some(nul) = text.iter().position(|&b| b == 0) {
        let line = text[..nul].iter().filter(|&&b| b == b'\n').count() + 1;
        let spot = Spot::Line(u32::try_from(line).unwrap_or(u32::MAX));
        let at = Place::with(source, spot);
        return Err(MeshError::NotText { at });
    }
    let mut reader = Reader {
        source,
        mesh: SubdivMesh {
            name: name.to_owned(),
            // What OpenSubdiv's own readers of such files start from.
            boundary: Boundary::EdgeOnly,
            ..SubdivMesh::default()
        },
        lines: Lines::default(),
        passed: Passed::default(),
        edge_creases: 0,
    };
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut lines = LogicalLines::new(text);
    while let Some((number, line)) = lines.next() {
        reader.line(number, line)?;
    }
    reader.passed.count_comments(lines.crease_comments);
    reader.finish(is_strict)
}

struct Reader<'a> {
    source: &'a str,
    mesh: SubdivMesh,
    lines: Lines,
    passed: Passed,
    /// Number of Embree's lines with an edge crease.
    edge_creases: usize,
}

impl Reader<'_> {
    /// Validates what was read, and says what was not.
    fn finish(mut self, is_strict: bool) -> Result<SubdivMesh, MeshError> {
        let missing = match (&self.mesh.points[..], &self.mesh.face_sizes[..]) {
            ([], _) => Some("vertices"),
            (_, []) => Some("faces"),
            _ => None,
        };
        if let Some(missing) = missing.filter(|_| !self.passed.is_empty()) {
            let at = Place::with(self.source, Spot::Whole);
            return Err(MeshError::NothingRead { at, missing, found: self.passed.to_string() });
        }
        let name = self.source;
        check_indices(&self.mesh, &Source { name, lines: Some(&self.lines), first_vertex: 1 })?;
        tags::read_pairs(&mut self.mesh, &mut self.lines);
        bad_faces::leave_out(&mut self.mesh, Some(&mut self.lines));
        let source = Source { name, lines: Some(&self.lines), first_vertex: 1 };
        bad_faces::note(&mut self.mesh, is_strict, |_, bad| source.fault(bad))?;
        self.cut_concave_faces();
        check_left_out(&self.mesh, &Source { name, lines: Some(&self.lines), first_vertex: 1 })?;
        if self.edge_creases > 0 {
            let lines = count(self.edge_creases, "line");
            self.mesh.notes.push(format!("creases are read from {lines} of Embree's form, ec WEIGHT VERTEX VERTEX"));
        }
        if self.lines.pairs > 0 {
            let tags = count(self.lines.pairs, "crease tag");
            self.mesh.notes.push(format!("{tags} read as pairs of vertices, as OpenSubdiv does, not as a chain"));
        }
        if !self.passed.is_empty() {
            self.mesh.notes.push(format!("passed over: {}", self.passed));
        }
        Ok(SubdivMesh { face_lines: self.lines.faces, ..self.mesh })
    }

    fn line(&mut self, number: u32, line: &[u8]) -> Result<(), MeshError> {
        let mut tokens = line.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty());
        match tokens.next() {
            Some(b"v") => self.vertex(number, tokens),
            // `fo` is how the first versions of the format wrote `f`.
            Some(b"f" | b"fo") => self.face(number, tokens),
            Some(b"t") => {
                let tokens: Vec<_> = tokens.collect();
                let at = || Place::with(self.source, Spot::Line(number));
                tags::read(&tokens, number, at, &mut self.mesh, &mut self.lines)
            }
            Some(b"ec") if self.edge_crease(number, tokens.clone()).is_some() => Ok(()),
            Some(keyword) => {
                self.passed.count(keyword, number);
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Cuts concave faces under the scheme none; pieces are of the line of their face.
    fn cut_concave_faces(&mut self) {
        if self.mesh.face_sizes.iter().map(|&size| u64::from(size)).sum::<u64>() != self.mesh.face_vertices.len() as u64
        {
            return;
        }
        let lines = self.lines.faces.clone();
        let faces = &mut self.lines.faces;
        let cut = self.mesh.cut_concave_faces_with(|face, pieces| {
            let line = faces[face];
            faces.splice(face..=face, std::iter::repeat_n(line, pieces));
        });
        self.mesh.notes.extend(cut.notes(|face| format!("line {}", lines[face])));
    }

    /// Reads an edge crease as Embree's OBJ loader does: a weight, which is a sharpness, and the ends of the edge, as
    /// in faces. `None` if it is something else.
    fn edge_crease<'t>(&mut self, number: u32, mut tokens: impl Iterator<Item = &'t [u8]>) -> Option<()> {
        let weight: f32 = std::str::from_utf8(tokens.next()?).ok()?.parse().ok()?;
        let mut end = || self.face_vertex(number, tokens.next()?).ok();
        let vertices = [end()?, end()?];
        if tokens.next().is_some() || weight.is_nan() {
            return None;
        }
        let sharpness = if weight == f32::INFINITY { INFINITE } else { weight };
        self.mesh.creases.push(Crease { vertices, sharpness });
        self.lines.creases.push(number);
        self.edge_creases += 1;
        Some(())
    }

    fn place(&self, number: u32) -> Place {
        Place::with(self.source, Spot::Line(number))
    }

    fn vertex<'t>(&mut self, number: u32, mut tokens: impl Iterator<Item = &'t [u8]>) -> Result<(), MeshError> {
        let mut point = DVec3::ZERO;
        for axis in 0..3 {
            let token =
                tokens.next().ok_or_else(|| MeshError::MissingCoordinates { at: self.place(number), found: axis })?;
            let value = std::str::from_utf8(token).ok().and_then(|text| text.parse::<f64>().ok());
            point[axis] = match value {
                Some(value) if value.is_finite() => value,
                _ => self.odd_coordinate(number, token, value)?,
            };
        }
        // What may follow is a weight or a colour.
        self.mesh.points.push(point);
        self.lines.vertices.push(number);
        Ok(())
    }

    /// A coordinate that is no finite number: refused, but for digits that overflow, which validation refuses.
    fn odd_coordinate(&self, number: u32, token: &[u8], value: Option<f64>) -> Result<f64, MeshError> {
        match number::not_finite(token) {
            Some(what) => {
                Err(MeshError::CoordinateNoNumber { at: self.place(number), found: quote(token), cause: what.cause() })
            }
            None => value.ok_or_else(|| self.not_a_number(number, token, "a coordinate")),
        }
    }

    fn face<'t>(&mut self, number: u32, tokens: impl Iterator<Item = &'t [u8]>) -> Result<(), MeshError> {
        let start = self.mesh.face_vertices.len();
        for token in tokens {
            let vertex = self.face_vertex(number, token)?;
            self.mesh.face_vertices.push(vertex);
        }
        let size = self.mesh.face_vertices.len() - start;
        // A size beyond u32 takes a line of more than 8 GB, whose vertices are refused as too many.
        self.mesh.face_sizes.push(u32::try_from(size).unwrap_or(u32::MAX));
        self.lines.faces.push(number);
        Ok(())
    }

    /// Index, from 0, of the vertex in `v`, `v/vt`, `v//vn` or `v/vt/vn`. It may name a vertex that is still to come.
    fn face_vertex(&self, number: u32, token: &[u8]) -> Result<u32, MeshError> {
        let expected = "a vertex index of at most 2147483647";
        let end = token.iter().position(|&b| b == b'/').unwrap_or(token.len());
        let index = parse_index(&token[..end]).ok_or_else(|| self.not_a_number(number, token, expected))?;
        if index > 0 {
            return Ok(index.unsigned_abs() - 1);
        }
        if index == 0 {
            let at = self.place(number);
            return Err(MeshError::VertexZero { at });
        }
        let index = i64::from(index);
        let defined = self.mesh.points.len();
        if defined == 0 {
            let at = self.place(number);
            return Err(MeshError::NegativeBeforeVertices { at, index });
        }
        defined
            .checked_sub(index.unsigned_abs() as usize)
            .and_then(|vertex| u32::try_from(vertex).ok())
            .ok_or_else(|| MeshError::VertexBeforeStart { at: self.place(number), index, defined })
    }

    fn not_a_number(&self, number: u32, token: &[u8], expected: &'static str) -> MeshError {
        MeshError::NotANumber { at: self.place(number), found: quote(token), expected }
    }
}

fn parse_index(digits: &[u8]) -> Option<i32> {
    std::str::from_utf8(digits).ok()?.parse().ok()
}
