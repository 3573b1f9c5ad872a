//! OBJ, read directly: a subdivision mesh needs the vertices exactly as the file indexes them.
//!
//! Readers made for drawing re-index vertices and split them between groups, which would cut seams into the surface.
//! Here `v`, `f` and OpenSubdiv's `t` tags count, and everything else is passed over: texture coordinates and normals
//! (the limit surface has its own), groups, objects, materials, smoothing groups, points, lines and free-form geometry.
//! Text may be ASCII, UTF-8 or Latin-1; only numbers and tag names are interpreted.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use glam::DVec3;

use super::error::{MeshError, Place, Spot, quote};
use super::lines::LogicalLines;
use super::validate::{Lines, Source, check};
use super::{Boundary, SubdivMesh, tags};

/// Reads and validates the file; see [`super::read`].
pub(super) fn read(path: &Path) -> Result<SubdivMesh, MeshError> {
    let at = || Place::file(path);
    let text = fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => MeshError::NotFound { at: at() },
        _ => MeshError::Unreadable { at: at(), error },
    })?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    parse(&text, &path.display().to_string(), &name)
}

/// Reads and validates the text of an OBJ. `source` is the file's name in messages.
pub(super) fn parse(text: &[u8], source: &str, name: &str) -> Result<SubdivMesh, MeshError> {
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
    };
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut lines = LogicalLines::new(text);
    while let Some((number, line)) = lines.next() {
        reader.line(number, line)?;
    }
    reader.cut_concave_faces();
    let source = Source { name: source, lines: Some(&reader.lines), first_vertex: 1 };
    check(&reader.mesh, &source)?;
    Ok(SubdivMesh { face_lines: reader.lines.faces, ..reader.mesh })
}

struct Reader<'a> {
    source: &'a str,
    mesh: SubdivMesh,
    lines: Lines,
}

impl Reader<'_> {
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
            _ => Ok(()),
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

    fn place(&self, number: u32) -> Place {
        Place::with(self.source, Spot::Line(number))
    }

    fn vertex<'t>(&mut self, number: u32, mut tokens: impl Iterator<Item = &'t [u8]>) -> Result<(), MeshError> {
        let mut point = DVec3::ZERO;
        for axis in 0..3 {
            let token =
                tokens.next().ok_or_else(|| MeshError::MissingCoordinates { at: self.place(number), found: axis })?;
            let value = std::str::from_utf8(token).ok().and_then(|text| text.parse().ok());
            point[axis] = value.ok_or_else(|| self.not_a_number(number, token, "a coordinate"))?;
        }
        // What may follow is a weight or a colour.
        self.mesh.points.push(point);
        self.lines.vertices.push(number);
        Ok(())
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
