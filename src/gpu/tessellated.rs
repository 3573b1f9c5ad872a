//! `shaders/tessellated.wgsl`: a tessellation drawn with interpolated normals, which is what frames are measured against.

use super::device::Device;
use super::{Gpu, GpuError, View};
use glam::{DMat3, DMat4, DVec3, Vec4};
use wgpu::util::DeviceExt;

/// Corner of a tessellation: position, world units, and unit normal.
pub type Corner = [[f32; 3]; 2];

/// Triangles on an adapter, with all that draws them.
#[derive(Debug)]
pub struct Tessellated {
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
    pipeline: wgpu::RenderPipeline,
    scene: wgpu::BindGroup,
    picture: wgpu::Texture,
    depth: wgpu::Texture,
}

const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

impl Tessellated {
    /// Bytes of corners and indices.
    pub fn bytes(&self) -> u64 {
        self.corners.size() + self.indices.size()
    }
}

impl Gpu {
    /// Puts triangles on the adapter, to be drawn as `view` says: its camera, its size, reflection lines of its light.
    ///
    /// # Errors
    /// The adapter has no room for them.
    ///
    /// # Panics
    /// There are more indices than 32 bits count.
    pub fn tessellate(&self, corners: &[Corner], indices: &[u32], view: &View) -> Result<Tessellated, GpuError> {
        let Device { device, .. } = &self.device;
        let count = u32::try_from(indices.len()).expect("32 bits count the indices");
        let buffer = |what, contents: &[u8], usage| {
            let (size, limit) = (contents.len() as u64, self.device.limits.max_buffer_size);
            if size > limit {
                return Err(GpuError::TooLarge { what, size, limit });
            }
            let label = Some(what);
            Ok(device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage }))
        };
        let corners = buffer("corners", bytemuck::cast_slice(corners), wgpu::BufferUsages::VERTEX)?;
        let indices = buffer("triangles", bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX)?;
        let shader = device.create_shader_module(wgpu::include_wgsl!("../../shaders/tessellated.wgsl"));
        let vertex = wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("tessellated"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[Some(vertex)],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("stripes"),
                compilation_options: Default::default(),
                targets: &[Some(PICTURE.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let uniform = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("scene"),
            contents: bytemuck::cast_slice(&scene(view)),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let scene = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let [width, height] = view.camera.size;
        let target = |format| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("tessellated"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let (picture, depth) = (target(PICTURE), target(DEPTH));
        self.device.check()?;
        Ok(Tessellated { corners, indices, count, pipeline, scene, picture, depth })
    }

    /// Draws the triangles, and waits for the adapter. The picture stays there.
    ///
    /// # Errors
    /// The adapter fails.
    pub fn draw_tessellated(&self, triangles: &Tessellated) -> Result<(), GpuError> {
        let mut encoder = self.device.encoder();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tessellated"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &triangles.picture.create_view(&Default::default()),
                resolve_target: None,
                depth_slice: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &triangles.depth.create_view(&Default::default()),
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&triangles.pipeline);
        pass.set_bind_group(0, &triangles.scene, &[]);
        pass.set_vertex_buffer(0, triangles.corners.slice(..));
        pass.set_index_buffer(triangles.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..triangles.count, 0, 0..1);
        drop(pass);
        self.device.submit(encoder)
    }

    /// The picture that was drawn last: RGBA, rows from top to bottom.
    ///
    /// # Errors
    /// The adapter fails.
    pub fn read_tessellated(&self, triangles: &Tessellated) -> Result<Vec<[u8; 4]>, GpuError> {
        self.device.read_texture(&triangles.picture)
    }
}

/// The uniform of the shader.
fn scene(view: &View) -> [[f32; 4]; 8] {
    let (camera, light) = (&view.camera, view.light());
    let axes = camera.axes();
    let turn = DMat3::from_cols(axes.right, axes.up, -axes.forward).transpose();
    let look = DMat4::from_mat3(turn) * DMat4::from_translation(-camera.eye);
    let distance = camera.eye.distance(camera.target);
    let scale = DMat4::from_scale(DVec3::new(axes.scale[0], axes.scale[1], 1.0));
    // Depth from a hundredth to a hundred times the distance of the target.
    let [near, far] = [0.01 * distance, 100.0 * distance];
    let projection = DMat4::from_cols(
        DVec3::X.extend(0.0),
        DVec3::Y.extend(0.0),
        glam::DVec4::new(0.0, 0.0, far / (near - far), -1.0),
        glam::DVec4::new(0.0, 0.0, near * far / (near - far), 0.0),
    );
    let columns = (scale * projection * look).as_mat4().to_cols_array_2d();
    let [c0, c1, c2, c3] = columns;
    let point = |x: DVec3, w: f64| Vec4::from((x.as_vec3(), w as f32)).to_array();
    [
        c0,
        c1,
        c2,
        c3,
        point(camera.eye, 1.0),
        point(light.center, light.spacing),
        point(light.normal(), 0.0),
        point(light.axes[0], 0.0),
    ]
}
