//! Rows of meshes of 10,000 to 1,000,000 control faces, each measured in a process of its own, so that its peak of memory is its own.

use super::contest::{Figure, RUNS};
use super::sheet::{obj, sheet};
use super::{BenchError, Effort, Row};
use crate::field::Scout;
use crate::gpu::{Gpu, View};
use crate::memory;
use crate::mesh;
use crate::osd::{Far, MAX_ISOLATION};
use crate::stam::LimitSurface;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Sheets that are measured, by their control faces.
const SIZES: [usize; 3] = [10_000, 100_000, 1_000_000];
/// Seconds up to which a size is measured in all runs, and not once.
const SHORT: f64 = 5.0;
/// Bytes a control face that Far takes at isolation 10, on sheets.
const FAR_BYTES: u64 = 15_000;

/// Who takes a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contender {
    /// We: from the file to a picture of 1024 x 1024, four samples a pixel.
    Ours,
    /// OpenSubdiv: refinement, patch table and points of Far at isolation 10, nothing drawn; the file is read before.
    Osd,
}

impl Contender {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Ours, Self::Osd];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours => "catoptric",
            Self::Osd => "osd",
        }
    }
}

/// What a file took.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Stages {
    /// Seconds of each stage, in order.
    pub seconds: Vec<(String, f64)>,
    /// Peak of the process's memory, in MiB.
    pub peak: f64,
}

impl Stages {
    /// Takes a file, in this process.
    ///
    /// # Errors
    /// The file is refused, there is no adapter, or no peak of memory to be read.
    pub fn of(contender: Contender, path: &Path) -> Result<Self, BenchError> {
        let mut seconds = Vec::new();
        match contender {
            Contender::Ours => ours(path, &mut seconds)?,
            Contender::Osd => {
                let mesh = mesh::read(path)?;
                let start = Instant::now();
                let _far = Far::new(&mesh, MAX_ISOLATION)?;
                seconds.push(("refine".to_owned(), start.elapsed().as_secs_f64()));
            }
        }
        Ok(Self { seconds, peak: peak()? })
    }

    /// Takes a file, in a process of its own.
    fn apart(program: &Path, contender: Contender, path: &Path) -> Result<Self, BenchError> {
        let output = Command::new(program).args(["bench", "--stages", contender.name()]).arg(path).output()?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            return Err(format!("scale, {}: {} {said}", contender.name(), output.status).into());
        }
        Ok(serde_json::from_slice(&output.stdout)?)
    }

    fn whole(&self) -> f64 {
        self.seconds.iter().map(|(_, seconds)| seconds).sum()
    }
}

fn ours(path: &Path, seconds: &mut Vec<(String, f64)>) -> Result<(), BenchError> {
    let mut last = Instant::now();
    let mut done = |stage: &str| {
        seconds.push((stage.to_owned(), last.elapsed().as_secs_f64()));
        last = Instant::now();
    };
    let mesh = mesh::read(path)?;
    done("read");
    let surface = LimitSurface::new(&mesh)?;
    done("refine");
    let scout = Scout::new(&surface).ok_or("no face")?;
    let camera = scout.camera([1024, 1024], DVec3::Z);
    done("fit");
    let gpu = Gpu::new()?;
    done("adapter");
    let tables = gpu.upload(&surface)?;
    done("tables");
    let frame = gpu.render(&tables, &View::new(camera, scout.light(&camera)))?;
    done("picture");
    let right = frame.summary.is_some_and(|summary| summary.covered > 0 && summary.unconverged == 0);
    if right { Ok(()) } else { Err("the picture is not right".into()) }
}

/// Peak of this process's memory in MiB.
fn peak() -> Result<f64, BenchError> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
    Ok(peak.ok_or("no VmHWM in /proc/self/status")?.parse::<f64>()? / 1024.0)
}

/// As many runs as the first one leaves time for; the others are as it.
fn runs(mut run: impl FnMut() -> Result<Stages, BenchError>) -> Result<(Stages, [Figure; 2], usize), BenchError> {
    let first = run()?;
    let count = if first.whole() < SHORT { RUNS } else { 1 };
    let mut all = [[first.whole(), first.peak]; RUNS];
    for figures in &mut all[1..count] {
        let next = run()?;
        *figures = [next.whole(), next.peak];
    }
    Ok((first, [0, 1].map(|k| Figure(all.map(|figures| figures[k]))), count))
}

pub(super) fn rows(program: &Path, effort: Effort) -> Result<Vec<Row>, BenchError> {
    let folder = tempfile::tempdir()?;
    let mut rows = Vec::new();
    let mut before: Option<[f64; 2]> = None;
    for size in SIZES.into_iter().filter(|&size| size <= effort.faces) {
        let (mesh, path) = (sheet(size), folder.path().join("sheet.obj"));
        std::fs::write(&path, obj(&mesh)?)?;
        let faces = mesh.face_count();
        let (stages, ours, count) = runs(|| Stages::apart(program, Contender::Ours, &path))?;
        // Beyond what is free the system would kill it, or something else.
        let fits = FAR_BYTES * (faces as u64) < memory::free().map_or(u64::MAX, |limit| limit.bytes);
        let theirs = fits.then(|| runs(|| Stages::apart(program, Contender::Osd, &path))).transpose()?;
        let point = [faces as f64, ours[0].median()];
        let slope = before.replace(point).map_or(String::new(), |[faces, seconds]| {
            format!("; slope {:.2}", (point[1] / seconds).ln() / (point[0] / faces).ln())
        });
        let steps: Vec<String> = stages.seconds.iter().map(|(stage, s)| format!("{stage} {s:.2}")).collect();
        let note = format!(
            "sheet of {faces} faces, from its file to a picture of 1024 x 1024, runs: {count}; first run: {}{slope}; Osd: refinement, patch \
             table and points at isolation 10 of a mesh in memory, nothing drawn{}",
            steps.join(", "),
            if fits { "" } else { ": left out, for its memory is not free" }
        );
        for (what, unit, which) in [("s", "s", 0), ("memory", "MiB", 1)] {
            let name = format!("scale_{what}_{size}");
            let theirs = theirs.iter().map(|(_, theirs, _)| ("osd", theirs[which])).collect();
            rows.push(Row::new(name, unit, 1.0, &ours[which], &theirs, note.clone()));
        }
    }
    Ok(rows)
}
