//! `shaders/resolve.wgsl`: the mean of each pixel's samples, over the background in sRGB or as it is.

use super::{Colour, Depth, Drawing, Passes, PictureTargets, Scene, bind, create, draw_fullscreen, whole};
use crate::gpu::device::Device;
use crate::gpu::view::Tile;
use crate::gpu::{GpuError, shader::RESOLVE};

pub fn pipeline<'a>(passes: &'a Passes, device: &Device, samples: u32, colour: Colour) -> &'a wgpu::RenderPipeline {
    let (pipelines, entry) = match colour {
        Colour::Display => (&passes.resolve, "resolve"),
        Colour::Linear => (&passes.resolve_linear, "resolve_linear"),
    };
    let drawing = Drawing {
        module: &RESOLVE,
        entries: ["fullscreen", entry],
        topology: wgpu::PrimitiveTopology::TriangleList,
        layout: None,
        formats: &[colour.format()],
        depth: Depth::None,
        constants: &[("SAMPLES", f64::from(samples))],
    };
    pipelines[samples as usize - 1].get_or_init(|| create(passes, device, &drawing))
}

pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    picture: &PictureTargets,
    tile: &Tile,
    colour: Colour,
) -> Result<(), GpuError> {
    let pipeline = pipeline(passes, device, tile.samples, colour);
    let samples = whole(&picture.samples);
    let record = device.buffer("the background", &[scene.view.resolve_record(tile)], wgpu::BufferUsages::UNIFORM)?;
    let resources = [(0, wgpu::BindingResource::TextureView(&samples)), (1, record.as_entire_binding())];
    // Linear colour has no background.
    let bound = if colour == Colour::Linear { 1 } else { 2 };
    let group = bind(device, pipeline.get_bind_group_layout(0), &resources[..bound]);
    draw_fullscreen(device, pipeline, &[group], &[&picture.colour], None)
}
