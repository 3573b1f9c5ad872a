//! Runs the passes in order and reads the results back.

use super::certificate::{Certificate, Summary};
use super::device::Device;
use super::passes::{self, Colour, Passes, PictureTargets, Scene, SurfaceTargets, Visible};
use super::scenes::Scenes;
use super::view::{Tile, View};
use super::watch::Watch;
use super::{GpuError, Pipeline, Stage, Tables, paper};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
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
    pub(super) fn time<R>(&mut self, name: &'static str, step: impl FnOnce() -> R) -> R {
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
    /// What the certificates of its samples say; `None` but for the exact pipeline.
    pub summary: Option<Summary>,
    /// Time of each step.
    pub timings: Timings,
}

/// A picture to work with.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearFrame {
    /// Width and height.
    pub size: [u32; 2],
    /// Linear RGB and coverage, premultiplied, without a background; rows from top to bottom.
    pub rgba: Vec<[f32; 4]>,
    /// What the certificates of its samples say; `None` but for the exact pipeline.
    pub summary: Option<Summary>,
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
    /// Field value, as [`Field::value`](crate::field::Field::value).
    pub field: Vec<Option<DVec2>>,
    /// How each pixel came to its point.
    pub certificate: Vec<Certificate>,
    /// Time of each step.
    pub timings: Timings,
}

impl SurfaceImage {
    /// No surface anywhere.
    pub(super) fn empty(size: [u32; 2]) -> SurfaceImage {
        let count = size[0] as usize * size[1] as usize;
        SurfaceImage {
            size,
            patch: vec![NO_PATCH; count],
            uv: vec![[0.0; 2]; count],
            position: vec![DVec3::ZERO; count],
            normal: vec![[0.0; 3]; count],
            field: vec![None; count],
            certificate: vec![Certificate::default(); count],
            timings: Timings::default(),
        }
    }

    /// The certificates, summed up.
    pub fn summary(&self) -> Summary {
        Summary::of(&self.certificate)
    }
}

pub(super) fn render(
    device: &Device,
    passes: &Passes,
    tables: &Tables,
    view: &View,
    watch: Watch<'_>,
) -> Result<Frame, GpuError> {
    let Drawn { pixels, summary, timings } = draw::<[u8; 4]>(device, passes, tables, view, Colour::Display, watch)?;
    Ok(Frame { size: view.camera.size, rgba8: pixels.into_flattened(), summary, timings })
}

pub(super) fn render_linear(
    device: &Device,
    passes: &Passes,
    tables: &Tables,
    view: &View,
    watch: Watch<'_>,
) -> Result<LinearFrame, GpuError> {
    let Drawn { pixels: rgba, summary, timings } = draw(device, passes, tables, view, Colour::Linear, watch)?;
    Ok(LinearFrame { size: view.camera.size, rgba, summary, timings })
}

/// A picture in pixels of some kind.
pub(super) struct Drawn<T> {
    pub pixels: Vec<T>,
    pub summary: Option<Summary>,
    pub timings: Timings,
}

/// Part of a tile's time that is gone when it is known what its samples see, and when the limit is evaluated there. `render --timings` says 0.24 and
/// 0.61 for the sample at 2048 x 2048 pixels on the software adapter, 0.44 and 0.81 for OpenSubdiv's `catmark_car`.
const SEEN: f64 = 0.35;
const EVALUATED: f64 = 0.7;

/// Draws a picture whose pixels are `T`, which is what `colour` comes in.
fn draw<T: bytemuck::Pod>(
    device: &Device,
    passes: &Passes,
    tables: &Tables,
    view: &View,
    colour: Colour,
    watch: Watch<'_>,
) -> Result<Drawn<T>, GpuError> {
    view.check(tables)?;
    if view.pipeline == Pipeline::Points {
        return paper::draw(device, passes, tables, view, colour).inspect(|_| watch.tell(1.0));
    }
    let mut timings = Timings::default();
    timings.time("compile", || passes.prepare(device, view, colour));
    let mut scenes = Scenes::new(device, tables, view, &mut timings)?;
    let size = view.camera.size;
    let mut summary = (view.pipeline == Pipeline::Exact).then(Summary::default);
    let mut whole = vec![T::zeroed(); size[0] as usize * size[1] as usize];
    let side = scenes.side(Tile::PICTURE_SIDE);
    let tiles = match size.iter().all(|&n| n * view.samples <= side) {
        true => Tile::cover(size, view.samples, side),
        false => Tile::cover(size, view.samples, (side - 2 * view.samples).max(view.samples)),
    };
    let count = tiles.len();
    for (i, own) in tiles.into_iter().enumerate() {
        let watch = watch.part(i as f64 / count as f64, (i + 1) as f64 / count as f64);
        let tile = own.grown(size);
        let mut visible = Visible::new(device, &device.pool, &tile, view.pipeline);
        let picture = PictureTargets::new(device, &device.pool, &tile, colour);
        let scene = &scenes.see(passes, &mut visible, &tile, &mut timings, watch.part(0.0, SEEN))?;
        let stage = choose_stage(device, passes, scene, &visible, &picture)?;
        timings
            .time(limit_step(view), || passes::limit::run(device, passes, scene, &visible, &picture.surface, stage))?;
        watch.tell(EVALUATED);
        timings.time("shade", || passes::shade::run(device, passes, scene, &visible, &picture, stage))?;
        timings.time("resolve", || passes::resolve::run(device, passes, scene, &picture, &tile, colour))?;
        if let (Some(summary), Some(texture)) = (&mut summary, &visible.certificate) {
            let of_tile =
                timings.time("certificates", || passes::summary::run(device, passes, texture, &tile, &own))?;
            *summary = summary.and(of_tile);
        }
        timings.time("read back", || read_own(device, &picture.colour, [&tile, &own], &mut whole, size))?;
        watch.tell(1.0);
    }
    Ok(Drawn { pixels: whole, summary, timings })
}

pub(super) fn inspect(
    device: &Device,
    passes: &Passes,
    tables: &Tables,
    view: &View,
    watch: Watch<'_>,
) -> Result<SurfaceImage, GpuError> {
    view.check(tables)?;
    if view.pipeline == Pipeline::Points {
        return paper::inspect(device, passes, tables, view).inspect(|_| watch.tell(1.0));
    }
    let mut timings = Timings::default();
    let mut scenes = Scenes::new(device, tables, view, &mut timings)?;
    let size = view.camera.size;
    let mut image = SurfaceImage::empty(size);
    let tiles = Tile::cover(size, 1, scenes.side(Tile::SURFACE_SIDE));
    for (i, tile) in tiles.iter().enumerate() {
        let watch = watch.part(i as f64 / tiles.len() as f64, (i + 1) as f64 / tiles.len() as f64);
        let mut visible = Visible::new(device, &device.pool, tile, view.pipeline);
        let surface = SurfaceTargets::new(device, tile);
        let scene = &scenes.see(passes, &mut visible, tile, &mut timings, watch.part(0.0, SEEN))?;
        timings.time(limit_step(view), || passes::limit::run_full(device, passes, scene, &visible, &surface))?;
        timings.time("read back", || read_tile(device, scene, &visible, &surface, tile, &mut image))?;
        watch.tell(1.0);
    }
    image.timings = timings;
    Ok(image)
}

/// The stage that the view asks for; where it leaves the choice, the one that took less time over the first tile.
pub(super) fn choose_stage(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    visible: &Visible,
    picture: &PictureTargets,
) -> Result<Stage, GpuError> {
    if scene.view.stage != Stage::Auto {
        return Ok(scene.view.stage);
    }
    if device.info.device_type == wgpu::DeviceType::Cpu {
        return Ok(Stage::Fragment);
    }
    if let Some(&stage) = passes.fastest.get() {
        return Ok(stage);
    }
    let time = |stage: Stage| -> Result<Duration, GpuError> {
        let once = || -> Result<Duration, GpuError> {
            let start = Instant::now();
            passes::limit::run(device, passes, scene, visible, &picture.surface, stage)?;
            passes::shade::run(device, passes, scene, visible, picture, stage)?;
            Ok(start.elapsed())
        };
        // The first time compiles.
        once()?;
        Ok(once()?.min(once()?))
    };
    let stage = if time(Stage::Compute)? < time(Stage::Fragment)? { Stage::Compute } else { Stage::Fragment };
    Ok(*passes.fastest.get_or_init(|| stage))
}

fn limit_step(view: &View) -> &'static str {
    match view.pipeline {
        Pipeline::Exact | Pipeline::Limit | Pipeline::Points => "limit",
        Pipeline::Polygon => "polygon",
    }
}

/// Reads one tile into the image of the whole picture, a texture at a time.
pub(super) fn read_tile(
    device: &Device,
    scene: &Scene<'_>,
    visible: &Visible,
    surface: &SurfaceTargets,
    tile: &Tile,
    image: &mut SurfaceImage,
) -> Result<(), GpuError> {
    let tables = scene.tables;
    let (size, unit) = (image.size, tables.unit());
    let scale = scene.view.field.method.scale(unit);
    let ids: Vec<u32> = device.read_texture(&visible.patch)?;
    let patch: Vec<u32> = ids.iter().map(|id| id.wrapping_sub(1)).collect();
    let in_whole = |&patch: &u32| if patch == NO_PATCH { patch } else { tables.in_whole(patch) };
    paste(&mut image.patch, size, &patch.iter().map(in_whole).collect::<Vec<_>>(), tile.origin, tile.size);
    paste(&mut image.uv, size, &device.read_texture(&visible.uv)?, tile.origin, tile.size);
    let local: Vec<[f32; 4]> = device.read_texture(&surface.position)?;
    let world = |(p, &patch): (&[f32; 4], &u32)| match patch {
        NO_PATCH => DVec3::ZERO,
        patch => tables.origin(patch as usize) + Vec3::new(p[0], p[1], p[2]).as_dvec3() * unit,
    };
    let position: Vec<DVec3> = local.iter().zip(&patch).map(world).collect();
    paste(&mut image.position, size, &position, tile.origin, tile.size);
    let normal: Vec<[f32; 4]> = device.read_texture(&surface.normal)?;
    let normal: Vec<[f32; 3]> = normal.iter().map(|n| [n[0], n[1], n[2]]).collect();
    paste(&mut image.normal, size, &normal, tile.origin, tile.size);
    let field: Vec<[f32; 4]> = device.read_texture(&surface.field)?;
    let value = |f: &[f32; 4]| (f[2] > 0.0).then(|| DVec2::new(f64::from(f[0]), f64::from(f[1])) * scale);
    paste(&mut image.field, size, &field.iter().map(value).collect::<Vec<_>>(), tile.origin, tile.size);
    let certificate: Vec<Certificate> = match &visible.certificate {
        Some(texture) => device.read_texture(texture)?.into_iter().map(Certificate::from_bits).collect(),
        None => {
            let camera = &scene.view.camera;
            let at = |i: usize| [i as u32 % tile.size[0] + tile.origin[0], i as u32 / tile.size[0] + tile.origin[1]];
            let of = |i: usize| match patch[i] {
                NO_PATCH => Certificate::default(),
                _ => Certificate::of_proxy(camera, at(i), position[i]),
            };
            (0..patch.len()).into_par_iter().map(of).collect()
        }
    };
    paste(&mut image.certificate, size, &certificate, tile.origin, tile.size);
    Ok(())
}

/// Reads what of a tile is its own into the picture.
fn read_own<T: bytemuck::Pod>(
    device: &Device,
    texture: &wgpu::Texture,
    [tile, own]: [&Tile; 2],
    whole: &mut [T],
    size: [u32; 2],
) -> Result<(), GpuError> {
    let ([from, _], [to, [width, height]]) = (tile.pixels(), own.pixels());
    let [left, top] = [0, 1].map(|k| (to[k] - from[k]) as usize);
    let width = width as usize;
    device.read_rows(texture, size_of::<T>(), |rows| {
        for (y, row) in rows.skip(top).take(height as usize).enumerate() {
            let at = (to[1] as usize + y) * size[0] as usize + to[0] as usize;
            let part = &row[left * size_of::<T>()..(left + width) * size_of::<T>()];
            bytemuck::cast_slice_mut(&mut whole[at..at + width]).copy_from_slice(part);
        }
    })
}

/// Copies a rectangle into a picture.
fn paste<T: Copy>(picture: &mut [T], size: [u32; 2], part: &[T], origin: [u32; 2], part_size: [u32; 2]) {
    let width = part_size[0] as usize;
    for (row, source) in part.chunks_exact(width).enumerate() {
        let at = (origin[1] as usize + row) * size[0] as usize + origin[0] as usize;
        picture[at..at + width].copy_from_slice(source);
    }
}
