//! Rigs as TOML or JSON files; every fault with its line.

use super::{PatternName, Rig, RigError};
use crate::absent::problem;
use crate::field::Method;
use crate::line::printable;
use std::path::{Path, PathBuf};

/// How a file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RigFormat {
    /// TOML 1.0.
    Toml,
    /// JSON.
    Json,
}

/// A file that is no rig.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {problem}", .path.display(), .line.map_or(String::new(), |line| format!(":{line}")))]
pub struct RigFileError {
    /// Which file.
    pub path: PathBuf,
    /// Which line, counted from 1.
    pub line: Option<usize>,
    /// What is wrong, and what to do.
    pub problem: String,
}

impl RigFileError {
    /// A rig from this file that turned out to contradict itself, with the line where the file says so, if it does.
    pub fn of(path: &Path, error: &RigError) -> RigFileError {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let line = RigFormat::of(path).and_then(|format| line_of_key(&text, error.key, format));
        RigFileError { path: path.to_owned(), line, problem: error.to_string() }
    }
}

impl RigFormat {
    /// By the file's extension; `None` for others.
    pub fn of(path: &Path) -> Option<RigFormat> {
        let is = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
        match () {
            () if is("toml") => Some(RigFormat::Toml),
            () if is("json") => Some(RigFormat::Json),
            () => None,
        }
    }

    /// The rig in a text, or the line of a fault and what it is.
    fn deserialize(self, text: &str) -> Result<Rig, (Option<usize>, String)> {
        match self {
            RigFormat::Toml => toml::from_str(text).map_err(|error| {
                let line = error.span().map(|span| line_of(text, span.start));
                (line, error.message().lines().collect::<Vec<_>>().join(" "))
            }),
            RigFormat::Json => serde_json::from_str(text).map_err(|error| {
                // Without the place, which goes in front.
                let what = error.to_string();
                let what = what.rsplit_once(" at line ").map_or(what.as_str(), |(what, _)| what).to_owned();
                ((error.line() > 0).then_some(error.line()), what)
            }),
        }
    }
}

/// Number of the line that a byte is in, counted from 1.
fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at.min(text.len())].iter().filter(|&&byte| byte == b'\n').count() + 1
}

/// A line of TOML without its comment: a `#` in quotes begins none.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    for (at, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') => return &line[..at],
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), _) if open == c => quote = None,
            _ => {}
        }
    }
    line
}

/// Line of a key such as `light.normal`: no two tables have a key in common.
fn line_of_key(text: &str, key: &str, format: RigFormat) -> Option<usize> {
    let name = key.rsplit('.').next().unwrap_or(key);
    let is_set = |line: &str| {
        let line = if format == RigFormat::Toml { without_comment(line) } else { line };
        line.match_indices(name).any(|(at, _)| {
            let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
            let after = line[at + name.len()..].trim_start_matches('"').trim_start();
            !line[..at].ends_with(is_word) && after.starts_with(['=', ':'])
        })
    };
    text.lines().position(is_set).map(|line| line + 1)
}

impl Rig {
    /// Reads a file: TOML or JSON by its extension. Pictures that it names are where it says, seen from its own folder.
    ///
    /// # Errors
    /// It cannot be read, or is no rig: one line, with the number of the line in question.
    pub fn read(path: &Path) -> Result<Rig, RigFileError> {
        let error = |line, problem| RigFileError { path: path.to_owned(), line, problem };
        let format = RigFormat::of(path).ok_or_else(|| {
            error(None, "not a light rig that we read; choose a name that ends in .toml or .json".to_owned())
        })?;
        let text = std::fs::read_to_string(path).map_err(|e| {
            error(None, format!("cannot read the light rig: {}; give a TOML or JSON file", problem(path, &e)))
        })?;
        let mut rig = Rig::parse(&text, format, path)?;
        if let Some(PatternName::File(picture)) = &mut rig.pattern.name {
            let found = path.parent().unwrap_or(Path::new("")).join(&*picture);
            if !found.is_file() {
                let names = "stripes, lattice, circles, band, heat or a PNG file beside this one";
                let what = format!("pattern.name \"{}\": there is no such picture; give {names}", picture.display());
                return Err(error(line_of_key(&text, "pattern.name", format), what));
            }
            *picture = found;
        }
        if let Some(grid) = rig.field.as_mut().and_then(Method::grid_mut) {
            grid.set_path(path.parent().unwrap_or(Path::new("")).join(grid.path()));
            grid.read().map_err(|what| error(line_of_key(&text, "field", format), format!("field: {what}")))?;
        }
        Ok(rig)
    }

    /// Reads a text; `path` is its name in messages. Pictures are not looked for.
    ///
    /// # Errors
    /// It is no rig, or contradicts itself: one line, with the number of the line in question.
    pub fn parse(text: &str, format: RigFormat, path: &Path) -> Result<Rig, RigFileError> {
        let error = |line, problem| RigFileError { path: path.to_owned(), line, problem };
        let rig = format
            .deserialize(text)
            .map_err(|(line, what)| error(line, format!("{}; see docs/RIGS.md", printable(&what))))?;
        // With the preset's word, as every picture has it.
        let whole = rig.clone().with_preset();
        whole.check().map_err(|e| error(line_of_key(text, e.key, format), e.to_string()))?;
        Ok(rig)
    }

    /// The text of a file in a folder that holds this rig. A picture in that folder is named without it, others are by their
    /// full path.
    ///
    /// # Errors
    /// The picture is gone.
    pub fn write(&self, format: RigFormat, folder: &Path) -> std::io::Result<String> {
        let mut rig = self.clone();
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let seen_from_there = |picture: &Path| -> std::io::Result<PathBuf> {
            let (full, folder) = (picture.canonicalize()?, folder.canonicalize()?);
            Ok(full.strip_prefix(&folder).map(Path::to_owned).unwrap_or(full))
        };
        if let Some(PatternName::File(picture)) = &mut rig.pattern.name {
            *picture = seen_from_there(picture)?;
        }
        if let Some(grid) = rig.field.as_mut().and_then(Method::grid_mut) {
            grid.set_path(seen_from_there(grid.path())?);
        }
        match format {
            RigFormat::Toml => toml::to_string(&rig).map_err(std::io::Error::other),
            RigFormat::Json => serde_json::to_string_pretty(&rig).map(|text| text + "\n").map_err(Into::into),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_where_they_are_set() {
        let toml = "# fov = 3\n[camera]\nprojection = \"orthographic\"\nfov = 26\nlight.lines = [1, 2, 3]";
        assert_eq!(line_of_key(toml, "camera.fov", RigFormat::Toml), Some(4));
        assert_eq!(line_of_key(toml, "light.lines", RigFormat::Toml), Some(5));
        assert_eq!(line_of_key(toml, "light.normal", RigFormat::Toml), None);
        let inline = "\ncolours = { paint = \"#112233\", top = '#445566' } # bottom = 3";
        assert_eq!(line_of_key(inline, "colours.top", RigFormat::Toml), Some(2));
        assert_eq!(line_of_key(inline, "colours.bottom", RigFormat::Toml), None);
        let json = "{\"light\": {\n \"lines\" : [0, 0, 0]}}";
        assert_eq!(line_of_key(json, "light.lines", RigFormat::Json), Some(2));
        let json = "{\"colours\": {\"paint\": \"#112233\"}, \"light\": {\"normal\": [0, 0, 0]}}";
        assert_eq!(line_of_key(json, "light.normal", RigFormat::Json), Some(1));
    }
}
