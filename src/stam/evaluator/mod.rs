//! The exact limit, many samples at a time: the fast evaluator for processors.
//!
//! # Theory
//! A regular patch is a bicubic polynomial; an irregular one is three of them on each level of its Stam table (docs/LIMIT.md, section 4).
//! What [`LimitSurface::evaluate`] looks up and sums for every sample is done here once a patch: its control points become
//! coefficients, in f64, of polynomials in the parameters of the ptex face. A sample is then one polynomial by Horner's rule, and
//! samples on the same polynomial share its coefficients, one in each lane of a vector.
//!
//! # Changes
//! Against batches over B-spline nets, as OpenSubdiv's and Embree's: coefficients of derivatives are differences taken in f64 and then
//! rounded, not differences of rounded points, so normals in f32 are as good far from the origin as near it. Nothing is
//! approximated near extraordinary vertices: samples beyond the stored levels (1/256 of an irregular patch) go to the reference.

mod batch;
mod columns;
mod normal;
mod pieces;
mod polynomial;
mod samples;

pub use columns::{Column, Columns, Results, Wanted};
pub use pieces::PIECE_LEVELS;
pub use samples::Samples;

use super::real::{Real, vectorized};
use super::{Jet2, LimitSurface};
use crate::memory::{self, TooMuch};
use batch::{Batch, Ordered};
use glam::DVec3;
use pieces::Plan;
use polynomial::{Piece, single};
use pulp::{Simd, WithSimd};
use samples::Place;
use std::ops::Range;
use std::sync::Arc;

/// Samples that one thread takes at a time.
const JOB: usize = 4096;

/// Evaluates a limit surface in `f32` or `f64`. Clones share what does not depend on control points.
///
/// [`Evaluator::new`] from a surface; [`Evaluator::place`] finds and groups samples once; [`Evaluator::evaluate`] writes into
/// [`Columns`] as often as control points move ([`Evaluator::update`]). For a few samples here and there: [`Evaluator::at`] and
/// [`Evaluator::each`]. The widest vectors of the processor are found when the program runs (AVX-512, AVX2, SSE2).
///
/// ```
/// use catoptric::stam::{Evaluator, LimitSurface, Results, Wanted};
/// let mesh = catoptric::mesh::sample();
/// let surface = LimitSurface::new(&mesh)?;
/// let evaluator = Evaluator::<f32>::new(&surface)?;
/// let samples = evaluator.place(&[(0, 0.25, 0.5), (3, 0.5, 0.125)]);
/// let mut results = Results::new(Wanted { first: true, ..Wanted::default() }, samples.len());
/// evaluator.evaluate(&samples, results.columns());
/// let place = results.position(0); // of the sample numbered samples.order()[0]
/// # assert!(place.iter().all(|x| x.is_finite()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Evaluator<T> {
    surface: LimitSurface,
    plan: Arc<Plan>,
    pieces: Vec<Piece<T>>,
}

impl<T: Real> Evaluator<T> {
    /// Computes the polynomials of all patches: 192 bytes in `f32` a regular patch, 2.3 kB an irregular one; twice that in `f64`.
    /// Triangles (Loop's scheme) and patches at vertices of more than 16 faces have none: they take the reference's time, a
    /// microsecond a sample.
    ///
    /// # Errors
    /// They take more memory than the process may have.
    pub fn new(surface: &LimitSurface) -> Result<Self, TooMuch> {
        let plan = Plan::new(surface);
        let bytes = plan.count() * size_of::<Piece<T>>();
        memory::check(surface.bytes() + bytes as u64)?;
        let mut pieces = vec![Piece::default(); plan.count()];
        plan.fill(surface, &mut pieces);
        Ok(Self { surface: surface.clone(), plan: Arc::new(plan), pieces })
    }

    /// The surface that is evaluated.
    pub fn surface(&self) -> &LimitSurface {
        &self.surface
    }

    /// Bytes of the polynomials.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.pieces[..])
    }

    /// Follows control points that moved: the surface of the same mesh with other points, as
    /// [`MovingSurface`](super::MovingSurface) gives it. [`Samples`] stay what they are.
    ///
    /// # Panics
    /// It has other patches.
    pub fn update(&mut self, surface: &LimitSurface) {
        assert_eq!(surface.patches(), self.surface.patches(), "the surface of the same mesh, moved");
        self.surface = surface.clone();
        self.plan.fill(surface, &mut self.pieces);
    }

    /// Finds where samples (ptex face, u, v), u and v from 0 to 1, lie, and groups them by polynomial. Samples that come grouped so
    /// keep their order.
    ///
    /// # Panics
    /// A ptex face is out of range.
    pub fn place(&self, samples: &[(u32, T, T)]) -> Samples<T> {
        Samples::new(&self.surface, &self.plan, samples)
    }

    /// Evaluates samples on this thread: sample `samples.order()[i]` is row i of the columns. Zero in holes.
    ///
    /// # Panics
    /// A column is not as long as there are samples.
    pub fn evaluate(&self, samples: &Samples<T>, columns: Columns<'_, T>) {
        self.all(samples, columns, usize::MAX, |job| job());
    }

    /// As [`evaluate`](Self::evaluate), on all threads of rayon's pool.
    ///
    /// # Panics
    /// As [`evaluate`](Self::evaluate).
    pub fn evaluate_in_parallel(&self, samples: &Samples<T>, columns: Columns<'_, T>) {
        rayon::scope(|scope| self.all(samples, columns, JOB, |job| scope.spawn(|_| job())));
    }

    /// Hands out jobs of at most so many samples.
    fn all<'a>(
        &'a self,
        samples: &'a Samples<T>,
        mut columns: Columns<'a, T>,
        most: usize,
        mut hand_out: impl FnMut(Box<dyn FnOnce() + Send + 'a>),
    ) {
        assert!(columns.slices().all(|slice| slice.len() == samples.len()), "columns as long as there are samples");
        let (on_pieces, others) = (samples.u.len(), samples.others.len());
        for [from, to, most] in [[0, on_pieces, most], [on_pieces, on_pieces + others, most.div_ceil(64)]] {
            for start in (from..to).step_by(most) {
                let job = start..start.saturating_add(most).min(to);
                let [own, rest] = columns.split_at(job.len());
                columns = rest;
                match start < on_pieces {
                    true => hand_out(Box::new(|| self.on_pieces(samples, job, own))),
                    false => hand_out(Box::new(move || {
                        self.on_patches(&samples.others[job.start - on_pieces..job.end - on_pieces], own);
                    })),
                }
            }
        }
        columns.slices().for_each(|slice| slice.fill(T::default()));
    }

    /// Evaluates a range of the samples that lie on pieces.
    fn on_pieces(&self, samples: &Samples<T>, job: Range<usize>, columns: Columns<'_, T>) {
        let mut room: [[Vec<T>; 3]; 2] = Default::default();
        let mut columns = columns; // of a shorter life
        if columns.first.is_none() && (columns.second.is_some() || columns.normal.is_some()) {
            // Needed on the way.
            room.as_flattened_mut().iter_mut().for_each(|column| column.resize(job.len(), T::default()));
            columns.first = Some(room.each_mut().map(|column| column.each_mut().map(|numbers| &mut numbers[..])));
        }
        let order = if columns.second.is_some() { 2 } else { usize::from(columns.first.is_some()) };
        let mut normal = columns.normal.take();
        let mut out: Vec<&mut [T]> = columns.slices().map(|slice| &mut **slice).collect();
        let mut unclear = Vec::new();
        let (pieces, normals, start) = (&self.pieces, normal.as_mut(), job.start);
        let batch = Batch { pieces, samples, job, out: &mut out, normals, unclear: &mut unclear };
        match order {
            0 => vectorized(Ordered::<T, 0>(batch)),
            1 => vectorized(Ordered::<T, 1>(batch)),
            _ => vectorized(Ordered::<T, 2>(batch)),
        }
        let Some(mut normal) = normal else { return };
        for index in unclear {
            let sample = start + index;
            let run = samples.runs.partition_point(|(_, run)| run.end as usize <= sample);
            let (patch, middle) = self.plan.patch(samples.runs[run].0);
            let of = &self.surface.patches()[patch];
            let [u, v] = of.to_ptex(middle);
            let uv = of.to_local([u + samples.u[sample].to_f64(), v + samples.v[sample].to_f64()]);
            let exact = self.surface.evaluate(patch, uv.map(|t| t.clamp(0.0, 1.0))).normal;
            write(&mut normal, index, exact);
        }
    }

    /// Evaluates patches by the reference.
    fn on_patches(&self, places: &[(u32, [f64; 2])], mut columns: Columns<'_, T>) {
        for (index, &(patch, uv)) in places.iter().enumerate() {
            let patch = patch as usize;
            let of = &self.surface.patches()[patch];
            let Columns { position, first, second, normal } = &mut columns;
            let jet = match second {
                Some(_) => of.jet2_to_ptex(self.surface.evaluate_second(patch, uv)),
                None => {
                    let first = of.jet_to_ptex(self.surface.evaluate(patch, uv));
                    Jet2 { first, duu: DVec3::ZERO, duv: DVec3::ZERO, dvv: DVec3::ZERO }
                }
            };
            write(position, index, jet.first.position);
            first.iter_mut().for_each(|[du, dv]| {
                write(du, index, jet.first.du);
                write(dv, index, jet.first.dv);
            });
            second.iter_mut().for_each(|[duu, duv, dvv]| {
                write(duu, index, jet.duu);
                write(duv, index, jet.duv);
                write(dvv, index, jet.dvv);
            });
            normal.iter_mut().for_each(|normal| write(normal, index, jet.first.normal));
        }
    }

    /// Position and derivatives by u and v at (u,v), each 0 to 1, of a ptex face; `None` in a hole.
    ///
    /// # Panics
    /// The ptex face is out of range.
    pub fn at(&self, ptex: u32, [u, v]: [T; 2]) -> Option<[[T; 3]; 3]> {
        let mut out = [[[T::default(); 3]; 3]];
        let place = Place::new(&self.surface, &self.plan, ptex, [u.to_f64(), v.to_f64()]);
        self.each(&[(ptex, u, v)], &mut out);
        (place != Place::Hole).then_some(out[0])
    }

    /// As [`at`](Self::at) for samples (ptex face, u, v) in any order; zero in holes.
    ///
    /// # Panics
    /// A ptex face is out of range, or there is less room than there are samples.
    pub fn each(&self, samples: &[(u32, T, T)], out: &mut [[[T; 3]; 3]]) {
        vectorized(Each { evaluator: self, samples, out: &mut out[..samples.len()] });
    }
}

/// Rounds a vector into row `index` of a column.
fn write<T: Real>(column: &mut Column<'_, T>, index: usize, x: DVec3) {
    column.iter_mut().zip(x.to_array()).for_each(|(to, x)| to[index] = T::of(x));
}

/// [`Evaluator::each`].
struct Each<'a, T> {
    evaluator: &'a Evaluator<T>,
    samples: &'a [(u32, T, T)],
    out: &'a mut [[[T; 3]; 3]],
}

impl<T: Real> WithSimd for Each<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Evaluator { surface, plan, pieces } = self.evaluator;
        for (&(ptex, u, v), out) in self.samples.iter().zip(self.out) {
            *out = match Place::new(surface, plan, ptex, [u.to_f64(), v.to_f64()]) {
                Place::Piece(piece, [u, v]) => single(simd, &pieces[piece as usize], T::of(u), T::of(v)),
                Place::Patch(patch, uv) => {
                    let jet = surface.patches()[patch as usize].jet_to_ptex(surface.evaluate(patch as usize, uv));
                    [jet.position, jet.du, jet.dv].map(|x| x.to_array().map(T::of))
                }
                Place::Hole => [[T::default(); 3]; 3],
            };
        }
    }
}
