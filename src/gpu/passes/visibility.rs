//! `shaders/visibility.wgsl`: which patch, at which (u,v), each pixel sees.

use super::{Depth, Drawing, PATCH_FORMAT, Passes, SURFACE_FORMAT, Scene, UV_FORMAT, Visible};
use super::{bind, cleared, whole};
use crate::gpu::device::Device;
use crate::gpu::proxy::{Draw, Proxy};
use crate::gpu::records::{DrawRecord, ProxyVertex};
use crate::gpu::view::Tile;
use crate::gpu::{GpuError, Pipeline, shader::VISIBILITY};
use wgpu::BindingResource::TextureView;
use wgpu::BufferUsages;

/// The proxy tessellation on the adapter.
pub struct ProxyBuffers {
    pub(super) vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    pub(super) order: wgpu::Buffer,
    pub(super) draws: Vec<(Draw, wgpu::Buffer)>,
}

impl ProxyBuffers {
    pub fn new(device: &Device, proxy: &Proxy) -> Result<Self, GpuError> {
        let record = |draw: &Draw| {
            let record = DrawRecord { first: draw.first, group_size: draw.group_size, padding: [0; 2] };
            device.buffer("a draw", &[record], BufferUsages::UNIFORM)
        };
        Ok(ProxyBuffers {
            vertices: device.buffer(
                "the vertices of the proxy",
                &proxy.vertices,
                BufferUsages::VERTEX | BufferUsages::STORAGE,
            )?,
            indices: device.buffer("the triangles of the proxy", &proxy.indices, BufferUsages::INDEX)?,
            order: device.buffer("the order of the patches", &proxy.order, BufferUsages::STORAGE)?,
            draws: proxy.draws.iter().map(|draw| Ok((draw.clone(), record(draw)?))).collect::<Result<_, GpuError>>()?,
        })
    }
}

pub fn pipeline<'a>(passes: &'a Passes, device: &Device, pipeline: Pipeline) -> &'a wgpu::RenderPipeline {
    match pipeline {
        Pipeline::Exact | Pipeline::Limit => {
            passes.visibility.get_or_init(|| create(passes, device, ["vertex", "visible"], &[PATCH_FORMAT, UV_FORMAT]))
        }
        Pipeline::Points => passes
            .visibility_plain
            .get_or_init(|| create(passes, device, ["vertex_plain", "visible"], &[PATCH_FORMAT, UV_FORMAT])),
        Pipeline::Polygon => passes.visibility_polygon.get_or_init(|| {
            create(passes, device, ["vertex", "polygon"], &[PATCH_FORMAT, UV_FORMAT, SURFACE_FORMAT, SURFACE_FORMAT])
        }),
    }
}

fn create(
    passes: &Passes,
    device: &Device,
    [vertex, fragment]: [&str; 2],
    formats: &[wgpu::TextureFormat],
) -> wgpu::RenderPipeline {
    let layout = wgpu::VertexBufferLayout {
        array_stride: size_of::<ProxyVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Uint32],
    };
    let drawing = Drawing {
        module: &VISIBILITY,
        entries: [vertex, fragment],
        topology: wgpu::PrimitiveTopology::TriangleList,
        layout: Some(layout),
        formats,
        depth: Depth::Nearest,
        constants: &[],
    };
    super::create(passes, device, &drawing)
}

pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    visible: &Visible,
    tile: &Tile,
) -> Result<(), GpuError> {
    let pipeline = pipeline(passes, device, scene.view.pipeline);
    let frame = scene.view.frame_record(scene.tables, tile);
    let frame = device.buffer("the frame", &[frame], BufferUsages::UNIFORM)?;
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
    let draw_groups: Vec<_> = scene
        .proxy
        .draws
        .iter()
        .map(|(_, record)| bind(device, pipeline.get_bind_group_layout(1), &[(0, record.as_entire_binding())]))
        .collect();
    let views: Vec<_> = [&visible.patch, &visible.uv]
        .into_iter()
        .chain(visible.proxy.iter().flatten())
        .map(|target| whole(target))
        .collect();
    let attachments: Vec<_> = views.iter().map(cleared).collect();
    let depth = whole(&visible.depth);
    let mut encoder = device.encoder();
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
    pass.set_vertex_buffer(0, scene.proxy.vertices.slice(..));
    pass.set_index_buffer(scene.proxy.indices.slice(..), wgpu::IndexFormat::Uint32);
    for ((draw, _), group) in scene.proxy.draws.iter().zip(&draw_groups) {
        pass.set_bind_group(1, group, &[]);
        pass.draw_indexed(draw.indices.clone(), draw.base_vertex, 0..draw.groups);
    }
    drop(pass);
    device.submit(encoder)
}
