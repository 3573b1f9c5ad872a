//! The regression references: OpenSubdiv's own evaluators of the limit surface.

use super::{Descriptor, EndCap, Error, FarPatch, Isolation, check, int, raw};
use crate::mesh::SubdivMesh;
use glam::DVec3;
use std::ptr::NonNull;

/// What answered a reference sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// Nothing: the face is a hole or has no limit surface.
    None,
    /// A regular patch, exact.
    Regular,
    /// An end cap (Far) or an irregular face (Bfr), approximate away from its corners.
    EndCap,
    /// The reference was not asked: OpenSubdiv 3.5.0 reads out of bounds there. That is Bfr on faces with an interior
    /// vertex of valence 2.
    NotAsked,
}

/// A reference's answer, derivatives by the (u,v) of the ptex face.
#[derive(Debug, Clone, Copy, PartialEq)]
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
}

/// An evaluator that we did not write.
pub trait Reference {
    /// Evaluates samples (ptex face, u, v), u and v 0 to 1. Fastest when samples come grouped by face.
    ///
    /// # Errors
    /// A face is out of range, or OpenSubdiv reports an error.
    fn evaluate(&mut self, samples: &[(u32, f64, f64)]) -> Result<Vec<ReferenceJet>, Error>;
}

/// Samples in the layout of the header, and room for the answers.
struct Batch {
    faces: Vec<i32>,
    uv: Vec<f64>,
    jets: Vec<[DVec3; 3]>,
    cells: Vec<f64>,
    answers: Vec<u8>,
}

impl Batch {
    fn new(samples: &[(u32, f64, f64)]) -> Self {
        Self {
            // A face that 32 bits do not hold does not exist: nor does the largest that they do.
            faces: samples.iter().map(|s| i32::try_from(s.0).unwrap_or(i32::MAX)).collect(),
            uv: samples.iter().flat_map(|s| [s.1, s.2]).collect(),
            jets: vec![[DVec3::ZERO; 3]; samples.len()],
            cells: vec![1.0; samples.len()],
            answers: vec![0; samples.len()],
        }
    }

    fn run(
        mut self,
        call: impl FnOnce(i32, *const i32, *const f64, *mut f64, *mut f64, *mut u8) -> raw::osd_status,
    ) -> Result<Vec<ReferenceJet>, Error> {
        let jets: &mut [f64] = bytemuck::cast_slice_mut(&mut self.jets);
        check(call(
            int(self.faces.len(), "number of samples")?,
            self.faces.as_ptr(),
            self.uv.as_ptr(),
            jets.as_mut_ptr(),
            self.cells.as_mut_ptr(),
            self.answers.as_mut_ptr(),
        ))?;
        Ok(self
            .jets
            .iter()
            .zip(&self.cells)
            .zip(&self.answers)
            .map(|((&[position, du, dv], &cell), &answer)| ReferenceJet {
                answer: match raw::osd_answer::from(answer) {
                    raw::OSD_ANSWER_REGULAR => Answer::Regular,
                    raw::OSD_ANSWER_END_CAP => Answer::EndCap,
                    raw::OSD_ANSWER_NOT_ASKED => Answer::NotAsked,
                    _ => Answer::None,
                },
                position,
                du,
                dv,
                cell,
            })
            .collect())
    }
}

/// Owner of a `Far::PatchTable` in double precision with Gregory end caps, and of its points.
///
/// Exact on regular patches, and at dyadic points i/2^k, k <= isolation; end caps approximate elsewhere. The options
/// are not the defaults, which are drawing approximations: infinitely sharp patches on, legacy sharp corners and single-crease patches off.
///
/// Evaluation borrows the table mutably: one evaluation at a time.
/// ```compile_fail
/// fn shared<T: Sync>() {}
/// shared::<catoptric::osd::Far>();
/// ```
/// ```compile_fail
/// use catoptric::osd::{Far, Reference};
/// fn twice(far: &Far) { far.evaluate(&[]).unwrap(); }
/// ```
#[derive(Debug)]
pub struct Far(NonNull<raw::osd_far>);

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
        let descriptor = Descriptor::new(mesh)?;
        let mut handle = std::ptr::null_mut();
        let [sharp, smooth] = [isolation.sharp, isolation.smooth].map(|level| level.min(i32::MAX as u32) as i32);
        let end_cap = match end_cap {
            EndCap::Gregory => raw::OSD_END_CAP_GREGORY,
            EndCap::BSpline => raw::OSD_END_CAP_BSPLINE,
        };
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe {
            raw::osd_far_create(&descriptor.as_raw(), descriptor.points.as_ptr(), sharp, smooth, end_cap, &mut handle)
        })?;
        Ok(Self(NonNull::new(handle).expect("a table comes with status OK")))
    }

    /// The patches and their control points, phantom points included: 16 of a bicubic B-spline, u fastest, or the 20 of a
    /// Gregory patch in the order of `Far::PatchDescriptor`.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    pub fn patches(&self) -> Result<Vec<FarPatch>, Error> {
        let sizes = self.sizes();
        let mut records = vec![raw::osd_far_patch::default(); sizes.patches as usize];
        let mut points = vec![DVec3::ZERO; sizes.control_points as usize];
        let flat: &mut [f64] = bytemuck::cast_slice_mut(&mut points);
        // SAFETY: the handle is live; the arrays are sized as it says itself.
        check(unsafe { raw::osd_far_patches(self.0.as_ptr(), records.as_mut_ptr(), flat.as_mut_ptr()) })?;
        let mut rest = points.as_slice();
        Ok(records
            .iter()
            .map(|record| FarPatch::new(record, rest.split_off(..record.points as usize).unwrap_or_default()))
            .collect())
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

impl Reference for Far {
    fn evaluate(&mut self, samples: &[(u32, f64, f64)]) -> Result<Vec<ReferenceJet>, Error> {
        // SAFETY: the handle is live and borrowed mutably; the arrays are sized by `count`.
        Batch::new(samples).run(|count, faces, uv, jets, cells, answers| unsafe {
            raw::osd_far_evaluate(self.0.as_ptr(), count, faces, uv, jets, cells, answers)
        })
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
    fn evaluate(&mut self, samples: &[(u32, f64, f64)]) -> Result<Vec<ReferenceJet>, Error> {
        // SAFETY: the handle is live and borrowed mutably; the arrays are sized by `count`.
        Batch::new(samples).run(|count, faces, uv, jets, cells, answers| unsafe {
            raw::osd_bfr_evaluate(self.0.as_ptr(), count, faces, uv, jets, cells, answers)
        })
    }
}
