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
    let targets: [&wgpu::Texture; 3] = [&surface.position, &surface.normal, &surface.field];
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

/// The control values of a grid, rows from top to bottom.
pub fn grid(device: &Device, ([width, height], values): ([u32; 2], &[f64])) -> Result<wgpu::Texture, GpuError> {
    let limit = device.limits.max_texture_dimension_2d;
    if width > limit || height > limit {
        return Err(GpuError::View(format!("grid of {width}x{height}: this adapter takes at most {limit} a side")));
    }
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = device.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("the grid"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels: Vec<f32> = values.iter().map(|&value| value as f32).collect();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
    device.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, size);
    Ok(texture)
}

fn groups(
    device: &Device,
    layout: &dyn Fn(u32) -> wgpu::BindGroupLayout,
    scene: &Scene<'_>,
    visible: &Visible,
) -> [wgpu::BindGroup; 2] {
    let [records, points, scales, patch_views] = scene.table_views();
    let mut resources = vec![(3, TextureView(&patch_views)), (4, scene.light.as_entire_binding())];
    let grid = scene.grid.as_ref().map(whole);
    resources.extend(grid.iter().map(|grid| (5, TextureView(grid))));
    let patch = whole(&visible.patch);
    let inputs: Vec<_> = match &visible.proxy {
        Some(proxy) => proxy.iter().map(|target| whole(target)).collect(),
        None => {
            resources.extend([(0, TextureView(&records)), (1, TextureView(&points)), (2, TextureView(&scales))]);
            vec![whole(&visible.uv)]
        }
    };
    let textures: Vec<_> =
        [&patch].into_iter().chain(&inputs).enumerate().map(|(k, view)| (k as u32, TextureView(view))).collect();
    [bind(device, layout(0), &resources), bind(device, layout(1), &textures)]
}
