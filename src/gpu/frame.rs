//! Runs the passes in order and reads the results back.

use super::device::Device;
use super::passes::{self, Passes, Scene, Targets};
use super::view::{Tile, View};
use super::{GpuError, Pipeline, Tables};
use glam::{DVec2, DVec3};
use std::time::{Duration, Instant};

/// Patch index of a pixel that sees no surface.
pub const NO_PATCH: u32 = u32::MAX;

/// Wall time of each step, in the order in which they first ran; waiting for the adapter included.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timings {
    /// Name of the step and the sum of its times.
    pub steps: Vec<(&'static str, Duration)>,
}

impl Timings {
    fn time<R>(&mut self, name: &'static str, step: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = step();
        let elapsed = start.elapsed();
        match self.steps.iter_mut().find(|(known, _)| *known == name) {
            Some((_, total)) => *total += elapsed,
            None => self.steps.push((name, elapsed)),
        }
        result
    }
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Width and height.
    pub size: [u32; 2],
    /// sRGB RGBA, 4 bytes a pixel, rows from top to bottom, opaque.
    pub rgba8: Vec<u8>,
    /// Time of each step.
    pub timings: Timings,
}

/// What each pixel's centre sees, rows from top to bottom. Where `patch` is [`NO_PATCH`] the rest is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceImage {
    /// Width and height.
    pub size: [u32; 2],
    /// Patch index.
    pub patch: Vec<u32>,
    /// Patch-local parameters, exactly as the limit pass used them.
    pub uv: Vec<[f32; 2]>,
    /// World-space position: the patch's f64 origin plus the f32 result of the shader.
    pub position: Vec<DVec3>,
    /// Unit normal of the parametrisation (du x dv).
    pub normal: Vec<[f32; 3]>,
    /// Field value in world units, as [`Field::value`](crate::field::Field::value).
    pub field: Vec<Option<DVec2>>,
    /// Time of each step.
    pub timings: Timings,
}

pub(super) fn render(device: &Device, passes: &Passes, tables: &Tables, view: &View) -> Result<Frame, GpuError> {
    view.check()?;
    let mut timings = Timings::default();
    timings.time("compile", || passes.prepare(device, view.pipeline));
    let scene = timings.time("scene", || Scene::new(device, tables, view))?;
    let size = view.camera.size;
    let mut rgba8 = vec![0; 4 * size[0] as usize * size[1] as usize];
    for tile in Tile::cover(size, view.samples) {
        let targets = timings.time("targets", || Targets::new(device, &tile, view.pipeline));
        timings.time("visibility", || passes::visibility::run(device, passes, &scene, &targets, &tile))?;
        for rows in tile.bands() {
            let band = passes::Band::new(device, &tile, rows)?;
            timings.time(limit_step(view), || passes::limit::run(device, passes, &scene, &targets, &band))?;
            timings.time("shade", || passes::shade::run(device, passes, &scene, &targets, &tile, &band))?;
        }
        timings.time("resolve", || passes::resolve::run(device, passes, &targets, &tile))?;
        let pixels: Vec<[u8; 4]> = timings.time("read back", || device.read_texture(&targets.colour))?;
        let [origin, tile_size] = tile.pixels();
        paste(bytemuck::cast_slice_mut::<u8, [u8; 4]>(&mut rgba8), size, &pixels, origin, tile_size);
    }
    Ok(Frame { size, rgba8, timings })
}

pub(super) fn inspect(
    device: &Device,
    passes: &Passes,
    tables: &Tables,
    view: &View,
) -> Result<SurfaceImage, GpuError> {
    view.check()?;
    let mut timings = Timings::default();
    timings.time("compile", || passes.prepare(device, view.pipeline));
    let scene = timings.time("scene", || Scene::new(device, tables, view))?;
    let size = view.camera.size;
    let count = size[0] as usize * size[1] as usize;
    let mut image = SurfaceImage {
        size,
        patch: vec![NO_PATCH; count],
        uv: vec![[0.0; 2]; count],
        position: vec![DVec3::ZERO; count],
        normal: vec![[0.0; 3]; count],
        field: vec![None; count],
        timings: Timings::default(),
    };
    for tile in Tile::cover(size, 1) {
        let targets = Targets::new(device, &tile, view.pipeline);
        timings.time("visibility", || passes::visibility::run(device, passes, &scene, &targets, &tile))?;
        timings.time("read back", || -> Result<(), GpuError> {
            let ids: Vec<u32> = device.read_texture(&targets.patch)?;
            let patch: Vec<u32> = ids.iter().map(|id| id.wrapping_sub(1)).collect();
            paste(&mut image.patch, size, &patch, tile.origin, tile.size);
            paste(&mut image.uv, size, &device.read_texture(&targets.uv)?, tile.origin, tile.size);
            Ok(())
        })?;
        for rows in tile.bands() {
            let band = passes::Band::new(device, &tile, rows)?;
            timings.time(limit_step(view), || passes::limit::run(device, passes, &scene, &targets, &band))?;
            timings.time("read back", || read_band(device, tables, &targets, &tile, &band, &mut image))?;
        }
    }
    image.timings = timings;
    Ok(image)
}

fn limit_step(view: &View) -> &'static str {
    match view.pipeline {
        Pipeline::Limit => "limit",
        Pipeline::Polygon => "polygon",
    }
}

/// Reads the surface textures of one band into the image of the whole picture.
fn read_band(
    device: &Device,
    tables: &Tables,
    targets: &Targets,
    tile: &Tile,
    band: &passes::Band,
    image: &mut SurfaceImage,
) -> Result<(), GpuError> {
    let unit = tables.unit();
    let width = tile.size[0] as usize;
    // The textures hold one row before and after the band.
    let inner = width..width * (1 + band.rows.len());
    let origin = [tile.origin[0], tile.origin[1] + band.rows.start];
    let band_size = [tile.size[0], band.rows.len() as u32];
    let size = image.size;
    let rows =
        |texture| -> Result<Vec<[f32; 4]>, GpuError> { Ok(device.read_texture(texture)?[inner.clone()].to_vec()) };
    let normal: Vec<_> = rows(&targets.normal)?.iter().map(|n| [n[0], n[1], n[2]]).collect();
    paste(&mut image.normal, size, &normal, origin, band_size);
    let value = |f: &[f32; 4]| (f[2] > 0.0).then(|| DVec2::new(f64::from(f[0]), f64::from(f[1])) * unit);
    let field: Vec<_> = rows(&targets.field)?.iter().map(value).collect();
    paste(&mut image.field, size, &field, origin, band_size);
    let local: Vec<_> =
        rows(&targets.position)?.iter().map(|p| DVec3::new(p[0].into(), p[1].into(), p[2].into())).collect();
    paste(&mut image.position, size, &local, origin, band_size);
    for y in 0..band_size[1] {
        for x in 0..band_size[0] {
            let at = (origin[1] + y) as usize * size[0] as usize + (origin[0] + x) as usize;
            if image.patch[at] != NO_PATCH {
                image.position[at] = tables.origin(image.patch[at] as usize) + image.position[at] * unit;
            }
        }
    }
    Ok(())
}

/// Copies a rectangle into a picture.
fn paste<T: Copy>(picture: &mut [T], size: [u32; 2], part: &[T], origin: [u32; 2], part_size: [u32; 2]) {
    let width = part_size[0] as usize;
    for (row, source) in part.chunks_exact(width).enumerate() {
        let at = (origin[1] as usize + row) * size[0] as usize + origin[0] as usize;
        picture[at..at + width].copy_from_slice(source);
    }
}
