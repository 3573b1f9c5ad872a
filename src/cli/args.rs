//! Flags, typed.

use super::memory::MemoryArgs;
use super::scene::SceneArgs;
use crate::osd::MAX_ISOLATION;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Parser)]
#[command(
    name = "catoptric",
    version,
    about = "What the limit surface of a subdivision mesh really reflects",
    after_help = "Without MESH, the built-in sample is used. Exit codes: 0 done or passed, 1 a check failed, \
                  2 bad usage or input, 3 no usable GPU adapter. Where a file is written, - is standard output."
)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub memory: MemoryArgs,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Draw the reflection lines of the limit surface
    Render(Box<super::render::RenderArgs>),
    /// Trace the lines as curves on the limit surface
    Lines(Box<super::lines::LinesArgs>),
    /// Evaluate the limit surface at given samples
    Eval(EvalArgs),
    /// Compare the limit surface, on CPU and GPU, with OpenSubdiv
    Verify(VerifyArgs),
    /// Find the points that mirror light points into the eye (physical reflection)
    Glints(GlintsArgs),
    /// Find where the surface breaks: along creases, between patches, round extraordinary vertices
    Quality(Box<super::quality::QualityArgs>),
    /// Say what a mesh is made of and what it will take
    Info(InfoArgs),
    /// Measure against OpenSubdiv's evaluators, side by side, on this machine
    Bench(BenchArgs),
    /// List the GPU adapters of this machine, the one that is used marked by a star (CATOPTRIC_ADAPTER chooses another)
    Adapters,
    /// Write manual pages, one a command, into a folder
    Man(ManArgs),
    /// Print the completions of a shell
    Completions(CompletionsArgs),
    /// Answer for OpenSubdiv in a process of its own, which `verify` starts
    #[command(name = super::verify::WORKER, hide = true)]
    ReferenceWorker,
}

#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// Folder for the pages, made where it is not there
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct CompletionsArgs {
    /// Which shell
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Backend {
    /// The exact limit in f64
    Cpu,
    /// The shader's f32 twin
    Gpu,
    /// OpenSubdiv's Far patches at isolation 10, with its end caps
    Osd,
}

#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    /// Control mesh (.obj, .usd, .usda, .usdc or .usdz, also with .gz), or - for standard input
    pub mesh: Option<PathBuf>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Write the figures as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Only rows of these names, with commas between
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = super::bench::work)]
    pub only: Vec<crate::bench::Work>,
    /// See that all works: few samples, one turn; the figures say little
    #[arg(long)]
    pub quick: bool,
    /// What this file takes, in this process, of catoptric or osd: for the row `scale`
    #[arg(long, value_name = "NAME", hide = true, requires = "mesh", value_parser = super::bench::contender)]
    pub stages: Option<crate::bench::Contender>,
}

#[derive(Debug, Args)]
pub(super) struct EvalArgs {
    /// Control mesh (.obj, .usd, .usda, .usdc or .usdz, also with .gz), or - for standard input
    pub mesh: Option<PathBuf>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// CSV file with the header face,u,v: ptex face, u and v in 0 to 1
    #[arg(long, value_name = "FILE")]
    pub samples: PathBuf,
    /// CSV file to write; standard output otherwise
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Which evaluator answers
    #[arg(long, value_enum, default_value = "cpu")]
    pub backend: Backend,
}

#[derive(Debug, Args)]
pub(super) struct VerifyArgs {
    /// Control meshes: files, folders (with those in them), and patterns such as 'meshes/*.obj'
    #[arg(value_name = "MESH")]
    pub meshes: Vec<PathBuf>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Write the report as JSON (docs/verify-report.schema.json)
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the report as JUnit XML, for CI systems
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write the report as one HTML page with histograms and pictures, which needs no network
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Fail on what is worse than in this earlier JSON report
    #[arg(long, value_name = "FILE")]
    pub baseline: Option<PathBuf>,
    /// Meshes of folders and patterns that are refused do not fail the run
    #[arg(long)]
    pub allow_refused: bool,
    /// Size of the view that the fragment tier checks pixel by pixel
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = size)]
    pub size: [u32; 2],
    /// Show all evaluations of one point of one mesh side by side, with the control points involved
    #[arg(long, value_name = "FACE,U,V", value_parser = location, conflicts_with_all = ["junit", "html", "baseline"])]
    pub only: Option<crate::osd::Location>,
    /// Print every row, also of many meshes
    #[arg(short, long)]
    pub verbose: bool,
    /// Report how long each step took
    #[arg(long)]
    pub timings: bool,
    /// Plant an error in our evaluation, to test that it is caught: point[:PATCH], crease[:N], swap or
    /// crash:masks|stencils|far|bfr
    #[arg(long, value_name = "ERROR", hide = true)]
    pub plant: Option<crate::verify::Plant>,
    /// The conformance test
    #[command(flatten)]
    pub conformance: super::verify::ConformanceArgs,
}

#[derive(Debug, Args)]
pub(super) struct GlintsArgs {
    /// Control mesh (.obj, .usd, .usda, .usdc or .usdz, also with .gz), or - for standard input
    pub mesh: Option<PathBuf>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A light point; give as many as there are
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, required = true)]
    pub light_point: Vec<glam::DVec3>,
    /// Eye position [default: that of `render`, fitted]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    pub eye: Option<glam::DVec3>,
    /// Direction to an eye infinitely far away, instead of --eye
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, conflicts_with = "eye")]
    pub eye_direction: Option<glam::DVec3>,
    /// Write JSON instead of CSV
    #[arg(long)]
    pub json: bool,
    /// File to write; standard output otherwise
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct InfoArgs {
    /// Control mesh (.obj, .usd, .usda, .usdc or .usdz, also with .gz), or - for standard input
    pub mesh: Option<PathBuf>,
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Deepest level of OpenSubdiv's feature-adaptive patches to list, 0 to 10: number, memory, and how far their end caps
    /// are from the limit [default: 10; 3 for meshes of more than 20,000 faces, 0 where more than
    /// 1,024 meet at a vertex]
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_ISOLATION)))]
    pub levels: Option<u32>,
}

/// Parses `WxH`.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    crate::rig::checked_size(sides.unwrap_or_default())
}

/// Parses `FACE,U,V`: a ptex face and parameters in 0 to 1.
fn location(text: &str) -> Result<crate::osd::Location, String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let parse = |part: &str| part.parse().ok().filter(|x| (0.0..=1.0).contains(x));
    let parsed = match parts[..] {
        [face, u, v] => face.parse().ok().zip(parse(u)).zip(parse(v)).map(|((face, u), v)| (face, u, v)),
        _ => None,
    };
    parsed.ok_or_else(|| "give FACE,U,V: a ptex face, and u and v in 0 to 1".to_owned())
}

/// Parses `X,Y,Z`.
pub(super) fn vector(text: &str) -> Result<glam::DVec3, String> {
    let numbers: Vec<f64> =
        text.split(',').map_while(|x| x.trim().parse().ok()).filter(|x: &f64| x.is_finite()).collect();
    match numbers[..] {
        [x, y, z] if text.matches(',').count() == 2 => Ok(glam::DVec3::new(x, y, z)),
        _ => Err("give three finite numbers X,Y,Z".to_owned()),
    }
}
