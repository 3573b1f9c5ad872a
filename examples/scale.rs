//! What meshes of 10,000 to 1,000,000 control faces take, stage by stage, and what OpenSubdiv alone takes at isolation 10. As a Markdown
//! table.
//!
//! `cargo run --release --example scale [FACES...]`, by default 10000, 100000 and 1000000.
//!
//! The mesh is a wavy sheet of quads with a boundary; two faces in a hundred are two triangles or a hexagon instead, so that there are
//! extraordinary vertices of valence 3, 5 and 6 everywhere, and every fiftieth row and column is a crease of sharpness 1, 2.5, 3.3
//! or infinite. It is written as an OBJ and read back. Each row is a process of its own, so that its peak memory is its own. *Slope*: by which power of
//! the faces the whole time grew from the row above. *OpenSubdiv*: refinement, patch table and points of `Far` at isolation 10 with Gregory end
//! caps, of the same mesh in memory, nothing drawn.

use catoptric::field::Scout;
use catoptric::gpu::{Gpu, View};
use catoptric::mesh::{self, Crease, SubdivMesh};
use catoptric::osd::{Far, MAX_ISOLATION};
use catoptric::stam::LimitSurface;
use glam::DVec3;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// Stages in the order in which they run.
const STAGES: [&str; 6] = ["read", "refine", "fit", "adapter", "tables", "picture"];

fn main() -> ExitCode {
    match run(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("scale: {failure}");
            ExitCode::from(2)
        }
    }
}

fn run(words: &[String]) -> Result<(), Failure> {
    match words {
        [stage, path] if stage == "--ours" => ours(Path::new(path)),
        [stage, path] if stage == "--opensubdiv" => opensubdiv(Path::new(path)),
        [] => table(&[10_000, 100_000, 1_000_000]),
        faces => table(&faces.iter().map(|word| word.parse()).collect::<Result<Vec<_>, _>>()?),
    }
}

fn table(sizes: &[usize]) -> Result<(), Failure> {
    println!("| faces | {} | whole, s | slope | peak, MiB | OpenSubdiv at 10: s | peak, MiB |", STAGES.join(", s | "));
    println!("|{}", "---:|".repeat(STAGES.len() + 6));
    let mut before: Option<(f64, f64)> = None;
    for &size in sizes {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("sheet.obj");
        let mesh = sheet(size);
        std::fs::write(&path, obj(&mesh)?)?;
        let own = child("--ours", &path)?.ok_or("our own process died")?;
        let [stages @ .., peak] = &own[..] else { return Err("our own process said nothing".into()) };
        let (faces, whole) = (mesh.face_count() as f64, stages.iter().sum::<f64>());
        let slope = before.map_or("-".to_owned(), |(f, s)| format!("{:.2}", (whole / s).ln() / (faces / f).ln()));
        before = Some((faces, whole));
        let stages: Vec<String> = stages.iter().map(|s| format!("{s:.2}")).collect();
        let theirs = match child("--opensubdiv", &path)?.as_deref() {
            Some([time, peak]) => format!("{time:.2} | {peak:.0}"),
            _ => "died | -".to_owned(),
        };
        println!("| {faces} | {} | {whole:.2} | {slope} | {peak:.0} | {theirs} |", stages.join(" | "));
    }
    Ok(())
}

/// The numbers that this program prints in a process of its own; `None` if that died.
fn child(stage: &str, path: &Path) -> Result<Option<Vec<f64>>, Failure> {
    let output = Command::new(std::env::current_exe()?).arg(stage).arg(path).output()?;
    if !output.status.success() {
        eprint!("{}", String::from_utf8_lossy(&output.stderr));
        return Ok(None);
    }
    let words = String::from_utf8(output.stdout)?;
    Ok(Some(words.split_whitespace().map(str::parse).collect::<Result<_, _>>()?))
}

/// Seconds of each stage, then the peak.
fn ours(path: &Path) -> Result<(), Failure> {
    let mut last = Instant::now();
    let mut say = || {
        print!("{} ", last.elapsed().as_secs_f64());
        last = Instant::now();
    };
    let mesh = mesh::read(path)?;
    say();
    let surface = LimitSurface::new(&mesh)?;
    say();
    let scout = Scout::new(&surface).ok_or("no face")?;
    let camera = scout.camera([1024, 1024], DVec3::Z);
    say();
    let gpu = Gpu::new()?;
    say();
    let tables = gpu.upload(&surface)?;
    say();
    let frame = gpu.render(&tables, &View::new(camera, scout.light(&camera)))?;
    say();
    if frame.summary.is_none_or(|summary| summary.covered == 0 || summary.unconverged > 0) {
        return Err("the picture is not right".into());
    }
    say_peak()
}

/// Seconds, then the peak.
fn opensubdiv(path: &Path) -> Result<(), Failure> {
    let mesh = mesh::read(path)?;
    let start = Instant::now();
    let far = Far::new(&mesh, MAX_ISOLATION)?;
    print!("{} ", start.elapsed().as_secs_f64());
    drop(far);
    say_peak()
}

/// Peak of the process's memory in MiB.
fn say_peak() -> Result<(), Failure> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
    println!("{}", peak.ok_or("no VmHWM in /proc/self/status")?.parse::<f64>()? / 1024.0);
    Ok(())
}

/// About `faces` faces.
fn sheet(faces: usize) -> SubdivMesh {
    const SHARPNESS: [f32; 4] = [1.0, 2.5, 3.3, 10.0];
    let side = faces.isqrt();
    let vertex = |i: usize, j: usize| (j * (side + 1) + i) as u32;
    let mut mesh = SubdivMesh { name: "sheet".to_owned(), ..SubdivMesh::default() };
    for j in 0..=side {
        for i in 0..=side {
            let [x, y] = [i, j].map(|k| k as f64 / side as f64 * 4.0 - 2.0);
            let wave = 0.3 * (3.0 * x).sin() * (2.5 * y).cos() + 0.05 * (17.0 * x + 11.0 * y).sin();
            mesh.points.push(DVec3::new(x, y, wave));
        }
    }
    let mut push = |face: &[u32]| {
        mesh.face_sizes.push(face.len() as u32);
        mesh.face_vertices.extend(face);
    };
    let mut seed = 1u64;
    for j in 0..side {
        let mut i = 0;
        while i < side {
            // A linear congruential generator (Knuth's MMIX constants).
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            let on_crease = (i + 1) % 50 == 0 || j % 50 == 0 || (j + 1) % 50 == 0;
            match seed >> 33 {
                x if x % 100 == 0 => [[a, b, c], [a, c, d]].iter().for_each(|face| push(face)),
                x if x % 100 == 1 && i + 2 <= side && !on_crease => {
                    push(&[a, b, vertex(i + 2, j), vertex(i + 2, j + 1), c, d]);
                    i += 1;
                }
                _ => push(&[a, b, c, d]),
            }
            i += 1;
        }
    }
    for at in (50..side).step_by(50) {
        let sharpness = SHARPNESS[at / 50 % 4];
        for i in 0..side {
            mesh.creases.push(Crease { vertices: [vertex(i, at), vertex(i + 1, at)], sharpness });
            mesh.creases.push(Crease { vertices: [vertex(at, i), vertex(at, i + 1)], sharpness });
        }
    }
    mesh
}

fn obj(mesh: &SubdivMesh) -> Result<String, std::fmt::Error> {
    let mut text = String::from("t interpolateboundary 1/0/0 1\n");
    for p in &mesh.points {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for (_, face) in mesh.faces() {
        text.push('f');
        face.iter().try_for_each(|vertex| write!(text, " {}", vertex + 1))?;
        text.push('\n');
    }
    for Crease { vertices: [a, b], sharpness } in &mesh.creases {
        writeln!(text, "t crease 2/1/0 {a} {b} {sharpness}")?;
    }
    Ok(text)
}
