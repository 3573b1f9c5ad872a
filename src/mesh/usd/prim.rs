//! One Mesh prim as a control mesh. Where an attribute has no value, the fallback of `UsdGeomMesh` counts.

use glam::{DMat4, DVec3};

use super::scene::Placed;
use super::value::Node;
use super::{instances, motion};
use crate::mesh::validate::{Source, check_indices, check_left_out};
use crate::mesh::{Boundary, Corner, Crease, CutFaces, MeshError, Scheme, SubdivMesh, TriangleRule, bad_faces};

/// Whether the prim has no faces at all.
pub(super) fn is_empty(node: &Node<'_>) -> Result<bool, MeshError> {
    let none = |name| node.indices(name).map(|values| values.is_none_or(|values| values.is_empty()));
    Ok(none("faceVertexCounts")? && none("faceVertexIndices")?)
}

/// Whether a skeleton or blend shapes would move the points (`UsdSkelBindingAPI`).
pub(super) fn is_posed(node: &Node<'_>) -> Result<bool, MeshError> {
    Ok(node.has_value("primvars:skel:jointIndices")? || node.has_value("skel:blendShapes")?)
}

/// A mesh before its transform.
#[derive(Clone)]
pub(super) struct Unplaced {
    /// With its points as they are in the file.
    mesh: SubdivMesh,
    is_left_handed: bool,
}

/// Reads the mesh, its bad faces left out. What else is wrong with faces and points shows when it is placed.
pub(super) fn read(node: &Node<'_>) -> Result<Unplaced, MeshError> {
    let mut mesh = SubdivMesh {
        name: node.source.to_owned(),
        points: node.required("points", motion::points(node)?)?,
        face_sizes: node.required("faceVertexCounts", node.indices("faceVertexCounts")?)?,
        face_vertices: node.required("faceVertexIndices", node.indices("faceVertexIndices")?)?,
        creases: creases(node)?,
        corners: corners(node)?,
        holes: node.indices("holeIndices")?.unwrap_or_default(),
        scheme: scheme(node)?,
        boundary: boundary(node)?,
        ..SubdivMesh::default()
    };
    mesh.triangles = triangle_rule(node, &mesh)?;
    check_indices(&mesh, &Source { name: &mesh.name, lines: None, first_vertex: 0 })?;
    bad_faces::leave_out(&mut mesh, None);
    Ok(Unplaced { mesh, is_left_handed: is_left_handed(node)? })
}

impl Unplaced {
    pub(super) fn vertex_count(&self) -> usize {
        self.mesh.points.len()
    }

    /// Validates the mesh with its points where `world` puts them; `name` is the path of the prim.
    pub(super) fn place(self, name: String, world: DMat4) -> Result<Placed, MeshError> {
        let Self { mut mesh, is_left_handed } = self;
        // What is not finite stays what it is, for the message.
        let place = |point: &DVec3| if point.is_finite() { world.project_point3(*point) } else { *point };
        let moved = mesh.points.iter().map(place).collect();
        let local = std::mem::replace(&mut mesh.points, moved);
        let cut = cut_concave_faces(&mut mesh);
        check_left_out(&mesh, &Source { name: &mesh.name, lines: None, first_vertex: 0 })?;
        // A transform that mirrors turns the inside out once more.
        if is_left_handed != (world.determinant() < 0.0) {
            turn(&mut mesh);
        }
        let digest = instances::digest(&mesh, &local);
        Ok(Placed { name, mesh, world, digest, cut })
    }
}

/// Cuts concave faces of a mesh whose arrays agree; others are refused later.
fn cut_concave_faces(mesh: &mut SubdivMesh) -> CutFaces {
    let size: u64 = mesh.face_sizes.iter().map(|&size| u64::from(size)).sum();
    if size == mesh.face_vertices.len() as u64 { mesh.cut_concave_faces() } else { CutFaces::default() }
}

fn scheme(node: &Node<'_>) -> Result<Scheme, MeshError> {
    let Some(name) = node.token("subdivisionScheme")? else { return Ok(Scheme::CatmullClark) };
    Scheme::of_name(&name).ok_or_else(|| MeshError::SchemeUnknown { at: node.place(), scheme: name })
}

fn refused(node: &Node<'_>, name: &'static str, value: &str, expected: &'static str) -> MeshError {
    MeshError::TagValue { at: node.place(), name, value: value.to_owned(), expected }
}

fn boundary(node: &Node<'_>) -> Result<Boundary, MeshError> {
    let name = "interpolateBoundary";
    match node.token(name)?.as_deref() {
        None | Some("edgeAndCorner") => Ok(Boundary::EdgeAndCorner),
        Some("edgeOnly") => Ok(Boundary::EdgeOnly),
        Some("none") => Ok(Boundary::None),
        Some(other) => Err(refused(node, name, other, "none, edgeOnly or edgeAndCorner")),
    }
}

fn is_left_handed(node: &Node<'_>) -> Result<bool, MeshError> {
    match node.token("orientation")?.as_deref() {
        None | Some("rightHanded") => Ok(false),
        Some("leftHanded") => Ok(true),
        Some(other) => Err(refused(node, "orientation", other, "rightHanded or leftHanded")),
    }
}

/// The rule for triangles: which one matters only where there are any, under Catmull and Clark's scheme.
fn triangle_rule(node: &Node<'_>, mesh: &SubdivMesh) -> Result<TriangleRule, MeshError> {
    let name = "triangleSubdivisionRule";
    match node.token(name)?.as_deref() {
        Some("smooth") if mesh.scheme == Scheme::CatmullClark && mesh.face_sizes.contains(&3) => {
            Ok(TriangleRule::Smooth)
        }
        None | Some("catmullClark" | "smooth") => Ok(TriangleRule::CatmullClark),
        Some(other) => Err(refused(node, name, other, "catmullClark or smooth")),
    }
}

/// Turns all faces over; each keeps its first vertex, as in OpenSubdiv's `isLeftHanded`.
fn turn(mesh: &mut SubdivMesh) {
    let mut rest = mesh.face_vertices.as_mut_slice();
    for &size in &mesh.face_sizes {
        let (face, more) = rest.split_at_mut(size as usize);
        face[1..].reverse();
        rest = more;
    }
}

/// Creases are chains of vertices, with a sharpness a chain or a sharpness an edge.
fn creases(node: &Node<'_>) -> Result<Vec<Crease>, MeshError> {
    let indices = node.indices("creaseIndices")?.unwrap_or_default();
    let lengths = node.indices("creaseLengths")?.unwrap_or_default();
    let sharpness = node.floats("creaseSharpnesses")?;
    let wrong = |name, found, expected| MeshError::AttributeLength { at: node.place(), name, found, expected };
    if let Some(&length) = lengths.iter().find(|&&length| length < 2) {
        return Err(MeshError::CreaseTooShort { at: node.place(), length });
    }
    let total: u64 = lengths.iter().map(|&length| u64::from(length)).sum();
    if total != indices.len() as u64 {
        let expected = format!("{total}, the sum of creaseLengths");
        return Err(wrong("creaseIndices", indices.len(), expected));
    }
    let edges = indices.len() - lengths.len();
    let a_chain = sharpness.len() == lengths.len();
    if !a_chain && sharpness.len() != edges {
        let expected = format!("{}, one for each crease, or {edges}, one for each edge", lengths.len());
        return Err(wrong("creaseSharpnesses", sharpness.len(), expected));
    }
    let mut creases = Vec::with_capacity(edges);
    let mut rest = indices.as_slice();
    for (i, &length) in lengths.iter().enumerate() {
        let (chain, more) = rest.split_at(length as usize);
        for pair in chain.windows(2) {
            let at = if a_chain { i } else { creases.len() };
            creases.push(Crease { vertices: [pair[0], pair[1]], sharpness: sharpness[at] });
        }
        rest = more;
    }
    Ok(creases)
}

fn corners(node: &Node<'_>) -> Result<Vec<Corner>, MeshError> {
    let indices = node.indices("cornerIndices")?.unwrap_or_default();
    let sharpness = node.floats("cornerSharpnesses")?;
    if sharpness.len() != indices.len() {
        let expected = format!("{}, one for each of cornerIndices", indices.len());
        let (at, name, found) = (node.place(), "cornerSharpnesses", sharpness.len());
        return Err(MeshError::AttributeLength { at, name, found, expected });
    }
    Ok(indices.into_iter().zip(sharpness).map(|(vertex, sharpness)| Corner { vertex, sharpness }).collect())
}
