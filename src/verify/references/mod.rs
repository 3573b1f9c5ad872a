//! The references that several tiers ask, and where they run.
//!
//! OpenSubdiv validates almost nothing and has bugs that end the process. What is known to do so is not asked; for the rest, its
//! evaluators run in worker processes ([`Process`]), and one that ends is a row of the report.

mod oracle;
mod worker;

use crate::mesh::SubdivMesh;
use crate::osd::{Location, ReferenceJet, Stencil};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use super::expense::Expense;
use super::key::Against;
pub(super) use oracle::Masks;
use oracle::{Answer, Oracle, Question};
pub use worker::serve;

/// Where OpenSubdiv's reference evaluators run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Process {
    /// In this process: what ends OpenSubdiv ends it too.
    #[default]
    Own,
    /// In processes of their own, which are started for each mesh.
    Worker {
        /// A program that calls [`serve`] with its standard input and output.
        program: PathBuf,
        /// Its arguments.
        arguments: Vec<OsString>,
        /// Threads of each process (`RAYON_NUM_THREADS`).
        threads: usize,
    },
}

/// Why a reference does not answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReferenceError {
    /// The process that it ran in ended, by a signal or with an exit code.
    #[error("OpenSubdiv ended with {0}")]
    Ended(String),
    /// OpenSubdiv reported an error or threw an exception.
    #[error("{0}")]
    Reported(String),
    /// There is no process for it.
    #[error("no process for OpenSubdiv's evaluators: {0}")]
    NoWorker(String),
}

/// OpenSubdiv's evaluators of one mesh.
///
/// There are two of everything, so that two can answer at a time: limit masks and stencils by one, Far and Bfr by the other.
pub(super) struct References<'a> {
    mesh: &'a SubdivMesh,
    /// What OpenSubdiv's evaluators cost at the faces of the mesh.
    pub expense: Expense,
    process: &'a Process,
    /// The evaluator that is to crash ([`Plant::Crash`](super::Plant::Crash)).
    crash: Option<Against>,
    masks_and_stencils: Mutex<Seat>,
    far_and_bfr: Mutex<Seat>,
}

/// Samples that limit stencils are asked about.
pub(super) struct Asked {
    /// All of them.
    pub samples: Vec<Location>,
    /// Lengths of their portions, each asked about by itself; at the end comes the rest.
    portions: Vec<usize>,
    /// Samples at vertices of many faces that are left out, because OpenSubdiv would take too long.
    pub left_out: usize,
}

impl Asked {
    /// Samples of one face, whatever they cost.
    pub fn all(samples: &[Location]) -> Self {
        Self { samples: samples.to_vec(), portions: Vec::new(), left_out: 0 }
    }
}

/// Who answers, once there is somebody.
#[derive(Default)]
enum Seat {
    #[default]
    Empty,
    Own(Box<Oracle>),
    Worker(worker::Worker),
}

impl<'a> References<'a> {
    pub fn new(mesh: &'a SubdivMesh, process: &'a Process, crash: Option<Against>) -> Self {
        let expense = Expense::new(mesh);
        Self { mesh, expense, process, crash, masks_and_stencils: Mutex::default(), far_and_bfr: Mutex::default() }
    }

    /// A uniform refinement to `level`, and the limits of its vertices.
    pub fn limit_masks(&self, level: u32) -> Result<Masks, ReferenceError> {
        match self.ask(Against::LimitMasks, Question::LimitMasks { level })? {
            Answer::Masks(masks) => Ok(*masks),
            _ => Err(unasked()),
        }
    }

    /// Which of some samples, which come grouped by face, limit stencils are asked about.
    pub fn for_stencils(&self, samples: &[Location]) -> Asked {
        let (cheap, dear) = self.expense.for_stencils(samples);
        let portions: Vec<usize> = dear.iter().map(Vec::len).collect();
        let left_out = samples.len() - cheap.len() - portions.iter().sum::<usize>();
        let samples = dear.into_iter().chain([thinned(&cheap)]).flatten().collect();
        Asked { samples, portions, left_out }
    }

    /// Limit stencils at the deepest isolation.
    pub fn stencils(&self, asked: &Asked) -> Result<Vec<ReferenceJet>, ReferenceError> {
        let Asked { samples, portions, .. } = asked;
        let question = Question::Stencils { samples: samples.clone(), portions: portions.clone() };
        self.jets(Against::LimitStencils, question)
    }

    /// The limit stencil of one sample.
    pub fn stencil(&self, sample: Location) -> Result<Stencil, ReferenceError> {
        match self.ask(Against::LimitStencils, Question::Stencil(sample))? {
            Answer::Stencil(stencil) => Ok(stencil),
            _ => Err(unasked()),
        }
    }

    /// Far's patches at the deepest isolation.
    pub fn far(&self, samples: &[Location]) -> Result<Vec<ReferenceJet>, ReferenceError> {
        let mut jets = Vec::with_capacity(samples.len());
        // None at all is a question too: whether there are patches.
        let portions = samples.chunks(PORTION).chain(samples.is_empty().then_some(samples));
        for portion in portions {
            jets.extend(self.jets(Against::Far, Question::Far(portion.to_vec()))?);
        }
        Ok(jets)
    }

    /// Bfr's surfaces with these approximation levels; samples come grouped by face.
    pub fn bfr(&self, levels: (u32, u32), samples: &[Location]) -> Result<Vec<ReferenceJet>, ReferenceError> {
        self.jets(Against::Bfr, Question::Bfr { levels, samples: samples.to_vec() })
    }

    fn jets(&self, against: Against, question: Question) -> Result<Vec<ReferenceJet>, ReferenceError> {
        match self.ask(against, question)? {
            Answer::Jets(jets) => Ok(jets),
            _ => Err(unasked()),
        }
    }

    fn ask(&self, against: Against, question: Question) -> Result<Answer, ReferenceError> {
        let crash = self.crash == Some(against);
        if crash && *self.process == Process::Own {
            return Err(ReferenceError::NoWorker("a crash can be planted in a worker alone".to_owned()));
        }
        let question = if crash { Question::Crash } else { question };
        let seat = match against {
            Against::LimitMasks | Against::LimitStencils => &self.masks_and_stencils,
            _ => &self.far_and_bfr,
        };
        let mut seat = seat.lock().unwrap_or_else(PoisonError::into_inner);
        if matches!(*seat, Seat::Empty) {
            *seat = match self.process {
                Process::Own => Seat::Own(Box::new(Oracle::new(self.mesh.clone()))),
                Process::Worker { .. } => Seat::Worker(worker::Worker::start(self.process, self.mesh)?),
            };
        }
        let answer = match &mut *seat {
            Seat::Own(oracle) => {
                return oracle.answer(question).map_err(|error| ReferenceError::Reported(error.to_string()));
            }
            Seat::Worker(worker) => worker.ask(&question),
            Seat::Empty => Err(unasked()),
        };
        if matches!(answer, Err(ReferenceError::Ended(_))) {
            *seat = Seat::Empty;
        }
        answer
    }
}

/// The answer to something else, which a worker of this program does not give.
fn unasked() -> ReferenceError {
    ReferenceError::NoWorker("it answers another question".to_owned())
}

/// Samples of a question to Far. On both sides of a pipe, messages of a megabyte are put into memory that is there already; for larger
/// ones the system clears new pages each time, which took a tenth of the time of `verify`.
const PORTION: usize = 1 << 13;

/// Faces that limit stencils are made for, in each set of samples: a face takes a millisecond, and they say what Far's
/// patches say at every sample, in another way. They come in runs, because a stencil needs the faces round its own.
const STENCIL_FACES: usize = 2048;
const RUN: usize = 16;

/// The samples of evenly spread faces, no more than limit stencils are made for. Samples come grouped by face.
fn thinned(samples: &[Location]) -> Vec<Location> {
    let faces = samples.chunk_by(|a, b| a.0 == b.0);
    let stride = faces.clone().count().div_ceil(STENCIL_FACES).max(1);
    let kept = faces.enumerate().filter(|(i, _)| (i / RUN).is_multiple_of(stride));
    kept.flat_map(|(_, face)| face).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_whole_faces_all_over() {
        for (faces, kept_at_most) in [(1, 1), (2048, 2048), (2049, 1040), (100_000, STENCIL_FACES + RUN)] {
            let samples: Vec<Location> = (0..faces).flat_map(|face| [(face, 0.1, 0.2), (face, 0.3, 0.4)]).collect();
            let kept = thinned(&samples);
            assert!(kept.len().is_multiple_of(2) && !kept.is_empty() && kept.len() / 2 <= kept_at_most, "{faces}");
            assert!(kept.chunks(2).all(|pair| pair[0].0 == pair[1].0 && pair[1].1 == 0.3));
            let last = kept[kept.len() - 1].0;
            assert!(f64::from(last) >= 0.98 * f64::from(faces - 1) - RUN as f64, "{faces}: {last}");
        }
    }
}
