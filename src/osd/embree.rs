//! Embree 3.13, a peer of benchmarks (cargo feature `peers`).

use super::{Descriptor, Error, check, int, raw};
use crate::mesh::{Creasing, Scheme, SubdivMesh, TriangleRule};
use std::ptr::NonNull;

/// Samples that go to Embree at a time.
const BATCH: usize = raw::EMB_BATCH as usize;

/// Edges of a face, and faces of a vertex, up to which Embree evaluates: beyond them it aborts (`MAX_PATCH_VALENCE`, `MAX_RING_FACE_VALENCE`).
const MOST_EDGES: u32 = 15;
const MOST_FACES: usize = 64;

/// Samples of a subdivision mesh as Embree takes them.
#[derive(Debug, Clone, Default)]
pub struct EmbreeSamples {
    faces: Vec<u32>,
    u: Vec<f32>,
    v: Vec<f32>,
    /// Control faces of the mesh.
    of: usize,
}

impl EmbreeSamples {
    /// Samples (ptex face, u, v): quadrant k of an n-gon is encoded in the whole parts of half its u and v, four a row.
    ///
    /// # Panics
    /// A ptex face is out of range.
    pub fn new(mesh: &SubdivMesh, samples: &[(u32, f32, f32)]) -> Self {
        let ptex: Vec<(u32, Option<u32>)> =
            (0..).zip(&mesh.face_sizes).flat_map(|(face, &size)| of_face(face, size)).collect();
        let mut out = Self { of: mesh.face_count(), ..Self::default() };
        for &(at, u, v) in samples {
            let (face, quadrant) = ptex[at as usize];
            let encoded = |cell: u32, t: f32| 2.0 * cell as f32 + 0.5 + t;
            out.faces.push(face);
            out.u.push(quadrant.map_or(u, |k| encoded(k % 4, u)));
            out.v.push(quadrant.map_or(v, |k| encoded(k / 4, v)));
        }
        out
    }

    /// Numbers that the results take: position, du and dv of each sample, in whole batches.
    pub fn room(&self) -> usize {
        9 * self.faces.len().next_multiple_of(BATCH)
    }

    /// Position, du and dv of one sample among the results.
    ///
    /// # Panics
    /// There is no such sample.
    pub fn jet(&self, results: &[f32], sample: usize) -> [[f32; 3]; 3] {
        let first = sample - sample % BATCH;
        // The last batch has as many of each as there are left.
        let stride = BATCH.min(self.faces.len() - first);
        let number = |k: usize| results[9 * first + k * stride + sample % BATCH];
        [0, 3, 6].map(|k| [number(k), number(k + 1), number(k + 2)])
    }
}

fn of_face(face: u32, size: u32) -> impl Iterator<Item = (u32, Option<u32>)> {
    let parts = if size == 4 { 1 } else { size };
    (0..parts).map(move |k| (face, (size != 4).then_some(k)))
}

/// A subdivision mesh of Embree's.
#[derive(Debug)]
pub struct EmbreeSubdivision {
    handle: NonNull<raw::emb_subdivision>,
    faces: usize,
}

impl Drop for EmbreeSubdivision {
    fn drop(&mut self) {
        // SAFETY: the handle came from emb_subdivision_create and is released here alone.
        unsafe { raw::emb_subdivision_destroy(self.handle.as_ptr()) }
    }
}

impl EmbreeSubdivision {
    /// Whether Embree knows all of the mesh's rules, and has room for its faces and vertices.
    pub fn takes(mesh: &SubdivMesh) -> bool {
        let mut faces = vec![0usize; mesh.points.len()];
        mesh.face_vertices.iter().for_each(|&vertex| faces[vertex as usize] += 1);
        let fits = mesh.face_sizes.iter().all(|&size| size <= MOST_EDGES) && faces.iter().all(|&n| n <= MOST_FACES);
        fits && mesh.scheme == Scheme::CatmullClark
            && mesh.creasing == Creasing::Uniform
            && mesh.triangles == TriangleRule::CatmullClark
    }

    /// Hands the mesh to Embree.
    ///
    /// # Errors
    /// The mesh is not valid, Embree does not take it, or reports an error.
    pub fn new(mesh: &SubdivMesh) -> Result<Self, Error> {
        let descriptor = Descriptor::new(mesh)?;
        if !Self::takes(mesh) {
            let refusal =
                format!("Embree takes faces of {MOST_EDGES} edges, vertices of {MOST_FACES} faces, uniform creases");
            return Err(Error::OpenSubdiv(refusal));
        }
        let mut handle = std::ptr::null_mut();
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe { raw::emb_subdivision_create(&descriptor.as_raw(), descriptor.points.as_ptr(), &mut handle) })?;
        Ok(Self { handle: NonNull::new(handle).expect("a mesh comes with status OK"), faces: mesh.face_count() })
    }

    /// Position, du and dv, by `rtcInterpolateN` for 256 samples at a time: x of all of them, then y, z, and those of du and dv.
    ///
    /// # Errors
    /// Embree reports an error.
    ///
    /// # Panics
    /// `out` has less than [`EmbreeSamples::room`], or the samples are of a mesh with more faces.
    pub fn evaluate(&self, samples: &EmbreeSamples, out: &mut [f32]) -> Result<(), Error> {
        assert!(out.len() >= samples.room(), "room for all results");
        assert!(samples.of <= self.faces, "faces are in range");
        let count = int(samples.faces.len(), "number of samples")?;
        let (faces, u, v) = (samples.faces.as_ptr(), samples.u.as_ptr(), samples.v.as_ptr());
        // SAFETY: the handle is live; the arrays are sized by `count` and `out` holds whole batches; faces are in range.
        check(unsafe { raw::emb_subdivision_evaluate(self.handle.as_ptr(), count, faces, u, v, out.as_mut_ptr()) })
    }
}

/// Where rays of a picture start, and where they go: from the eye through `first + x right + y down`.
pub type EmbreeCamera = raw::emb_camera;

/// Triangles in Embree's bounding volume hierarchy.
#[derive(Debug)]
pub struct EmbreeTriangles(NonNull<raw::emb_triangles>);

impl Drop for EmbreeTriangles {
    fn drop(&mut self) {
        // SAFETY: the handle came from emb_triangles_create and is released here alone.
        unsafe { raw::emb_triangles_destroy(self.0.as_ptr()) }
    }
}

impl EmbreeTriangles {
    /// Builds the hierarchy on so many threads.
    ///
    /// # Errors
    /// Embree reports an error.
    ///
    /// # Panics
    /// An index is out of range.
    pub fn new(points: &[[f32; 3]], triangles: &[[u32; 3]], threads: u32) -> Result<Self, Error> {
        assert!(triangles.as_flattened().iter().all(|&i| (i as usize) < points.len()), "indices are in range");
        let (count, triangle_count) =
            (int(points.len(), "number of points")?, int(triangles.len(), "number of triangles")?);
        let (points, indices) = (points.as_ptr().cast(), triangles.as_ptr().cast());
        let mut handle = std::ptr::null_mut();
        // SAFETY: the arrays are sized by their counts, indices are in range, and the call copies them.
        check(unsafe {
            raw::emb_triangles_create(count, points, triangle_count, indices, threads as i32, &mut handle)
        })?;
        Ok(Self(NonNull::new(handle).expect("triangles come with status OK")))
    }

    /// A ray a pixel; `depths` has one a pixel, infinite where nothing is hit. Number of rays that hit.
    ///
    /// # Errors
    /// Embree reports an error.
    ///
    /// # Panics
    /// There are not as many depths as pixels.
    pub fn trace(&self, camera: &EmbreeCamera, threads: u32, depths: &mut [f32]) -> Result<u64, Error> {
        assert_eq!(depths.len(), (camera.width.max(0) as usize) * (camera.height.max(0) as usize), "one depth a pixel");
        let mut hits = 0;
        // SAFETY: the handle is live, and `depths` has a number a pixel.
        check(unsafe {
            raw::emb_triangles_trace(self.0.as_ptr(), camera, threads as i32, depths.as_mut_ptr(), &mut hits)
        })?;
        Ok(hits as u64)
    }
}
