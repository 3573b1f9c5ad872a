//! `bench`: figures of this machine, side by side with peers.

use super::args::BenchArgs;
use super::{Failure, outgoing, write_out};
use crate::bench::{self, Contender, Effort, Means, Row, Stages, Work};
use crate::gpu::Gpu;
use crate::line::count;
use crate::nearest::nearest;
use crate::statistics::short;
use serde::Serialize;
use std::fmt::Write;

#[derive(Debug, Serialize)]
struct Report<'a> {
    version: &'static str,
    machine: String,
    /// `null` without one: rows that need it are left out.
    adapter: Option<&'a str>,
    mesh: &'a str,
    faces: usize,
    results: Vec<Row>,
}

/// The work of this name.
pub(super) fn work(name: &str) -> Result<Work, String> {
    let names = || Work::ALL.map(Work::name).join(", ");
    let named = Work::ALL.into_iter().find(|work| work.name() == name);
    named.ok_or_else(|| {
        let near = nearest(name, Work::ALL.map(Work::name));
        let near = near.map(|near| format!(" (did you mean {near}?)")).unwrap_or_default();
        format!("no row has this name{near}; give {}", names())
    })
}

/// The contender of this name.
pub(super) fn contender(name: &str) -> Result<Contender, String> {
    Contender::ALL.into_iter().find(|contender| contender.name() == name).ok_or_else(|| format!("no contender {name}"))
}

/// Processor, and the cores that are used.
fn machine() -> String {
    let Ok(mut system) = sysinfo::System::new() else { return "unknown".to_owned() };
    system.refresh_cpu_list(sysinfo::CpuRefreshKind::nothing());
    let brand = system.cpus().first().map_or("unknown processor", |cpu| cpu.brand().trim());
    format!("{brand}, {}", count(system.cpus().len(), "core"))
}

pub(super) fn run(args: &BenchArgs) -> Result<(), Failure> {
    if let (Some(contender), Some(path)) = (args.stages, &args.mesh) {
        let stages = Stages::of(contender, path).map_err(|error| Failure::Bad(error.to_string()))?;
        return write_out(None, serde_json::to_string(&stages).expect("numbers and names").as_bytes());
    }
    args.json.iter().try_for_each(|path| outgoing::check(path, "--json"))?;
    let mesh = args.scene.load_quads(args.mesh.as_deref(), "bench")?;
    let gpu = match Gpu::new() {
        Ok(gpu) => Some(gpu),
        Err(error) if error.is_no_adapter() => None,
        Err(error) => return Err(error.into()),
    };
    let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
    let all = if args.only.is_empty() { &Work::ALL[..] } else { &args.only };
    let program = std::env::current_exe().ok();
    let means = Means { gpu: gpu.as_ref(), program: program.as_deref() };
    let mut results = Vec::new();
    for &work in all {
        let rows = bench::measure(work, &mesh, effort, means).map_err(|error| Failure::of(&mesh, error))?;
        results.extend(rows);
    }
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        machine: machine(),
        adapter: gpu.as_ref().map(Gpu::adapter),
        mesh: &mesh.name,
        faces: mesh.face_count(),
        results,
    };
    write_out(None, text(&report).as_bytes())?;
    if let Some(path) = &args.json {
        let json = serde_json::to_string_pretty(&report).expect("numbers and names");
        write_out(Some(path), (json + "\n").as_bytes())?;
    }
    Ok(())
}

fn text(report: &Report<'_>) -> String {
    let mut out = format!(
        "machine  {}\nadapter  {}\nmesh     {} ({})\n\n",
        report.machine,
        report.adapter.unwrap_or("none: rows that need one are left out"),
        report.mesh,
        count(report.faces, "face")
    );
    let _ = writeln!(
        out,
        "{:<32} {:>9} {:>10}  {:>10}  peers, and their ratios to it",
        "row", "unit", "catoptric", "floor"
    );
    for row in &report.results {
        let floor = row.floor.map_or("-".to_owned(), short);
        let _ = write!(out, "{:<32} {:>9} {:>10}  {floor:>10} ", row.name, row.unit, short(row.catoptric));
        for (peer, figure) in row.peers.iter().filter_map(|(peer, figure)| Some((peer, (*figure)?))) {
            let _ = write!(out, " {peer} {}", short(figure));
            if let Some([low, high]) = row.ratios.get(peer) {
                let ends = [low, high].map(|ratio| short(*ratio));
                let _ = if ends[0] == ends[1] {
                    write!(out, " ({}x)", ends[0])
                } else {
                    write!(out, " ({}..{}x)", ends[0], ends[1])
                };
            }
        }
        out.push('\n');
    }
    out.push('\n');
    for row in &report.results {
        let _ = writeln!(out, "{}: {}", row.name, row.note);
    }
    out
}
