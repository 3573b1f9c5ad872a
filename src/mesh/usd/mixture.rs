//! Meshes of several schemes and rules as meshes of one, with the surfaces that they have alone.
//!
//! Meshes share no vertices, so what a rule says of one can be said by features of its own: Catmull and Clark's scheme has the patches of
//! `bilinear` and `none` where all is infinitely sharp, and `edgeOnly` has the other boundary rules by sharp vertices and by holes.
//! Loop's scheme, and triangles by two rules, have no such form: then the rarer meshes are left out by name.

use std::collections::HashMap;

use super::scene::Placed;
use crate::mesh::{Boundary, Corner, Scheme, SubdivMesh, TriangleRule};

/// Sharpness from which a vertex or edge never decays.
const INFINITE: f32 = 10.0;

/// The rules that all meshes of a scene have.
pub(super) struct Rules {
    pub(super) scheme: Scheme,
    pub(super) boundary: Boundary,
    pub(super) triangles: TriangleRule,
}

/// Makes meshes those of one scheme and one set of rules; says in `notes` which it leaves out.
pub(super) fn unify(meshes: &mut Vec<Placed>, notes: &mut Vec<String>) -> Rules {
    let scheme = unify_schemes(meshes, notes);
    let has_smooth = |mesh: &SubdivMesh| mesh.triangles == TriangleRule::Smooth;
    let (smooth, other): (Vec<&Placed>, _) =
        meshes.iter().filter(|placed| has_triangles(&placed.mesh)).partition(|placed| has_smooth(&placed.mesh));
    let triangles = if smooth.len() > other.len() { TriangleRule::Smooth } else { TriangleRule::CatmullClark };
    if !smooth.is_empty() && !other.is_empty() {
        let leaves = |mesh: &SubdivMesh| has_triangles(mesh) && mesh.triangles != triangles;
        let name = if triangles == TriangleRule::Smooth { "catmullClark" } else { "smooth" };
        leave_out(meshes, leaves, &format!("triangleSubdivisionRule {name}"), notes);
    }
    Rules { scheme, boundary: unify_boundaries(meshes, scheme), triangles }
}

/// Whether the rule for triangles matters.
fn has_triangles(mesh: &SubdivMesh) -> bool {
    mesh.scheme == Scheme::CatmullClark && mesh.face_sizes.contains(&3)
}

fn unify_schemes(meshes: &mut Vec<Placed>, notes: &mut Vec<String>) -> Scheme {
    let is_loop = |mesh: &SubdivMesh| mesh.scheme == Scheme::Loop;
    let loops = meshes.iter().filter(|placed| is_loop(&placed.mesh)).count();
    if loops > 0 && loops < meshes.len() {
        match 2 * loops > meshes.len() {
            true => leave_out(meshes, |mesh| !is_loop(mesh), "a scheme that is not loop", notes),
            false => leave_out(meshes, is_loop, "the scheme loop", notes),
        }
    }
    let scheme = meshes.first().map_or_else(Default::default, |first| first.mesh.scheme);
    if meshes.iter().all(|placed| placed.mesh.scheme == scheme) {
        return scheme;
    }
    let linear = meshes.iter_mut().filter(|placed| placed.mesh.scheme.is_linear());
    if linear.count() == meshes.len() {
        // Concave faces are cut already, and then both are one.
        meshes.iter_mut().for_each(|placed| placed.mesh.scheme = Scheme::Bilinear);
        return Scheme::Bilinear;
    }
    let linear = meshes.iter_mut().filter(|placed| placed.mesh.scheme.is_linear());
    linear.for_each(|placed| placed.mesh.linear_to_catmull_clark());
    Scheme::CatmullClark
}

/// Leaves meshes out that cannot stand beside the others, with a note.
fn leave_out(meshes: &mut Vec<Placed>, leaves: impl Fn(&SubdivMesh) -> bool, what: &str, notes: &mut Vec<String>) {
    let mut left: Vec<String> = Vec::new();
    meshes.retain(|placed| {
        let leaves = leaves(&placed.mesh);
        left.extend(leaves.then(|| placed.name.clone()));
        !leaves
    });
    if let Some(first) = left.first() {
        let count = left.len();
        let (meshes, are) = if count == 1 { ("mesh", "is") } else { ("meshes", "are") };
        notes.push(format!(
            "{count} {meshes} of {what} {are} left out (first: {first}), since a surface has one rule for all; \
             read alone with --prim {first}"
        ));
    }
}

/// One boundary rule for all: where meshes have several, `EdgeOnly`, with sharp vertices and holes for the others.
fn unify_boundaries(meshes: &mut [Placed], scheme: Scheme) -> Boundary {
    let Some(first) = meshes.first().map(|placed| placed.mesh.boundary) else { return Boundary::default() };
    if meshes.iter().all(|placed| placed.mesh.boundary == first) || scheme.is_linear() {
        return first;
    }
    let mut rules: Vec<Boundary> =
        meshes.iter().filter(|placed| has_boundary(&placed.mesh)).map(|placed| placed.mesh.boundary).collect();
    rules.dedup();
    match rules[..] {
        [] => return Boundary::EdgeAndCorner,
        [rule] => return rule,
        _ => {}
    }
    for Placed { mesh, .. } in meshes {
        match mesh.boundary {
            Boundary::EdgeOnly => {}
            Boundary::EdgeAndCorner => sharpen_lone_vertices(mesh),
            Boundary::None => leave_boundary_open(mesh),
        }
        mesh.boundary = Boundary::EdgeOnly;
    }
    Boundary::EdgeOnly
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Edges that have a single face.
fn boundary_edges(mesh: &SubdivMesh) -> Vec<[u32; 2]> {
    let mut faces_at = HashMap::new();
    for (_, face) in mesh.good_faces() {
        for (k, &vertex) in face.iter().enumerate() {
            *faces_at.entry(edge(vertex, face[(k + 1) % face.len()])).or_insert(0_u32) += 1;
        }
    }
    faces_at.into_iter().filter_map(|(edge, faces)| (faces == 1).then_some(edge)).collect()
}

fn has_boundary(mesh: &SubdivMesh) -> bool {
    !boundary_edges(mesh).is_empty()
}

fn sharpen_lone_vertices(mesh: &mut SubdivMesh) {
    let mut faces_at = vec![0_u32; mesh.points.len()];
    for &vertex in &mesh.face_vertices {
        faces_at[vertex as usize] += 1;
    }
    // Those of bad faces are there for no rule.
    mesh.spare_vertices().iter().for_each(|&vertex| faces_at[vertex as usize] = 0);
    let lone = (0..).zip(&faces_at).filter(|(_, faces)| **faces == 1);
    mesh.corners.extend(lone.map(|(vertex, _)| Corner { vertex, sharpness: INFINITE }));
}

/// Makes the faces holes that have no surface where boundaries are not interpolated: all that touch a boundary edge, unless that is
/// infinitely sharp.
fn leave_boundary_open(mesh: &mut SubdivMesh) {
    let sharpness: HashMap<[u32; 2], f32> =
        mesh.creases.iter().map(|crease| (edge(crease.vertices[0], crease.vertices[1]), crease.sharpness)).collect();
    let mut is_open = vec![false; mesh.points.len()];
    for edge in boundary_edges(mesh) {
        if sharpness.get(&edge).is_none_or(|&sharpness| sharpness < INFINITE) {
            edge.into_iter().for_each(|vertex| is_open[vertex as usize] = true);
        }
    }
    let touches = |face: &[u32]| face.iter().any(|&vertex| is_open[vertex as usize]);
    let open: Vec<u32> = mesh.faces().filter_map(|(index, face)| touches(face).then_some(index as u32)).collect();
    mesh.holes.extend(open);
    mesh.holes.sort_unstable();
    mesh.holes.dedup();
}
