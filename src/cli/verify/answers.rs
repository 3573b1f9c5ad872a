//! Another program's answers, from a CSV file.

use super::super::Failure;
use super::super::rows::{Rows, check_place, parameter};
use crate::verify::Sample;
use crate::verify::conformance::Answer;
use csv::StringRecord;
use glam::DVec3;
use std::path::Path;

const NEEDED: &str = "face,u,v,x,y,z";

/// Where the columns of answers are.
struct Columns {
    place: [usize; 3],
    position: [usize; 3],
    derivatives: Option<[[usize; 3]; 2]>,
    normal: Option<[usize; 3]>,
}

impl Columns {
    /// Finds columns by their names, in any order; others are passed over.
    fn of(header: Option<&StringRecord>) -> Result<Self, String> {
        let header = header.ok_or_else(|| format!("the header is not text; make {NEEDED} the first line"))?;
        let find = |name: &str| {
            let mut found = header.iter().enumerate().filter(|(_, column)| *column == name).map(|(i, _)| i);
            match (found.next(), found.next()) {
                (_, Some(_)) => Err(format!("column {name} is there twice; leave one")),
                (first, None) => Ok(first),
            }
        };
        let needed = |names: [&str; 3]| -> Result<[usize; 3], String> {
            let mut columns = [0; 3];
            for (column, name) in columns.iter_mut().zip(names) {
                *column =
                    find(name)?.ok_or_else(|| format!("the header has no column {name}; name the columns {NEEDED}"))?;
            }
            Ok(columns)
        };
        let optional = |names: [&str; 3]| -> Result<Option<[usize; 3]>, String> {
            let found = [find(names[0])?, find(names[1])?, find(names[2])?];
            match found {
                [Some(x), Some(y), Some(z)] => Ok(Some([x, y, z])),
                [None, None, None] => Ok(None),
                _ => {
                    Err(format!("the header has some of {}, not all; complete them or leave them out", names.join(",")))
                }
            }
        };
        let derivatives = match [optional(["xu", "yu", "zu"])?, optional(["xv", "yv", "zv"])?] {
            [Some(du), Some(dv)] => Some([du, dv]),
            [None, None] => None,
            _ => {
                return Err(
                    "the header has derivatives by one of u and v only; give xu,yu,zu and xv,yv,zv, or neither".into(),
                );
            }
        };
        Ok(Self {
            place: needed(["face", "u", "v"])?,
            position: needed(["x", "y", "z"])?,
            derivatives,
            normal: optional(["nx", "ny", "nz"])?,
        })
    }
}

/// Reads answers, every row checked.
pub(super) fn read(path: &Path, faces: usize) -> Result<Vec<Answer>, Failure> {
    of(&Rows::open(path, "answers", NEEDED)?, faces)
}

/// Reads the answers of a text as `verify --results` does; `name` is the file's in messages, `faces` the number of ptex faces.
///
/// # Errors
/// What is wrong with which line, and what to do: one line.
pub fn parse_answers(text: &[u8], name: &Path, faces: usize) -> Result<Vec<Answer>, String> {
    of(&Rows::of(name, text), faces).map_err(Failure::line)
}

fn of(rows: &Rows<'_>, faces: usize) -> Result<Vec<Answer>, Failure> {
    let answers = rows.read(
        Columns::of,
        "it has more or fewer fields than the header, or is not text; correct it",
        |columns, row| answer(columns, row, faces),
    )?;
    if answers.iter().all(|answer| answer.position.is_none()) {
        return Err(rows.bad(None, "no row has an answer (x,y,z); there is nothing to judge"));
    }
    Ok(answers)
}

fn answer(columns: &Columns, row: &StringRecord, faces: usize) -> Result<Answer, String> {
    let face = &row[columns.place[0]];
    let face = face.parse().map_err(|_| format!("face = '{face}' is not a whole number from 0; correct it"))?;
    let [_, u, v] = columns.place.map(|i| &row[i]);
    let [u, v] = [("u", u), ("v", v)].map(|(name, x)| match x.parse::<f64>() {
        Ok(x) => Ok(x),
        Err(_) => Err(format!("{name} = '{x}' is not a number; correct it")),
    });
    let (u, v) = (u?, v?);
    check_place((face, u, v), faces, false)?;
    let number = |i: usize| match row[i].trim() {
        "" => Ok(f64::NAN),
        x => x.parse().map_err(|_| format!("'{x}' is not a number; write one, or nothing where there is no answer")),
    };
    let vector = |[x, y, z]: [usize; 3]| Ok::<_, String>(DVec3::new(number(x)?, number(y)?, number(z)?));
    let derivatives = columns.derivatives.map(|[du, dv]| Ok::<_, String>([vector(du)?, vector(dv)?])).transpose()?;
    Ok(Answer {
        at: Sample { face, u: parameter(u), v: parameter(v) },
        position: Some(vector(columns.position)?).filter(|p| p.is_finite()),
        derivatives,
        normal: columns.normal.map(vector).transpose()?,
    })
}
