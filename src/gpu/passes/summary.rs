//! `shaders/summary.wgsl`: what the certificates of a tile say together.

use super::{Passes, bind, compute, whole};
use crate::gpu::GpuError;
use crate::gpu::certificate::Summary;
use crate::gpu::device::Device;
use crate::gpu::records::OwnRecord;
use crate::gpu::shader::{SUMMARY, SUMMED, WORKGROUP};
use crate::gpu::view::Tile;
use wgpu::BufferUsages;

pub fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::ComputePipeline {
    passes.summary.get_or_init(|| compute(passes, device, &SUMMARY, "summarise", &[]))
}

/// Of the samples of `own`, which lies in `tile`. A tile has too few samples for sums of 32 bits to be exceeded.
pub fn run(
    device: &Device,
    passes: &Passes,
    certificates: &wgpu::Texture,
    tile: &Tile,
    own: &Tile,
) -> Result<Summary, GpuError> {
    let pipeline = pipeline(passes, device);
    let origin = [0, 1].map(|k| own.origin[k] - tile.origin[k]);
    let record = device.buffer("the tile", &[OwnRecord { origin, size: own.size }], BufferUsages::UNIFORM)?;
    let sums = device.buffer("the summary", &[[0u32; 5]], BufferUsages::STORAGE | BufferUsages::COPY_SRC)?;
    let view = whole(certificates);
    let resources = [
        (0, wgpu::BindingResource::TextureView(&view)),
        (1, record.as_entire_binding()),
        (2, sums.as_entire_binding()),
    ];
    let mut encoder = device.encoder();
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &bind(device, pipeline.get_bind_group_layout(0), &resources), &[]);
    pass.dispatch_workgroups(own.size[0].div_ceil(WORKGROUP), own.size[1].div_ceil(SUMMED), 1);
    drop(pass);
    device.submit(encoder)?;
    let [covered, solved, unconverged, steps, residual] = device.read::<[u32; 5]>(&sums)?[0];
    Ok(Summary {
        samples: u64::from(own.size[0]) * u64::from(own.size[1]),
        covered: covered.into(),
        solved: solved.into(),
        unconverged: unconverged.into(),
        steps: steps.into(),
        residual_max: f32::from_bits(residual),
    })
}
