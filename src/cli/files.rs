//! Files of a run that must not be one another's.

use super::Failure;
use super::outgoing::is_stdout;
use crate::rig::{PatternName, Rig};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What is read and what is written, however it is spelled.
#[derive(Default)]
pub(super) struct Files {
    /// By where they are: what they are called in messages.
    known: HashMap<PathBuf, &'static str>,
    /// Folders that were looked up.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Files {
    /// The files that a rig and its mesh are read from.
    pub(super) fn read(mesh: Option<&Path>, rig_file: Option<&Path>, rig: &Rig) -> Files {
        let pattern = rig.pattern.name.as_ref().and_then(|name| match name {
            PatternName::File(path) => Some(path.as_path()),
            _ => None,
        });
        let field = rig.field.as_ref().and_then(|field| field.grid()).map(|grid| grid.path());
        let mut files = Files::default();
        let inputs = [(mesh, "the mesh"), (rig_file, "the light rig"), (pattern, "the pattern"), (field, "the field")];
        for (path, what) in inputs {
            let Some(path) = path else { continue };
            let place = files.place(path);
            files.known.insert(place, what);
            // And what a link leads to.
            files.known.extend(path.canonicalize().ok().map(|target| (target, what)));
        }
        files
    }

    /// Adds a file that `flag` writes, called `what` in messages.
    ///
    /// # Errors
    /// It would replace one that is known already.
    pub(super) fn write(&mut self, path: &Path, flag: &str, what: &'static str) -> Result<(), Failure> {
        if is_stdout(path) {
            return Ok(());
        }
        let place = self.place(path);
        match self.known.insert(place, what) {
            Some(other) => {
                let path = path.display();
                Err(Failure::Bad(format!("{path}: {flag} would overwrite {other}; choose another name")))
            }
            None => Ok(()),
        }
    }

    /// Where a file is: writing one replaces a link, not what it leads to, so that only the folder is followed.
    fn place(&mut self, path: &Path) -> PathBuf {
        let folder = match path.parent() {
            Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
            Some(folder) => folder,
            None => return path.to_owned(),
        };
        let found = self.folders.entry(folder.to_owned());
        let found = found.or_insert_with(|| folder.canonicalize().unwrap_or_else(|_| folder.to_owned()));
        path.file_name().map_or_else(|| path.to_owned(), |name| found.join(name))
    }
}
