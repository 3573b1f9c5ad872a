//! What the programs share that redo figures and tables of Yasui & Kanai 2004.

use catoptric::gpu::{Gpu, Pipeline, Tables, View};
use catoptric::mesh::SubdivMesh;
use catoptric::stam::LimitSurface;
use std::process::ExitCode;

/// The pipeline that stands for the limit surface itself.
pub const EXACT: Pipeline = Pipeline::Exact;

/// Why a program stopped: one line.
pub type Failure = Box<dyn std::error::Error>;

/// Exit code of a program: 0 done, 2 bad usage or input, as in `catoptric`.
pub fn exit(name: &str, result: Result<(), Failure>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{name}: {failure}");
            ExitCode::from(2)
        }
    }
}

/// A surface on the adapter.
pub struct Stage {
    pub gpu: Gpu,
    pub surface: LimitSurface,
    pub tables: Tables,
}

impl Stage {
    pub fn new(mesh: &SubdivMesh) -> Result<Stage, Failure> {
        let surface = LimitSurface::new(mesh).map_err(|e| format!("{}: {e}", mesh.name))?;
        if surface.patches().is_empty() {
            return Err(format!("{}: no face has a limit surface; nothing to draw", mesh.name).into());
        }
        let gpu = Gpu::new()?;
        let tables = gpu.upload(&surface)?;
        Ok(Stage { gpu, surface, tables })
    }
}

/// A view drawn by a pipeline at a level; `enlarge` is for points.
pub fn drawn_by(view: &View, pipeline: Pipeline, level: u32, enlarge: f64) -> View {
    let enlarge = if pipeline == Pipeline::Points { enlarge } else { 1.0 };
    View { pipeline, proxy_level: Some(level), enlarge, ..view.clone() }
}
