//! The command line: a thin layer of typed flags over the library.

/// Writes a line to standard error. Where nobody takes it, the work goes on.
macro_rules! tell {
    ($($line:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), $($line)*);
    }};
}

mod account;
mod adapters;
mod args;
mod bench;
mod compare;
mod eval;
mod field;
mod files;
mod frames;
mod glints;
mod info;
mod lines;
mod manual;
mod memory;
mod numbered;
mod outgoing;
mod patches;
mod quality;
mod render;
mod rig;
mod rows;
mod scene;
mod series;
mod settings;
mod usage;
mod verify;

pub use eval::parse_samples;
pub use verify::parse_answers;

use args::{Cli, Command};
use clap::Parser;
use clap::error::ErrorKind;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ffi::OsString;
use std::fmt::Display;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use crate::gpu::GpuError;
use crate::line::printable;
use crate::mesh::{MeshError, SubdivMesh};
use crate::output::OutputError;
use crate::stam::LimitSurface;

/// Why a command stopped, and with which exit code.
#[derive(Debug)]
enum Failure {
    /// A check failed; the report says which.
    Check,
    /// Bad usage or input: what, where, what to do.
    Bad(String),
    /// No usable GPU adapter.
    NoAdapter(String),
    /// Standard output is gone.
    Stdout(std::io::Error),
}

impl Failure {
    /// A failure with the mesh in front.
    fn of(mesh: &SubdivMesh, error: impl Display) -> Self {
        Self::Bad(format!("{}: {error}", mesh.name))
    }

    /// What it says in one line.
    fn line(self) -> String {
        match self {
            Self::Check => "a check failed".to_owned(),
            Self::Bad(message) | Self::NoAdapter(message) => message,
            Self::Stdout(error) => format!("cannot write to standard output: {error}"),
        }
    }
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        let limit = crate::memory::limit();
        match error {
            GpuError::NoAdapter => Self::NoAdapter(error.to_string()),
            GpuError::UnknownAdapter { .. } => Self::NoAdapter(format!("CATOPTRIC_ADAPTER: {error}")),
            // Drivers say little of it.
            GpuError::Device { .. } if limit.cause.is_hard() => Self::Bad(format!("{error}; at the start {limit}")),
            _ => Self::Bad(error.to_string()),
        }
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::Bad(error.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::Bad(error.to_string())
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::Stdout(error)
    }
}

/// Parses the arguments of the process, runs the command and returns its exit code: 0 done or passed, 1 a check failed,
/// 2 bad usage or input, 3 no usable GPU adapter. `commit` is that of the source that the program was built from, for `--version`; empty
/// where it is not known.
pub fn run(commit: &str) -> ExitCode {
    let args: Vec<OsString> = std::env::args_os().collect();
    let cli = match Cli::try_parse_from(&args) {
        Ok(cli) => cli,
        Err(error) if error.kind() == ErrorKind::DisplayVersion => {
            return exit_code(outgoing::say(version(commit).as_bytes()));
        }
        // Help.
        Err(error) if !error.use_stderr() => {
            return exit_code(check_stdout().and_then(|()| heard(error.print())));
        }
        Err(error) => {
            tell!("catoptric: {}", printable(&usage::line(&error, &args)));
            return ExitCode::from(2);
        }
    };
    // The process that started a worker asks how it ended.
    if !matches!(cli.command, Command::ReferenceWorker) {
        crate::osd::name_fatal_signals();
    }
    discard_unfinished_when_stopped();
    let ready = cli.memory.apply().and_then(|()| match cli.command {
        // Known before the work, where all of the answer goes there.
        Command::Verify(_) | Command::Quality(_) | Command::Info(_) | Command::Bench(_) => check_stdout(),
        _ => Ok(()),
    });
    let result = ready.and_then(|()| match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Lines(args) => lines::run(&args),
        Command::Eval(args) => eval::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Glints(args) => glints::run(&args),
        Command::Quality(args) => quality::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::ReferenceWorker => verify::work(),
        Command::Adapters => adapters::run(),
        Command::Man(args) => manual::man(&args),
        Command::Completions(args) => manual::completions(&args),
    });
    outgoing::say_written();
    exit_code(result)
}

/// One line: version, OpenSubdiv's, and the commit where it is known.
fn version(commit: &str) -> String {
    let commit = if commit.is_empty() { String::new() } else { format!(", commit {commit}") };
    format!("catoptric {} (OpenSubdiv {}{commit})\n", env!("CARGO_PKG_VERSION"), crate::osd::version())
}

/// The exit code of a command, after a line that says why it stopped.
fn exit_code(result: Result<(), Failure>) -> ExitCode {
    let failure = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Check) => return ExitCode::from(1),
        Err(failure) => failure,
    };
    let code = if matches!(failure, Failure::NoAdapter(_)) { 3 } else { 2 };
    tell!("catoptric: {}", printable(&failure.line()));
    ExitCode::from(code)
}

/// Writes a text to a file, whole, which is named at the end; `None`: what the command says, to standard output.
fn write_out(path: Option<&PathBuf>, text: &[u8]) -> Result<(), Failure> {
    let Some(path) = path else { return outgoing::say(text) };
    outgoing::write(path, |out| out.write_all(text))?;
    outgoing::note(path, "");
    Ok(())
}

/// The result of writing to standard output: whoever closed the pipe that it is (`| head -1`) has read enough, and what the command finds
/// out decides its exit code as ever.
fn heard(written: std::io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

/// An error if nothing can be written to standard output: the standard library takes one that is closed for one that discards everything.
fn check_stdout() -> Result<(), Failure> {
    let closed = |what: &str| {
        Err(Failure::Bad(format!("{what}; give the command a standard output, or a file where it takes one")))
    };
    if crate::osd::stdout_was_closed() {
        return closed("standard output is closed, and the answer goes there");
    }
    #[cfg(unix)]
    if rustix::fs::fcntl_getfl(std::io::stdout())
        .is_ok_and(|flags| flags & rustix::fs::OFlags::RWMODE == rustix::fs::OFlags::RDONLY)
    {
        return closed("standard output is open for reading alone, and the answer goes there");
    }
    Ok(())
}

/// A spinner on standard error that shows what takes longer than a second, on a terminal only.
fn progress(message: String) -> ProgressBar {
    const PATIENCE: Duration = Duration::from_secs(1);
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()).with_message(message);
    bar.set_style(ProgressStyle::default_spinner());
    if std::io::stderr().is_terminal() {
        let weak = bar.downgrade();
        std::thread::spawn(move || {
            std::thread::sleep(PATIENCE);
            if let Some(bar) = weak.upgrade().filter(|bar| !bar.is_finished()) {
                bar.set_draw_target(ProgressDrawTarget::stderr());
                bar.enable_steady_tick(PATIENCE);
            }
        });
    }
    bar
}

/// Makes a spinner a bar of per cent, and returns what sets it: how much is done, from 0 to 1.
fn percent(bar: &ProgressBar) -> impl Fn(f64) + Sync {
    /// Steps of the bar.
    const WHOLE: f64 = 1000.0;
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:40} {percent} %, {eta} left") {
        bar.set_style(style);
    }
    bar.set_position(0);
    bar.set_length(WHOLE as u64);
    bar.reset_eta();
    let bar = bar.clone();
    move |done| bar.set_position((done * WHOLE) as u64)
}

/// The surface of a mesh; the spinner becomes a bar meanwhile, where there is more than one piece to refine.
fn refined(mesh: &SubdivMesh, spinner: &ProgressBar) -> Result<LimitSurface, Failure> {
    let message = spinner.message();
    let watch = |done: usize, pieces: usize| {
        if pieces > 1 {
            spinner.set_length(pieces as u64);
            spinner.set_position(done as u64);
            if let Ok(style) = ProgressStyle::with_template("refining {bar:40} {pos} of {len} pieces, {eta} left") {
                spinner.set_style(style);
            }
        }
    };
    let surface = LimitSurface::watched(mesh, &watch).map_err(|error| Failure::of(mesh, error));
    spinner.set_style(ProgressStyle::default_spinner());
    spinner.set_message(message);
    surface
}

/// A bar on standard error that counts steps of what takes longer than a second, on a terminal only.
struct Steps {
    bar: ProgressBar,
    start: Instant,
}

impl Steps {
    fn new(count: usize, what: &str) -> Steps {
        let hidden = ProgressDrawTarget::hidden();
        let bar = ProgressBar::with_draw_target(Some(count as u64), hidden).with_message(what.to_owned());
        let style = ProgressStyle::with_template("{bar:40} {pos} of {len} {msg}, {eta} left");
        Steps { bar: style.map(|style| bar.clone().with_style(style)).unwrap_or(bar), start: Instant::now() }
    }

    fn done_one(&self) {
        if self.bar.is_hidden() && self.start.elapsed().as_secs() >= 1 {
            // Not a terminal: it stays hidden.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.inc(1);
    }

    /// Runs what writes to the terminal, with the bar out of the way.
    fn aside<R>(&self, write: impl FnOnce() -> R) -> R {
        self.bar.suspend(write)
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Takes away what is not finished when the process is interrupted, terminated or left by its terminal, then lets it die of that.
/// Files that grow beyond the limit of the shell (`ulimit -f`) are errors like any other.
#[cfg(unix)]
fn discard_unfinished_when_stopped() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use std::sync::atomic::AtomicBool;
    // Nothing to do but not to die: the write fails, and says why.
    static TOO_LARGE: AtomicBool = AtomicBool::new(false);
    let _ = signal_hook::flag::register(SIGXFSZ, &TOO_LARGE);
    let ignored = ignored_signals();
    let stops = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored & (1 << (signal - 1)) == 0);
    // Without a handler the worst is a hidden file that stays.
    let Ok(mut signals) = signal_hook::iterator::Signals::new(stops) else { return };
    let wait = move || {
        for signal in signals.forever() {
            crate::output::discard_unfinished();
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    };
    // Nor is there more to lose without a thread.
    let _ = std::thread::Builder::new().spawn(wait);
}

/// Signals that whoever started us wants ignored, as `nohup` does, a bit each; none where the system does not say (elsewhere than on
/// Linux).
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

#[cfg(not(unix))]
fn discard_unfinished_when_stopped() {}
