//! `shaders/specks.wgsl` and `shaders/charts.wgsl`: the point that each sample sees first.

use super::{CERTIFICATE_FORMAT, DEPTH_FORMAT, PATCH_FORMAT, Passes, Scene, UV_FORMAT, Visible};
use super::{bind, cleared, target, whole};
use crate::gpu::GpuError;
use crate::gpu::charts::Charts;
use crate::gpu::device::Device;
use crate::gpu::records::{SightRecord, SpeckRecord};
use crate::gpu::shader::{CHARTS, SPECKS};
use crate::gpu::view::Tile;
use wgpu::BindingResource::TextureView;
use wgpu::{BufferUsages, TextureFormat};

const SPECK_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;

pub fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.charts.get_or_init(|| {
        let shader = passes.shader(device, &CHARTS);
        let formats = [PATCH_FORMAT, UV_FORMAT, CERTIFICATE_FORMAT].map(|format| Some(format.into()));
        device.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("charts"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("fullscreen"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("visible"),
                compilation_options: Default::default(),
                targets: &formats,
            }),
            multiview_mask: None,
            cache: None,
        })
    })
}

fn speck_pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::RenderPipeline {
    passes.specks.get_or_init(|| {
        let shader = passes.shader(device, &SPECKS);
        device.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("specks"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<SpeckRecord>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Uint32, 2 => Float32x2, 3 => Float32],
                })],
            },
            primitive: wgpu::PrimitiveState { topology: wgpu::PrimitiveTopology::PointList, ..Default::default() },
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("speck"),
                compilation_options: Default::default(),
                targets: &[Some(SPECK_FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    })
}

pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    charts: &Charts,
    visible: &Visible,
    tile: &Tile,
) -> Result<(), GpuError> {
    let Some(certificate) = &visible.certificate else { return Ok(()) };
    let pipeline = pipeline(passes, device);
    let specks = target(device, tile.size, SPECK_FORMAT);
    let points = device.buffer("the samples solved", &charts.specks, BufferUsages::VERTEX)?;
    let texels = device.table("the charts", &charts.texels, TextureFormat::Rgba32Uint)?;
    let list = device.table("the lists of charts", &charts.list, TextureFormat::R32Uint)?;
    let tiles = device.texture("the tiles", &charts.tiles, charts.grid, TextureFormat::Rg32Uint);
    let perspective = if scene.view.camera.is_perspective() { 1.0 } else { 0.0 };
    let sight = SightRecord { perspective, padding: [0.0; 3] };
    let sight = device.buffer("the kind of projection", &[sight], BufferUsages::UNIFORM)?;
    let views = [&texels, &tiles, &list, &specks].map(whole);
    let mut resources: Vec<_> = (0..).zip(&views).map(|(k, view)| (k, TextureView(view))).collect();
    resources.push((4, sight.as_entire_binding()));
    let group = bind(device, pipeline.get_bind_group_layout(0), &resources);

    let mut encoder = device.encoder();
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[cleared(&views[3])],
        ..Default::default()
    });
    if !charts.specks.is_empty() {
        pass.set_pipeline(speck_pipeline(passes, device));
        pass.set_vertex_buffer(0, points.slice(..));
        pass.draw(0..charts.specks.len() as u32, 0..1);
    }
    drop(pass);
    let targets = [&visible.patch, &visible.uv, certificate].map(whole);
    let attachments = targets.each_ref().map(cleared);
    let depth = whole(&visible.depth);
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &attachments,
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    device.submit(encoder)
}
