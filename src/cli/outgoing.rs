//! What leaves the program: files, each named on standard error when the command is done, and at most one of them to standard output.

use super::{Failure, check_stdout, heard};
use crate::output::{Layers, WriteSeek, check_writable, exr_bytes, write_whole};
use std::io::{Cursor, Write};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The files of this run. One a process, as standard output is.
static OUTGOING: Mutex<Outgoing> = Mutex::new(Outgoing { to_stdout: None, written: Vec::new() });

#[derive(Debug, Default)]
struct Outgoing {
    /// The flag whose file is standard output.
    to_stdout: Option<&'static str>,
    /// A line a file, to be said at the end.
    written: Vec<String>,
}

fn outgoing() -> MutexGuard<'static, Outgoing> {
    OUTGOING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What standard output is called where a file is named.
pub(super) const STDOUT: &str = "-";

/// Whether a path stands for standard output.
pub(super) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == STDOUT
}

/// Tells before the work that what `flag` names cannot be written. What goes to standard output has it alone from now on.
pub(super) fn check(path: &Path, flag: &'static str) -> Result<(), Failure> {
    if !is_stdout(path) {
        return Ok(check_writable(path)?);
    }
    match outgoing().to_stdout.replace(flag) {
        None => Ok(()),
        Some(other) => {
            let what = if other == flag { "twice".to_owned() } else { format!("for {other} and {flag}") };
            Err(Failure::Bad(format!("standard output (-) is named {what}; write one of them to a file")))
        }
    }
}

/// Refuses a file whose name does not say in which of our formats `what` is to be written; `endings` are those that do.
pub(super) fn unknown_ending(path: &Path, what: &str, endings: &str) -> Failure {
    let shown = path.display();
    if path.is_dir() {
        let first = endings.split([',', ' ']).next().unwrap_or_default();
        let example = path.join("view").with_extension(first.trim_start_matches('.'));
        return Failure::Bad(format!("{shown}: it is a folder; name a file in it, such as {}", example.display()));
    }
    Failure::Bad(format!("{shown}: not {what} that we write; choose a name that ends in {endings}"))
}

/// Writes a file through `content`, whole or not at all, or to standard output.
pub(super) fn write(
    path: &Path,
    content: impl FnOnce(&mut dyn WriteSeek) -> std::io::Result<()>,
) -> Result<(), Failure> {
    if !is_stdout(path) {
        return Ok(write_whole(path, content)?);
    }
    // Formats with an index go back to fill it in, which a pipe does not.
    let mut whole = Cursor::new(Vec::new());
    content(&mut whole)?;
    to_stdout(whole.get_ref())
}

/// Writes what a command says: to standard output, or to standard error where a file goes there.
pub(super) fn say(text: &[u8]) -> Result<(), Failure> {
    if outgoing().to_stdout.is_none() {
        return to_stdout(text);
    }
    // Where nobody takes it, the work goes on.
    let _ = std::io::stderr().write_all(text);
    Ok(())
}

/// Writes an OpenEXR picture to a file, whole or not at all, or to standard output.
pub(super) fn write_exr(path: &Path, layers: &Layers<'_>) -> Result<(), Failure> {
    if is_stdout(path) { to_stdout(&exr_bytes(layers)?) } else { Ok(crate::output::write_exr(path, layers)?) }
}

fn to_stdout(bytes: &[u8]) -> Result<(), Failure> {
    check_stdout()?;
    let mut out = std::io::stdout().lock();
    heard(out.write_all(bytes).and_then(|()| out.flush()))
}

/// Notes a file that was written, for the end; `what` it is may be empty.
pub(super) fn note(path: &Path, what: &str) {
    if !is_stdout(path) {
        let what = if what.is_empty() { String::new() } else { format!(", {what}") };
        note_line(format!("wrote {}{what}", path.display()));
    }
}

/// Notes a line about files that were written.
pub(super) fn note_line(line: String) {
    outgoing().written.push(line);
}

/// Says which files were written, a line each.
pub(super) fn say_written() {
    for line in std::mem::take(&mut outgoing().written) {
        tell!("{}", crate::line::printable(&line));
    }
}
