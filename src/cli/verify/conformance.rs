//! `verify --samples-out` and `--results`: the conformance test of other programs.

use super::super::{Failure, args::VerifyArgs, outgoing, rows::shortest, write_out};
use super::{answers, inputs::Input, write_files};
use crate::mesh::Scheme;
use crate::stam::LimitSurface;
use crate::verify::conformance::{DEFAULT_PER_FACE, Terms, Tolerances, conformance, sample_set};
use crate::verify::{MeshReport, Report, Sample};
use clap::Args;
use std::path::{Path, PathBuf};

/// Most samples a face.
const MOST_PER_FACE: i64 = 65_536;

/// Flags of the conformance test.
#[derive(Debug, Args)]
#[command(next_help_heading = "Testing another evaluator (docs/CONFORMANCE.md)")]
pub(in crate::cli) struct ConformanceArgs {
    /// Write the standard sample set of the mesh (face,u,v) and stop
    #[arg(
        long,
        value_name = "FILE",
        group = "other",
        conflicts_with_all = ["results", "json", "junit", "html", "baseline", "only", "plant"]
    )]
    pub samples_out: Option<PathBuf>,
    /// Judge another program's answers instead: a CSV file with face,u,v,x,y,z, and if it has them xu,yu,zu,xv,yv,zv and nx,ny,nz
    #[arg(long, value_name = "FILE", group = "other", conflicts_with_all = ["baseline", "only", "plant"])]
    pub results: Option<PathBuf>,
    /// Standard samples of each ptex face
    #[arg(long, value_name = "N", requires = "other", default_value_t = DEFAULT_PER_FACE as u32, value_parser = clap::value_parser!(u32).range(1..=MOST_PER_FACE))]
    pub samples: u32,
    /// Any part of the standard samples will do
    #[arg(long, requires = "results")]
    pub partial: bool,
    /// What answers may be off: parts of the diagonal, degrees, parts of the longer derivative [default: 2e-6,1e-3,3.6e-6]
    #[arg(long, value_name = "POSITION[,NORMAL[,DERIVATIVE]]", requires = "results", value_parser = tolerances)]
    pub tolerance: Option<Tolerances>,
}

fn tolerances(text: &str) -> Result<Tolerances, String> {
    let parse = |x: &str| x.trim().parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let default = Tolerances::default();
    match numbers.as_deref() {
        Some(&[position, ref rest @ ..]) if rest.len() <= 2 => Ok(Tolerances {
            position,
            normal_deg: rest.first().copied().unwrap_or(default.normal_deg),
            derivative: rest.get(1).copied().unwrap_or(default.derivative),
        }),
        _ => Err("give one to three numbers above 0: POSITION[,NORMAL[,DERIVATIVE]]".to_owned()),
    }
}

impl ConformanceArgs {
    /// Whether this is a conformance test at all.
    pub fn asked(&self) -> bool {
        self.samples_out.is_some() || self.results.is_some()
    }
}

/// Writes the sample set, or judges answers.
pub(super) fn run(args: &VerifyArgs, inputs: &[Input]) -> Result<(), Failure> {
    let [input] = inputs else {
        return Err(Failure::Bad(format!("--samples-out and --results take one mesh, not {}; name it", inputs.len())));
    };
    let per_face = args.conformance.samples as usize;
    let mesh = input.mesh().map_err(Failure::Bad)?;
    if mesh.scheme == Scheme::Loop {
        let reason = "the scheme loop has no standard samples so far; use catmullClark";
        return Err(Failure::of(&mesh, reason));
    }
    if let Some(path) = &args.conformance.samples_out {
        let surface = LimitSurface::new(&mesh).map_err(|error| Failure::of(&mesh, error))?;
        return write_samples(path, &surface, per_face);
    }
    let Some(path) = &args.conformance.results else { return Ok(()) };
    // A bad file is told before the mesh is refined.
    let answers = answers::read(path, mesh.ptex_count())?;
    let ConformanceArgs { tolerance, partial, .. } = args.conformance;
    let terms = Terms { tolerances: tolerance.unwrap_or_default(), per_face, partial };
    let mut report = conformance(&mesh, &answers, &terms).map_err(|error| Failure::of(&mesh, error))?;
    report.set_source(input.source().as_deref(), "catoptric verify");
    write_out(None, text(path, &report).as_bytes())?;
    let report = Report::new(args.size, vec![report], Vec::new());
    write_files(args, &report, &[])?;
    write_out(None, format!("{}\n", report.verdict()).as_bytes())?;
    if report.pass { Ok(()) } else { Err(Failure::Check) }
}

fn write_samples(path: &Path, surface: &LimitSurface, per_face: usize) -> Result<(), Failure> {
    let mut count = 0;
    outgoing::write(path, |out| {
        writeln!(out, "face,u,v")?;
        sample_set(surface, per_face)
            .inspect(|_| count += 1)
            .try_for_each(|Sample { face, u, v }| writeln!(out, "{face},{},{}", shortest(u), shortest(v)))
    })?;
    outgoing::note(path, &format!("{count} samples"));
    Ok(())
}

fn text(path: &Path, report: &MeshReport) -> String {
    let verdict = if report.pass { "pass" } else { "FAIL" };
    let results = report.results.as_ref().map_or(String::new(), ToString::to_string);
    format!("{} for {}: {verdict}\n{results}", path.display(), report.mesh)
}
