//! The passes: `NAME.rs` here runs `shaders/NAME.wgsl`.

pub mod evaluate;
pub mod limit;
pub mod resolve;
pub mod shade;
pub mod visibility;

use super::device::Device;
use super::proxy::Proxy;
use super::shader::Module;
use super::{GpuError, Pipeline, Tables, View};
use std::sync::OnceLock;
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

/// The compiled pipelines, each made when it is first needed: on a software adapter compiling takes longer than drawing.
#[derive(Debug, Default)]
pub struct Passes {
    visibility: OnceLock<wgpu::RenderPipeline>,
    visibility_polygon: OnceLock<wgpu::RenderPipeline>,
    limit: OnceLock<wgpu::RenderPipeline>,
    polygon: OnceLock<wgpu::RenderPipeline>,
    shade: OnceLock<wgpu::RenderPipeline>,
    resolve: OnceLock<wgpu::RenderPipeline>,
    evaluate: OnceLock<wgpu::ComputePipeline>,
}

impl Passes {
    /// Compiles what a picture needs, in parallel.
    pub(super) fn prepare(&self, device: &Device, pipeline: Pipeline) {
        rayon::join(
            || visibility::pipeline(self, device, pipeline),
            || {
                limit::pipeline(self, device, pipeline);
                shade::pipeline(self, device);
                resolve::pipeline(self, device);
            },
        );
    }
}

/// What stays the same in all windows of a picture.
pub(super) struct Scene<'a> {
    pub tables: &'a Tables,
    pub view: &'a View,
    pub patch_views: wgpu::Buffer,
    pub light: wgpu::Buffer,
    pub proxy: visibility::ProxyBuffers,
    pub picture: shade::PictureTexture,
}

impl<'a> Scene<'a> {
    pub fn new(device: &Device, tables: &'a Tables, view: &'a View) -> Result<Self, GpuError> {
        let proxy = Proxy::new(&tables.cells, view.proxy_level);
        Ok(Scene {
            tables,
            view,
            patch_views: device.buffer("the views of the patches", &view.patch_views(tables), BufferUsages::STORAGE)?,
            light: device.buffer("the light", &[view.light_record(tables)], BufferUsages::UNIFORM)?,
            proxy: visibility::ProxyBuffers::new(device, &proxy)?,
            picture: shade::PictureTexture::new(device, view)?,
        })
    }
}

/// The textures between the passes.
pub(super) struct Targets {
    pub size: [u32; 2],
    /// Patch id + 1.
    pub patch: wgpu::Texture,
    pub uv: wgpu::Texture,
    pub depth: wgpu::Texture,
    /// Position and normal of the proxy, for the polygon pipeline.
    pub proxy: Option<[wgpu::Texture; 2]>,
    pub position: wgpu::Texture,
    pub normal: wgpu::Texture,
    pub field: wgpu::Texture,
    /// Sum of the samples, linear.
    pub sum: wgpu::Texture,
    pub colour: wgpu::Texture,
}

const PATCH_FORMAT: TextureFormat = TextureFormat::R32Uint;
const UV_FORMAT: TextureFormat = TextureFormat::Rg32Float;
const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;
const SURFACE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;
const SUM_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
const COLOUR_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

impl Targets {
    pub fn new(device: &Device, size: [u32; 2], pipeline: Pipeline) -> Targets {
        let texture = |format| {
            device.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        Targets {
            size,
            patch: texture(PATCH_FORMAT),
            uv: texture(UV_FORMAT),
            depth: texture(DEPTH_FORMAT),
            proxy: (pipeline == Pipeline::Polygon).then(|| [texture(SURFACE_FORMAT), texture(SURFACE_FORMAT)]),
            position: texture(SURFACE_FORMAT),
            normal: texture(SURFACE_FORMAT),
            field: texture(SURFACE_FORMAT),
            sum: texture(SUM_FORMAT),
            colour: texture(COLOUR_FORMAT),
        }
    }
}

fn shader(device: &Device, module: &Module) -> wgpu::ShaderModule {
    device.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(module.name),
        source: wgpu::ShaderSource::Wgsl(module.source().into()),
    })
}

/// A pipeline that draws one triangle over the target.
fn fullscreen(
    device: &Device,
    module: &Module,
    entry: &str,
    targets: &[Option<wgpu::ColorTargetState>],
) -> wgpu::RenderPipeline {
    let shader = shader(device, module);
    device.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(module.name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("fullscreen"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A bind group of numbered resources.
fn bind(
    device: &Device,
    layout: wgpu::BindGroupLayout,
    resources: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    device.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries })
}

fn whole(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

fn attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    })
}

const CLEAR: wgpu::LoadOp<wgpu::Color> = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);

/// Draws one triangle over the attachments.
fn draw_fullscreen(
    device: &Device,
    pipeline: &wgpu::RenderPipeline,
    groups: &[wgpu::BindGroup],
    attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
) -> Result<(), GpuError> {
    let mut encoder = device.encoder();
    let mut pass =
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor { color_attachments: attachments, ..Default::default() });
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    pass.draw(0..3, 0..1);
    drop(pass);
    device.submit(encoder)
}
