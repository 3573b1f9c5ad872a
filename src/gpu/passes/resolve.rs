//! `shaders/resolve.wgsl`: the mean of each pixel's samples, over the background in sRGB or as it is.

use super::{Colour, Passes, PictureTargets, Scene, bind, draw_fullscreen, fullscreen, whole};
use crate::gpu::device::Device;
use crate::gpu::view::Tile;
use crate::gpu::{GpuError, shader::RESOLVE};

pub fn pipeline<'a>(passes: &'a Passes, device: &Device, colour: Colour) -> &'a wgpu::RenderPipeline {
    let (pipeline, entry) = match colour {
        Colour::Display => (&passes.resolve, "resolve"),
        Colour::Linear => (&passes.resolve_linear, "resolve_linear"),
    };
    pipeline.get_or_init(|| fullscreen(passes, device, &RESOLVE, entry, &[colour.format()], false))
}

pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    picture: &PictureTargets,
    tile: &Tile,
    colour: Colour,
) -> Result<(), GpuError> {
    let pipeline = pipeline(passes, device, colour);
    let samples = whole(&picture.samples);
    let record = device.buffer("the background", &[scene.view.resolve_record(tile)], wgpu::BufferUsages::UNIFORM)?;
    let resources = [(0, wgpu::BindingResource::TextureView(&samples)), (1, record.as_entire_binding())];
    let group = bind(device, pipeline.get_bind_group_layout(0), &resources);
    draw_fullscreen(device, pipeline, &[group], &[&picture.colour], None)
}
