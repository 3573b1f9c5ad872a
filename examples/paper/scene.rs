//! The mesh and the view that `catoptric render` draws.

use super::paper::{Failure, Stage};
use catoptric::field::{DEFAULT_FOV, Scout, sample_rig};
use catoptric::gpu::View;
use catoptric::mesh;
use glam::DVec3;
use std::path::Path;

/// The mesh of a file, or the built-in sample, and the view that fits it, one sample a pixel.
pub fn load(path: Option<&Path>, size: [u32; 2]) -> Result<(Stage, View), Failure> {
    let mesh = path.map_or_else(|| Ok(mesh::sample()), mesh::read)?;
    let stage = Stage::new(&mesh)?;
    let scout = Scout::new(&stage.surface).ok_or("no face has a limit surface; nothing to draw")?;
    let view = if path.is_some() {
        let camera = scout.camera(size, DVec3::Z);
        View::new(camera, scout.light(&camera))
    } else {
        let (direction, light) = sample_rig();
        View::new(scout.camera_from(size, DVec3::Z, direction, DEFAULT_FOV), light)
    };
    Ok((stage, View { samples: 1, ..view }))
}
