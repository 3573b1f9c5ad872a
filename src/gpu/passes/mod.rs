//! The passes: `NAME.rs` here runs `shaders/NAME.wgsl`.

pub mod charts;
pub mod evaluate;
mod fields;
pub mod limit;
pub mod points;
pub mod rectangle;
pub mod resolve;
pub mod shade;
pub mod summary;
pub mod visibility;

use super::device::Device;
use super::pool::{Pool, Target};
use super::proxy::Proxy;
use super::shader::{Content, Module, PATTERNS, TILE_SIDE};
use super::view::{MAX_SAMPLES, Tile};
use super::{GpuError, Pipeline, Stage, Tables, View};
use crate::field::{Field, Grid};
use fields::{Compiles, FieldPasses};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use wgpu::{BufferUsages, PrimitiveTopology, TextureFormat, TextureUsages};

/// The compiled pipelines, each made when it is first needed: on a software adapter compiling takes longer than drawing.
#[derive(Debug, Default)]
pub struct Passes {
    /// What the tables that they read hold.
    content: Content,
    /// What [`Stage::Auto`] found out.
    pub fastest: OnceLock<Stage>,
    specks: OnceLock<wgpu::RenderPipeline>,
    charts: OnceLock<wgpu::RenderPipeline>,
    visibility: OnceLock<wgpu::RenderPipeline>,
    visibility_polygon: OnceLock<wgpu::RenderPipeline>,
    visibility_plain: OnceLock<wgpu::RenderPipeline>,
    rectangle: OnceLock<wgpu::ComputePipeline>,
    position: OnceLock<wgpu::RenderPipeline>,
    landed: OnceLock<wgpu::RenderPipeline>,
    landed_full: OnceLock<wgpu::RenderPipeline>,
    /// By the source of the field.
    fields: Mutex<HashMap<String, Arc<FieldPasses>>>,
    /// By pattern.
    shade: [OnceLock<wgpu::RenderPipeline>; PATTERNS],
    /// By samples a pixel each way, less one.
    resolve: [OnceLock<wgpu::RenderPipeline>; MAX_SAMPLES as usize],
    resolve_linear: [OnceLock<wgpu::RenderPipeline>; MAX_SAMPLES as usize],
    summary: OnceLock<wgpu::ComputePipeline>,
    evaluate: OnceLock<wgpu::ComputePipeline>,
    shade_compute: [OnceLock<wgpu::ComputePipeline>; PATTERNS],
}

impl Passes {
    pub(super) fn new(content: Content) -> Passes {
        Passes { content, ..Passes::default() }
    }

    /// The pipelines that read this field.
    pub(super) fn field(&self, field: &Field) -> Arc<FieldPasses> {
        let source = field.method.wgsl();
        let mut fields = self.fields.lock().unwrap_or_else(PoisonError::into_inner);
        let new = |source: &String| Arc::new(FieldPasses::new(self.content, source.clone()));
        fields.entry(source).or_insert_with_key(new).clone()
    }

    /// Compiles what a picture needs, in parallel.
    pub(super) fn prepare(&self, device: &Device, view: &View, colour: Colour) {
        let pipeline = view.pipeline;
        rayon::join(
            || match pipeline {
                Pipeline::Exact => {
                    charts::prepare(self, device);
                    summary::pipeline(self, device);
                }
                _ => drop(visibility::pipeline(self, device, pipeline)),
            },
            || {
                limit::pipeline(&self.field(&view.field), device, pipeline);
                shade::pipeline(self, device, view);
                resolve::pipeline(self, device, view.samples, colour);
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
    /// Control values of light curves.
    pub grid: Option<wgpu::Texture>,
}

impl<'a> Scene<'a> {
    pub fn new(device: &Device, tables: &'a Tables, view: &'a View) -> Result<Self, GpuError> {
        let proxy = match view.pipeline {
            Pipeline::Exact => Proxy::default(),
            _ => Proxy::new(&tables.cells, view.proxy_level_for(tables)),
        };
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
            grid: view.field.method.grid().and_then(Grid::net).map(|net| limit::grid(device, net)).transpose()?,
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

/// What the visibility pass writes.
pub(super) struct Visible {
    /// Patch id + 1.
    pub patch: Target,
    pub uv: Target,
    /// Above 0 where there is surface: the mask of the passes that follow.
    pub depth: Target,
    /// How the exact pipeline came to each point.
    pub certificate: Option<Target>,
    /// Position and normal of the proxy, for the polygon pipeline.
    proxy: Option<[Target; 2]>,
}

/// What the limit pass writes when all of it is read back.
pub(super) struct SurfaceTargets {
    pub position: Target,
    pub normal: Target,
    pub field: Target,
}

/// What the passes of a picture write.
pub(super) struct PictureTargets {
    /// Field value, normal and angles, packed.
    pub surface: Target,
    /// Shaded samples, linear, with coverage in alpha.
    samples: Target,
    pub colour: Target,
}

const PATCH_FORMAT: TextureFormat = TextureFormat::R32Uint;
const CERTIFICATE_FORMAT: TextureFormat = TextureFormat::R32Uint;
const UV_FORMAT: TextureFormat = TextureFormat::Rg32Float;
const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;
const SURFACE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;
const PACKED_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;
const SAMPLE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// What a picture's colour is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Colour {
    /// To be looked at: 8-bit sRGB over the background.
    Display,
    /// To be worked with: linear f32, premultiplied.
    Linear,
}

impl Colour {
    fn format(self) -> TextureFormat {
        match self {
            Colour::Display => TextureFormat::Rgba8Unorm,
            Colour::Linear => TextureFormat::Rgba32Float,
        }
    }
}

fn target(device: &Device, pool: &Pool, size: [u32; 2], format: TextureFormat) -> Target {
    // What compute stages write.
    let storage = match format {
        PACKED_FORMAT | SAMPLE_FORMAT => TextureUsages::STORAGE_BINDING,
        // What is renumbered.
        PATCH_FORMAT => TextureUsages::COPY_DST,
        _ => TextureUsages::empty(),
    };
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC | storage,
        view_formats: &[],
    };
    pool.take(&device.device, &descriptor)
}

impl Visible {
    pub fn new(device: &Device, pool: &Pool, tile: &Tile, pipeline: Pipeline) -> Visible {
        let texture = |format| target(device, pool, tile.size, format);
        Visible {
            patch: texture(PATCH_FORMAT),
            uv: texture(UV_FORMAT),
            depth: texture(DEPTH_FORMAT),
            certificate: (pipeline == Pipeline::Exact).then(|| texture(CERTIFICATE_FORMAT)),
            proxy: (pipeline == Pipeline::Polygon).then(|| [SURFACE_FORMAT; 2].map(texture)),
        }
    }
}

impl Visible {
    /// Replaces the patch ids, row by row.
    pub fn renumber(&mut self, device: &Device, ids: &[u32]) {
        let size = self.patch.size();
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size.width), rows_per_image: None };
        device.queue.write_texture(self.patch.as_image_copy(), bytemuck::cast_slice(ids), layout, size);
    }
}

impl SurfaceTargets {
    pub fn new(device: &Device, tile: &Tile) -> SurfaceTargets {
        let texture = || target(device, &device.pool, tile.size, SURFACE_FORMAT);
        SurfaceTargets { position: texture(), normal: texture(), field: texture() }
    }
}

impl PictureTargets {
    pub fn new(device: &Device, pool: &Pool, tile: &Tile, colour: Colour) -> PictureTargets {
        PictureTargets {
            surface: target(device, pool, tile.size, PACKED_FORMAT),
            samples: target(device, pool, tile.size, SAMPLE_FORMAT),
            colour: target(device, pool, tile.pixels()[1], colour.format()),
        }
    }
}

/// A pipeline that draws one triangle over the targets; `masked`: where the depth buffer of [`Visible`] has surface. (A
/// branch on coverage in the shader would save nothing on software adapters: they compute both sides.)
fn fullscreen(
    passes: &impl Compiles,
    device: &Device,
    module: &Module,
    entry: &str,
    formats: &[TextureFormat],
    masked: bool,
) -> wgpu::RenderPipeline {
    create(
        passes,
        device,
        &Drawing {
            module,
            entries: ["fullscreen", entry],
            topology: PrimitiveTopology::TriangleList,
            layout: None,
            formats,
            depth: if masked { Depth::Mask } else { Depth::None },
            constants: &[],
        },
    )
}

/// What a render pipeline does with the depth buffer.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Depth {
    /// There is none.
    None,
    /// It keeps the nearest. Reversed depth: the greater is the nearer.
    Nearest,
    /// It says where there is surface: a triangle at depth 0, the value of the background, is drawn where it is greater.
    Mask,
}

/// What a render pipeline draws, and into what. Both sides are seen: open panels have an inside.
struct Drawing<'a> {
    module: &'a Module,
    /// Vertex and fragment.
    entries: [&'a str; 2],
    topology: PrimitiveTopology,
    layout: Option<wgpu::VertexBufferLayout<'a>>,
    formats: &'a [TextureFormat],
    depth: Depth,
    constants: Constants<'a>,
}

/// Values of a shader's `override` constants.
type Constants<'a> = &'a [(&'a str, f64)];

fn options(constants: Constants<'_>) -> wgpu::PipelineCompilationOptions<'_> {
    wgpu::PipelineCompilationOptions { constants, ..Default::default() }
}

fn create(passes: &impl Compiles, device: &Device, drawing: &Drawing<'_>) -> wgpu::RenderPipeline {
    let Drawing { module, entries: [vertex, fragment], topology, ref layout, formats, depth, constants } = *drawing;
    let shader = passes.shader(device, module);
    let targets: Vec<_> = formats.iter().map(|&format| Some(format.into())).collect();
    let depth_state = |write, compare| wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: Default::default(),
        bias: Default::default(),
    };
    device.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(module.name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: layout.clone().map(Some).as_slice(),
        },
        primitive: wgpu::PrimitiveState { topology, ..Default::default() },
        depth_stencil: match depth {
            Depth::None => None,
            Depth::Nearest => Some(depth_state(true, wgpu::CompareFunction::Greater)),
            Depth::Mask => Some(depth_state(false, wgpu::CompareFunction::Less)),
        },
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some(fragment),
            compilation_options: options(constants),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A compute pipeline.
fn compute(
    passes: &impl Compiles,
    device: &Device,
    module: &Module,
    entry: &str,
    constants: Constants<'_>,
) -> wgpu::ComputePipeline {
    device.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: None,
        module: &passes.shader(device, module),
        entry_point: Some(entry),
        compilation_options: options(constants),
        cache: None,
    })
}

/// Runs a compute pass over all texels of `target`.
fn dispatch(
    device: &Device,
    pipeline: &wgpu::ComputePipeline,
    groups: &[wgpu::BindGroup],
    target: &wgpu::Texture,
) -> Result<(), GpuError> {
    let mut encoder = device.encoder();
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    pass.dispatch_workgroups(target.width().div_ceil(TILE_SIDE), target.height().div_ceil(TILE_SIDE), 1);
    drop(pass);
    device.submit(encoder)
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

/// A colour attachment that starts as zeros.
fn cleared(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let load = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    })
}

/// Draws one triangle over the targets, cleared to zero; `mask`: where this depth buffer has surface.
fn draw_fullscreen(
    device: &Device,
    pipeline: &wgpu::RenderPipeline,
    groups: &[wgpu::BindGroup],
    targets: &[&wgpu::Texture],
    mask: Option<&wgpu::Texture>,
) -> Result<(), GpuError> {
    let views: Vec<_> = targets.iter().map(|texture| whole(texture)).collect();
    let attachments: Vec<_> = views.iter().map(cleared).collect();
    let mask = mask.map(whole);
    let mut encoder = device.encoder();
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &attachments,
        // Without operations the depth buffer is read-only.
        depth_stencil_attachment: mask.as_ref().map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: None,
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    pass.draw(0..3, 0..1);
    drop(pass);
    device.submit(encoder)
}
