//! `shaders/resolve.wgsl`: the mean of each pixel's samples over the background, in sRGB.

use super::{COLOUR_FORMAT, Passes, PictureTargets, Scene, bind, draw_fullscreen, fullscreen, whole};
use crate::gpu::device::Device;
use crate::gpu::view::Tile;
use crate::gpu::{GpuError, shader::RESOLVE};

pub fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.resolve.get_or_init(|| fullscreen(passes, device, &RESOLVE, "resolve", &[COLOUR_FORMAT], false))
}

pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    picture: &PictureTargets,
    tile: &Tile,
) -> Result<(), GpuError> {
    let pipeline = pipeline(passes, device);
    let samples = whole(&picture.samples);
    let record = device.buffer("the background", &[scene.view.resolve_record(tile)], wgpu::BufferUsages::UNIFORM)?;
    let resources = [(0, wgpu::BindingResource::TextureView(&samples)), (1, record.as_entire_binding())];
    let group = bind(device, pipeline.get_bind_group_layout(0), &resources);
    draw_fullscreen(device, pipeline, &[group], &[&picture.colour], None)
}
