//! CSV files in: rows under a header, every fault with its line.

use super::Failure;
use crate::absent::problem;
use crate::line::printable;
use crate::osd::Location;
use csv::StringRecord;
use std::fmt::Display;
use std::path::Path;

/// A point of the surface, as files name it: ptex face, u, v.
pub(super) type Place = Location;

/// A CSV file, read whole.
pub(super) struct Rows<'a> {
    path: &'a Path,
    text: Vec<u8>,
}

impl<'a> Rows<'a> {
    /// Reads a file; `what` it holds and the header that it needs are for the message.
    pub fn open(path: &'a Path, what: &str, header: &str) -> Result<Self, Failure> {
        let unread = |problem: &dyn Display| {
            let path = path.display();
            Failure::Bad(format!("{path}: cannot read the {what}: {problem}; give a CSV file with the header {header}"))
        };
        let text = std::fs::read(path).map_err(|e| unread(&problem(path, &e)))?;
        Ok(Self { path, text })
    }

    /// A text that is in memory already; `path` is its name in messages.
    pub fn of(path: &'a Path, text: &[u8]) -> Self {
        Self { path, text: text.to_owned() }
    }

    /// A fault, with its line where it has one.
    pub fn bad(&self, line: Option<u64>, what: impl Display) -> Failure {
        let place = line.map_or(String::new(), |line| format!(":{line}"));
        Failure::Bad(printable(&format!("{}{place}: {what}", self.path.display())))
    }

    /// Reads the header by `columns`, then every row by `row`; `not_a_row` says what a line that is none should be. Empty lines are
    /// passed over.
    pub fn read<C, T>(
        &self,
        columns: impl FnOnce(Option<&StringRecord>) -> Result<C, String>,
        not_a_row: &str,
        row: impl Fn(&C, &StringRecord) -> Result<T, String>,
    ) -> Result<Vec<T>, Failure> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(&self.text[..]);
        let columns = columns(reader.headers().ok()).map_err(|what| self.bad(Some(1), what))?;
        let mut rows = Vec::new();
        for record in reader.into_records() {
            let start = match &record {
                Ok(record) => record.position(),
                Err(error) => error.position(),
            };
            // Counted when asked for: it takes a walk through the file.
            let line = || start.map(|start| line_of(&self.text, start.byte() as usize));
            let found = record.as_ref().map_err(|_| not_a_row.to_owned()).and_then(|record| row(&columns, record));
            rows.push(found.map_err(|what| self.bad(line(), what))?);
        }
        Ok(rows)
    }
}

/// Line of the record whose reading began at `start`: the reader skips empty lines before it.
fn line_of(text: &[u8], start: usize) -> u64 {
    let empty = text[start..].iter().take_while(|byte| matches!(byte, b'\n' | b'\r')).count();
    text[..start + empty].iter().filter(|&&byte| byte == b'\n').count() as u64 + 1
}

/// Refuses what lies on no ptex face.
pub(super) fn check_place((face, u, v): Place, faces: usize, triangles: bool) -> Result<(), String> {
    if face as usize >= faces {
        return Err(format!("ptex face {face} does not exist; the mesh has {faces}, counted from 0"));
    }
    match [("u", u), ("v", v)].into_iter().find(|(_, x)| !(0.0..=1.0).contains(x)) {
        Some((name, x)) => Err(format!("{name} = {x} is outside 0 to 1; correct it")),
        // What rounding may add is taken for the edge itself.
        None if triangles && u + v > 1.0 + 1e-12 => {
            Err(format!("u + v = {} is outside the triangle; correct it", u + v))
        }
        None => Ok(()),
    }
}

/// A parameter as evaluators take it: so close to 0 that exponents end, it counts as 0, which moves no point by as much as
/// a rounding.
pub(super) fn parameter(x: f64) -> f64 {
    const LEAST: f64 = 1e-300;
    if x < LEAST { 0.0 } else { x }
}

/// A parameter in as few digits as bring it back, with an exponent where there would be rows of zeros.
pub(super) fn shortest(x: f64) -> String {
    if x == 0.0 || x >= 1e-5 { x.to_string() } else { format!("{x:e}") }
}
