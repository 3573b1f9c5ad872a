//! Statements of an OBJ that are passed over: which, and how many.

use std::collections::HashMap;
use std::fmt;

use crate::mesh::error::quote;

/// Keywords of which the exact number is kept: more different ones are in no OBJ, but in a text that is none.
const MOST_KEYWORDS: usize = 1000;

/// Keywords of a kind that are named.
const MOST_NAMED: usize = 12;

/// What a keyword says that is passed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    FreeForm,
    Lines,
    Points,
    Files,
    Commands,
    Display,
    Comments,
    Unknown,
}

impl Kind {
    const ALL: [Self; 8] = [
        Self::FreeForm,
        Self::Lines,
        Self::Points,
        Self::Files,
        Self::Commands,
        Self::Display,
        Self::Comments,
        Self::Unknown,
    ];

    /// The kind of a keyword of the format's version 3.0, with those that it supersedes; `None` for what everybody
    /// writes and what changes no surface: texture coordinates, normals, groups, objects, smoothing groups and
    /// materials.
    fn of(keyword: &[u8]) -> Option<Self> {
        Some(match keyword {
            b"vt" | b"vn" | b"g" | b"o" | b"s" | b"usemtl" | b"mtllib" => return None,
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm" | b"trim"
            | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"mg" | b"ctech" | b"stech" => Self::FreeForm,
            b"bsp" | b"bzp" | b"cdc" | b"cdp" | b"res" => Self::FreeForm,
            b"l" => Self::Lines,
            b"p" => Self::Points,
            b"call" => Self::Files,
            b"csh" => Self::Commands,
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap" | b"maplib" | b"shadow_obj" | b"trace_obj" => {
                Self::Display
            }
            _ => Self::Unknown,
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::FreeForm => "free-form geometry",
            Self::Lines => "lines",
            Self::Points => "points",
            Self::Files => "other files",
            Self::Commands => "commands",
            Self::Display => "display attributes",
            Self::Comments => "comments that say creases",
            Self::Unknown => "unknown keywords",
        }
    }
}

struct Keyword {
    name: String,
    kind: Kind,
    count: usize,
    /// The line that it stands in first.
    line: u32,
}

/// The statements that were passed over. Shows as a list: `lines (3 l), unknown keywords (2 fa, the first in line 7)`.
#[derive(Default)]
pub(super) struct Passed {
    keywords: Vec<Keyword>,
    index: HashMap<Vec<u8>, usize>,
    /// Statements beyond [`MOST_KEYWORDS`].
    others: usize,
}

impl Passed {
    /// Counts a statement, unless it is one that is told of nobody's file.
    pub(super) fn count(&mut self, keyword: &[u8], line: u32) {
        let Some(kind) = Kind::of(keyword) else { return };
        match self.index.get(keyword) {
            Some(&index) => self.keywords[index].count += 1,
            None if self.keywords.len() == MOST_KEYWORDS => self.others += 1,
            None => {
                self.index.insert(keyword.to_owned(), self.keywords.len());
                self.keywords.push(Keyword { name: quote(keyword), kind, count: 1, line });
            }
        }
    }

    /// Counts comments that say creases; they are first in a line.
    pub(super) fn count_comments(&mut self, (count, line): (usize, u32)) {
        if count > 0 {
            self.keywords.push(Keyword { name: "# crease".to_owned(), kind: Kind::Comments, count, line });
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.keywords.is_empty()
    }
}

impl fmt::Display for Passed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "";
        for kind in Kind::ALL {
            let found: Vec<&Keyword> = self.keywords.iter().filter(|keyword| keyword.kind == kind).collect();
            let Some(first) = found.first() else { continue };
            let named = found.iter().take(MOST_NAMED).map(|Keyword { name, count, .. }| format!("{count} {name}"));
            write!(f, "{between}{} ({}", kind.name(), named.collect::<Vec<_>>().join(", "))?;
            let more = found[found.len().min(MOST_NAMED)..].iter().map(|keyword| keyword.count).sum::<usize>();
            match kind {
                Kind::Unknown if more + self.others > 0 => write!(f, " and {} of others", more + self.others)?,
                _ if more > 0 => write!(f, " and {more} of others")?,
                _ => {}
            }
            if matches!(kind, Kind::Comments | Kind::Unknown) {
                write!(f, ", the first in line {}", first.line)?;
            }
            write!(f, ")")?;
            between = ", ";
        }
        Ok(())
    }
}
