//! `shaders/limit.wgsl` and `shaders/polygon.wgsl`: position, normal and field of every pixel.

use super::{PACKED_FORMAT, Passes, SURFACE_FORMAT, Scene, SurfaceTargets, Visible};
use super::{bind, draw_fullscreen, fullscreen, whole};
use crate::gpu::device::Device;
use crate::gpu::shader::{LIMIT, POLYGON};
use crate::gpu::{GpuError, Pipeline};
use wgpu::BindingResource::TextureView;

pub fn pipeline<'a>(passes: &'a Passes, device: &Device, pipeline: Pipeline) -> &'a wgpu::RenderPipeline {
    let formats = [PACKED_FORMAT];
    match pipeline {
        Pipeline::Exact | Pipeline::Limit | Pipeline::Points => {
            passes.limit.get_or_init(|| fullscreen(passes, device, &LIMIT, "limit", &formats, true))
        }
        Pipeline::Polygon => {
            passes.polygon.get_or_init(|| fullscreen(passes, device, &POLYGON, "polygon", &formats, true))
        }
    }
}

fn pipeline_full<'a>(passes: &'a Passes, device: &Device, pipeline: Pipeline) -> &'a wgpu::RenderPipeline {
    let create = |module, entry| fullscreen(passes, device, module, entry, &[SURFACE_FORMAT; 3], true);
    match pipeline {
        Pipeline::Exact | Pipeline::Limit | Pipeline::Points => {
            passes.limit_full.get_or_init(|| create(&LIMIT, "limit_full"))
        }
        Pipeline::Polygon => passes.polygon_full.get_or_init(|| create(&POLYGON, "polygon_full")),
    }
}

/// Writes what shading needs, packed.
pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    visible: &Visible,
    surface: &wgpu::Texture,
) -> Result<(), GpuError> {
    draw(device, pipeline(passes, device, scene.view.pipeline), scene, visible, &[surface])
}

/// Writes everything in f32.
pub fn run_full(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    visible: &Visible,
    surface: &SurfaceTargets,
) -> Result<(), GpuError> {
    let targets = [&surface.position, &surface.normal, &surface.field];
    draw(device, pipeline_full(passes, device, scene.view.pipeline), scene, visible, &targets)
}

fn draw(
    device: &Device,
    pipeline: &wgpu::RenderPipeline,
    scene: &Scene<'_>,
    visible: &Visible,
    targets: &[&wgpu::Texture],
) -> Result<(), GpuError> {
    let [records, points, scales, patch_views] = scene.table_views();
    let mut resources = vec![(3, TextureView(&patch_views)), (4, scene.light.as_entire_binding())];
    let patch = whole(&visible.patch);
    let inputs: Vec<_> = match &visible.proxy {
        Some(proxy) => proxy.iter().map(whole).collect(),
        None => {
            resources.extend([(0, TextureView(&records)), (1, TextureView(&points)), (2, TextureView(&scales))]);
            vec![whole(&visible.uv)]
        }
    };
    let textures: Vec<_> =
        [&patch].into_iter().chain(&inputs).enumerate().map(|(k, view)| (k as u32, TextureView(view))).collect();
    let groups = [
        bind(device, pipeline.get_bind_group_layout(0), &resources),
        bind(device, pipeline.get_bind_group_layout(1), &textures),
    ];
    draw_fullscreen(device, pipeline, &groups, targets, Some(&visible.depth))
}
