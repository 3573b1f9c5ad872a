//! Several meshes as one: faces and points one after the other, under one scheme and one boundary rule.

use glam::DMat4;

use super::instances::{Extent, Originals};
use super::mixture::{self, Rules};
use crate::mesh::error::{Place, Spot};
use crate::mesh::validate::check_counts;
use crate::mesh::{BadFace, Corner, Crease, CutFaces, MeshError, Part, SubdivMesh};

/// One mesh of all, in their order, each under the path of its prim; `file` names it in messages.
///
/// # Errors
/// More points or faces than OpenSubdiv counts.
pub(super) fn join(mut meshes: Vec<Placed>, file: &str, name: &str) -> Result<SubdivMesh, MeshError> {
    let mut notes = cut_notes(&meshes);
    let Rules { scheme, boundary, triangles } = mixture::unify(&mut meshes, &mut notes);
    let mut scene = SubdivMesh { name: name.to_owned(), scheme, boundary, triangles, notes, ..SubdivMesh::default() };
    let mut originals = Originals::default();
    for Placed { name, mesh, world, digest, .. } in meshes {
        let before = Extent::of(&scene);
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
    /// Which of its faces were cut before it was placed.
    pub cut: CutFaces,
}

/// What to tell of all faces that were cut.
fn cut_notes(meshes: &[Placed]) -> Vec<String> {
    let sum = |of: fn(&CutFaces) -> Option<(usize, usize)>| {
        let mut found = meshes.iter().filter_map(|placed| Some((placed, of(&placed.cut)?))).peekable();
        let (placed, (_, first)) = *found.peek()?;
        Some((placed.name.as_str(), (found.map(|(_, (count, _))| count).sum(), first)))
    };
    let (cut, crossing) = (sum(|cut| cut.cut), sum(|cut| cut.crossing));
    let mut notes = Vec::new();
    for (name, told) in [
        cut.map(|(name, cut)| (name, CutFaces { cut: Some(cut), crossing: None })),
        crossing.map(|(name, crossing)| (name, CutFaces { cut: None, crossing: Some(crossing) })),
    ]
    .into_iter()
    .flatten()
    {
        notes.extend(told.notes(|face| format!("face {face} of {name}")));
    }
    notes
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
