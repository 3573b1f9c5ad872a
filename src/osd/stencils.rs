//! Limit stencils, the main reference.

use super::reference::{Answer, Batch, Location, ReferenceJet, answer};
use super::{Descriptor, Error, check, raw};
use crate::mesh::SubdivMesh;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ptr::NonNull;

/// Owner of a control mesh that `Far::LimitStencilTable`s in double precision are made for, with the options of
/// [`Far`](super::Far).
///
/// A limit stencil says a point of the limit as a weighted sum of control points. It is exact where `Far` is: regular
/// patches, and dyadic points. Every call refines the faces that it asks about and forgets them again. Any number of threads
/// may call.
#[derive(Debug)]
pub struct LimitStencils {
    handle: NonNull<raw::osd_stencils>,
    points: Vec<DVec3>,
}

/// One point of the limit as a sum of control points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stencil {
    /// What kind of patch it comes from.
    pub answer: Answer,
    /// Control points, by index.
    pub vertices: Vec<u32>,
    /// Weight of each in the position, and in the derivatives by u and v.
    pub weights: Vec<[f64; 3]>,
}

// SAFETY: nothing in the object belongs to a thread, and both calls only read it: each refines a copy of the base level, which
// `TopologyRefiner`s share as const and OpenSubdiv documents as such, and all else that it makes is its own. Errors are
// thread-local.
unsafe impl Send for LimitStencils {}
// SAFETY: as above.
unsafe impl Sync for LimitStencils {}

impl Drop for LimitStencils {
    fn drop(&mut self) {
        // SAFETY: the handle came from osd_stencils_create and is released here alone.
        unsafe { raw::osd_stencils_destroy(self.handle.as_ptr()) }
    }
}

/// Control faces that are refined at a time. With the stencils of their refined points a face takes up to a megabyte (a mesh
/// full of semi-sharp creases); with fewer faces the rings round them weigh more.
const FACES: usize = 256;

/// Samples of a call, 1 to 2 kB each.
const SAMPLES: usize = 1 << 15;

impl LimitStencils {
    /// Keeps a mesh; stencils will be isolated to `isolation` (1..=10).
    ///
    /// # Errors
    /// The mesh is not valid, `isolation` is out of range, or OpenSubdiv reports an error.
    pub fn new(mesh: &SubdivMesh, isolation: u32) -> Result<Self, Error> {
        let descriptor = Descriptor::new(mesh)?;
        let mut handle = std::ptr::null_mut();
        let isolation = isolation.min(i32::MAX as u32) as i32;
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe { raw::osd_stencils_create(&descriptor.as_raw(), isolation, &mut handle) })?;
        Ok(Self { handle: NonNull::new(handle).expect("an object comes with status OK"), points: mesh.points.clone() })
    }

    /// Evaluates samples (ptex face, u, v), u and v 0 to 1, grouped by face, on all threads.
    ///
    /// # Errors
    /// A face is out of range, or OpenSubdiv reports an error.
    pub fn evaluate(&self, samples: &[Location]) -> Result<Vec<ReferenceJet>, Error> {
        let call = |samples: &[Location]| {
            Batch::new(samples).run(|count, batch, jets| {
                let Batch { faces, uv, cells, answers, terms, .. } = batch;
                let points = bytemuck::cast_slice::<_, f64>(&self.points).as_ptr();
                let (cells, answers, terms) = (cells.as_mut_ptr(), answers.as_mut_ptr(), terms.as_mut_ptr());
                let (faces, uv) = (faces.as_ptr(), uv.as_ptr());
                // SAFETY: the handle is live, calls may overlap, there is a point for each vertex of its mesh, and the
                // arrays are sized by `count`.
                unsafe {
                    let handle = self.handle.as_ptr();
                    raw::osd_stencils_evaluate(handle, points, count, faces, uv, jets, cells, answers, terms)
                }
            })
        };
        let chunks: Vec<_> = portions(samples).into_par_iter().map(call).collect::<Result<_, _>>()?;
        Ok(chunks.concat())
    }

    /// The stencil of a sample (ptex face, u, v), u and v 0 to 1; without points in a hole.
    ///
    /// # Errors
    /// The face is out of range, or OpenSubdiv reports an error.
    pub fn stencil(&self, sample: Location) -> Result<Stencil, Error> {
        let Batch { faces, uv, .. } = Batch::new(&[sample]);
        let capacity = self.points.len();
        let (mut vertices, mut weights) = (vec![0; capacity], vec![[0.0; 3]; capacity]);
        let (mut size, mut kind) = (0, 0);
        // SAFETY: the handle is live; the arrays hold one sample and `capacity` control points.
        check(unsafe {
            raw::osd_stencils_weights(
                self.handle.as_ptr(),
                faces[0],
                uv.as_ptr(),
                capacity as i32,
                &mut size,
                vertices.as_mut_ptr(),
                weights.as_flattened_mut().as_mut_ptr(),
                &mut kind,
            )
        })?;
        let size = size as usize;
        Ok(Stencil {
            answer: answer(kind),
            vertices: vertices.into_iter().take(size).map(|vertex: i32| vertex as u32).collect(),
            weights: weights.into_iter().take(size).collect(),
        })
    }
}

/// Cuts samples where faces change, so that no portion has too many faces or samples.
fn portions(samples: &[Location]) -> Vec<&[Location]> {
    let mut portions: Vec<&[Location]> = Vec::new();
    let (mut first, mut end, mut faces) = (0, 0, 0);
    for face in samples.chunk_by(|a, b| a.0 == b.0) {
        if faces == FACES || end - first + face.len() > SAMPLES && end > first {
            portions.push(&samples[first..end]);
            (first, faces) = (end, 0);
        }
        end += face.len();
        faces += 1;
    }
    if end > first {
        portions.push(&samples[first..end]);
    }
    portions
}
