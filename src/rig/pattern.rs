//! The shape of the lights, as rigs say it.

use super::values;
use crate::absent::problem;
use crate::field::{Method, Pattern, Picture};
use crate::nearest::nearest;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What is said of a pattern.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PatternRig {
    /// Which one.
    #[serde(skip_serializing_if = "Option::is_none", with = "values::text")]
    pub name: Option<PatternName>,
    /// Part of the spacing that shines, 0 to 1; of circles their diameter.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "values::part")]
    pub width: Option<f64>,
    /// Ends of the scale of false colours in units of the field, the smaller first.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "values::range")]
    pub range: Option<[f64; 2]>,
}

/// Name of a [`Pattern`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PatternName {
    /// [`Pattern::Stripes`].
    Stripes,
    /// [`Pattern::Lattice`].
    Lattice,
    /// [`Pattern::Circles`].
    Circles,
    /// [`Pattern::Band`].
    Band,
    /// [`Pattern::Heat`].
    Heat,
    /// [`Pattern::Picture`]: a file.
    File(PathBuf),
}

impl FromStr for PatternName {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<PatternName, Self::Err> {
        Ok(match text {
            "stripes" => PatternName::Stripes,
            "lattice" => PatternName::Lattice,
            "circles" => PatternName::Circles,
            "band" => PatternName::Band,
            "heat" => PatternName::Heat,
            path => PatternName::File(PathBuf::from(path)),
        })
    }
}

impl fmt::Display for PatternName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            PatternName::Stripes => "stripes",
            PatternName::Lattice => "lattice",
            PatternName::Circles => "circles",
            PatternName::Band => "band",
            PatternName::Heat => "heat",
            PatternName::File(path) => return path.display().fmt(f),
        })
    }
}

impl PatternRig {
    pub(super) fn over(self, base: PatternRig) -> PatternRig {
        let base = if self.name.is_none() { base } else { PatternRig::default() };
        PatternRig { name: self.name.or(base.name), width: self.width.or(base.width), range: self.range.or(base.range) }
    }

    /// The pattern, and its picture if it is one. `None` for the ends of false colours that are to be fitted.
    ///
    /// # Errors
    /// The picture cannot be read: one line.
    pub fn read(&self, method: &Method) -> Result<Option<Pattern>, String> {
        let width = |usual: f64| self.width.unwrap_or(usual);
        Ok(Some(match self.name_for(method) {
            PatternName::Stripes => Pattern::Stripes { width: width(0.42) },
            PatternName::Lattice => Pattern::Lattice { width: width(0.2) },
            PatternName::Circles => Pattern::Circles { radius: width(0.6) / 2.0 },
            PatternName::Band => Pattern::Band { radius: width(0.42) / 2.0 },
            PatternName::Heat => return Ok(self.range.map(|range| Pattern::Heat { range })),
            PatternName::File(path) => Pattern::Picture(picture(&path)?),
        }))
    }

    /// The pattern's name, where none is given the usual one of a method.
    pub fn name_for(&self, method: &Method) -> PatternName {
        let usual = if method.reads_curvature() { PatternName::Heat } else { PatternName::Stripes };
        self.name.clone().unwrap_or(usual)
    }

    /// A pattern of this name, with nothing left open.
    pub fn of(name: PatternName, pattern: &Pattern) -> PatternRig {
        let (width, range) = match *pattern {
            Pattern::Stripes { width } | Pattern::Lattice { width } => (Some(width), None),
            Pattern::Circles { radius } | Pattern::Band { radius } => (Some(2.0 * radius), None),
            Pattern::Heat { range } => (None, Some(range)),
            Pattern::Picture(_) => (None, None),
        };
        PatternRig { name: Some(name), width, range }
    }
}

fn picture(path: &Path) -> Result<Picture, String> {
    const NAMES: [&str; 5] = ["stripes", "lattice", "circles", "band", "heat"];
    let bad = |what: String| {
        let names = "stripes, lattice, circles, band, heat or a PNG file";
        format!("{}: {what}; give {names}", path.display())
    };
    let unread = |e: std::io::Error| {
        // A name that is no path is a name misspelt.
        let is_name =
            e.kind() == std::io::ErrorKind::NotFound && path.extension().is_none() && path.iter().count() == 1;
        let near = is_name.then(|| nearest(&path.to_string_lossy(), NAMES)).flatten();
        match near {
            Some(name) => bad(format!("no pattern has this name (did you mean {name}?), and no file")),
            None => bad(format!("cannot read the pattern: {}", problem(path, &e))),
        }
    };
    let reader = image::ImageReader::open(path).map_err(unread)?;
    let reader = reader.with_guessed_format().map_err(unread)?;
    let picture = reader.decode().map_err(|e| bad(format!("not a picture we read ({e})")))?.to_rgba8();
    Ok(Picture { size: [picture.width(), picture.height()], rgba8: picture.into_raw() })
}
