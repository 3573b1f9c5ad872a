//! `shaders/rectangle.wgsl`: the smallest rectangle that encloses the proxy's projection.

use super::fields::Compiles;
use super::{Passes, Scene, bind};
use crate::gpu::GpuError;
use crate::gpu::device::Device;
use crate::gpu::records::{ProxyVertex, SpanRecord};
use crate::gpu::shader::{RECTANGLE, WORKGROUP};
use crate::gpu::view::Tile;
use wgpu::BindingResource::TextureView;
use wgpu::BufferUsages;

/// Workgroups along one side of a dispatch, WebGPU's default limit.
const MAX_GROUPS: u32 = 65_535;

pub fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::ComputePipeline {
    passes.rectangle.get_or_init(|| {
        device.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("rectangle"),
            layout: None,
            module: &passes.shader(device, &RECTANGLE),
            entry_point: Some("enclose"),
            compilation_options: Default::default(),
            cache: None,
        })
    })
}

/// Least and greatest coordinates of the proxy's vertices in `tile`, in its samples and within it; the least are greater
/// than the greatest where there is no vertex.
pub fn run(device: &Device, passes: &Passes, scene: &Scene<'_>, tile: &Tile) -> Result<[[f32; 2]; 2], GpuError> {
    let pipeline = pipeline(passes, device);
    let frame = device.buffer("the frame", &[scene.view.frame_record(scene.tables, tile)], BufferUsages::UNIFORM)?;
    let nothing = [f32::MAX, f32::MAX, 0.0, 0.0];
    let result = device.buffer("the rectangle", &[nothing], BufferUsages::STORAGE | BufferUsages::COPY_SRC)?;
    let [records, points, scales, patch_views] = scene.table_views();
    let group = bind(
        device,
        pipeline.get_bind_group_layout(0),
        &[
            (0, TextureView(&records)),
            (1, TextureView(&points)),
            (2, TextureView(&scales)),
            (3, TextureView(&patch_views)),
            (4, frame.as_entire_binding()),
            (5, scene.proxy.order.as_entire_binding()),
        ],
    );
    let mut encoder = device.encoder();
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    let draws = &scene.proxy.draws;
    let total = (scene.proxy.vertices.size() / size_of::<ProxyVertex>() as u64) as u32;
    for (k, (draw, record)) in draws.iter().enumerate() {
        let first = draw.base_vertex as u32;
        let end = draws.get(k + 1).map_or(total, |(next, _)| next.base_vertex as u32);
        let rows = draw.groups.clamp(1, MAX_GROUPS);
        let span = SpanRecord { first, count: end - first, groups: draw.groups, rows };
        let span = device.buffer("the vertices of a draw", &[span], BufferUsages::UNIFORM)?;
        let resources = [
            (0, record.as_entire_binding()),
            (1, scene.proxy.vertices.as_entire_binding()),
            (2, span.as_entire_binding()),
            (3, result.as_entire_binding()),
        ];
        pass.set_bind_group(1, &bind(device, pipeline.get_bind_group_layout(1), &resources), &[]);
        pass.dispatch_workgroups((end - first).div_ceil(WORKGROUP), rows, draw.groups.div_ceil(rows));
    }
    drop(pass);
    device.submit(encoder)?;
    let found: Vec<[[f32; 2]; 2]> = device.read(&result)?;
    Ok(found[0])
}
