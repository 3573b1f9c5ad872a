//! Which meshes to verify: files, folders and patterns.

use super::super::{Failure, scene::SceneArgs};
use crate::absent::no_folder;
use crate::mesh::{self, MeshFormat, SubdivMesh};
use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

/// A mesh to verify.
#[derive(Debug)]
pub(super) struct Input {
    /// Its file; `None` for the built-in sample.
    pub path: Option<PathBuf>,
    /// What was named by itself is read at once, so that a typing error costs no minutes. What was found in a folder or by a
    /// pattern is read when its turn comes, and may be refused.
    named: Option<SubdivMesh>,
    scene: SceneArgs,
    /// Why the folder that should have it cannot be read.
    unreadable: Option<String>,
}

impl Input {
    fn named(path: Option<&Path>, scene: &SceneArgs) -> Result<Self, Failure> {
        let named = Some(scene.load(path)?);
        Ok(Self { path: path.map(Path::to_owned), named, scene: scene.clone(), unreadable: None })
    }

    fn found(path: PathBuf, unreadable: Option<String>) -> Self {
        Self { path: Some(path), named: None, scene: SceneArgs::default(), unreadable }
    }

    /// Whether the command line names this very mesh, so that its refusal ends the run.
    pub fn is_named(&self) -> bool {
        self.named.is_some()
    }

    /// Where it comes from, as the command line or its folder spells it.
    pub fn source(&self) -> Option<String> {
        self.path.as_ref().map(|path| path.display().to_string())
    }

    /// Name that its report will have.
    pub fn name(&self) -> String {
        match (&self.named, &self.path) {
            (Some(mesh), _) => mesh.name.clone(),
            (None, Some(path)) => mesh::stem(path),
            (None, None) => "sample".to_owned(),
        }
    }

    /// The mesh, or one line that says why there is none.
    pub fn mesh(&self) -> Result<SubdivMesh, String> {
        match (&self.named, &self.unreadable) {
            (Some(mesh), _) => Ok(mesh.clone()),
            (_, Some(reason)) => Err(reason.clone()),
            _ => self.scene.read(self.path.as_deref()),
        }
    }
}

/// Finds the meshes: in the order of the command line, those of a folder or pattern sorted by name, none twice.
///
/// # Errors
/// A mesh that is named by itself is refused; a folder or pattern has no mesh.
pub(super) fn find(words: &[PathBuf], scene: &SceneArgs) -> Result<Vec<Input>, Failure> {
    if words.is_empty() {
        return Ok(vec![Input::named(None, scene)?]);
    }
    let mut inputs = Vec::new();
    for word in words {
        let found = match pattern(word) {
            Some(pattern) => matches(word, pattern)?,
            None if word.is_dir() => walk(word),
            None => vec![Input::named(Some(word), scene)?],
        };
        if found.is_empty() {
            return Err(Failure::Bad(format!("{}: {}; check the path", word.display(), no_mesh(word))));
        }
        inputs.extend(found.into_iter().map(|input| Input { scene: scene.clone(), ..input }));
    }
    let mut seen = HashSet::new();
    inputs.retain(|input| seen.insert(input.path.clone()));
    Ok(inputs)
}

/// A word with wildcards that is not the name of a file.
fn pattern(word: &Path) -> Option<&str> {
    word.to_str().filter(|text| text.contains(['*', '?', '[']) && !word.exists())
}

/// Why there is no mesh in a folder, or none that matches a pattern.
fn no_mesh(word: &Path) -> String {
    let extensions = mesh::EXTENSIONS.map(|extension| format!(".{extension}")).join(", ");
    if word.is_dir() {
        return format!("the folder has no mesh ({extensions})");
    }
    // The folders before the first wildcard are meant as they stand.
    let is_plain = |part: &Component<'_>| !part.as_os_str().to_string_lossy().contains(['*', '?', '[']);
    let folder: PathBuf = word.components().take_while(is_plain).collect();
    let others = word.to_str().and_then(|text| glob::glob(text).ok()).map_or(0, Iterator::count);
    match (no_folder(Some(&folder)), others) {
        (Some(problem), _) => problem,
        (None, 0) => format!("no mesh matches ({extensions})"),
        (None, 1) => format!("1 file matches, but none is a mesh ({extensions})"),
        (None, others) => format!("{others} files match, but none is a mesh ({extensions})"),
    }
}

fn matches(word: &Path, pattern: &str) -> Result<Vec<Input>, Failure> {
    let paths = glob::glob(pattern).map_err(|error| Failure::Bad(format!("{}: {error}", word.display())))?;
    let inputs = paths.flat_map(|path| match path {
        Ok(path) if path.is_dir() => walk(&path),
        Ok(path) if is_mesh(&path) => vec![Input::found(path, None)],
        Ok(_) => Vec::new(),
        Err(error) => vec![Input::found(error.path().to_owned(), Some(error.to_string().replace('\n', " ")))],
    });
    Ok(inputs.collect())
}

/// The meshes of a folder and of the folders in it, sorted by name.
fn walk(folder: &Path) -> Vec<Input> {
    let entries = walkdir::WalkDir::new(folder).follow_links(true).sort_by_file_name();
    let inputs = entries.into_iter().filter_map(|entry| match entry {
        Ok(entry) => {
            (entry.file_type().is_file() && is_mesh(entry.path())).then(|| Input::found(entry.into_path(), None))
        }
        Err(error) => {
            let path = error.path().unwrap_or(folder).to_owned();
            // A link that leads nowhere is no mesh, unless it is called like one.
            (path.is_dir() || is_mesh(&path)).then(|| Input::found(path, Some(error.to_string().replace('\n', " "))))
        }
    });
    inputs.collect()
}

fn is_mesh(path: &Path) -> bool {
    MeshFormat::of_path(path).is_some()
}
