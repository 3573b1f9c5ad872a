//! `eval`: position, derivatives and normal at given samples.

use super::args::{Backend, EvalArgs};
use super::{Failure, load, write_out};
use crate::gpu::{self, Gpu};
use crate::mesh::SubdivMesh;
use crate::osd::{Answer, Far, MAX_ISOLATION};
use crate::output::check_writable;
use crate::stam::{Jet, LimitSurface};
use rayon::prelude::*;
use serde::Deserialize;
use std::fmt::Display;
use std::path::Path;

const HEADER: [&str; 16] =
    ["face", "u", "v", "x", "y", "z", "xu", "yu", "zu", "xv", "yv", "zv", "nx", "ny", "nz", "kind"];

#[derive(Debug, Clone, Copy, Deserialize)]
struct Sample {
    face: u32,
    u: f64,
    v: f64,
}

impl Sample {
    /// The parameters as evaluators take them: so close to 0 that exponents end, they count as 0, which moves no point
    /// by as much as a rounding.
    fn uv(self) -> [f64; 2] {
        const LEAST: f64 = 1e-300;
        [self.u, self.v].map(|x| if x < LEAST { 0.0 } else { x })
    }
}

pub(super) fn run(args: &EvalArgs) -> Result<(), Failure> {
    args.output.as_deref().map_or(Ok(()), check_writable)?;
    let mesh = load(args.mesh.as_deref())?;
    let surface = LimitSurface::new(&mesh).map_err(|e| Failure::of(&mesh, e))?;
    let samples = read(&args.samples, surface.ptex_count())?;
    let jets = match args.backend {
        Backend::Cpu => samples.par_iter().map(|s| Some(surface.evaluate_ptex(s.face, s.uv())?.1)).collect(),
        Backend::Gpu => on_gpu(&surface, &samples)?,
        Backend::Osd => by_opensubdiv(&mesh, &samples)?,
    };
    write_out(args.output.as_ref(), &table(&surface, &samples, &jets))
}

/// Reads `face,u,v` rows, every one checked.
fn read(path: &Path, faces: usize) -> Result<Vec<Sample>, Failure> {
    let bad = |line: Option<u64>, what: String| {
        let place = line.map_or(String::new(), |line| format!(":{line}"));
        Failure::Bad(format!("{}{place}: {what}", path.display()))
    };
    let unread = |what: &dyn Display| {
        bad(None, format!("cannot read the samples: {what}; give a CSV file with the header face,u,v"))
    };
    if path.is_dir() {
        return Err(unread(&"it is a folder"));
    }
    let text = std::fs::read(path).map_err(|e| unread(&e))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(&text[..]);
    let header = reader.headers().ok().filter(|header| header.iter().eq(["face", "u", "v"])).cloned();
    let header = header.ok_or_else(|| bad(Some(1), "the header is not face,u,v; make it the first line".to_owned()))?;
    let mut samples = Vec::new();
    for row in reader.into_records() {
        let start = match &row {
            Ok(row) => row.position(),
            Err(error) => error.position(),
        };
        let line = || start.map(|start| line_of(&text, start.byte() as usize));
        let what = "not a row of face,u,v (a whole number and two numbers); correct it";
        let sample = row.as_ref().ok().and_then(|row| row.deserialize::<Sample>(Some(&header)).ok());
        let sample = sample.ok_or_else(|| bad(line(), what.to_owned()))?;
        if sample.face as usize >= faces {
            let range = format!("ptex face {} does not exist; the mesh has {faces}, counted from 0", sample.face);
            return Err(bad(line(), range));
        }
        for (name, x) in [("u", sample.u), ("v", sample.v)] {
            if !(0.0..=1.0).contains(&x) {
                return Err(bad(line(), format!("{name} = {x} is outside 0 to 1; correct it")));
            }
        }
        samples.push(sample);
    }
    Ok(samples)
}

/// Line of the record whose reading began at `start`: the reader skips empty lines before it.
fn line_of(text: &[u8], start: usize) -> u64 {
    let empty = text[start..].iter().take_while(|byte| matches!(byte, b'\n' | b'\r')).count();
    text[..start + empty].iter().filter(|&&byte| byte == b'\n').count() as u64 + 1
}

fn on_gpu(surface: &LimitSurface, samples: &[Sample]) -> Result<Vec<Option<Jet>>, Failure> {
    let gpu = Gpu::new()?;
    let tables = gpu.upload(surface)?;
    let places: Vec<_> = samples.iter().map(|s| surface.locate(s.face, s.uv())).collect();
    let requests: Vec<_> = places
        .iter()
        .flatten()
        .map(|&(patch, uv)| gpu::Sample { patch: patch as u32, uv: uv.map(|x| x as f32) })
        .collect();
    let mut jets = gpu.evaluate(&tables, &requests)?.into_iter();
    let to_ptex = |place: &Option<(usize, [f64; 2])>| {
        place.and_then(|(patch, _)| Some(surface.patches()[patch].jet_to_ptex(jets.next()?)))
    };
    Ok(places.iter().map(to_ptex).collect())
}

fn by_opensubdiv(mesh: &SubdivMesh, samples: &[Sample]) -> Result<Vec<Option<Jet>>, Failure> {
    let samples: Vec<_> = samples.iter().map(|s| (s.face, s.u, s.v)).collect();
    let answers =
        Far::new(mesh, MAX_ISOLATION).and_then(|far| far.evaluate(&samples)).map_err(|e| Failure::of(mesh, e))?;
    let jet = |r: &crate::osd::ReferenceJet| Jet {
        position: r.position,
        du: r.du,
        dv: r.dv,
        normal: r.du.cross(r.dv).normalize_or_zero(),
    };
    Ok(answers.iter().map(|r| (r.answer != Answer::None).then(|| jet(r))).collect())
}

/// A parameter in as few digits as bring it back, with an exponent where there would be rows of zeros.
fn shortest(x: f64) -> String {
    if x == 0.0 || x >= 1e-5 { x.to_string() } else { format!("{x:e}") }
}

/// The answers as CSV, numbers with 17 digits; a sample in a hole has no numbers.
fn table(surface: &LimitSurface, samples: &[Sample], jets: &[Option<Jet>]) -> Vec<u8> {
    let mut out = HEADER.join(",");
    for (sample, jet) in samples.iter().zip(jets) {
        out += &format!("\n{},{},{}", sample.face, shortest(sample.u), shortest(sample.v));
        let kind = surface.locate(sample.face, sample.uv()).map(|(patch, _)| surface.kind(patch).name());
        match (jet, kind) {
            (Some(jet), Some(kind)) => {
                for x in [jet.position, jet.du, jet.dv, jet.normal].iter().flat_map(|p| p.to_array()) {
                    out += &format!(",{x:.16e}");
                }
                out += &format!(",{kind}");
            }
            _ => out += &format!("{}hole", ",".repeat(13)),
        }
    }
    out += "\n";
    out.into_bytes()
}
