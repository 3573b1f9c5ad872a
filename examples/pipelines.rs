//! What each pipeline gets wrong at each proxy level: gaps, silhouettes, normals, reflection lines. As a Markdown table.
//!
//! `cargo run --release --example pipelines [MESH.obj]`
//!
//! The reference is the limit surface on each pixel's ray, in f64. *Gaps* are pixels of surface that show none, 4 pixels and
//! more from the background; *missed* are those nearer to it, *beyond* are pixels of background that show surface.

#[path = "paper/measure.rs"]
mod measure;
mod paper;
#[path = "paper/scene.rs"]
mod scene;

use catoptric::gpu::Pipeline;
use measure::{Reference, cells};
use paper::{EXACT, Failure, drawn_by, exit};
use std::path::Path;
use std::process::ExitCode;

const SIZE: [u32; 2] = [512, 512];
const LEVELS: std::ops::RangeInclusive<u32> = 1..=5;

fn main() -> ExitCode {
    exit("pipelines", run())
}

fn run() -> Result<(), Failure> {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let mesh = match &arguments[..] {
        [] => None,
        [mesh] => Some(Path::new(mesh)),
        _ => return Err("give one mesh (.obj), or none for the built-in sample".into()),
    };
    let (stage, view) = scene::load(mesh, SIZE)?;
    let reference = Reference::new(&stage, &view)?;
    let [covered, unsolved] = reference.counts();
    println!(
        "{}x{} pixels, {covered} of surface ({unsolved} without a reference), {}.",
        SIZE[0],
        SIZE[1],
        stage.gpu.adapter()
    );
    println!("Normals in degrees, displacement of the reflection lines in pixels: mean, 99th percentile, maximum.\n");
    println!("| level | pipeline | gaps | missed | beyond | normal | p99 | max | lines | p99 | max |");
    println!("|{}", "---|".repeat(11));
    let points = [1.0, 1.3, 1.7].map(|enlarge| (Pipeline::Points, enlarge));
    let pipelines = [(Pipeline::Polygon, 1.0)].into_iter().chain(points).chain([(EXACT, 1.0)]);
    for level in LEVELS {
        for (pipeline, enlarge) in pipelines.clone() {
            let image = stage.gpu.inspect(&stage.tables, &drawn_by(&view, pipeline, level, enlarge))?;
            let errors = reference.errors(&image);
            let name = match pipeline {
                Pipeline::Points => format!("points x {enlarge}"),
                _ => format!("{pipeline:?}").to_lowercase(),
            };
            let [gaps, missed] = errors.missed;
            let beyond = errors.beyond;
            let (normal, lines) = (cells(&errors.normal), cells(&errors.lines));
            println!("| {level} | {name} | {gaps} | {missed} | {beyond} | {normal} | {lines} |");
        }
    }
    Ok(())
}
