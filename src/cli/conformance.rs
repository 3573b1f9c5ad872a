//! `verify --samples-out` and `--results`: the conformance test of other programs.

use super::args::VerifyArgs;
use super::rows::{Rows, check_place, parameter, shortest};
use super::{Failure, write_out};
use crate::mesh::SubdivMesh;
use crate::output::{check_writable, write_whole};
use crate::stam::LimitSurface;
use crate::verify::conformance::{Answer, DEFAULT_PER_FACE, Terms, Tolerances, conformance, sample_set};
use crate::verify::{MeshReport, Report, Sample};
use clap::Args;
use csv::StringRecord;
use glam::DVec3;
use std::path::{Path, PathBuf};

/// Most samples a face.
const MOST_PER_FACE: i64 = 65_536;

/// Flags of the conformance test.
#[derive(Debug, Args)]
#[command(next_help_heading = "Testing another evaluator (docs/CONFORMANCE.md)")]
pub(super) struct ConformanceArgs {
    /// Write the standard sample set of the mesh (face,u,v) and stop
    #[arg(long, value_name = "FILE", conflicts_with = "results", group = "other")]
    pub samples_out: Option<PathBuf>,
    /// Judge another program's answers instead: a CSV file with face,u,v,x,y,z, and if it has them xu,yu,zu,xv,yv,zv and nx,ny,nz
    #[arg(long, value_name = "FILE", group = "other")]
    pub results: Option<PathBuf>,
    /// Standard samples of each ptex face
    #[arg(long, value_name = "N", requires = "other", default_value_t = DEFAULT_PER_FACE as u32, value_parser = clap::value_parser!(u32).range(1..=MOST_PER_FACE))]
    pub samples: u32,
    /// Any part of the standard samples will do
    #[arg(long, requires = "results")]
    pub partial: bool,
    /// What answers may be off: parts of the diagonal, degrees, parts of the longer derivative [default: 2e-6,1e-3,3.6e-6]
    #[arg(long, value_name = "POSITION[,NORMAL[,DERIVATIVE]]", requires = "results", value_parser = tolerances)]
    pub tolerance: Option<Tolerances>,
}

fn tolerances(text: &str) -> Result<Tolerances, String> {
    let parse = |x: &str| x.trim().parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let default = Tolerances::default();
    match numbers.as_deref() {
        Some(&[position, ref rest @ ..]) if rest.len() <= 2 => Ok(Tolerances {
            position,
            normal_deg: rest.first().copied().unwrap_or(default.normal_deg),
            derivative: rest.get(1).copied().unwrap_or(default.derivative),
        }),
        _ => Err("give one to three numbers above 0: POSITION[,NORMAL[,DERIVATIVE]]".to_owned()),
    }
}

impl ConformanceArgs {
    /// Whether this is a conformance test at all.
    pub fn asked(&self) -> bool {
        self.samples_out.is_some() || self.results.is_some()
    }
}

/// Writes the sample set, or judges answers.
pub(super) fn run(args: &VerifyArgs, mesh: &SubdivMesh) -> Result<Option<Report>, Failure> {
    let ConformanceArgs { samples_out, results, .. } = &args.conformance;
    if let Some(path) = samples_out {
        write_samples(path, mesh, args.conformance.samples as usize)?;
    }
    results.as_deref().map(|path| judge(&args.conformance, path, mesh)).transpose()
}

fn write_samples(path: &Path, mesh: &SubdivMesh, per_face: usize) -> Result<(), Failure> {
    let surface = LimitSurface::new(mesh).map_err(|e| Failure::of(mesh, e))?;
    Ok(write_whole(path, |out| {
        writeln!(out, "face,u,v")?;
        sample_set(&surface, per_face)
            .try_for_each(|Sample { face, u, v }| writeln!(out, "{face},{},{}", shortest(u), shortest(v)))
    })?)
}

fn judge(args: &ConformanceArgs, path: &Path, mesh: &SubdivMesh) -> Result<Report, Failure> {
    let faces: usize = mesh.face_sizes.iter().map(|&size| if size == 4 { 1 } else { size as usize }).sum();
    let answers = read(path, faces)?;
    let terms = Terms {
        tolerances: args.tolerance.unwrap_or_default(),
        per_face: args.samples as usize,
        partial: args.partial,
    };
    let report = conformance(mesh, &answers, &terms).map_err(|e| Failure::of(mesh, e))?;
    write_out(None, text(path, &report).as_bytes())?;
    Ok(Report::new(vec![report]))
}

fn text(path: &Path, report: &MeshReport) -> String {
    let verdict = if report.pass { "pass" } else { "FAIL" };
    let results = report.results.as_ref().map_or(String::new(), ToString::to_string);
    format!("{} for {}: {verdict}\n{results}", path.display(), report.mesh)
}

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
fn read(path: &Path, faces: usize) -> Result<Vec<Answer>, Failure> {
    let rows = Rows::open(path, "answers", NEEDED)?;
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
    check_place((face, u, v), faces)?;
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

/// Refuses before there is work what could not be written.
pub(super) fn check(args: &VerifyArgs) -> Result<(), Failure> {
    let ConformanceArgs { samples_out, results, .. } = &args.conformance;
    if (samples_out.is_some() || results.is_some()) && args.meshes.len() > 1 {
        let count = args.meshes.len();
        return Err(Failure::Bad(format!("--samples-out and --results take one mesh, not {count}; name one")));
    }
    samples_out.as_deref().map_or(Ok(()), check_writable)?;
    Ok(())
}
