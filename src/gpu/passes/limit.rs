//! `shaders/limit.wgsl` and `shaders/polygon.wgsl`: position, normal and field of every pixel.

use super::{FieldPasses, PACKED_FORMAT, Passes, SURFACE_FORMAT, Scene, SurfaceTargets, Visible};
use super::{bind, compute, dispatch, draw_fullscreen, fullscreen, whole};
use crate::gpu::device::Device;
use crate::gpu::shader::{LIMIT, POLYGON};
use crate::gpu::{GpuError, Pipeline, Stage};
use wgpu::BindingResource::TextureView;

pub fn pipeline<'a>(passes: &'a FieldPasses, device: &Device, pipeline: Pipeline) -> &'a wgpu::RenderPipeline {
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

fn pipeline_full<'a>(passes: &'a FieldPasses, device: &Device, pipeline: Pipeline) -> &'a wgpu::RenderPipeline {
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
    stage: Stage,
) -> Result<(), GpuError> {
    let passes = &*passes.field(&scene.view.field);
    if stage == Stage::Compute && visible.proxy.is_none() {
        let pipeline = compute_pipeline(passes, device);
        let mut groups = groups(device, &|group| pipeline.get_bind_group_layout(group), scene, visible).to_vec();
        let out = whole(surface);
        groups.push(bind(device, pipeline.get_bind_group_layout(2), &[(0, TextureView(&out))]));
        return dispatch(device, pipeline, &groups, surface);
    }
    draw(device, pipeline(passes, device, scene.view.pipeline), scene, visible, &[surface])
}

fn compute_pipeline<'a>(passes: &'a FieldPasses, device: &Device) -> &'a wgpu::ComputePipeline {
    passes.limit_compute.get_or_init(|| compute(passes, device, &LIMIT, "limit_compute", &[]))
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
    let passes = &*passes.field(&scene.view.field);
    draw(device, pipeline_full(passes, device, scene.view.pipeline), scene, visible, &targets)
}

fn draw(
    device: &Device,
    pipeline: &wgpu::RenderPipeline,
    scene: &Scene<'_>,
    visible: &Visible,
    targets: &[&wgpu::Texture],
) -> Result<(), GpuError> {
    let groups = groups(device, &|group| pipeline.get_bind_group_layout(group), scene, visible);
    draw_fullscreen(device, pipeline, &groups, targets, Some(&visible.depth))
}

fn groups(
    device: &Device,
    layout: &dyn Fn(u32) -> wgpu::BindGroupLayout,
    scene: &Scene<'_>,
    visible: &Visible,
) -> [wgpu::BindGroup; 2] {
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
    [bind(device, layout(0), &resources), bind(device, layout(1), &textures)]
}
