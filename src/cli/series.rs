//! One run at a time draws a series of pictures: a lock beside its files.
//!
//! The lock is the system's, and ends with the process that holds it, however that ends: a file that a killed run has left is taken over. What
//! is written in it is for people, and for the message of whoever comes second.

use super::Failure;
use crate::digest::{START, fnv1a};
use crate::line::printable;
use crate::output::Unfinished;
use std::fs::{File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Longest file name that is part of the lock's, in bytes: names end at some 255 of them.
const LONGEST: usize = 200;
/// Most of what another run says of itself that is told.
const MOST_TOLD: u64 = 400;

/// A series that no other run draws while this lives.
#[derive(Debug)]
pub(super) struct Series {
    path: PathBuf,
    _file: File,
    _noted: Unfinished,
}

impl Series {
    /// Begins the series of a name with `#` in place of the number, beside `output`.
    ///
    /// # Errors
    /// Another run is drawing it, or the lock cannot be written.
    pub fn begin(output: &Path, name: &str) -> Result<Series, Failure> {
        let name = match name.len() {
            ..=LONGEST => name.to_owned(),
            _ => format!("{:016x}", fnv1a(START, name.as_bytes())),
        };
        let path = output.with_file_name(format!(".catoptric-{name}.lock"));
        let failed =
            |error: std::io::Error| Failure::Bad(format!("{}: cannot lock the series: {error}", path.display()));
        loop {
            let mut file =
                File::options().read(true).write(true).create(true).truncate(false).open(&path).map_err(failed)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(taken(output, file)),
                Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => {
                    tell!(
                        "catoptric: {}: this file system knows no locks ({error}); start no other run that draws these frames",
                        printable(&path.display().to_string())
                    );
                }
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
            // Whoever held it before has removed it meanwhile: then the lock is on a file that nobody finds.
            if !is_at(&file, &path) {
                continue;
            }
            let noted = Unfinished::note(&path);
            let words: Vec<String> = std::env::args().skip(1).collect();
            let record = format!("process {}: catoptric {}\n", std::process::id(), words.join(" "));
            file.set_len(0)
                .and_then(|()| file.rewind())
                .and_then(|()| file.write_all(record.as_bytes()))
                .map_err(failed)?;
            return Ok(Series { path, _file: file, _noted: noted });
        }
    }
}

impl Drop for Series {
    fn drop(&mut self) {
        // Still locked, so nobody else has it.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// The refusal of whoever comes second.
fn taken(output: &Path, mut file: File) -> Failure {
    let mut record = String::new();
    // It is written as soon as the lock is there. One that cannot be read says nothing.
    for _ in 0..20 {
        let _ = file.rewind().and_then(|()| (&file).take(MOST_TOLD).read_to_string(&mut record));
        if !record.trim().is_empty() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let who = if record.trim().is_empty() { String::new() } else { format!(" ({})", record.trim()) };
    Failure::Bad(format!(
        "{}: another run is drawing this series{who}; wait until it is done, or choose another -o",
        output.display()
    ))
}

/// Whether an open file is the one at a path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |data: std::fs::Metadata| (data.dev(), data.ino());
    let there = std::fs::metadata(path).map(place).ok();
    there.is_some() && file.metadata().map(place).ok() == there
}

/// A file that is open is not removed.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}
