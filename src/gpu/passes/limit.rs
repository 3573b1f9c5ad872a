//! `shaders/limit.wgsl` and `shaders/polygon.wgsl`: position, normal and field of every pixel.

use super::{
    Band, CLEAR, Passes, SURFACE_FORMAT, Scene, Targets, attachment, bind, draw_fullscreen, fullscreen, whole,
};
use crate::gpu::device::Device;
use crate::gpu::shader::{LIMIT, POLYGON};
use crate::gpu::{GpuError, Pipeline};
use wgpu::BindingResource::TextureView;

pub fn pipeline<'a>(passes: &'a Passes, device: &Device, pipeline: Pipeline) -> &'a wgpu::RenderPipeline {
    let targets = [const {
        Some(wgpu::ColorTargetState { format: SURFACE_FORMAT, blend: None, write_mask: wgpu::ColorWrites::ALL })
    }; 3];
    match pipeline {
        Pipeline::Limit => passes.limit.get_or_init(|| fullscreen(device, &LIMIT, "limit", &targets)),
        Pipeline::Polygon => passes.polygon.get_or_init(|| fullscreen(device, &POLYGON, "polygon", &targets)),
    }
}

pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    targets: &Targets,
    band: &Band,
) -> Result<(), GpuError> {
    let pipeline = pipeline(passes, device, scene.view.pipeline);
    let [records, points, scales, patch_views] = scene.table_views();
    let mut resources = vec![
        (3, TextureView(&patch_views)),
        (4, scene.light.as_entire_binding()),
        (5, band.record.as_entire_binding()),
    ];
    let patch = whole(&targets.patch);
    let inputs: Vec<_> = match &targets.proxy {
        Some(proxy) => proxy.iter().map(whole).collect(),
        None => {
            resources.push((0, TextureView(&records)));
            resources.push((1, TextureView(&points)));
            resources.push((2, TextureView(&scales)));
            vec![whole(&targets.uv)]
        }
    };
    let textures: Vec<_> =
        [&patch].into_iter().chain(&inputs).enumerate().map(|(k, view)| (k as u32, TextureView(view))).collect();
    let groups = [
        bind(device, pipeline.get_bind_group_layout(0), &resources),
        bind(device, pipeline.get_bind_group_layout(1), &textures),
    ];
    let views = [&targets.position, &targets.normal, &targets.field].map(whole);
    let attachments: Vec<_> = views.iter().map(|view| attachment(view, CLEAR)).collect();
    draw_fullscreen(device, pipeline, &groups, &attachments, None)
}
