//! `shaders/shade.wgsl`: field and pattern into colour.

use super::{
    Depth, Drawing, Passes, PictureTargets, SAMPLE_FORMAT, Scene, Visible, bind, compute, create, dispatch,
    draw_fullscreen, whole,
};
use crate::field::{Method, Pattern, Picture};
use crate::gpu::device::Device;
use crate::gpu::{GpuError, Stage, View, shader::SHADE};
use wgpu::BindingResource::{Sampler, TextureView};

/// The picture on the light plane with all its mip levels, or one white texel.
pub struct PictureTexture {
    view: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl PictureTexture {
    pub fn new(device: &Device, view: &View) -> Result<Self, GpuError> {
        let white = Picture { size: [1, 1], rgba8: vec![255; 4] };
        let picture = match &view.pattern {
            Pattern::Picture(picture) => picture,
            _ => &white,
        };
        let limit = device.limits.max_texture_dimension_2d;
        if picture.size.iter().any(|&n| n > limit) {
            let [w, h] = picture.size;
            return Err(GpuError::View(format!("picture of {w}x{h}: this adapter takes at most {limit} a side")));
        }
        let levels = mip_levels(picture);
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("the picture"),
            size: extent(picture.size),
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (level, picture) in levels.iter().enumerate() {
            device.queue.write_texture(
                wgpu::TexelCopyTextureInfo { mip_level: level as u32, ..texture.as_image_copy() },
                &picture.rgba8,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(4 * picture.size[0]),
                    rows_per_image: None,
                },
                extent(picture.size),
            );
        }
        // Nothing is beyond the poles of a sphere.
        let ends = matches!(view.field.method, Method::Sphere(_));
        let edge = |half: f64, ends: bool| match half.is_finite() || ends {
            true => wgpu::AddressMode::ClampToEdge,
            false => wgpu::AddressMode::Repeat,
        };
        let sampler = device.device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: edge(view.light().half[0], false),
            address_mode_v: edge(view.light().half[1], ends),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        Ok(PictureTexture { view: whole(&texture), sampler })
    }
}

fn extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 }
}

/// The picture and its halves down to one texel, averaged in linear light.
fn mip_levels(picture: &Picture) -> Vec<Picture> {
    let mut levels = vec![picture.clone()];
    while levels[levels.len() - 1].size != [1, 1] {
        levels.push(levels[levels.len() - 1].halved());
    }
    levels
}

/// A view's pattern, and what its pipelines are told.
fn pattern(view: &View) -> (usize, [(&'static str, f64); 1]) {
    let kind = view.pattern_kind();
    (kind as usize, [("PATTERN", f64::from(kind))])
}

pub fn pipeline<'a>(passes: &'a Passes, device: &Device, view: &View) -> &'a wgpu::RenderPipeline {
    let (which, constants) = pattern(view);
    let drawing = Drawing {
        module: &SHADE,
        entries: ["fullscreen", "shade"],
        topology: wgpu::PrimitiveTopology::TriangleList,
        layout: None,
        formats: &[SAMPLE_FORMAT],
        depth: Depth::Mask,
        constants: &constants,
    };
    passes.shade[which].get_or_init(|| create(passes, device, &drawing))
}

pub fn compute_pipeline<'a>(passes: &'a Passes, device: &Device, view: &View) -> &'a wgpu::ComputePipeline {
    let (which, constants) = pattern(view);
    passes.shade_compute[which].get_or_init(|| compute(passes, device, &SHADE, "shade_compute", &constants))
}

pub fn run(
    device: &Device,
    passes: &Passes,
    scene: &Scene<'_>,
    visible: &Visible,
    picture: &PictureTargets,
    stage: Stage,
) -> Result<(), GpuError> {
    let record = scene.view.shade_record(scene.tables);
    let record = device.buffer("the colours", &[record], wgpu::BufferUsages::UNIFORM)?;
    let surface = whole(&picture.surface);
    let resources = [
        (0, TextureView(&surface)),
        (1, TextureView(&scene.picture.view)),
        (2, Sampler(&scene.picture.sampler)),
        (3, record.as_entire_binding()),
        (4, scene.light.as_entire_binding()),
    ];
    if stage == Stage::Compute {
        let pipeline = compute_pipeline(passes, device, scene.view);
        let out = whole(&picture.samples);
        let groups = [
            bind(device, pipeline.get_bind_group_layout(0), &resources),
            bind(device, pipeline.get_bind_group_layout(1), &[(0, TextureView(&out))]),
        ];
        return dispatch(device, pipeline, &groups, &picture.samples);
    }
    let pipeline = pipeline(passes, device, scene.view);
    let group = bind(device, pipeline.get_bind_group_layout(0), &resources);
    draw_fullscreen(device, pipeline, &[group], &[&picture.samples], Some(&visible.depth))
}
