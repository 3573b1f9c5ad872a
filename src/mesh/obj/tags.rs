//! OpenSubdiv's `t` tags: the features of a subdivision mesh, written into an OBJ.
//!
//! `t NAME INTS/FLOATS/STRINGS` and then that many values of each kind. Indices count from 0 and may name vertices and
//! faces that come later in the file.
//!
//! | tag | values |
//! |---|---|
//! | `crease` | a chain of n + 1 vertices, whose n edges get one sharpness or n; or pairs of vertices with one sharpness |
//! | `corner` | n vertices with one sharpness or n |
//! | `hole` | faces |
//! | `interpolateboundary` | 0 none, 1 edge and corner, 2 edge only |
//! | `creasemethod` | `normal` (or `uniform`), `chaikin` |
//! | `scheme` | `catmullClark`, `loop`, `bilinear`, `none`; ours: OpenSubdiv's files leave the scheme to their name |
//! | `smoothtriangles` | `catmark`, `smooth`: the rule for triangles under Catmull and Clark's scheme |
//! | `facevaryinginterpolateboundary`, `facevaryingpropagatecorners` | ignored: there is no face-varying data here |
//!
//! OpenSubdiv's own shape reader takes the vertices of a `crease` in pairs (`assignComponentTags` in
//! regression/common/far_utils.h), RenderMan (which defined the tag) as a chain. The two agree for one edge a tag, as
//! in all of OpenSubdiv's shapes. Where they differ, a tag with one sharpness is pairs if all pairs are edges of the
//! mesh and the chain has a link that is none ([`read_pairs`]).

use std::collections::HashMap;
use std::ops::Range;

use crate::mesh::error::{MeshError, Place, quote};
use crate::mesh::validate::Lines;
use crate::mesh::{Boundary, Corner, Crease, Creasing, Scheme, SubdivMesh, TriangleRule};

/// The values of one tag, by kind, still as text.
struct Values<'a> {
    ints: &'a [&'a [u8]],
    floats: &'a [&'a [u8]],
    strings: &'a [&'a [u8]],
}

/// A tag on its line.
struct Tag<'a, F> {
    values: Values<'a>,
    line: u32,
    at: F,
}

/// Adds what one tag line says to the mesh. `tokens` are those after the `t`, `at` makes the place of the line.
pub(super) fn read<F: Fn() -> Place>(
    tokens: &[&[u8]],
    line: u32,
    at: F,
    mesh: &mut SubdivMesh,
    lines: &mut Lines,
) -> Result<(), MeshError> {
    let (&[name, counts], values) =
        tokens.split_first_chunk::<2>().ok_or_else(|| MeshError::TagWithoutHeader { at: at() })?;
    let counts = read_counts(counts).ok_or_else(|| MeshError::TagWithoutHeader { at: at() })?;
    // A header can announce more than fits into a usize.
    let announced = counts.iter().fold(0_usize, |sum, &n| sum.saturating_add(n));
    if announced != values.len() {
        return Err(MeshError::TagCountMismatch { at: at(), name: quote(name), announced, found: values.len() });
    }
    let (ints, rest) = values.split_at(counts[0]);
    let (floats, strings) = rest.split_at(counts[1]);
    let values = Values { ints, floats, strings };
    let tag = Tag { values, line, at };
    match name {
        b"crease" => tag.crease(mesh, lines),
        b"corner" => tag.corner(mesh, lines),
        b"hole" => tag.hole(mesh, lines),
        b"interpolateboundary" => tag.boundary(mesh),
        b"creasemethod" => tag.creasing(mesh),
        b"scheme" => tag.scheme(mesh),
        b"smoothtriangles" => tag.triangles(mesh),
        b"facevaryinginterpolateboundary" | b"facevaryingpropagatecorners" => Ok(()),
        _ => Err(MeshError::UnknownTag { at: (tag.at)(), name: quote(name) }),
    }
}

/// Takes chains of creases as pairs where only that makes sense: all pairs are edges, and a link between two of them is
/// none. Counts them with the other tags of pairs.
pub(super) fn read_pairs(mesh: &mut SubdivMesh, lines: &mut Lines) {
    if lines.chains.is_empty() {
        return;
    }
    let edge = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let of_chain = |chain: &Range<usize>| mesh.creases[chain.clone()].iter().map(|crease| edge(crease.vertices));
    let mut is_edge: HashMap<[u32; 2], bool> =
        lines.chains.iter().flat_map(of_chain).map(|edge| (edge, false)).collect();
    for (_, face) in mesh.faces() {
        for (k, &vertex) in face.iter().enumerate() {
            if let Some(found) = is_edge.get_mut(&edge([vertex, face[(k + 1) % face.len()]])) {
                *found = true;
            }
        }
    }
    let is_pairs = |chain: &Range<usize>| {
        let is_edge: Vec<bool> = of_chain(chain).map(|edge| is_edge[&edge]).collect();
        is_edge.iter().step_by(2).all(|&found| found) && is_edge.iter().any(|&found| !found)
    };
    let pairs: Vec<Range<usize>> = lines.chains.iter().filter(|chain| is_pairs(chain)).cloned().collect();
    lines.pairs += pairs.len();
    let mut keep = vec![true; mesh.creases.len()];
    for index in pairs.iter().flat_map(|chain| chain.clone().skip(1).step_by(2)) {
        keep[index] = false;
    }
    let mut kept = keep.iter();
    mesh.creases.retain(|_| *kept.next().unwrap_or(&true));
    let mut kept = keep.iter();
    lines.creases.retain(|_| *kept.next().unwrap_or(&true));
}

/// `INTS/FLOATS/STRINGS`.
fn read_counts(token: &[u8]) -> Option<[usize; 3]> {
    let mut fields = std::str::from_utf8(token).ok()?.split('/');
    let counts = [(); 3].map(|()| fields.next().and_then(|field| field.parse().ok()));
    let [Some(ints), Some(floats), Some(strings)] = counts else {
        return None;
    };
    fields.next().is_none().then_some([ints, floats, strings])
}

impl<F: Fn() -> Place> Tag<'_, F> {
    fn crease(&self, mesh: &mut SubdivMesh, lines: &mut Lines) -> Result<(), MeshError> {
        let (ints, floats) = (self.values.ints.len(), self.values.floats.len());
        let edges = ints.saturating_sub(1);
        let expected = "a chain of 2 ints or more, and one float or one an edge";
        self.expect_sharpness("crease", edges, expected)?;
        if floats == 1 && ints > 2 && ints.is_multiple_of(2) {
            lines.chains.push(mesh.creases.len()..mesh.creases.len() + edges);
        }
        let mut ends = self.values.ints.iter().map(|int| self.index("crease", int));
        let mut start = ends.next().unwrap_or(Ok(0))?;
        for (k, end) in ends.enumerate() {
            let end = end?;
            mesh.creases.push(Crease { vertices: [start, end], sharpness: self.sharpness(k)? });
            lines.creases.push(self.line);
            start = end;
        }
        Ok(())
    }

    fn corner(&self, mesh: &mut SubdivMesh, lines: &mut Lines) -> Result<(), MeshError> {
        let expected = "one int or more, and one float or one an int";
        self.expect_sharpness("corner", self.values.ints.len(), expected)?;
        for (k, int) in self.values.ints.iter().enumerate() {
            mesh.corners.push(Corner { vertex: self.index("corner", int)?, sharpness: self.sharpness(k)? });
            lines.corners.push(self.line);
        }
        Ok(())
    }

    fn hole(&self, mesh: &mut SubdivMesh, lines: &mut Lines) -> Result<(), MeshError> {
        let ok = self.values.floats.is_empty() && self.values.strings.is_empty();
        self.expect(ok, "hole", "ints alone")?;
        for int in self.values.ints {
            mesh.holes.push(self.index("hole", int)?);
            lines.holes.push(self.line);
        }
        Ok(())
    }

    fn boundary(&self, mesh: &mut SubdivMesh) -> Result<(), MeshError> {
        // Some exporters write the rule as a float.
        let value = match self.values {
            Values { ints: [value], floats: [], strings: [] } | Values { ints: [], floats: [value], strings: [] } => {
                value
            }
            _ => return self.expect(false, "interpolateboundary", "one int"),
        };
        mesh.boundary = match parse::<f64>(value) {
            Some(0.0) => Boundary::None,
            Some(1.0) => Boundary::EdgeAndCorner,
            Some(2.0) => Boundary::EdgeOnly,
            _ => {
                let expected = "0 (none), 1 (edge and corner) or 2 (edge only)";
                return Err(self.refuse_value("interpolateboundary", value, expected));
            }
        };
        Ok(())
    }

    fn creasing(&self, mesh: &mut SubdivMesh) -> Result<(), MeshError> {
        let Values { ints: [], floats: [], strings: [value] } = self.values else {
            return self.expect(false, "creasemethod", "one string");
        };
        mesh.creasing = match *value {
            b"normal" | b"uniform" => Creasing::Uniform,
            b"chaikin" => Creasing::Chaikin,
            _ => return Err(self.refuse_value("creasemethod", value, "normal or chaikin")),
        };
        Ok(())
    }

    fn scheme(&self, mesh: &mut SubdivMesh) -> Result<(), MeshError> {
        let Values { ints: [], floats: [], strings: [value] } = self.values else {
            return self.expect(false, "scheme", "one string");
        };
        let scheme = std::str::from_utf8(value).ok().and_then(Scheme::of_name);
        mesh.scheme =
            scheme.ok_or_else(|| self.refuse_value("scheme", value, "catmullClark, loop, bilinear or none"))?;
        Ok(())
    }

    fn triangles(&self, mesh: &mut SubdivMesh) -> Result<(), MeshError> {
        let Values { ints: [], floats: [], strings: [value] } = self.values else {
            return self.expect(false, "smoothtriangles", "one string");
        };
        mesh.triangles = match *value {
            b"catmark" => TriangleRule::CatmullClark,
            b"smooth" => TriangleRule::Smooth,
            _ => return Err(self.refuse_value("smoothtriangles", value, "catmark or smooth")),
        };
        Ok(())
    }

    fn expect_sharpness(&self, name: &'static str, sharpened: usize, expected: &'static str) -> Result<(), MeshError> {
        let Values { floats, strings, .. } = self.values;
        let ok = sharpened > 0 && (floats.len() == 1 || floats.len() == sharpened) && strings.is_empty();
        self.expect(ok, name, expected)
    }

    fn expect(&self, ok: bool, name: &'static str, expected: &'static str) -> Result<(), MeshError> {
        if ok {
            return Ok(());
        }
        let Values { ints, floats, strings } = self.values;
        Err(MeshError::TagShape {
            at: (self.at)(),
            name,
            ints: ints.len(),
            floats: floats.len(),
            strings: strings.len(),
            expected,
        })
    }

    /// An index, not yet compared with the counts of the mesh: what it names may follow.
    fn index(&self, name: &'static str, token: &[u8]) -> Result<u32, MeshError> {
        let index = parse::<i64>(token).ok_or_else(|| self.refuse_number(token, "an index"))?;
        match u32::try_from(index) {
            Ok(index) if i32::try_from(index).is_ok() => Ok(index),
            _ => Err(MeshError::TagIndex { at: (self.at)(), name, index }),
        }
    }

    /// Sharpness of the k-th edge or vertex: one for all, or each its own.
    fn sharpness(&self, k: usize) -> Result<f32, MeshError> {
        let floats = self.values.floats;
        let token = if floats.len() == 1 { floats[0] } else { floats[k] };
        parse(token).ok_or_else(|| self.refuse_number(token, "a sharpness"))
    }

    fn refuse_number(&self, token: &[u8], expected: &'static str) -> MeshError {
        MeshError::NotANumber { at: (self.at)(), found: quote(token), expected }
    }

    fn refuse_value(&self, name: &'static str, value: &[u8], expected: &'static str) -> MeshError {
        MeshError::TagValue { at: (self.at)(), name, value: quote(value), expected }
    }
}

fn parse<T: std::str::FromStr>(token: &[u8]) -> Option<T> {
    std::str::from_utf8(token).ok()?.parse().ok()
}
