//! The regression references: OpenSubdiv's own evaluators of the limit surface.

use super::{Descriptor, EndCap, Error, FarOptions, FarPatch, Isolation, check, int, raw};
use crate::mesh::SubdivMesh;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ptr::NonNull;

/// What answered a reference sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer {
    /// Nothing: the face is a hole or has no limit surface.
    None,
    /// A regular patch, exact.
    Regular,
    /// An end cap (Far) or an irregular face (Bfr), approximate away from its corners.
    EndCap,
    /// The reference was not asked: OpenSubdiv (3.5.0 to 3.6.0) reads out of bounds there. That is Bfr on faces with an interior
    /// vertex of valence 2.
    NotAsked,
}

/// A reference's answer, derivatives by the (u,v) of the ptex face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReferenceJet {
    /// What answered; the other fields are zero for [`Answer::None`] and [`Answer::NotAsked`].
    pub answer: Answer,
    /// Position.
    pub position: DVec3,
    /// Derivative by u.
    pub du: DVec3,
    /// Derivative by v.
    pub dv: DVec3,
    /// Side of the patch that answered, in parameters of the ptex face: OpenSubdiv differentiates in units of it, so
    /// rounding of its points shows 1/cell times as large in the derivatives.
    pub cell: f64,
    /// Control points that the answer is one sum of, each adding its rounding: those of a limit stencil. 0 where it was
    /// refined level by level.
    pub terms: u32,
}

/// An evaluator that we did not write.
pub trait Reference {
    /// Evaluates samples (ptex face, u, v), u and v 0 to 1. Fastest when samples come grouped by face.
    ///
    /// # Errors
    /// A face is out of range, or OpenSubdiv reports an error.
    fn evaluate(&mut self, samples: &[Location]) -> Result<Vec<ReferenceJet>, Error>;
}

/// A sample: ptex face, u and v.
pub type Location = (u32, f64, f64);

/// Samples in the layout of the header, and room for the answers.
pub(super) struct Batch {
    pub faces: Vec<i32>,
    pub uv: Vec<f64>,
    jets: Vec<[DVec3; 3]>,
    pub cells: Vec<f64>,
    pub answers: Vec<u8>,
    pub terms: Vec<i32>,
}

impl Batch {
    pub fn new(samples: &[Location]) -> Self {
        Self {
            // A face that 32 bits do not hold does not exist: nor does the largest that they do.
            faces: samples.iter().map(|s| i32::try_from(s.0).unwrap_or(i32::MAX)).collect(),
            uv: samples.iter().flat_map(|s| [s.1, s.2]).collect(),
            jets: vec![[DVec3::ZERO; 3]; samples.len()],
            cells: vec![1.0; samples.len()],
            answers: vec![0; samples.len()],
            terms: vec![0; samples.len()],
        }
    }

    /// Calls an evaluator of the header with the number of samples, these arrays, and one for the jets.
    pub fn run(
        mut self,
        call: impl FnOnce(i32, &mut Self, *mut f64) -> raw::osd_status,
    ) -> Result<Vec<ReferenceJet>, Error> {
        let mut jets = std::mem::take(&mut self.jets);
        let count = int(self.faces.len(), "number of samples")?;
        check(call(count, &mut self, bytemuck::cast_slice_mut::<_, f64>(&mut jets).as_mut_ptr()))?;
        let jet = |(i, [position, du, dv]): (usize, [DVec3; 3])| ReferenceJet {
            answer: answer(self.answers[i]),
            position,
            du,
            dv,
            cell: self.cells[i],
            terms: self.terms[i] as u32,
        };
        Ok(jets.into_iter().enumerate().map(jet).collect())
    }
}

pub(super) fn answer(raw: u8) -> Answer {
    match raw::osd_answer::from(raw) {
        raw::OSD_ANSWER_REGULAR => Answer::Regular,
        raw::OSD_ANSWER_END_CAP => Answer::EndCap,
        raw::OSD_ANSWER_NOT_ASKED => Answer::NotAsked,
        _ => Answer::None,
    }
}

/// Samples that one call evaluates: a fraction of a millisecond of work.
const CHUNK: usize = 1024;

/// Owner of a `Far::PatchTable` in double precision with Gregory end caps, and of its points.
///
/// Exact on regular patches, and at dyadic points i/2^k, k <= isolation; end caps approximate elsewhere. The options
/// are not the defaults, which are drawing approximations: infinitely sharp patches on, legacy sharp corners and single-crease patches off.
///
/// Any number of threads may evaluate at a time.
#[derive(Debug)]
pub struct Far(NonNull<raw::osd_far>);

// SAFETY: nothing in the object belongs to a thread, and osd_far_evaluate and osd_far_measure only read it: they call const
// members of `Far::PatchTable` and `Far::PatchMap`, which have no mutable fields, and write to the caller's arrays and their
// own stack. Errors are thread-local.
unsafe impl Send for Far {}
// SAFETY: as above.
unsafe impl Sync for Far {}

impl Drop for Far {
    fn drop(&mut self) {
        // SAFETY: the handle came from osd_far_create and is released here alone.
        unsafe { raw::osd_far_destroy(self.0.as_ptr()) }
    }
}

impl Far {
    /// Refines to `isolation` (1..=10) and builds the table.
    ///
    /// # Errors
    /// The mesh is not valid, `isolation` is out of range, or OpenSubdiv reports an error.
    pub fn new(mesh: &SubdivMesh, isolation: u32) -> Result<Self, Error> {
        Self::with(mesh, Isolation::uniform(isolation), EndCap::Gregory)
    }

    /// The same with another isolation of smooth features, and other end caps.
    ///
    /// # Errors
    /// As [`Far::new`].
    pub fn with(mesh: &SubdivMesh, isolation: Isolation, end_cap: EndCap) -> Result<Self, Error> {
        Self::with_options(mesh, FarOptions::exact(isolation, end_cap))
    }

    /// The same by other options, with which the table is not exact on creases and at corners.
    ///
    /// # Errors
    /// As [`Far::new`].
    pub fn with_options(mesh: &SubdivMesh, options: FarOptions) -> Result<Self, Error> {
        let FarOptions { isolation, end_cap, smoothed_creases, legacy_corners, single_crease } = options;
        let flags = [
            (smoothed_creases, raw::OSD_FAR_SMOOTHED_CREASES),
            (legacy_corners, raw::OSD_FAR_LEGACY_CORNERS),
            (single_crease, raw::OSD_FAR_SINGLE_CREASE),
        ];
        let flags: raw::osd_far_option = flags.iter().map(|&(on, bit)| if on { bit } else { 0 }).sum();
        let descriptor = Descriptor::new(mesh)?;
        let mut handle = std::ptr::null_mut();
        let [sharp, smooth] = [isolation.sharp, isolation.smooth].map(|level| level.min(i32::MAX as u32) as i32);
        let end_cap = match end_cap {
            EndCap::Gregory => raw::OSD_END_CAP_GREGORY,
            EndCap::BSpline => raw::OSD_END_CAP_BSPLINE,
            EndCap::Bilinear => raw::OSD_END_CAP_BILINEAR,
        };
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe {
            let points = descriptor.points.as_ptr();
            raw::osd_far_create(&descriptor.as_raw(), points, sharp, smooth, end_cap, flags as i32, &mut handle)
        })?;
        Ok(Self(NonNull::new(handle).expect("a table comes with status OK")))
    }

    /// The patches and their control points, phantom points included: 16 of a bicubic B-spline, u fastest, or the 20 of a
    /// Gregory patch in the order of `Far::PatchDescriptor`.
    ///
    /// # Errors
    /// The scheme is Loop's, or OpenSubdiv reports an error.
    pub fn patches(&self) -> Result<Vec<FarPatch>, Error> {
        let sizes = self.sizes();
        let mut records = vec![raw::osd_far_patch::default(); sizes.patches as usize];
        let mut points = vec![DVec3::ZERO; sizes.control_points as usize];
        let flat: &mut [f64] = bytemuck::cast_slice_mut(&mut points);
        // SAFETY: the handle is live; the arrays are sized as it says itself.
        check(unsafe { raw::osd_far_patches(self.0.as_ptr(), records.as_mut_ptr(), flat.as_mut_ptr()) })?;
        if records.iter().any(|record| ![4, 16, 20].contains(&record.points)) {
            return Err(Error::OpenSubdiv("patches of triangles (the scheme loop) are not read".to_owned()));
        }
        let mut rest = points.as_slice();
        Ok(records
            .iter()
            .map(|record| FarPatch::new(record, rest.split_off(..record.points as usize).unwrap_or_default()))
            .collect())
    }

    /// Evaluates samples (ptex face, u, v), u and v 0 to 1, on all threads. A face that does not exist has no answer.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    pub fn evaluate(&self, samples: &[Location]) -> Result<Vec<ReferenceJet>, Error> {
        let chunk = |samples: &[Location]| {
            Batch::new(samples).run(|count, batch, jets| {
                let Batch { faces, uv, cells, answers, .. } = batch;
                let (cells, answers) = (cells.as_mut_ptr(), answers.as_mut_ptr());
                // SAFETY: the handle is live, calls may overlap, and the arrays are sized by `count`.
                unsafe {
                    raw::osd_far_evaluate(self.0.as_ptr(), count, faces.as_ptr(), uv.as_ptr(), jets, cells, answers)
                }
            })
        };
        let chunks: Vec<_> = samples.par_chunks(CHUNK).map(chunk).collect::<Result<_, _>>()?;
        Ok(chunks.concat())
    }

    fn sizes(&self) -> raw::osd_far_sizes {
        let mut sizes = raw::osd_far_sizes::default();
        // SAFETY: the handle is live and the output is a local.
        check(unsafe { raw::osd_far_measure(self.0.as_ptr(), &mut sizes) }).expect("a table can be measured");
        sizes
    }

    /// Number of patches, end caps included.
    pub fn patch_count(&self) -> u64 {
        self.sizes().patches as u64
    }

    /// Bytes of the table: control vertex indices (4 a point of a patch), patch parameters (8 a patch) and its points,
    /// refined ones and those of end caps, in f64 (24 each). Without the stencils that make the points.
    pub fn bytes(&self) -> u64 {
        self.sizes().bytes as u64
    }
}

/// Owner of a `Bfr::RefinerSurfaceFactory` in double precision.
///
/// The factory's cache is not thread-safe: one thread, one evaluation at a time.
/// ```compile_fail
/// fn shared<T: Sync>() {}
/// shared::<catoptric::osd::Bfr>();
/// ```
/// ```compile_fail
/// fn sent<T: Send>() {}
/// sent::<catoptric::osd::Bfr>();
/// ```
#[derive(Debug)]
pub struct Bfr(NonNull<raw::osd_bfr>);

impl Drop for Bfr {
    fn drop(&mut self) {
        // SAFETY: the handle came from osd_bfr_create and is released here alone.
        unsafe { raw::osd_bfr_destroy(self.0.as_ptr()) }
    }
}

impl Bfr {
    /// OpenSubdiv's default approximation levels for smooth and sharp features.
    pub const DEFAULT_LEVELS: (u32, u32) = (2, 6);

    /// A factory with the given approximation levels (smooth, sharp), each 1..=10.
    ///
    /// # Errors
    /// The mesh is not valid, a level is out of range, or OpenSubdiv reports an error.
    pub fn new(mesh: &SubdivMesh, levels: (u32, u32)) -> Result<Self, Error> {
        let descriptor = Descriptor::new(mesh)?;
        let mut handle = std::ptr::null_mut();
        let [smooth, sharp] = [levels.0, levels.1].map(|level| level.min(i32::MAX as u32) as i32);
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe {
            raw::osd_bfr_create(&descriptor.as_raw(), descriptor.points.as_ptr(), smooth, sharp, &mut handle)
        })?;
        Ok(Self(NonNull::new(handle).expect("a factory comes with status OK")))
    }
}

impl Reference for Bfr {
    fn evaluate(&mut self, samples: &[Location]) -> Result<Vec<ReferenceJet>, Error> {
        Batch::new(samples).run(|count, batch, jets| {
            let Batch { faces, uv, cells, answers, .. } = batch;
            let (cells, answers) = (cells.as_mut_ptr(), answers.as_mut_ptr());
            // SAFETY: the handle is live and borrowed mutably; the arrays are sized by `count`.
            unsafe { raw::osd_bfr_evaluate(self.0.as_ptr(), count, faces.as_ptr(), uv.as_ptr(), jets, cells, answers) }
        })
    }
}
