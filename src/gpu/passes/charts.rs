//! `shaders/charts.wgsl` and `shaders/specks.wgsl`: the point that each sample sees first.

use super::{CERTIFICATE_FORMAT, Depth, Drawing, PATCH_FORMAT, Passes, UV_FORMAT, Visible};
use super::{bind, cleared, whole};
use crate::gpu::GpuError;
use crate::gpu::charts::Charts;
use crate::gpu::device::Device;
use crate::gpu::records::SpeckRecord;
use crate::gpu::shader::{CHARTS, Module, SPECKS};
use wgpu::{BufferUsages, PrimitiveTopology, VertexBufferLayout, VertexStepMode};

/// Charts and what was solved on the host: two pipelines.
pub fn prepare(passes: &Passes, device: &Device) {
    rayon::join(|| chart_pipeline(passes, device), || speck_pipeline(passes, device));
}

fn chart_pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes
        .charts
        .get_or_init(|| create(passes, device, &CHARTS, ["corner", "visible"], PrimitiveTopology::TriangleList, None))
}

fn speck_pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.specks.get_or_init(|| {
        let layout = VertexBufferLayout {
            array_stride: size_of::<SpeckRecord>() as u64,
            step_mode: VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x2, 3 => Float32],
        };
        create(passes, device, &SPECKS, ["speck", "solved"], PrimitiveTopology::PointList, Some(layout))
    })
}

fn create(
    passes: &Passes,
    device: &Device,
    module: &Module,
    entries: [&str; 2],
    topology: PrimitiveTopology,
    layout: Option<VertexBufferLayout<'_>>,
) -> wgpu::RenderPipeline {
    let formats = &[PATCH_FORMAT, UV_FORMAT, CERTIFICATE_FORMAT];
    super::create(
        passes,
        device,
        &Drawing { module, entries, topology, layout, formats, depth: Depth::Nearest, constants: &[] },
    )
}

pub fn run(device: &Device, passes: &Passes, charts: &Charts, visible: &Visible) -> Result<(), GpuError> {
    let Some(certificate) = &visible.certificate else { return Ok(()) };
    let pipeline = chart_pipeline(passes, device);
    let lens = device.buffer("the lens", &[charts.lens], BufferUsages::UNIFORM)?;
    let texels: &[[u32; 4]] = bytemuck::cast_slice(&charts.charts);
    let table = whole(&device.table("the charts", texels, wgpu::TextureFormat::Rgba32Uint)?);
    let resources = [(0, lens.as_entire_binding()), (1, wgpu::BindingResource::TextureView(&table))];
    let group = bind(device, pipeline.get_bind_group_layout(0), &resources);
    let corners: Vec<u32> =
        (0..4 * charts.charts.len() as u32).step_by(4).flat_map(|k| [0, 1, 2, 2, 1, 3].map(|i| k + i)).collect();
    let indices = device.buffer("the corners of the charts", &corners, BufferUsages::INDEX)?;
    let points = device.buffer("the samples solved", &charts.specks, BufferUsages::VERTEX)?;
    let targets = [&visible.patch, &visible.uv, certificate].map(|target| whole(target));
    let mut attachments = targets.each_ref().map(cleared);
    let mut load_depth = wgpu::LoadOp::Clear(0.0);
    if charts.is_rest {
        attachments.iter_mut().flatten().for_each(|target| target.ops.load = wgpu::LoadOp::Load);
        load_depth = wgpu::LoadOp::Load;
    }
    let depth = whole(&visible.depth);
    let mut encoder = device.encoder();
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &attachments,
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth,
            depth_ops: Some(wgpu::Operations { load: load_depth, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    if !charts.specks.is_empty() {
        pass.set_pipeline(speck_pipeline(passes, device));
        pass.set_vertex_buffer(0, points.slice(..));
        pass.draw(0..charts.specks.len() as u32, 0..1);
    }
    if !charts.charts.is_empty() {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..corners.len() as u32, 0, 0..1);
    }
    drop(pass);
    device.submit(encoder)
}
