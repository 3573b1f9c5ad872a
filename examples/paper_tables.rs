//! Tables 1 and 2 of Yasui & Kanai 2004, redone beside the paper's own figures. As Markdown.
//!
//! `cargo run --release --example paper_tables`
//!
//! Both draw one authored shape of 75 faces: the corner of a box, three sheets of 5 x 5 faces round a vertex of valence
//! 3. Subdivided once, twice and three times it has the paper's 300, 1,200 and 4,800 faces.

mod paper;

use catoptric::field::{Camera, Light, Projection};
use catoptric::gpu::{NO_PATCH, Pipeline, View};
use catoptric::mesh::SubdivMesh;
use glam::DVec3;
use paper::{EXACT, Failure, Stage, drawn_by, exit};
use std::collections::HashMap;
use std::process::ExitCode;
use std::time::Duration;

/// Pictures a figure: the median of an odd number.
const RUNS: usize = 15;
/// Faces each way of one of the three sheets.
const SIDE: u32 = 5;

fn main() -> ExitCode {
    exit("paper_tables", run())
}

fn run() -> Result<(), Failure> {
    if std::env::args_os().len() > 1 {
        return Err("takes no arguments".into());
    }
    let stage = Stage::new(&corner())?;
    println!("Median of {RUNS} pictures, milliseconds. The paper: Athlon XP 2600+, GeForce FX 5900 Ultra (2004).");
    println!("Here: {}, {}; a shape of {} faces.", stage.gpu.adapter(), processor(), stage.surface.ptex_count());
    faces(&stage)?;
    fragments(&stage)
}

/// As in `--pipeline`.
fn name(pipeline: Pipeline) -> String {
    format!("{pipeline:?}").to_lowercase()
}

/// Name of the processor, where the system tells it, and how many of its threads we have.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": ")).map(|(_, name)| name);
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    format!("{} ({threads} threads)", model.unwrap_or("processor unknown"))
}

fn faces(stage: &Stage) -> Result<(), Failure> {
    println!("\nTable 1: getting face id and parameters, 500x500 fragments, by faces of the subdivided polygon.\n");
    println!("| faces | paper | points | polygon | {} |", name(EXACT));
    println!("|{}", "---:|".repeat(5));
    for (level, count, paper) in [(1, 300, 0.8), (2, 1_200, 3.0), (3, 4_800, 12.0)] {
        print!("| {count} | {paper} |");
        for pipeline in [Pipeline::Points, Pipeline::Polygon, EXACT] {
            let steps = medians(stage, &drawn_by(&filled([500; 2]), pipeline, level, 1.0))?;
            let get: Duration =
                steps.iter().filter(|(step, _)| ["charts", "visibility"].contains(step)).map(|(_, time)| *time).sum();
            print!(" {:.1} |", milliseconds(get));
        }
        println!();
    }
    Ok(())
}

fn fragments(stage: &Stage) -> Result<(), Failure> {
    if stage.gpu.inspect(&stage.tables, &drawn_by(&filled([300; 2]), EXACT, 3, 1.0))?.patch.contains(&NO_PATCH) {
        return Err("the shape does not fill the picture".into());
    }
    println!("\nTable 2: computing position and colour, level 3, by fragments; all of them see surface.\n");
    println!("| | step | 300x300 | 500x500 | 700x700 |\n|---|---|---:|---:|---:|");
    println!("| paper | position | 30 | 70 | 130 |\n| paper | colour | 100 | 270 | 520 |");
    for pipeline in [Pipeline::Points, Pipeline::Polygon, EXACT] {
        let sizes: Result<Vec<_>, _> =
            [300, 500, 700].map(|n| medians(stage, &drawn_by(&filled([n; 2]), pipeline, 3, 1.0))).into_iter().collect();
        let sizes = sizes?;
        for (k, (step, _)) in sizes[0].iter().enumerate() {
            let cells: Vec<_> = sizes.iter().map(|steps| format!("{:.1}", milliseconds(steps[k].1))).collect();
            println!("| {} | {step} | {} |", name(pipeline), cells.join(" | "));
        }
    }
    Ok(())
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Median time of each step that draws, in order.
fn medians(stage: &Stage, view: &View) -> Result<Vec<(&'static str, Duration)>, Failure> {
    let mut steps: Vec<(&'static str, Vec<Duration>)> = Vec::new();
    // The first picture compiles.
    stage.gpu.render(&stage.tables, view)?;
    for _ in 0..RUNS {
        for (step, time) in stage.gpu.render(&stage.tables, view)?.timings.steps {
            match steps.iter_mut().find(|(name, _)| *name == step) {
                Some((_, times)) => times.push(time),
                None => steps.push((step, vec![time])),
            }
        }
    }
    let median = |(step, mut times): (&'static str, Vec<Duration>)| {
        times.sort();
        (step, times[times.len() / 2])
    };
    let draws = |(step, _): &(&str, _)| !["compile", "scene", "certificates", "read back"].contains(step);
    Ok(steps.into_iter().filter(draws).map(median).collect())
}

/// A view that the shape overfills, so that every fragment sees it.
fn filled(size: [u32; 2]) -> View {
    let eye = DVec3::splat(6.0);
    let camera =
        Camera { eye, target: DVec3::splat(0.5), up: DVec3::Z, projection: Projection::Perspective { fov: 5.0 }, size };
    let light = Light::new(DVec3::new(8.0, 8.0, 12.0), DVec3::new(-1.0, -1.0, -1.6), DVec3::X, 1.0);
    View { samples: 1, ..View::new(camera, light) }
}

/// The corner of a rounded box: the sheets x = 1, y = 1 and z = 1 of the unit cube, bulged.
fn corner() -> SubdivMesh {
    let mut mesh = SubdivMesh { name: "corner of 75 faces".to_owned(), ..SubdivMesh::default() };
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    for axis in 0..3 {
        for cell in 0..SIDE * SIDE {
            for [i, j] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                let mut grid = [SIDE; 3];
                (grid[(axis + 1) % 3], grid[(axis + 2) % 3]) = (cell % SIDE + i, cell / SIDE + j);
                let vertex = *known.entry(grid).or_insert_with(|| {
                    let p = DVec3::from_array(grid.map(|n| f64::from(n) / f64::from(SIDE)));
                    mesh.points.push(p * (1.0 + 0.3 * (1.0 - p.length_squared() / 3.0)));
                    mesh.points.len() as u32 - 1
                });
                mesh.face_vertices.push(vertex);
            }
            mesh.face_sizes.push(4);
        }
    }
    mesh
}
