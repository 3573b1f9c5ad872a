//! Whole files: written beside their destination under another name, then renamed over it.

use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Why a file was not written. Whatever stood at the path before still stands there.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot write: {source}; {}", path.display(), remedy(source))]
pub struct OutputError {
    /// Destination.
    pub path: PathBuf,
    /// What the system said.
    pub source: std::io::Error,
}

/// What to do about it.
fn remedy(error: &std::io::Error) -> &'static str {
    use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    match error.kind() {
        StorageFull | QuotaExceeded | FileTooLarge => "make room, or write elsewhere",
        _ => "choose a writable path",
    }
}

/// What a file's content is written to; formats with an index go back to fill it in.
pub trait WriteSeek: Write + Seek {}

impl<W: Write + Seek> WriteSeek for W {}

/// Files that are being written.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps a file among the unfinished ones while it lives.
struct Unfinished(PathBuf);

impl Drop for Unfinished {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

/// Begins the file that becomes `path`.
fn begin(path: &Path) -> std::io::Result<(tempfile::NamedTempFile, Unfinished)> {
    // Locked until it is noted, so that no file is there that is not.
    let mut unfinished = unfinished();
    let file = beside(path)?;
    unfinished.push(file.path().to_owned());
    let noted = Unfinished(file.path().to_owned());
    Ok((file, noted))
}

/// Removes the files that this process has begun and not finished: for when it is stopped, which runs no destructors. No
/// file is finished afterwards.
pub fn discard_unfinished() {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // It may be finished already, under its own name.
        let _ = std::fs::remove_file(path);
    }
    // Whoever begins another file waits for the end of the process.
    std::mem::forget(unfinished);
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Creates the file that is renamed over `path` later; it removes itself until then.
fn beside(path: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    if path.is_dir() {
        return Err(std::io::Error::other("it is a folder"));
    }
    let folder = folder_of(path);
    if let Some(problem) = crate::absent::no_folder(Some(folder)) {
        return Err(std::io::Error::other(problem));
    }
    let mut file = tempfile::Builder::new();
    file.prefix(".catoptric-").suffix(".part");
    // The usual rights of a new file: a temporary one is private otherwise.
    #[cfg(unix)]
    file.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // The error itself would name the temporary file, which tells the user nothing.
    file.tempfile_in(folder).map_err(|error| error.kind().into())
}

/// Whether there is something at the path that is neither a file nor a folder.
fn is_special(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Tells early, before the work, that a file could not be written: its folder is missing or not writable, or the path
/// is a folder.
///
/// # Errors
/// As above. Nothing is left behind.
pub fn check_writable(path: &Path) -> Result<(), OutputError> {
    if is_special(path) {
        return Ok(());
    }
    begin(path).map(drop).map_err(|source| OutputError { path: path.to_owned(), source })
}

/// Writes a file through `content`, whole or not at all.
///
/// # Errors
/// The folder does not exist or is not writable, the disk is full, or `content` fails; the destination is untouched then.
pub fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn WriteSeek) -> std::io::Result<()>,
) -> Result<(), OutputError> {
    let write = || -> std::io::Result<()> {
        // A device or a pipe is written to, not replaced.
        if is_special(path) {
            let mut writer = BufWriter::new(std::fs::OpenOptions::new().write(true).open(path)?);
            content(&mut writer)?;
            return writer.flush();
        }
        let (file, _unfinished) = begin(path)?;
        // The file itself: errors of the temporary one would name it.
        let mut writer = BufWriter::new(file.as_file());
        content(&mut writer)?;
        writer.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    write().map_err(|source| OutputError { path: path.to_owned(), source })
}
