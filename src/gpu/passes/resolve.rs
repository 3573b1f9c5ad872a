//! `shaders/resolve.wgsl`: the mean of each pixel's samples, in sRGB.

use super::{CLEAR, COLOUR_FORMAT, Passes, Targets, attachment, bind, draw_fullscreen, fullscreen, whole};
use crate::gpu::device::Device;
use crate::gpu::records::ResolveRecord;
use crate::gpu::view::Tile;
use crate::gpu::{GpuError, shader::RESOLVE};

pub fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.resolve.get_or_init(|| fullscreen(device, &RESOLVE, "resolve", &[Some(COLOUR_FORMAT.into())]))
}

pub fn run(device: &Device, passes: &Passes, targets: &Targets, tile: &Tile) -> Result<(), GpuError> {
    let pipeline = pipeline(passes, device);
    let samples = whole(&targets.samples);
    let record = ResolveRecord { samples: tile.samples as i32 };
    let record = device.buffer("the sample count", &[record], wgpu::BufferUsages::UNIFORM)?;
    let group = bind(
        device,
        pipeline.get_bind_group_layout(0),
        &[(0, wgpu::BindingResource::TextureView(&samples)), (1, record.as_entire_binding())],
    );
    draw_fullscreen(device, pipeline, &[group], &[attachment(&whole(&targets.colour), CLEAR)], None)
}
