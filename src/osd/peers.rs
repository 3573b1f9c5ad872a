//! Peers of benchmarks: OpenSubdiv's evaluators as their users have them, prepared once and fast.
//!
//! [`Bfr`](super::Bfr) and [`Far`](super::Far) are references: they check, and tell what answered. These do what is timed and no more.

use super::{Descriptor, Error, check, int, raw};
use crate::mesh::SubdivMesh;
use std::ptr::NonNull;

/// Samples in the layout of the header: ptex faces in range, and (u,v), each 0 to 1.
#[derive(Debug, Clone, Default)]
pub struct PeerSamples<T> {
    faces: Vec<i32>,
    uv: Vec<[T; 2]>,
    ptex_count: usize,
}

impl<T: Copy> PeerSamples<T> {
    /// Copies samples (ptex face, u, v) of a mesh with so many ptex faces.
    ///
    /// # Panics
    /// A face is out of range.
    pub fn new(samples: &[(u32, T, T)], ptex_count: usize) -> Self {
        assert!(samples.iter().all(|sample| (sample.0 as usize) < ptex_count), "ptex faces are in range");
        Self {
            faces: samples.iter().map(|sample| sample.0 as i32).collect(),
            uv: samples.iter().map(|sample| [sample.1, sample.2]).collect(),
            ptex_count,
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.faces.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }
}

mod sealed {
    pub trait Precision: Copy {
        const IN_DOUBLE: i32;
    }
    impl Precision for f32 {
        const IN_DOUBLE: i32 = 0;
    }
    impl Precision for f64 {
        const IN_DOUBLE: i32 = 1;
    }
}

/// Bfr's surfaces of all faces with their patch points, in `f32` or `f64`.
#[derive(Debug)]
pub struct BfrPeer<T: sealed::Precision> {
    handle: NonNull<raw::osd_bfr_peer>,
    ptex_count: usize,
    number: std::marker::PhantomData<T>,
}

impl<T: sealed::Precision> Drop for BfrPeer<T> {
    fn drop(&mut self) {
        // SAFETY: the handle came from osd_bfr_peer_create and is released here alone.
        unsafe { raw::osd_bfr_peer_destroy(self.handle.as_ptr()) }
    }
}

impl<T: sealed::Precision> BfrPeer<T> {
    /// Makes the surfaces with approximation levels (smooth, sharp), each 1..=10.
    ///
    /// # Errors
    /// The mesh is not valid, a level is out of range, or OpenSubdiv reports an error.
    pub fn new(mesh: &SubdivMesh, levels: (u32, u32)) -> Result<Self, Error> {
        let descriptor = Descriptor::new(mesh)?;
        let [smooth, sharp] = [levels.0, levels.1].map(|level| level.min(i32::MAX as u32) as i32);
        let (points, mut handle) = (descriptor.points.as_ptr(), std::ptr::null_mut());
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe {
            raw::osd_bfr_peer_create(&descriptor.as_raw(), points, smooth, sharp, T::IN_DOUBLE, &mut handle)
        })?;
        let handle = NonNull::new(handle).expect("a peer comes with status OK");
        Ok(Self { handle, ptex_count: mesh.ptex_count(), number: std::marker::PhantomData })
    }

    /// Position, du and dv of each sample, by the parameters of the ptex face; zero where Bfr must not be asked.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    ///
    /// # Panics
    /// The samples are of a mesh with more ptex faces, or there are not as many jets as samples.
    pub fn evaluate(&self, samples: &PeerSamples<T>, jets: &mut [[[T; 3]; 3]]) -> Result<(), Error> {
        assert_eq!(samples.len(), jets.len(), "one jet a sample");
        assert!(samples.ptex_count <= self.ptex_count, "ptex faces are in range");
        let count = int(samples.len(), "number of samples")?;
        let (faces, uv) = (samples.faces.as_ptr(), samples.uv.as_ptr());
        // SAFETY: the handle is live; the arrays are sized by `count` and of the peer's number type; faces are in range.
        check(unsafe {
            raw::osd_bfr_peer_evaluate(self.handle.as_ptr(), count, faces, uv.cast(), jets.as_mut_ptr().cast())
        })
    }
}

/// `Osd::CpuEvaluator`, in `f32`, over a patch table with Gregory end caps and the stencils that make its points.
#[derive(Debug)]
pub struct OsdPeer {
    handle: NonNull<raw::osd_cpu>,
    vertices: usize,
}

impl Drop for OsdPeer {
    fn drop(&mut self) {
        // SAFETY: the handle came from osd_cpu_create and is released here alone.
        unsafe { raw::osd_cpu_destroy(self.handle.as_ptr()) }
    }
}

impl OsdPeer {
    /// Refines everything to `isolation`, 1..=10, and makes tables of patches and stencils.
    ///
    /// # Errors
    /// The mesh is not valid, the level is out of range, or OpenSubdiv reports an error.
    pub fn new(mesh: &SubdivMesh, isolation: u32) -> Result<Self, Error> {
        let descriptor = Descriptor::new(mesh)?;
        let level = isolation.min(i32::MAX as u32) as i32;
        let mut handle = std::ptr::null_mut();
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe { raw::osd_cpu_create(&descriptor.as_raw(), descriptor.points.as_ptr(), level, &mut handle) })?;
        let handle = NonNull::new(handle).expect("a peer comes with status OK");
        Ok(Self { handle, vertices: mesh.points.len() })
    }

    /// Applies the stencils to control points that moved.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    ///
    /// # Panics
    /// `points` is not one point for each control vertex.
    pub fn update(&mut self, points: &[[f32; 3]]) -> Result<(), Error> {
        assert_eq!(points.len(), self.vertices, "one point a control vertex");
        // SAFETY: the handle is live and borrowed mutably; the array holds the control points.
        check(unsafe { raw::osd_cpu_update(self.handle.as_ptr(), points.as_ptr().cast()) })
    }

    /// Finds the patches of samples, which replace those of before; samples in holes are left out. How many have patches.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    pub fn place(&mut self, samples: &PeerSamples<f32>) -> Result<usize, Error> {
        let count = int(samples.len(), "number of samples")?;
        let (faces, uv) = (samples.faces.as_ptr(), samples.uv.as_ptr().cast());
        // SAFETY: the handle is live and borrowed mutably; the arrays are sized by `count`. Faces beyond its own have no patch in
        // Far::PatchMap, which checks.
        check(unsafe { raw::osd_cpu_place(self.handle.as_ptr(), count, faces, uv) })?;
        self.placed()
    }

    fn placed(&self) -> Result<usize, Error> {
        let mut placed = 0;
        // SAFETY: the handle is live and the output is a local.
        check(unsafe { raw::osd_cpu_placed(self.handle.as_ptr(), &mut placed) })?;
        Ok(placed as usize)
    }

    /// Position, du and dv of the samples that were placed; derivatives in quadrants of n-gons come twice as long.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    ///
    /// # Panics
    /// There are fewer jets than samples were placed.
    pub fn evaluate(&self, jets: &mut [[[f32; 3]; 3]]) -> Result<(), Error> {
        assert!(self.placed()? <= jets.len(), "one jet a sample");
        // SAFETY: the handle is live; the array has room for all samples that were placed.
        check(unsafe { raw::osd_cpu_evaluate(self.handle.as_ptr(), jets.as_mut_ptr().cast()) })
    }
}
