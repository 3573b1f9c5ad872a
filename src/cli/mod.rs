//! The command line: a thin layer of typed flags over the library.

mod args;
mod eval;
mod info;
mod render;
mod verify;

use args::{Cli, Command};
use clap::Parser;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::gpu::GpuError;
use crate::mesh::{self, MeshError, SubdivMesh};
use crate::output::OutputError;
use crate::patch::PatchError;
use crate::verify::VerifyError;

/// Why a command stopped, and with which exit code.
#[derive(Debug, thiserror::Error)]
enum Failure {
    /// A check failed; the report says which.
    #[error("")]
    Check,
    #[error("{0}")]
    Usage(String),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error("{mesh}: {source}")]
    Patch { mesh: String, source: PatchError },
    #[error(transparent)]
    Osd(#[from] crate::osd::Error),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error("{mesh}: {source}")]
    Verify { mesh: String, source: VerifyError },
    #[error("cannot write to standard output: {0}")]
    Stdout(#[from] std::io::Error),
}

impl Failure {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Check => 1,
            Self::Gpu(error) | Self::Verify { source: VerifyError::Gpu(error), .. } if error.is_no_adapter() => 3,
            _ => 2,
        }
    }
}

/// Parses the arguments of the process, runs the command and returns its exit code: 0 done or passed, 1 a check failed,
/// 2 bad usage or input, 3 no usable GPU adapter.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if !error.use_stderr() => {
            return if error.print().is_ok() { ExitCode::SUCCESS } else { ExitCode::from(2) };
        }
        Err(error) => {
            let text = error.to_string();
            let first = text.lines().next().unwrap_or("bad usage").trim_start_matches("error: ");
            eprintln!("catoptric: {first}; see catoptric --help");
            return ExitCode::from(2);
        }
    };
    let result = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Eval(args) => eval::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Info(args) => info::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever read our output has seen enough.
        Err(Failure::Stdout(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(failure) => {
            let message = failure.to_string();
            if !message.is_empty() {
                eprintln!("catoptric: {message}");
            }
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Reads a mesh, or makes the built-in sample.
fn load(path: Option<&Path>) -> Result<SubdivMesh, MeshError> {
    match path {
        Some(path) => mesh::read(path),
        None => Ok(mesh::sample()),
    }
}

/// Writes to a file, whole, or to standard output.
fn write_out(path: Option<&PathBuf>, text: &[u8]) -> Result<(), Failure> {
    match path {
        Some(path) => Ok(crate::output::write_whole(path, |out| out.write_all(text))?),
        None => {
            let mut out = std::io::stdout().lock();
            out.write_all(text)?;
            Ok(out.flush()?)
        }
    }
}

/// A spinner on standard error that shows what takes longer than a second, on a terminal only.
fn progress(message: String) -> indicatif::ProgressBar {
    let bar = indicatif::ProgressBar::new_spinner().with_message(message);
    bar.enable_steady_tick(std::time::Duration::from_secs(1));
    bar
}
