//! How long each part of a verification took.

use serde::Serialize;
use std::time::Instant;

/// One part of the work.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Timing {
    /// What was done: a tier, or a part of one after a colon.
    pub step: &'static str,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Times steps.
#[derive(Debug, Default)]
pub(super) struct Clock {
    pub steps: Vec<Timing>,
}

impl Clock {
    /// Runs a step and adds its time to what the step took before.
    pub fn time<R>(&mut self, step: &'static str, run: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = run();
        let seconds = start.elapsed().as_secs_f64();
        match self.steps.iter_mut().find(|timing| timing.step == step) {
            Some(timing) => timing.seconds += seconds,
            None => self.steps.push(Timing { step, seconds }),
        }
        result
    }
}
