//! `eval`: position, derivatives and normal at given samples.

use super::args::{Backend, EvalArgs};
use super::rows::{Rows, check_place, parameter, shortest};
use super::{Failure, outgoing, progress, refined, write_out};
use crate::gpu::{self, Gpu};
use crate::mesh::SubdivMesh;
use crate::osd::{Answer, Far, Location, MAX_ISOLATION};
use crate::stam::{Jet, LimitSurface};
use csv::StringRecord;
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

impl Sample {
    fn uv(self) -> [f64; 2] {
        [self.u, self.v].map(parameter)
    }
}

pub(super) fn run(args: &EvalArgs) -> Result<(), Failure> {
    args.output.iter().try_for_each(|path| outgoing::check(path, "-o"))?;
    let mesh = args.scene.load(args.mesh.as_deref())?;
    let surface = refined(&mesh, &progress("evaluating".to_owned()))?;
    let places = (surface.ptex_count(), surface.has_triangles());
    let samples = read(&Rows::open(&args.samples, "samples", "face,u,v")?, places)?;
    let jets = match args.backend {
        Backend::Cpu => samples.par_iter().map(|s| Some(surface.evaluate_ptex(s.face, s.uv())?.1)).collect(),
        Backend::Gpu => on_gpu(&surface, &samples)?,
        Backend::Osd => by_opensubdiv(&mesh, &samples)?,
    };
    write_out(args.output.as_ref(), &table(&surface, &samples, &jets))
}

/// Reads the samples of a text as `eval --samples` does; `name` is the file's in messages, `faces` the number of ptex faces, and `triangles` whether u + v
/// is at most 1 on them.
///
/// # Errors
/// What is wrong with which line, and what to do: one line.
pub fn parse_samples(text: &[u8], name: &Path, faces: usize, triangles: bool) -> Result<Vec<Location>, String> {
    let samples = read(&Rows::of(name, text), (faces, triangles)).map_err(Failure::line)?;
    Ok(samples.into_iter().map(|sample| (sample.face, sample.u, sample.v)).collect())
}

/// Reads `face,u,v` rows, every one checked.
fn read(rows: &Rows<'_>, (faces, triangles): (usize, bool)) -> Result<Vec<Sample>, Failure> {
    let header = |header: Option<&StringRecord>| {
        let header = header.filter(|header| header.iter().eq(["face", "u", "v"])).cloned();
        header.ok_or_else(|| "the header is not face,u,v; make it the first line".to_owned())
    };
    let not_a_row = "not a row of face,u,v (a whole number and two numbers); correct it";
    rows.read(header, not_a_row, |header, row| {
        let sample: Sample = row.deserialize(Some(header)).map_err(|_| not_a_row.to_owned())?;
        check_place((sample.face, sample.u, sample.v), faces, triangles)?;
        Ok(sample)
    })
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
