//! What the programs share that redo figures and tables of Yasui & Kanai 2004.

// Each program uses its part.
#![allow(dead_code)]

pub mod measure;

use catoptric::field::{Camera, DEFAULT_FOV, Projection, Scout, sample_rig};
use catoptric::gpu::{Gpu, Pipeline, Tables, View};
use catoptric::mesh::{self, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::DVec3;
use std::path::Path;
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

/// Name of a pipeline, as in `--pipeline`.
pub fn name(pipeline: Pipeline) -> String {
    format!("{pipeline:?}").to_lowercase()
}

/// By how much the paper enlarges the viewport each way at a level of the polygon (sec. 5: 1.7^2, 1.3^2 and 1 times).
pub fn enlargement(level: u32) -> f64 {
    match level {
        0 | 1 => 1.7,
        2 => 1.3,
        _ => 1.0,
    }
}

/// A surface on the adapter.
pub struct Stage {
    pub gpu: Gpu,
    pub surface: LimitSurface,
    pub tables: Tables,
    /// It is the built-in sample.
    is_sample: bool,
}

impl Stage {
    pub fn new(mesh: &SubdivMesh) -> Result<Stage, Failure> {
        let surface = LimitSurface::new(mesh).map_err(|e| format!("{}: {e}", mesh.name))?;
        let gpu = Gpu::new()?;
        let tables = gpu.upload(&surface)?;
        Ok(Stage { gpu, surface, tables, is_sample: false })
    }

    /// The mesh of a file, or the built-in sample.
    pub fn load(path: Option<&Path>) -> Result<Stage, Failure> {
        match path {
            Some(path) => Stage::new(&mesh::read(path)?),
            None => Ok(Stage { is_sample: true, ..Stage::new(&mesh::sample())? }),
        }
    }

    /// The view that `catoptric render` chooses, one sample a pixel.
    pub fn view(&self, size: [u32; 2]) -> Result<View, Failure> {
        let scout = Scout::new(&self.surface).ok_or("no face has a limit surface; nothing to draw")?;
        let view = match self.is_sample {
            true => {
                let (direction, light) = sample_rig();
                View::new(scout.camera_from(size, DVec3::Z, direction, DEFAULT_FOV), light)
            }
            false => {
                let camera = scout.camera(size, DVec3::Z);
                View::new(camera, scout.light(&camera))
            }
        };
        Ok(View { samples: 1, ..view })
    }
}

/// The part of a picture in perspective round a point of it, from the same eye: `center` in parts of its width and height,
/// `zoom` times as large.
pub fn close_up(camera: &Camera, center: [f64; 2], zoom: f64) -> Camera {
    let [w, h] = camera.size.map(f64::from);
    let ray = camera.pixel_ray(center[0] * w, center[1] * h);
    let projection = match camera.projection {
        Projection::Perspective { fov } => {
            let fov = 2.0 * ((fov.to_radians() / 2.0).tan() / zoom).atan().to_degrees();
            Projection::Perspective { fov }
        }
        Projection::Orthographic { height } => Projection::Orthographic { height: height / zoom },
    };
    Camera { target: camera.eye + ray.direction * camera.eye.distance(camera.target), projection, ..*camera }
}

/// Some view drawn by a pipeline at a level; points with the enlargement given.
pub fn drawn_by(view: &View, pipeline: Pipeline, level: u32, enlarge: f64) -> View {
    let enlarge = if pipeline == Pipeline::Points { enlarge } else { 1.0 };
    View { pipeline, proxy_level: Some(level), enlarge, ..view.clone() }
}
