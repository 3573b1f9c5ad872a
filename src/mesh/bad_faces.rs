//! Faces that cannot be part of a surface: they are left out, and keep their places.
//!
//! OpenSubdiv crashes on a face that names a vertex twice, and takes a face that is there twice without a word. Files
//! have such faces all the same (collapsed quads, objects that were pasted twice), and a scene with thousands of good
//! faces is still worth looking at. So the readers replace each by a polygon of the same size on vertices of its own,
//! at the same coordinates and behind the vertices of the file, and make it a hole. Faces and ptex faces are numbered
//! as in the file then, and the edges of a bad face are not those of its neighbours.

use std::collections::{HashMap, HashSet};

use serde::{Deserialize, Serialize};

use super::error::{MeshError, Place, Spot};
use super::validate::Lines;
use super::{Scheme, SubdivMesh};
use crate::line::count;

/// A face of a file that is left out of the surface: it is a hole on vertices of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct BadFace {
    /// Its index among the faces of the mesh.
    pub face: u32,
    /// What is wrong with it.
    pub fault: Fault,
    /// Number of creases that are left out with it, because no other face has their edges.
    pub creases: u32,
}

/// What is wrong with a face. Indices count from 0, within the part of the mesh that the face is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// It has less than three vertices.
    TooSmall {
        /// How many it has.
        size: u32,
    },
    /// It names a vertex twice.
    RepeatedVertex {
        /// The first vertex that comes again.
        vertex: u32,
    },
    /// An earlier face has the same vertices in the same order.
    Duplicate {
        /// That face.
        original: u32,
    },
}

impl Fault {
    /// The fault as an error: of a face at `at`, in a source whose first vertex has the number `first_vertex` and whose
    /// faces are where `spot` says.
    pub(super) fn error(self, at: Place, first_vertex: u64, spot: impl Fn(usize) -> Spot) -> MeshError {
        match self {
            Self::TooSmall { size } => MeshError::FaceTooSmall { at, size: size as usize },
            Self::RepeatedVertex { vertex } => {
                MeshError::RepeatedVertex { at, vertex: u64::from(vertex) + first_vertex }
            }
            Self::Duplicate { original } => MeshError::DuplicateFace { at, original: spot(original as usize) },
        }
    }
}

impl SubdivMesh {
    /// Whether a face is one of [`bad_faces`](Self::bad_faces).
    pub fn is_bad_face(&self, face: usize) -> bool {
        self.bad_faces.binary_search_by_key(&face, |bad| bad.face as usize).is_ok()
    }

    /// The faces that can be part of the surface: all but [`bad_faces`](Self::bad_faces), with their indices.
    pub fn good_faces(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut bad = self.bad_faces.iter().map(|bad| bad.face as usize).peekable();
        self.faces().filter(move |(face, _)| bad.next_if_eq(face).is_none())
    }

    /// Vertices of bad faces, which are none of the file's, in ascending order.
    pub(crate) fn spare_vertices(&self) -> Vec<u32> {
        if self.bad_faces.is_empty() {
            return Vec::new();
        }
        let spare = self.faces().filter(|(face, _)| self.is_bad_face(*face));
        let mut spare: Vec<u32> = spare.flat_map(|(_, vertices)| vertices).copied().collect();
        spare.sort_unstable();
        spare
    }
}

/// Leaves the bad faces of a mesh out, and with them the creases on edges that only they have. `lines` follow the
/// creases.
///
/// All vertices that faces, creases and corners name must be there ([`check_indices`](super::validate::check_indices)):
/// those of the bad faces come behind them.
pub(super) fn leave_out(mesh: &mut SubdivMesh, lines: Option<&mut Lines>) {
    mesh.bad_faces = find(mesh);
    if mesh.bad_faces.is_empty() {
        return;
    }
    leave_creases_out(mesh, lines);
    give_own_vertices(mesh);
    mesh.holes.extend(mesh.bad_faces.iter().map(|bad| bad.face));
}

/// All bad faces, in their order.
fn find(mesh: &SubdivMesh) -> Vec<BadFace> {
    let bad = |face: usize, fault: Fault| BadFace { face: face as u32, fault, creases: 0 };
    // The face that used a vertex last, plus one: finds a repetition without comparing all pairs.
    let mut last_face = vec![0_u32; mesh.points.len()];
    let mut found = Vec::new();
    for (face, vertices) in mesh.faces() {
        if vertices.len() < 3 {
            found.push(bad(face, Fault::TooSmall { size: vertices.len() as u32 }));
            continue;
        }
        let stamp = face as u32 + 1;
        let repeated =
            vertices.iter().find(|&&vertex| std::mem::replace(&mut last_face[vertex as usize], stamp) == stamp);
        found.extend(repeated.map(|&vertex| bad(face, Fault::RepeatedVertex { vertex })));
    }
    let mut known = found.iter().map(|bad| bad.face as usize).peekable();
    let good = mesh.faces().filter(|(face, _)| known.next_if_eq(face).is_none());
    let copies = duplicates(good);
    found.extend(copies.into_iter().map(|[face, original]| bad(face, Fault::Duplicate { original: original as u32 })));
    found.sort_unstable_by_key(|bad| bad.face);
    found
}

/// A face as its smallest vertex and the one after it, where to find the rest, and its index.
struct Turned<'a> {
    key: [u32; 2],
    face: &'a [u32],
    start: usize,
    index: usize,
}

impl<'a> Turned<'a> {
    fn new((index, face): (usize, &'a [u32])) -> Self {
        let start = (0..face.len()).min_by_key(|&k| face[k]).unwrap_or(0);
        let key = [face[start], face[(start + 1) % face.len()]];
        Self { key, face, start, index }
    }

    /// All vertices from the smallest one on, in the face's own direction.
    fn vertices(&self) -> impl Iterator<Item = &u32> {
        self.face[self.start..].iter().chain(&self.face[..self.start])
    }
}

/// Faces with the vertices of an earlier one in the same cyclic order, each with the first such face; in ascending
/// order. No face may be empty.
pub(super) fn duplicates<'a>(faces: impl Iterator<Item = (usize, &'a [u32])>) -> Vec<[usize; 2]> {
    let mut turned: Vec<_> = faces.map(Turned::new).collect();
    turned.sort_unstable_by(|a, b| {
        a.key.cmp(&b.key).then_with(|| a.vertices().cmp(b.vertices())).then(a.index.cmp(&b.index))
    });
    let same = |a: &Turned<'_>, b: &Turned<'_>| a.key == b.key && a.vertices().eq(b.vertices());
    let copies = turned.chunk_by(same).flat_map(|group| group[1..].iter().map(|copy| [copy.index, group[0].index]));
    let mut copies: Vec<_> = copies.collect();
    copies.sort_unstable();
    copies
}

type Edge = [u32; 2];

fn ordered([a, b]: Edge) -> Edge {
    [a.min(b), a.max(b)]
}

fn edges(face: &[u32]) -> impl Iterator<Item = Edge> {
    let next = face.iter().cycle().skip(1);
    face.iter().zip(next).map(|(&a, &b)| ordered([a, b])).filter(|[a, b]| a != b)
}

/// Takes away the creases on edges that only bad faces have, and counts them with the first face that has each.
fn leave_creases_out(mesh: &mut SubdivMesh, lines: Option<&mut Lines>) {
    let creased: HashSet<Edge> = mesh.creases.iter().map(|crease| ordered(crease.vertices)).collect();
    let bad: Vec<&[u32]> = mesh.faces().filter(|(face, _)| mesh.is_bad_face(*face)).map(|(_, face)| face).collect();
    // Creases on each edge that only bad faces have.
    let of_bad = bad.iter().flat_map(|face| edges(face)).filter(|edge| creased.contains(edge));
    let mut lost: HashMap<Edge, u32> = of_bad.map(|edge| (edge, 0)).collect();
    if lost.is_empty() {
        return;
    }
    mesh.good_faces().flat_map(|(_, face)| edges(face)).for_each(|edge| _ = lost.remove(&edge));
    let mut keep = Vec::with_capacity(mesh.creases.len());
    for crease in &mesh.creases {
        let creases = lost.get_mut(&ordered(crease.vertices));
        keep.push(creases.is_none());
        if let Some(creases) = creases {
            *creases += 1;
        }
    }
    let count = |face: &&[u32]| edges(face).filter_map(|edge| lost.remove(&edge)).sum();
    let counts: Vec<u32> = bad.iter().map(count).collect();
    mesh.bad_faces.iter_mut().zip(counts).for_each(|(bad, creases)| bad.creases = creases);
    retain(&mut mesh.creases, &keep);
    if let Some(lines) = lines {
        retain(&mut lines.creases, &keep);
    }
}

fn retain<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| keep.next().copied().unwrap_or(true));
}

/// Gives each bad face vertices that no other face has, where its own are. One with less than three gets the last of
/// them again.
fn give_own_vertices(mesh: &mut SubdivMesh) {
    let mut points = std::mem::take(&mut mesh.points);
    let mut sizes = Vec::with_capacity(mesh.face_sizes.len());
    let mut vertices = Vec::with_capacity(mesh.face_vertices.len() + mesh.bad_faces.len());
    for (face, old) in mesh.faces() {
        if !mesh.is_bad_face(face) {
            sizes.push(old.len() as u32);
            vertices.extend(old);
            continue;
        }
        // The only size that Loop's scheme takes.
        let size = if mesh.scheme == Scheme::Loop { 3 } else { old.len().max(3) };
        sizes.push(size as u32);
        for k in 0..size {
            let at = old.get(k).or(old.last()).map_or(0, |&vertex| vertex as usize);
            vertices.push(points.len() as u32);
            points.push(points[at]);
        }
    }
    (mesh.points, mesh.face_sizes, mesh.face_vertices) = (points, sizes, vertices);
}

/// Says that faces were left out, as a note of the mesh; `error` says what is wrong with one.
///
/// # Errors
/// The first of them, if none may be left out, or if there is no other face.
pub(super) fn note(
    mesh: &mut SubdivMesh,
    is_strict: bool,
    error: impl Fn(&SubdivMesh, &BadFace) -> MeshError,
) -> Result<(), MeshError> {
    let Some(first) = mesh.bad_faces.first() else { return Ok(()) };
    let error = error(mesh, first);
    let (left_out, faces) = (mesh.bad_faces.len(), mesh.face_count());
    if is_strict || left_out == faces {
        return Err(error);
    }
    let are =
        if left_out == 1 { "is left out of the surface, as a hole" } else { "are left out of the surface, as holes" };
    let creases: u32 = mesh.bad_faces.iter().map(|bad| bad.creases).sum();
    let with = match creases {
        0 => String::new(),
        _ => format!(", with {} on edges that no other face has", count(creases as usize, "crease")),
    };
    let first = if left_out == 1 { "" } else { "the first: " };
    mesh.notes.push(format!("{left_out} of {} {are}{with}; {first}{error}", count(faces, "face")));
    Ok(())
}
