//! Whole files: written beside their destination under another name, then renamed over it.

use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

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

/// How names of files begin and end that are being written.
const PREFIX: &str = ".catoptric-";
const SUFFIX: &str = ".part";
/// Age from which such a file that nobody has locked is left over. It is locked as soon as it is made, so any age would do that is more than a
/// moment.
const LEFT_OVER: Duration = Duration::from_secs(60);

/// Keeps a file among the unfinished ones while it lives.
#[derive(Debug)]
pub(crate) struct Unfinished(PathBuf);

impl Unfinished {
    /// Notes a file that is to be removed where the process is stopped.
    pub fn note(path: &Path) -> Unfinished {
        unfinished().push(path.to_owned());
        Unfinished(path.to_owned())
    }
}

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
    // While it is written it is locked: a file that is not is left over ([`discard_left_over`]). Some file systems know no locks.
    let _ = file.as_file().try_lock();
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
    file.prefix(PREFIX).suffix(SUFFIX);
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
    begin(path).map(drop).map_err(|source| OutputError { path: path.to_owned(), source })?;
    discard_left_over(folder_of(path));
    Ok(())
}

/// Removes what processes that were killed have left of files that they were writing. What cannot be removed stays.
fn discard_left_over(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        let is_old = || {
            entry
                .metadata()
                .and_then(|data| data.modified())
                .is_ok_and(|time| time.elapsed().is_ok_and(|age| age > LEFT_OVER))
        };
        if is_ours && is_old() && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Writes a file through `content`, whole or not at all.
///
/// # Errors
/// The folder does not exist or is not writable, the disk is full, or `content` fails; the destination is untouched then.
pub fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn WriteSeek) -> std::io::Result<()>,
) -> Result<(), OutputError> {
    write_sealed(path, content, |_| Ok(()))
}

/// As [`write_whole`]; `seal` reads and changes the file once all of it is there. What is no file but a device or a pipe is not sealed.
pub(super) fn write_sealed(
    path: &Path,
    content: impl FnOnce(&mut dyn WriteSeek) -> std::io::Result<()>,
    seal: impl FnOnce(&File) -> std::io::Result<()>,
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
        writer.into_inner().map_err(std::io::IntoInnerError::into_error)?;
        seal(file.as_file())?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    write().map_err(|source| OutputError { path: path.to_owned(), source })
}
