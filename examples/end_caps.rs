//! What OpenSubdiv's end caps do to reflection lines, level by level, and what they take; the exact tables as last row. As a
//! Markdown table a mesh.
//!
//! `cargo run --release --example end_caps [MESH.obj...]`, without a mesh for the built-in sample.
//!
//! *Approximate*: end caps, and regular patches over semi-sharp features that are not resolved at the level. *Surface*: angles
//! between their normals and those of the limit, at points scattered over all of them. *Picture*: the same and the displacement of the reflection lines over all pixels of the fitted view at 1024x1024. *Table*: bytes on the adapter, in f32.
//! *Build*: refinement, patches and points, and tables on the adapter, the least of three.

use catoptric::adaptive::AdaptivePatches;
use catoptric::compare::{Comparison, Exact};
use catoptric::field::{Scout, sample_rig};
use catoptric::gpu::{Gpu, PatchSource, Tables, View};
use catoptric::mesh::{self, SubdivMesh};
use catoptric::osd::{EndCap, Isolation, MAX_ISOLATION};
use catoptric::stam::LimitSurface;
use catoptric::statistics::short;
use glam::DVec3;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error>;

const SIZE: [u32; 2] = [1024, 1024];
/// Points on the end caps of a level.
const SAMPLES: usize = 100_000;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("end_caps: {failure}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<(), Failure> {
    let paths: Vec<_> = std::env::args_os().skip(1).collect();
    let gpu = Gpu::new()?;
    if paths.is_empty() {
        return table(&gpu, &mesh::sample(), true);
    }
    paths.iter().try_for_each(|path| table(&gpu, &mesh::read(Path::new(path))?, false))
}

/// The least time of three, and what was made last.
fn least<T>(mut make: impl FnMut() -> Result<T, Failure>) -> Result<(T, Duration), Failure> {
    let mut once = || -> Result<(T, Duration), Failure> {
        let start = Instant::now();
        let made = make()?;
        Ok((made, start.elapsed()))
    };
    let times = [once()?.1, once()?.1];
    let (made, last) = once()?;
    Ok((made, times.into_iter().fold(last, Duration::min)))
}

fn upload<S: PatchSource>(gpu: &Gpu, source: S) -> Result<(S, Tables), Failure> {
    let tables = gpu.upload_patches(&source)?;
    Ok((source, tables))
}

fn table(gpu: &Gpu, mesh: &SubdivMesh, is_sample: bool) -> Result<(), Failure> {
    let ((surface, tables), exact_time) = least(|| upload(gpu, LimitSurface::new(mesh)?))?;
    let scout = Scout::new(&surface).ok_or_else(|| format!("{}: no face has a limit surface", mesh.name))?;
    // As `render` without options: the sample has a rig of its own.
    let fitted = scout.camera(SIZE, DVec3::Z);
    let (direction, light) = sample_rig();
    let view = match is_sample {
        true => View::new(scout.camera_from(SIZE, DVec3::Z, direction, catoptric::field::DEFAULT_FOV), light),
        false => View::new(fitted, scout.light(&fitted)),
    };
    let seen = gpu.inspect(&tables, &view)?;
    let exact = Exact { surface: &surface, view: &view, image: &seen };
    let same = exact.compare(&surface, &seen);
    println!("**{}**, {} faces; {} pixels of surface\n", mesh.name, mesh.face_count(), same.normal.count);
    println!(
        "| level | patches | approximate | table | build | surface: normal p99 | max | picture: normal p99 | max | lines p99 | max |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for level in 1..=MAX_ISOLATION {
        let make = || upload(gpu, AdaptivePatches::new(mesh, Isolation::uniform(level), EndCap::Gregory)?);
        let ((patches, tables), time) = least(make)?;
        let accuracy = patches.accuracy(&surface, SAMPLES);
        let picture = exact.compare(&patches, &gpu.inspect(&tables, &view)?);
        let normal = [accuracy.normal_deg.p99, accuracy.normal_deg.max].map(degrees);
        row(&level.to_string(), patches.patches().len(), accuracy.patches, &tables, time, normal, &picture);
    }
    let none = ["-".to_owned(), "-".to_owned()];
    row("exact", surface.patches().len(), 0, &tables, exact_time, none, &same);
    println!();
    Ok(())
}

fn row(
    name: &str,
    patches: usize,
    caps: usize,
    tables: &Tables,
    time: Duration,
    normal: [String; 2],
    picture: &Comparison,
) {
    let (kib, ms) = (tables.size() as f64 / 1024.0, time.as_secs_f64() * 1e3);
    let Comparison { normal: seen, lines, .. } = picture;
    println!(
        "| {name} | {patches} | {caps} | {kib:.0} KiB | {ms:.1} ms | {} | {} | {} | {} | {} | {} |",
        normal[0],
        normal[1],
        degrees(seen.p99),
        degrees(seen.max),
        pixels(lines.p99),
        pixels(lines.max)
    );
}

fn degrees(x: f64) -> String {
    format!("{}°", short(x))
}

fn pixels(x: f64) -> String {
    format!("{} px", short(x))
}
