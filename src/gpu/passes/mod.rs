//! The passes: `NAME.rs` here runs `shaders/NAME.wgsl`.

pub mod evaluate;
pub mod limit;
pub mod resolve;
pub mod shade;
pub mod visibility;

use super::device::Device;
use super::proxy::Proxy;
use super::records::BandRecord;
use super::shader::Module;
use super::view::Tile;
use super::{GpuError, Pipeline, Tables, View};
use std::ops::Range;
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

/// What stays the same in all tiles of a picture.
pub(super) struct Scene<'a> {
    pub tables: &'a Tables,
    pub view: &'a View,
    pub patch_views: wgpu::Texture,
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
            patch_views: {
                let texels = view.patch_views(tables);
                device.table("the views of the patches", texels.as_flattened(), SURFACE_FORMAT)?
            },
            light: device.buffer("the light", &[view.light_record(tables)], BufferUsages::UNIFORM)?,
            proxy: visibility::ProxyBuffers::new(device, &proxy)?,
            picture: shade::PictureTexture::new(device, view)?,
        })
    }
}

impl Scene<'_> {
    /// Texture views of the tables and of the patch views, at bindings 0 to 3.
    fn table_views(&self) -> [wgpu::TextureView; 4] {
        let [records, points, scales] = self.tables.views();
        [records, points, scales, whole(&self.patch_views)]
    }
}

/// Rows of a tile whose surface exists at a time.
pub(super) struct Band {
    pub rows: Range<u32>,
    record: wgpu::Buffer,
}

impl Band {
    pub fn new(device: &Device, tile: &Tile, rows: Range<u32>) -> Result<Band, GpuError> {
        // One row more on each side, for the field's derivative.
        let record = BandRecord { first: rows.start as i32 - 1, rows: tile.size[1] as i32, padding: [0; 2] };
        Ok(Band { rows, record: device.buffer("the band", &[record], BufferUsages::UNIFORM)? })
    }
}

/// The textures between the passes, for one tile.
pub(super) struct Targets {
    /// Patch id + 1.
    pub patch: wgpu::Texture,
    pub uv: wgpu::Texture,
    pub depth: wgpu::Texture,
    /// Position and normal of the proxy, for the polygon pipeline.
    pub proxy: Option<[wgpu::Texture; 2]>,
    pub position: wgpu::Texture,
    pub normal: wgpu::Texture,
    pub field: wgpu::Texture,
    /// Shaded samples, linear.
    pub samples: wgpu::Texture,
    pub colour: wgpu::Texture,
}

const PATCH_FORMAT: TextureFormat = TextureFormat::R32Uint;
const UV_FORMAT: TextureFormat = TextureFormat::Rg32Float;
const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;
const SURFACE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;
const SAMPLE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
const COLOUR_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

impl Targets {
    pub fn new(device: &Device, tile: &Tile, pipeline: Pipeline) -> Targets {
        let texture = |size: [u32; 2], format| {
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
        let size = tile.size;
        let band = [size[0], tile.band_rows() + 2];
        Targets {
            patch: texture(size, PATCH_FORMAT),
            uv: texture(size, UV_FORMAT),
            depth: texture(size, DEPTH_FORMAT),
            proxy: (pipeline == Pipeline::Polygon).then(|| [SURFACE_FORMAT; 2].map(|format| texture(size, format))),
            position: texture(band, SURFACE_FORMAT),
            normal: texture(band, SURFACE_FORMAT),
            field: texture(band, SURFACE_FORMAT),
            samples: texture(size, SAMPLE_FORMAT),
            colour: texture(tile.pixels()[1], COLOUR_FORMAT),
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

/// Draws one triangle over the attachments, or the part of them that starts at scissor x, y, width w, height h.
fn draw_fullscreen(
    device: &Device,
    pipeline: &wgpu::RenderPipeline,
    groups: &[wgpu::BindGroup],
    attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    scissor: Option<[u32; 4]>,
) -> Result<(), GpuError> {
    let mut encoder = device.encoder();
    let mut pass =
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor { color_attachments: attachments, ..Default::default() });
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    if let Some([x, y, width, height]) = scissor {
        pass.set_scissor_rect(x, y, width, height);
    }
    pass.draw(0..3, 0..1);
    drop(pass);
    device.submit(encoder)
}
