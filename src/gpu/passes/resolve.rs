//! `shaders/resolve.wgsl`: the sum of the samples into sRGB.

use super::{CLEAR, COLOUR_FORMAT, Passes, Targets, attachment, bind, draw_fullscreen, fullscreen, whole};
use crate::gpu::device::Device;
use crate::gpu::{GpuError, shader::RESOLVE};

pub fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.resolve.get_or_init(|| fullscreen(device, &RESOLVE, "resolve", &[Some(COLOUR_FORMAT.into())]))
}

pub fn run(device: &Device, passes: &Passes, targets: &Targets) -> Result<(), GpuError> {
    let pipeline = pipeline(passes, device);
    let sum = whole(&targets.sum);
    let group = bind(device, pipeline.get_bind_group_layout(0), &[(0, wgpu::BindingResource::TextureView(&sum))]);
    draw_fullscreen(device, pipeline, &[group], &[attachment(&whole(&targets.colour), CLEAR)])
}
