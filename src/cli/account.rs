//! What a `render` did: the certificates of its samples, and the time of each step.

use super::compare::Compared;
use super::{Failure, write_out};
use crate::gpu::{Summary, Timings};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Names and times of the steps, and the certificates of all pictures.
#[derive(Default)]
pub(super) struct Account {
    steps: Vec<(&'static str, Duration)>,
    summary: Option<Summary>,
    pictures: usize,
    /// Pictures none of whose samples sees the surface.
    empty: usize,
    comparisons: Vec<Compared>,
}

/// What `--json` writes.
#[derive(Serialize)]
struct Record<'a> {
    version: u32,
    adapter: Option<&'a str>,
    pictures: usize,
    /// Samples a pixel each way.
    samples_per_pixel: u32,
    certificate: Option<Certified>,
    /// With OpenSubdiv's patches, a picture each.
    #[serde(skip_serializing_if = "<[Compared]>::is_empty")]
    comparisons: &'a [Compared],
    /// Milliseconds.
    timings: BTreeMap<&'static str, f64>,
}

/// A [`Summary`] in pixels.
#[derive(Serialize)]
struct Certified {
    samples: u64,
    covered: u64,
    solved_on_host: u64,
    unconverged: u64,
    newton_steps_mean: f64,
    residual_max_pixels: f64,
}

impl Certified {
    fn new(summary: &Summary, samples_per_pixel: u32) -> Certified {
        let Summary { samples, covered, solved, unconverged, steps, residual_max } = *summary;
        Certified {
            samples,
            covered,
            solved_on_host: solved,
            unconverged,
            newton_steps_mean: steps as f64 / (covered - solved).max(1) as f64,
            residual_max_pixels: f64::from(residual_max) / f64::from(samples_per_pixel),
        }
    }
}

impl Account {
    pub fn time<R>(&mut self, name: &'static str, step: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = step();
        self.count(name, start.elapsed());
        result
    }

    fn count(&mut self, name: &'static str, time: Duration) {
        match self.steps.iter_mut().find(|(known, _)| *known == name) {
            Some((_, total)) => *total += time,
            None => self.steps.push((name, time)),
        }
    }

    pub fn add(&mut self, timings: &Timings) {
        timings.steps.iter().for_each(|&(name, time)| self.count(name, time));
    }

    /// A picture was taken.
    pub fn picture(&mut self, summary: Option<Summary>) {
        self.pictures += 1;
        self.empty += usize::from(summary.is_some_and(|summary| summary.covered == 0));
        self.summary = match (self.summary, summary) {
            (Some(sum), Some(one)) => Some(sum.and(one)),
            (sum, one) => sum.or(one),
        };
    }

    /// The picture that was taken last turns out to show nothing.
    pub fn picture_is_empty(&mut self) {
        self.empty += 1;
    }

    /// A line on standard error where pictures show nothing of the surface.
    pub fn say_empty(&self) {
        let why =
            "it lies outside of the view, behind the eye, or edge-on; leave --eye and --target out to fit the view";
        match (self.empty, self.pictures) {
            (0, _) => {}
            (1, 1) => tell!("catoptric: no sample of the picture sees the surface: {why}"),
            (empty, all) => tell!("catoptric: {empty} of {all} pictures see nothing of the surface: {why}"),
        }
    }

    /// A picture was compared with one of OpenSubdiv's patches.
    pub fn compared(&mut self, compared: Compared) {
        compared.say();
        self.comparisons.push(compared);
    }

    /// A line on standard error: how exact the pictures are.
    pub fn say_certificate(&self, samples_per_pixel: u32) {
        let Some(summary) = &self.summary else { return };
        let Certified { samples, covered, solved_on_host, unconverged, newton_steps_mean, residual_max_pixels } =
            Certified::new(summary, samples_per_pixel);
        tell!(
            "exact: {covered} of {samples} samples see the surface, {solved_on_host} of them solved on the host, the others in \
             {newton_steps_mean:.2} Newton steps; at most {residual_max_pixels:.1e} pixels off; {unconverged} not converged"
        );
    }

    /// The time of each step, on standard error.
    pub fn say_timings(&self, adapter: &str) {
        tell!("{:<20} {adapter}", "adapter");
        self.say_steps();
    }

    /// The same where no adapter took part.
    pub fn say_steps(&self) {
        for (name, time) in &self.steps {
            tell!("{name:<20} {:>8.1} ms", time.as_secs_f64() * 1e3);
        }
    }

    /// All of it, as JSON, if a file for it is named. No adapter: nothing was left to draw.
    pub fn write(&self, path: Option<&PathBuf>, adapter: Option<&str>, samples_per_pixel: u32) -> Result<(), Failure> {
        let Some(path) = path else { return Ok(()) };
        let record = Record {
            version: 1,
            adapter,
            pictures: self.pictures,
            samples_per_pixel,
            certificate: self.summary.as_ref().map(|summary| Certified::new(summary, samples_per_pixel)),
            comparisons: &self.comparisons,
            timings: self.steps.iter().map(|&(name, time)| (name, time.as_secs_f64() * 1e3)).collect(),
        };
        let mut text = serde_json::to_vec_pretty(&record).map_err(std::io::Error::from)?;
        text.push(b'\n');
        write_out(Some(path), &text)
    }
}
