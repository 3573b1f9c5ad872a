//! Runs the passes in order and reads the results back.

use super::device::Device;
use super::passes::{self, Passes, Scene, Targets};
use super::view::{View, Window};
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
    let mut targets: Option<Targets> = None;
    for tile in Window::tiles(size) {
        if targets.as_ref().is_none_or(|t| t.size != tile.size) {
            targets = Some(Targets::new(device, tile.size, view.pipeline));
        }
        let Some(targets) = &targets else { continue };
        for (sample, window) in tile.samples(view.samples).enumerate() {
            draw_surface(device, passes, &scene, targets, &window, &mut timings)?;
            timings.time("shade", || passes::shade::run(device, passes, &scene, targets, &window, sample == 0))?;
        }
        timings.time("resolve", || passes::resolve::run(device, passes, targets))?;
        let pixels: Vec<[u8; 4]> = timings.time("read back", || device.read_texture(&targets.colour))?;
        paste(&mut rgba8, size, bytemuck::cast_slice(&pixels), &tile, 4);
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
    for tile in Window::tiles(size) {
        let targets = Targets::new(device, tile.size, view.pipeline);
        draw_surface(device, passes, &scene, &targets, &tile, &mut timings)?;
        timings.time("read back", || read_surface(device, tables, &targets, &tile, &mut image))?;
    }
    image.timings = timings;
    Ok(image)
}

/// Visibility and limit (or polygon) passes of one window.
fn draw_surface(
    device: &Device,
    passes: &Passes,
    scene: &Scene,
    targets: &Targets,
    window: &Window,
    timings: &mut Timings,
) -> Result<(), GpuError> {
    timings.time("visibility", || passes::visibility::run(device, passes, scene, targets, window))?;
    let name = match scene.view.pipeline {
        Pipeline::Limit => "limit",
        Pipeline::Polygon => "polygon",
    };
    timings.time(name, || passes::limit::run(device, passes, scene, targets))
}

/// Reads the textures of one tile into the image of the whole picture.
fn read_surface(
    device: &Device,
    tables: &Tables,
    targets: &Targets,
    tile: &Window,
    image: &mut SurfaceImage,
) -> Result<(), GpuError> {
    let unit = tables.unit();
    let ids: Vec<u32> = device.read_texture(&targets.patch)?;
    let patch: Vec<u32> = ids.iter().map(|id| id.wrapping_sub(1)).collect();
    let uv: Vec<[f32; 2]> = device.read_texture(&targets.uv)?;
    let local: Vec<[f32; 4]> = device.read_texture(&targets.position)?;
    let world = local.iter().zip(&patch).map(|(p, &patch)| match patch {
        NO_PATCH => DVec3::ZERO,
        patch => tables.origin(patch as usize) + glam::Vec3::new(p[0], p[1], p[2]).as_dvec3() * unit,
    });
    let normal: Vec<[f32; 4]> = device.read_texture(&targets.normal)?;
    let field: Vec<[f32; 4]> = device.read_texture(&targets.field)?;
    let value = |f: &[f32; 4]| (f[2] > 0.0).then(|| DVec2::new(f64::from(f[0]), f64::from(f[1])) * unit);
    let size = image.size;
    paste(&mut image.patch, size, &patch, tile, 1);
    paste(&mut image.uv, size, &uv, tile, 1);
    paste(&mut image.position, size, &world.collect::<Vec<_>>(), tile, 1);
    paste(&mut image.normal, size, &normal.iter().map(|n| [n[0], n[1], n[2]]).collect::<Vec<_>>(), tile, 1);
    paste(&mut image.field, size, &field.iter().map(value).collect::<Vec<_>>(), tile, 1);
    Ok(())
}

/// Copies a tile into a picture of `size` pixels of `channels` elements each.
fn paste<T: Copy>(picture: &mut [T], size: [u32; 2], tile_data: &[T], tile: &Window, channels: usize) {
    let [width, tile_width] = [size[0] as usize * channels, tile.size[0] as usize * channels];
    let start = tile.origin[1] as usize * width + tile.origin[0] as usize * channels;
    for (row, source) in tile_data.chunks_exact(tile_width).enumerate() {
        let at = start + row * width;
        picture[at..at + tile_width].copy_from_slice(source);
    }
}
