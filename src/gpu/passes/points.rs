//! `shaders/points.wgsl`: exact positions of the proxy's fragments, and the fragments drawn as points.

use super::{
    Colour, Depth, Drawing, Passes, PictureTargets, Scene, Visible, bind, draw_fullscreen, fullscreen, target, whole,
};
use super::{DEPTH_FORMAT, PACKED_FORMAT, PATCH_FORMAT, SAMPLE_FORMAT, SURFACE_FORMAT, UV_FORMAT};
use crate::gpu::device::Device;
use crate::gpu::pool::{Pool, Target};
use crate::gpu::view::Tile;
use crate::gpu::{GpuError, shader::POINTS};
use wgpu::BindingResource::TextureView;
use wgpu::BufferUsages;

pub fn position_pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.position.get_or_init(|| fullscreen(passes, device, &POINTS, "position", &[SURFACE_FORMAT], true))
}

pub fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.landed.get_or_init(|| create(passes, device, "landed", &[SAMPLE_FORMAT]))
}

fn pipeline_full<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.landed_full.get_or_init(|| create(passes, device, "landed_full", &[PATCH_FORMAT, UV_FORMAT]))
}

fn create(passes: &Passes, device: &Device, entry: &str, formats: &[wgpu::TextureFormat]) -> wgpu::RenderPipeline {
    let drawing = Drawing {
        module: &POINTS,
        entries: ["point", entry],
        topology: wgpu::PrimitiveTopology::PointList,
        layout: None,
        formats,
        depth: Depth::Nearest,
        constants: &[],
    };
    super::create(passes, device, &drawing)
}

/// Where the points land: the whole picture. Starts empty, as new textures are zero and so is the depth of nothing.
pub struct Landing {
    pub picture: PictureTargets,
    depth: Target,
}

impl Landing {
    pub fn new(device: &Device, tile: &Tile, colour: Colour) -> Landing {
        let pool = &Pool::default();
        let picture = PictureTargets {
            // Colours arrive finished.
            surface: target(device, pool, [1, 1], PACKED_FORMAT),
            samples: target(device, pool, tile.size, SAMPLE_FORMAT),
            colour: target(device, pool, tile.pixels()[1], colour.format()),
        };
        Landing { picture, depth: target(device, pool, tile.size, DEPTH_FORMAT) }
    }
}

/// The exact position of every fragment in `visible`, relative to the origin of its patch.
pub fn run_position(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    visible: &Visible,
) -> Result<Target, GpuError> {
    let pipeline = position_pipeline(passes, device);
    let [records, points, scales, _] = scene.table_views();
    let tables = [(0, TextureView(&records)), (1, TextureView(&points)), (2, TextureView(&scales))];
    let [patch, uv] = [&visible.patch, &visible.uv].map(|target| whole(target));
    let groups = [
        bind(device, pipeline.get_bind_group_layout(0), &tables),
        bind(device, pipeline.get_bind_group_layout(1), &[(1, TextureView(&patch)), (2, TextureView(&uv))]),
    ];
    let size = [visible.patch.width(), visible.patch.height()];
    let position = target(device, &device.pool, size, SURFACE_FORMAT);
    draw_fullscreen(device, pipeline, &groups, &[&position], Some(&visible.depth))?;
    Ok(position)
}

/// Fragments with their exact positions.
pub struct Cloud<'a> {
    pub visible: &'a Visible,
    pub position: &'a wgpu::Texture,
}

/// Draws the fragments in the colours of `texels`; `tile` is the whole picture.
pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    cloud: &Cloud<'_>,
    texels: &PictureTargets,
    landing: &Landing,
    tile: &Tile,
) -> Result<(), GpuError> {
    let targets: [&wgpu::Texture; 1] = [&landing.picture.samples];
    let transfer = Transfer { input: (4, &texels.samples), targets: &targets, depth: &landing.depth };
    draw(device, pipeline(passes, device), scene, cloud, &transfer, tile)
}

/// Writes the patch and (u,v) of what lands on each sample; `tile` is the whole picture.
pub fn run_full(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    cloud: &Cloud<'_>,
    landed: &Visible,
    tile: &Tile,
) -> Result<(), GpuError> {
    let targets: [&wgpu::Texture; 2] = [&landed.patch, &landed.uv];
    let transfer = Transfer { input: (2, &cloud.visible.uv), targets: &targets, depth: &landed.depth };
    draw(device, pipeline_full(passes, device), scene, cloud, &transfer, tile)
}

/// What a fragment of a point reads, by binding, and writes.
struct Transfer<'a> {
    input: (u32, &'a wgpu::Texture),
    targets: &'a [&'a wgpu::Texture],
    depth: &'a wgpu::Texture,
}

fn draw(
    device: &Device,
    pipeline: &wgpu::RenderPipeline,
    scene: &Scene<'_>,
    cloud: &Cloud<'_>,
    transfer: &Transfer<'_>,
    tile: &Tile,
) -> Result<(), GpuError> {
    let Transfer { input, targets, depth } = *transfer;
    let frame = device.buffer("the frame", &[scene.view.frame_record(scene.tables, tile)], BufferUsages::UNIFORM)?;
    let [.., patch_views] = scene.table_views();
    let inputs: [(u32, &wgpu::Texture); 3] = [(1, &cloud.visible.patch), (3, cloud.position), input];
    let inputs = inputs.map(|(binding, texture)| (binding, whole(texture)));
    let inputs = inputs.each_ref().map(|(binding, view)| (*binding, TextureView(view)));
    let groups = [
        bind(
            device,
            pipeline.get_bind_group_layout(0),
            &[(3, TextureView(&patch_views)), (4, frame.as_entire_binding())],
        ),
        bind(device, pipeline.get_bind_group_layout(1), &inputs),
    ];
    // Points of every part of the rectangle land on the same picture.
    let views: Vec<_> = targets.iter().map(|texture| whole(texture)).collect();
    let keep = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
    let attachments: Vec<_> = views
        .iter()
        .map(|view| Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops: keep }))
        .collect();
    let depth = whole(depth);
    let mut encoder = device.encoder();
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &attachments,
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    pass.draw(0..cloud.position.width() * cloud.position.height(), 0..1);
    drop(pass);
    device.submit(encoder)
}
