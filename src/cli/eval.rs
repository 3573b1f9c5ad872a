//! `eval`: position, derivatives and normal at given samples.

use super::args::{Backend, EvalArgs};
use super::{Failure, load, write_out};
use crate::gpu::{self, Gpu};
use crate::mesh::SubdivMesh;
use crate::osd::{Answer, Far, MAX_ISOLATION, Reference};
use crate::stam::{Jet, LimitSurface};
use rayon::prelude::*;
use serde::Deserialize;
use std::path::Path;

const HEADER: [&str; 16] =
    ["face", "u", "v", "x", "y", "z", "xu", "yu", "zu", "xv", "yv", "zv", "nx", "ny", "nz", "kind"];

#[derive(Debug, Clone, Copy, Deserialize)]
struct Sample {
    face: u32,
    u: f64,
    v: f64,
}

pub(super) fn run(args: &EvalArgs) -> Result<(), Failure> {
    let mesh = load(args.mesh.as_deref())?;
    let surface = LimitSurface::new(&mesh).map_err(|e| Failure::of(&mesh, e))?;
    let samples = read(&args.samples, surface.ptex_count())?;
    let jets = match args.backend {
        Backend::Cpu => samples.par_iter().map(|s| Some(surface.evaluate_ptex(s.face, [s.u, s.v])?.1)).collect(),
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
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(|e| bad(None, format!("cannot read the samples: {e}; give a CSV file with the header face,u,v")))?;
    let header = reader.headers().map_err(|e| bad(Some(1), e.to_string()))?;
    if header.iter().ne(["face", "u", "v"]) {
        return Err(bad(Some(1), "the header is not face,u,v; make it the first line".to_owned()));
    }
    let mut samples = Vec::new();
    for row in reader.into_deserialize::<Sample>() {
        let line = samples.len() as u64 + 2;
        let sample = row.map_err(|e| {
            let line = e.position().map_or(line, csv::Position::line);
            bad(Some(line), "not a row of face,u,v (a whole number and two numbers); correct it".to_owned())
        })?;
        if sample.face as usize >= faces {
            let range = format!("ptex face {} does not exist; the mesh has {faces}, counted from 0", sample.face);
            return Err(bad(Some(line), range));
        }
        for (name, x) in [("u", sample.u), ("v", sample.v)] {
            if !(0.0..=1.0).contains(&x) {
                return Err(bad(Some(line), format!("{name} = {x} is outside 0 to 1; correct it")));
            }
        }
        samples.push(sample);
    }
    Ok(samples)
}

fn on_gpu(surface: &LimitSurface, samples: &[Sample]) -> Result<Vec<Option<Jet>>, Failure> {
    let gpu = Gpu::new()?;
    let tables = gpu.upload(surface)?;
    let places: Vec<_> = samples.iter().map(|s| surface.locate(s.face, [s.u, s.v])).collect();
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
        Far::new(mesh, MAX_ISOLATION).and_then(|mut far| far.evaluate(&samples)).map_err(|e| Failure::of(mesh, e))?;
    let jet = |r: &crate::osd::ReferenceJet| Jet {
        position: r.position,
        du: r.du,
        dv: r.dv,
        normal: r.du.cross(r.dv).normalize_or_zero(),
    };
    Ok(answers.iter().map(|r| (r.answer != Answer::None).then(|| jet(r))).collect())
}

/// The answers as CSV, numbers with 17 digits; a sample in a hole has no numbers.
fn table(surface: &LimitSurface, samples: &[Sample], jets: &[Option<Jet>]) -> Vec<u8> {
    let mut out = HEADER.join(",");
    for (sample, jet) in samples.iter().zip(jets) {
        out += &format!("\n{},{},{}", sample.face, sample.u, sample.v);
        let kind = surface.locate(sample.face, [sample.u, sample.v]).map(|(patch, _)| surface.kind(patch).name());
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
