//! Which meshes of a stage are the same one in several places, however the stage says it: as instances, by references, or as copies.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use glam::{DAffine3, DMat4, DVec3};

use crate::mesh::{Corner, Crease, Repeat, SubdivMesh};

/// Largest distance of a point of an instance from where its transform has it, over the size: the rounding of both ways.
const ROUNDING: f64 = 1e-13;

/// Digest of a mesh whose points would be at `local` without its transform.
pub(super) fn digest(mesh: &SubdivMesh, local: &[DVec3]) -> u64 {
    let mut hasher = DefaultHasher::new();
    local.iter().for_each(|p| p.to_array().map(f64::to_bits).hash(&mut hasher));
    (&mesh.face_sizes, &mesh.face_vertices, &mesh.holes).hash(&mut hasher);
    mesh.creases.iter().for_each(|crease| (crease.vertices, crease.sharpness.to_bits()).hash(&mut hasher));
    mesh.corners.iter().for_each(|corner| (corner.vertex, corner.sharpness.to_bits()).hash(&mut hasher));
    // Meshes become those of one scheme and rule by what they had.
    (mesh.scheme, mesh.boundary as u8, mesh.triangles as u8).hash(&mut hasher);
    hasher.finish()
}

/// Where in the arrays of a scene a mesh begins.
#[derive(Debug, Clone)]
pub(super) struct Extent {
    pub faces: usize,
    pub points: usize,
    face_vertices: usize,
    creases: usize,
    corners: usize,
    holes: usize,
}

impl Extent {
    /// Where the next mesh of a scene will begin.
    pub(super) fn of(scene: &SubdivMesh) -> Self {
        Self {
            faces: scene.face_count(),
            points: scene.points.len(),
            face_vertices: scene.face_vertices.len(),
            creases: scene.creases.len(),
            corners: scene.corners.len(),
            holes: scene.holes.len(),
        }
    }
}

/// A mesh that is no instance: its part, where it begins, and what brought its points there.
struct Original {
    part: u32,
    start: Extent,
    world: DMat4,
}

/// Originals by digest.
#[derive(Default)]
pub(super) struct Originals(HashMap<u64, Original>);

impl Originals {
    /// The part that the last mesh of a scene repeats; else it is an original from now on. It begins at `start`.
    pub(super) fn find(&mut self, scene: &SubdivMesh, start: &Extent, digest: u64, world: DMat4) -> Option<Repeat> {
        let part = scene.parts.len() as u32;
        let original = self.0.entry(digest).or_insert_with(|| Original { part, start: start.clone(), world });
        if original.part == part {
            return None;
        }
        let transform = DAffine3::from_mat4(world * original.world.inverse());
        // Faces of one that is mirrored are turned over, so it has another digest.
        let is_same = transform.matrix3.determinant() > 0.0
            && has_topology_of(scene, start, &original.start)
            && is_moved_by(scene, start, &original.start, transform);
        is_same.then_some(Repeat { part: original.part, transform })
    }
}

/// Whether the last mesh, which begins at `start`, has faces and features of the one at `original`.
fn has_topology_of(scene: &SubdivMesh, start: &Extent, original: &Extent) -> bool {
    let [own, first] = [start.points, original.points].map(|points| points as u32);
    let crease = |crease: &Crease, points: u32| (crease.vertices.map(|v| v - points), crease.sharpness.to_bits());
    let corner = |corner: &Corner, points: u32| (corner.vertex - points, corner.sharpness.to_bits());
    let [own_faces, first_faces] = [start.faces, original.faces].map(|faces| faces as u32);
    same(&scene.face_sizes, [start.faces, original.faces], |a, b| a == b)
        && same(&scene.face_vertices, [start.face_vertices, original.face_vertices], |a, b| a - own == b - first)
        && same(&scene.creases, [start.creases, original.creases], |a, b| crease(a, own) == crease(b, first))
        && same(&scene.corners, [start.corners, original.corners], |a, b| corner(a, own) == corner(b, first))
        && same(&scene.holes, [start.holes, original.holes], |a, b| a - own_faces == b - first_faces)
}

/// Whether the items from `starts[0]` to the end are those from `starts[1]` on.
fn same<T>(items: &[T], starts: [usize; 2], is_same: impl Fn(&T, &T) -> bool) -> bool {
    items[starts[0]..].iter().zip(&items[starts[1]..]).all(|(a, b)| is_same(a, b))
}

fn is_moved_by(scene: &SubdivMesh, start: &Extent, original: &Extent, transform: DAffine3) -> bool {
    let points = &scene.points[start.points..];
    let size = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let mut pairs = points.iter().zip(&scene.points[original.points..]);
    pairs.all(|(&to, &from)| transform.transform_point3(from).distance(to) <= ROUNDING * size)
}
