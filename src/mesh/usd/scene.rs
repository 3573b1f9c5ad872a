//! Several meshes as one: faces and points one after the other, under one boundary rule.

use std::collections::HashMap;

use glam::DMat4;

use super::instances::{Extent, Originals};
use crate::mesh::error::{Place, Spot};
use crate::mesh::validate::check_counts;
use crate::mesh::{BadFace, Boundary, Corner, Crease, MeshError, Part, SubdivMesh};

/// Sharpness from which a vertex never decays.
const INFINITE: f32 = 10.0;

/// One mesh of all, in their order, each under the path of its prim; `file` names it in messages.
///
/// `EdgeAndCorner` is `EdgeOnly` with the vertices of a single face infinitely sharp, so meshes of both kinds become
/// one of `EdgeOnly`; meshes without a boundary go with either.
///
/// # Errors
/// Meshes of two schemes, a mesh whose boundary is not interpolated beside one whose is, and more points or faces than
/// OpenSubdiv counts.
pub(super) fn join(meshes: Vec<Placed>, file: &str, name: &str) -> Result<SubdivMesh, MeshError> {
    let mut scene = SubdivMesh { name: name.to_owned(), ..SubdivMesh::default() };
    scene.boundary = match &meshes[..] {
        [one] => one.mesh.boundary,
        _ => common_rule(&meshes)?,
    };
    scene.scheme = meshes.first().map_or_else(Default::default, |first| first.mesh.scheme);
    if let Some(Placed { mesh, .. }) = meshes.iter().find(|placed| placed.mesh.scheme != scene.scheme) {
        let (first, found) = (scene.scheme.name(), mesh.scheme.name());
        return Err(MeshError::SchemeMixed { at: Place::with(&mesh.name, Spot::Whole), first, found });
    }
    let mut originals = Originals::default();
    for Placed { name, mut mesh, world, digest } in meshes {
        let before = Extent::of(&scene);
        if mesh.boundary == Boundary::EdgeAndCorner && scene.boundary == Boundary::EdgeOnly {
            sharpen_lone_vertices(&mut mesh);
        }
        append(&mut scene, mesh);
        // Indices fit as long as their number does.
        check_counts(&scene, &Place::with(file, Spot::Whole))?;
        let repeats = originals.find(&scene, &before, digest, world);
        let [faces, points] = [scene.face_count(), scene.points.len()].map(|count| count as u32);
        scene.parts.push(Part {
            name,
            faces: before.faces as u32..faces,
            points: before.points as u32..points,
            repeats,
        });
    }
    Ok(scene)
}

/// A mesh of the stage, with its points in world space.
pub(super) struct Placed {
    /// Path of its prim.
    pub name: String,
    pub mesh: SubdivMesh,
    /// What brought its points there.
    pub world: DMat4,
    /// Digest of all that it is before that ([`digest`](super::instances::digest)).
    pub digest: u64,
}

fn common_rule(meshes: &[Placed]) -> Result<Boundary, MeshError> {
    let mut rules: Vec<(&SubdivMesh, Boundary)> = Vec::new();
    for Placed { mesh, .. } in meshes {
        if rules.iter().all(|&(_, rule)| rule != mesh.boundary) && has_boundary(mesh) {
            rules.push((mesh, mesh.boundary));
        }
    }
    match rules[..] {
        [] => Ok(Boundary::EdgeAndCorner),
        [(_, rule)] => Ok(rule),
        _ => match rules.iter().find(|(_, rule)| *rule == Boundary::None) {
            Some((mesh, _)) => Err(MeshError::BoundaryMixed { at: Place::with(&mesh.name, Spot::Whole) }),
            None => Ok(Boundary::EdgeOnly),
        },
    }
}

/// Whether an edge has a single face.
fn has_boundary(mesh: &SubdivMesh) -> bool {
    let mut faces_at = HashMap::new();
    for (_, face) in mesh.good_faces() {
        for (k, &vertex) in face.iter().enumerate() {
            let next = face[(k + 1) % face.len()];
            *faces_at.entry([vertex.min(next), vertex.max(next)]).or_insert(0_u32) += 1;
        }
    }
    faces_at.values().any(|&faces| faces == 1)
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

fn append(scene: &mut SubdivMesh, mesh: SubdivMesh) {
    let [points, faces] = [scene.points.len(), scene.face_sizes.len()].map(|count| count as u32);
    scene.points.extend(mesh.points);
    scene.face_sizes.extend(mesh.face_sizes);
    scene.face_vertices.extend(mesh.face_vertices.into_iter().map(|vertex| vertex + points));
    let crease = |Crease { vertices, sharpness }| Crease { vertices: vertices.map(|v| v + points), sharpness };
    scene.creases.extend(mesh.creases.into_iter().map(crease));
    let corner = |Corner { vertex, sharpness }| Corner { vertex: vertex + points, sharpness };
    scene.corners.extend(mesh.corners.into_iter().map(corner));
    scene.holes.extend(mesh.holes.into_iter().map(|face| face + faces));
    scene.bad_faces.extend(mesh.bad_faces.into_iter().map(|bad| BadFace { face: bad.face + faces, ..bad }));
}
