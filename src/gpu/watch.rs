//! How far a picture is.

use super::frame::{self, Frame, LinearFrame, SurfaceImage};
use super::{Gpu, GpuError, Tables, View};
use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Who is told how far a picture is, and which part of it is under way.
#[derive(Clone, Copy)]
pub(super) struct Watch<'a> {
    call: Option<&'a (dyn Fn(f64) + Sync)>,
    /// Where the part under way begins and ends, of 0 to 1.
    from: f64,
    to: f64,
}

impl<'a> Watch<'a> {
    /// Nobody is told.
    pub const NOBODY: Watch<'static> = Watch { call: None, from: 0.0, to: 1.0 };

    fn of(call: &'a (dyn Fn(f64) + Sync)) -> Self {
        Self { call: Some(call), from: 0.0, to: 1.0 }
    }

    /// A part of this part.
    pub fn part(&self, from: f64, to: f64) -> Self {
        let at = |x: f64| self.from + x * (self.to - self.from);
        Self { call: self.call, from: at(from), to: at(to) }
    }

    /// Tells how much of this part is done, of 0 to 1.
    pub fn tell(&self, done: f64) {
        if let Some(call) = self.call {
            call(self.from + done * (self.to - self.from));
        }
    }

    /// Counts jobs of this part, as many as `jobs`, on any thread.
    pub fn count(&self, jobs: usize) -> impl Fn() + Sync + use<'a> {
        let (watch, done) = (*self, AtomicUsize::new(0));
        move || watch.tell((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / jobs.max(1) as f64)
    }
}

/// An adapter that tells how far its pictures are: [`Gpu::watched`].
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    gpu: &'a Gpu,
    watch: Watch<'a>,
}

impl fmt::Debug for Watched<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watched").field("gpu", self.gpu).finish_non_exhaustive()
    }
}

impl Gpu {
    /// The calls that draw, which tell `call` how much of the picture is done: from 0 to 1, growing but for small steps back where threads
    /// overtake one another, from any thread, and so often that it should be quick. 1 comes last.
    pub fn watched<'a>(&'a self, call: &'a (dyn Fn(f64) + Sync)) -> Watched<'a> {
        Watched { gpu: self, watch: Watch::of(call) }
    }
}

impl Watched<'_> {
    /// As [`Gpu::render`].
    ///
    /// # Errors
    /// As there.
    pub fn render(&self, tables: &Tables, view: &View) -> Result<Frame, GpuError> {
        frame::render(&self.gpu.device, self.gpu.passes(tables), tables, view, self.watch)
    }

    /// As [`Gpu::render_linear`].
    ///
    /// # Errors
    /// As there.
    pub fn render_linear(&self, tables: &Tables, view: &View) -> Result<LinearFrame, GpuError> {
        frame::render_linear(&self.gpu.device, self.gpu.passes(tables), tables, view, self.watch)
    }

    /// As [`Gpu::inspect`].
    ///
    /// # Errors
    /// As there.
    pub fn inspect(&self, tables: &Tables, view: &View) -> Result<SurfaceImage, GpuError> {
        frame::inspect(&self.gpu.device, self.gpu.passes(tables), tables, view, self.watch)
    }
}
