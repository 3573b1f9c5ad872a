//! `verify`: the regression against OpenSubdiv.

mod answers;
mod conformance;
mod inputs;
mod many;

use super::args::VerifyArgs;
use super::files::Files;
use super::rows::check_place;
use super::{Failure, outgoing, write_out};
use crate::absent::problem;
use crate::gpu::Gpu;
use crate::mesh::Scheme;
use crate::osd::Location;
use crate::page::{Pictures, page};
use crate::verify::{Baseline, MeshReport, Process, Refused, Report, Sample, Settings, only};
pub use answers::parse_answers;
pub(super) use conformance::ConformanceArgs;
use inputs::Input;
use many::{Job, Outcome};
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(super) fn run(args: &VerifyArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut files = Files::default();
    for (path, flag, what) in [
        (&args.json, "--json", "the JSON report"),
        (&args.junit, "--junit", "the JUnit report"),
        (&args.html, "--html", "the HTML report"),
        (&args.conformance.samples_out, "--samples-out", "the samples"),
    ] {
        if let Some(path) = path {
            outgoing::check(path, flag)?;
            files.write(path, flag, what)?;
        }
    }
    let baseline = args.baseline.as_deref().map(|path| read_baseline(path, args.size)).transpose()?;
    let inputs = inputs::find(&args.meshes, &args.scene)?;
    if args.conformance.asked() {
        return conformance::run(args, &inputs);
    }
    if let Some(sample) = args.only {
        return one(args, &inputs, sample);
    }
    let gpu = Gpu::new()?;
    let job = Job { gpu: &gpu, settings: settings(args, inputs.len())?, pictures: args.html.is_some() };
    let show = Show { width: inputs.iter().map(|input| input.name().len()).max().unwrap_or(0), args, of: inputs.len() };
    let (mut meshes, mut pictures, mut refused) = (Vec::new(), Vec::new(), Vec::new());
    many::run(&inputs, &job, |input, outcome| {
        match outcome {
            Outcome::Verified(mut report, shown) => {
                report.set_source(input.source().as_deref(), &show.flags());
                if !args.timings {
                    report.timings = None;
                }
                show.report(&report)?;
                meshes.push(*report);
                pictures.push(shown);
            }
            Outcome::Refused(reason) => {
                let path = input.source().unwrap_or_default();
                write_out(None, format!("refused  {reason}\n").as_bytes())?;
                refused.push(Refused { path, reason });
            }
        }
        Ok(())
    })?;
    let mut report = Report::new(args.size, meshes, refused).with_adapter(gpu.adapter());
    if args.allow_refused {
        report = report.allow_refused();
    }
    if let Some((path, baseline)) = args.baseline.as_ref().zip(baseline) {
        report = report.with_baseline(path.display().to_string(), &baseline);
    }
    write_files(args, &report, &pictures)?;
    if let Some(comparison) = &report.baseline {
        write_out(None, comparison.to_string().as_bytes())?;
    }
    write_out(None, format!("{} ({:.1} s)\n", report.verdict(), start.elapsed().as_secs_f64()).as_bytes())?;
    if report.pass { Ok(()) } else { Err(Failure::Check) }
}

/// Writes the report as the files that were asked for.
fn write_files(args: &VerifyArgs, report: &Report, pictures: &[Pictures]) -> Result<(), Failure> {
    if let Some(path) = &args.json {
        write_json(path, report)?;
    }
    if let Some(path) = &args.junit {
        let text = report.junit().map_err(|error| Failure::Bad(format!("{}: {error}", path.display())))?;
        write_out(Some(path), text.as_bytes())?;
    }
    if let Some(path) = &args.html {
        let text = page(report, pictures).map_err(|error| Failure::Bad(format!("{}: {error}", path.display())))?;
        write_out(Some(path), text.as_bytes())?;
    }
    Ok(())
}

/// How meshes are verified: OpenSubdiv's evaluators run in processes of this program's own.
fn settings(args: &VerifyArgs, meshes: usize) -> Result<Settings, Failure> {
    let program = std::env::current_exe().map_err(|error| {
        Failure::Bad(format!("cannot find this program, to run OpenSubdiv in a process of its own: {error}"))
    })?;
    // As many threads in all as there are processors, or each waits for the others.
    let threads = (many::processors() / many::at_a_time(meshes)).max(1);
    let process = Process::Worker { program, arguments: vec![WORKER.into()], threads };
    Ok(Settings { size: args.size, plant: args.plant, process })
}

/// The command by which this program starts itself to answer for OpenSubdiv.
pub(super) const WORKER: &str = "reference-worker";

/// Answers for OpenSubdiv, question by question.
pub(super) fn work() -> Result<(), Failure> {
    let (questions, answers) = (std::io::stdin().lock(), std::io::stdout().lock());
    crate::verify::serve(questions, answers).map_err(|error| Failure::Bad(format!("{WORKER}: {error}")))
}

fn read_baseline(path: &Path, size: [u32; 2]) -> Result<Baseline, Failure> {
    let bad = |what: String| Failure::Bad(format!("{}: {what}", path.display()));
    let json = std::fs::read(path).map_err(|error| {
        bad(format!("cannot be read: {}; give an earlier report of verify --json", problem(path, &error)))
    })?;
    Baseline::read(&json, size).map_err(|error| bad(error.to_string()))
}

/// `--only`: all evaluations of one point. It shows, and judges nothing.
fn one(args: &VerifyArgs, inputs: &[Input], (face, u, v): Location) -> Result<(), Failure> {
    let [input] = inputs else {
        return Err(Failure::Bad(format!("--only takes one mesh, not {}; name it", inputs.len())));
    };
    let mesh = input.mesh().map_err(Failure::Bad)?;
    check_place((face, u, v), mesh.ptex_count(), mesh.scheme == Scheme::Loop)
        .map_err(|what| Failure::of_input(input, format!("--only: {what}")))?;
    // Without an adapter the shader is left out: what f64 and OpenSubdiv say does not need it.
    let gpu = match Gpu::new() {
        Ok(gpu) => Some(gpu),
        Err(error) if error.is_no_adapter() => None,
        Err(error) => return Err(error.into()),
    };
    let shown = only(&mesh, gpu.as_ref(), Sample { face, u, v }, &settings(args, 1)?)
        .map_err(|error| Failure::of_input(input, error.to_string()))?;
    if let Some(path) = &args.json {
        write_json(path, &shown)?;
    }
    write_out(None, shown.to_string().as_bytes())
}

fn write_json(path: &PathBuf, value: &impl serde::Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_vec_pretty(value).map_err(std::io::Error::from)?;
    text.push(b'\n');
    write_out(Some(path), &text)
}

/// How reports are shown as they come in.
struct Show<'a> {
    args: &'a VerifyArgs,
    /// Longest name.
    width: usize,
    /// Number of meshes.
    of: usize,
}

impl Show<'_> {
    /// The command that shows a single sample, up to the mesh.
    fn flags(&self) -> String {
        let plant = self.args.plant.map(|plant| format!(" --plant {plant}")).unwrap_or_default();
        format!("catoptric verify{}{plant}", self.args.scene.flags())
    }

    /// All rows of a single mesh; of many a line each, and the rows that failed.
    fn report(&self, report: &MeshReport) -> Result<(), Failure> {
        let text = match (self.of == 1 || self.args.verbose, report.pass) {
            (true, _) => report.to_string(),
            (false, true) => format!("{}\n", report.line(self.width)),
            (false, false) => format!("{}\n{}", report.line(self.width), report.table(true)),
        };
        write_out(None, text.as_bytes())
    }
}

impl Failure {
    fn of_input(input: &Input, reason: String) -> Self {
        Self::Bad(format!("{}: {reason}", input.name()))
    }
}
