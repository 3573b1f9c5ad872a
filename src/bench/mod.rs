//! Side by side with what a user could pick instead: the figures of docs/PERFORMANCE.md.
//!
//! # Practice
//! A [`Row`] is one piece of work, done by us and by peers in the same process, on the same samples with the same outputs. All take turns, so
//! that what the machine does beside hits all alike, and warm up when their turn comes; of three runs each gives a median, and what counts is
//! the ratio. The floor is what the same run measured for the least that the work cannot do without.

mod contest;
mod evaluate;
mod frame;
mod normals;
mod scale;
mod sheet;
mod tables;

pub use contest::{Contest, Figure, Unit};
pub use scale::{Contender, Stages};

use crate::gpu::Gpu;
use crate::mesh::SubdivMesh;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Why a row was not measured: somebody refuses the mesh, the adapter fails, or memory does not suffice.
pub type BenchError = Box<dyn std::error::Error + Send + Sync>;

/// The work that is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// Position, du and dv of samples grouped by patch, one thread, `f32`.
    Batched,
    /// The same in `f64`.
    BatchedDouble,
    /// Position, du and dv of samples on random faces, the search for their patches counted in, one thread, `f32`.
    Random,
    /// From a mesh in memory to tables, one thread.
    Tables,
    /// Control points move, topology stays, one thread.
    Update,
    /// Reflection lines at 1024 x 1024 against a tessellation that is as accurate as 1.4e-3 degrees, steady state.
    Frame,
    /// How far normals in `f32` are off.
    NormalError,
    /// Sheets of 10,000 to 1,000,000 faces, from their files to their pictures.
    Scale,
}

impl Work {
    /// All, in the order of the report.
    pub const ALL: [Self; 8] = [
        Self::Batched,
        Self::BatchedDouble,
        Self::Random,
        Self::Tables,
        Self::Update,
        Self::Frame,
        Self::NormalError,
        Self::Scale,
    ];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Batched => "evaluate_batched",
            Self::BatchedDouble => "evaluate_batched_f64",
            Self::Random => "evaluate_random",
            Self::Tables => "tables",
            Self::Update => "update",
            Self::Frame => "frame",
            Self::NormalError => "normal_error",
            Self::Scale => "scale",
        }
    }
}

/// One figure of ours beside those of peers.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// What was done.
    pub name: String,
    /// Unit of all figures; less is better.
    pub unit: &'static str,
    /// Ours: the median.
    pub catoptric: f64,
    /// Theirs, by peer; `None` where one does not do this.
    pub peers: BTreeMap<&'static str, Option<f64>>,
    /// The least that the work cannot do without, where it was measured.
    pub floor: Option<f64>,
    /// Theirs over ours, least and largest of the runs.
    pub ratios: BTreeMap<&'static str, [f64; 2]>,
    /// What was measured, in words.
    pub note: String,
}

impl Row {
    /// From the runs of all, `scale` of whose units are one of the row's.
    fn new(
        name: String,
        unit: &'static str,
        scale: f64,
        ours: &Figure,
        theirs: &BTreeMap<&'static str, Figure>,
        note: String,
    ) -> Self {
        let mut peers: BTreeMap<_, _> = ["bfr", "osd", "embree"].map(|peer| (peer, None)).into();
        peers.extend(theirs.iter().map(|(peer, figure)| (*peer, Some(scale * figure.median()))));
        let ratios = theirs.iter().map(|(peer, figure)| (*peer, figure.over(ours))).collect();
        Self { name, unit, catoptric: scale * ours.median(), peers, floor: None, ratios, note }
    }
}

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Turns that each contestant takes in a run.
    pub turns: usize,
    /// Samples of the rows that evaluate.
    pub samples: usize,
    /// Control faces of the largest sheet.
    pub faces: usize,
}

impl Effort {
    /// What the documentation quotes.
    pub const FULL: Self = Self { turns: 9, samples: 1 << 17, faces: 1_000_000 };
    /// Enough to see that all works.
    pub const QUICK: Self = Self { turns: 1, samples: 1 << 12, faces: 10_000 };
}

/// What some work needs beside a mesh; what lacks it is left out.
#[derive(Debug, Clone, Copy, Default)]
pub struct Means<'a> {
    /// Where pictures are drawn.
    pub gpu: Option<&'a Gpu>,
    /// The program `catoptric`: sheets are measured in processes of their own.
    pub program: Option<&'a Path>,
}

/// Measures one piece of work on a mesh.
///
/// # Errors
/// Somebody refuses the mesh, or fails.
pub fn measure(work: Work, mesh: &SubdivMesh, effort: Effort, means: Means<'_>) -> Result<Vec<Row>, BenchError> {
    match (work, means) {
        (Work::NormalError, _) => normals::errors(mesh, effort),
        (Work::Scale, Means { gpu: Some(_), program: Some(program) }) => scale::rows(program, effort),
        _ => Ok(contests(work, mesh, effort, means.gpu)?.into_iter().map(|contest| contest.row(effort)).collect()),
    }
}

/// The contests behind the rows of timed work; none of work that takes no turns, or needs an adapter that is not there.
///
/// # Errors
/// Somebody refuses the mesh, or fails.
pub fn contests<'a>(
    work: Work,
    mesh: &'a SubdivMesh,
    effort: Effort,
    gpu: Option<&'a Gpu>,
) -> Result<Vec<Contest<'a>>, BenchError> {
    match work {
        Work::Batched => Ok(vec![evaluate::batched::<f32>(mesh, effort)?]),
        Work::BatchedDouble => Ok(vec![evaluate::batched::<f64>(mesh, effort)?]),
        Work::Random => Ok(vec![evaluate::random(mesh, effort)?]),
        Work::Tables => tables::tables(mesh, gpu),
        Work::Update => tables::update(mesh),
        Work::Frame => gpu.map_or(Ok(Vec::new()), |gpu| frame::frame(mesh, gpu)),
        Work::NormalError | Work::Scale => Ok(Vec::new()),
    }
}

/// Where what we spread over threads runs on one.
fn one_thread() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread")
}
