//! Many meshes at a time, reported in their order.

use super::super::{Failure, Steps, progress};
use super::inputs::Input;
use crate::gpu::Gpu;
use crate::page::Pictures;
use crate::verify::{MeshReport, Settings, VerifyError, verify};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// How each mesh is verified.
pub(super) struct Job<'a> {
    pub gpu: &'a Gpu,
    pub settings: Settings,
    /// Pictures are wanted too.
    pub pictures: bool,
}

/// What became of a mesh.
pub(super) enum Outcome {
    Verified(Box<MeshReport>, Pictures),
    /// Found in a folder or by a pattern, and not fit to be verified: why, in one line.
    Refused(String),
}

/// Meshes at a time: most of the work is parallel within a mesh already, and each takes its memory.
const AT_A_TIME: usize = 4;

/// Processors that there are.
pub(super) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// How many of so many meshes are verified at a time.
pub(super) fn at_a_time(meshes: usize) -> usize {
    processors().min(AT_A_TIME).min(meshes).max(1)
}

impl Job<'_> {
    fn verify(&self, input: &Input) -> Result<Outcome, Failure> {
        let report = |input: &Input| -> Result<(MeshReport, Pictures), Refusal> {
            let mesh = input.mesh().map_err(Refusal::Mesh)?;
            let report = verify(&mesh, self.gpu, &self.settings)?;
            // Pictures ask OpenSubdiv in this process, which its answers so far must have shown to be safe.
            let safe = report.reference_unanswered.is_empty();
            let pictures = if self.pictures && safe { Pictures::take(&mesh, self.gpu)? } else { Pictures::default() };
            Ok((report, pictures))
        };
        match (report(input), input.is_named()) {
            (Ok((report, pictures)), _) => Ok(Outcome::Verified(Box::new(report), pictures)),
            (Err(Refusal::Gpu(failure)), _) => Err(failure),
            (Err(Refusal::Mesh(reason)), false) => Ok(Outcome::Refused(reason)),
            (Err(Refusal::Mesh(reason)), true) => Err(Failure::Bad(reason)),
            (Err(Refusal::Verify(error)), false) => {
                Ok(Outcome::Refused(format!("{}: {error}", input.source().unwrap_or_default())))
            }
            (Err(Refusal::Verify(error)), true) => Err(Failure::of_input(input, error)),
        }
    }
}

/// Why a mesh was not verified.
enum Refusal {
    /// It is none; the line names the file.
    Mesh(String),
    /// Nothing of it can be judged.
    Verify(String),
    /// The adapter is at fault, not the mesh.
    Gpu(Failure),
}

impl From<VerifyError> for Refusal {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Gpu(error) => Self::Gpu(error.into()),
            error => Self::Verify(error.to_string()),
        }
    }
}

/// Verifies all, some at a time, and hands each outcome on as soon as those before it are.
///
/// # Errors
/// A mesh that was named by itself is refused, the adapter fails, or the outcome cannot be handed on. Nothing more is
/// verified then.
pub(super) fn run(
    inputs: &[Input],
    job: &Job<'_>,
    mut hand_on: impl FnMut(&Input, Outcome) -> Result<(), Failure>,
) -> Result<(), Failure> {
    if let [input] = inputs {
        let bar = progress(format!("verifying {}", input.name()));
        let outcome = job.verify(input)?;
        bar.finish_and_clear();
        return hand_on(input, outcome);
    }
    let threads = at_a_time(inputs.len());
    let steps = Steps::new(inputs.len(), "meshes verified");
    let next = AtomicUsize::new(0);
    let (send, receive) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let (send, next) = (send.clone(), &next);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(input) = inputs.get(index) else { break };
                    if send.send((index, job.verify(input))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        let mut waiting = BTreeMap::new();
        let mut handed_on = 0;
        let mut in_order = || -> Result<(), Failure> {
            for (index, outcome) in &receive {
                steps.done_one();
                waiting.insert(index, outcome);
                while let Some(outcome) = waiting.remove(&handed_on) {
                    let outcome = outcome?;
                    steps.aside(|| hand_on(&inputs[handed_on], outcome))?;
                    handed_on += 1;
                }
            }
            Ok(())
        };
        let result = in_order();
        // After a failure the others stop at the mesh that they are at.
        next.store(inputs.len(), Ordering::Relaxed);
        result
    })
}
