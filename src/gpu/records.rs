//! Host twins of the structs in `shaders/` (tables are textures, see [`tables`](super::tables)), field by field; `tests/shaders.rs` compares offsets with naga's layout.
//!
//! Lengths are in units of [`Tables::unit`](super::Tables::unit). Padding is explicit: `vec3f` aligns to 16 bytes.

use bytemuck::{Pod, Zeroable};

/// A vertex of the proxy, as vertex attributes 0 and 1 of shaders/visibility.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable, PartialEq)]
pub struct ProxyVertex {
    /// Patch-local parameters.
    pub uv: [f32; 2],
    /// Which patch of its group.
    pub member: u32,
}

/// `Draw`, shaders/visibility.wgsl: which patches an instanced draw covers.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct DrawRecord {
    /// First patch in the drawing order.
    pub first: u32,
    /// Patches an instance.
    pub group_size: u32,
    /// Zero.
    pub padding: [u32; 2],
}

/// `Span`, shaders/rectangle.wgsl: the vertices of a draw.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct SpanRecord {
    /// First vertex of the group.
    pub first: u32,
    /// Vertices in a group.
    pub count: u32,
    /// Groups.
    pub groups: u32,
    /// Groups a layer of the dispatch.
    pub rows: u32,
}

/// A chart, as 16 texels of the table that shaders/shared/chart.wgsl reads; it says what they are.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable, PartialEq)]
pub struct ChartRecord {
    /// Patch + 1; x, y of its middle and how far that is before the far end of depths, as bits.
    pub id: [u32; 4],
    /// Inverse of the linear map, row by row.
    pub inverse: [f32; 4],
    /// (u,v) of the middle, half the sides of the rectangle; the first side below zero if the chart ends at a diagonal.
    pub start: [f32; 4],
    /// Origin and size in the patch.
    pub place: [f32; 4],
    /// Rows of v: x, y, depth.
    pub net: [[[f32; 4]; 3]; 4],
}

/// A sample solved on the host, as vertex attributes 0 to 3 of shaders/specks.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable, PartialEq)]
pub struct SpeckRecord {
    /// Centre of the sample in normalised device coordinates, and depth.
    pub place: [f32; 3],
    /// Patch + 1.
    pub patch_id: u32,
    /// Patch-local parameters.
    pub uv: [f32; 2],
    /// Samples between the point and the sample's ray.
    pub residual: f32,
}

/// `Lens`, shaders/charts.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct LensRecord {
    /// Samples.
    pub size: [f32; 2],
    /// 1 in perspective, else 0.
    pub perspective: f32,
    /// What makes 1 of the nearest depth in the depth buffer.
    pub scale: f32,
}

/// `Own`, shaders/summary.wgsl: part of a tile.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct OwnRecord {
    /// First sample.
    pub origin: [u32; 2],
    /// Samples each way.
    pub size: [u32; 2],
}

/// `Resolve`, shaders/resolve.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ResolveRecord {
    /// Linear RGB of the background at the top of the picture.
    pub top: [f32; 3],
    /// Zero.
    pub padding0: u32,
    /// Linear RGB of the background at the bottom.
    pub bottom: [f32; 3],
    /// First row of the tile in the picture, in pixels.
    pub row: f32,
    /// Rows of the picture.
    pub rows: f32,
    /// Zero.
    pub padding: [f32; 3],
}

/// `Frame`, shaders/shared/records.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct FrameRecord {
    /// Row of clip-space x.
    pub clip_x: [f32; 3],
    /// Near distance: z in perspective.
    pub near: f32,
    /// Row of clip-space y.
    pub clip_y: [f32; 3],
    /// Pixels per unit where clip-space w is 1.
    pub focal: f32,
    /// Row of clip-space w; in an orthographic view, of z.
    pub clip_depth: [f32; 3],
    /// Level of the proxy tessellation.
    pub proxy_level: u32,
    /// Scale of clip-space x and y to this pass's part of the picture.
    pub scale: [f32; 2],
    /// Shift, times w.
    pub shift: [f32; 2],
    /// Target size in pixels.
    pub size: [f32; 2],
    /// 1 in an orthographic view, else 0.
    pub orthographic: u32,
    /// Zero.
    pub padding: u32,
}

/// `SampleRecord`, shaders/evaluate.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct SampleRecord {
    /// Patch-local parameters.
    pub uv: [f32; 2],
    /// Patch.
    pub patch_id: u32,
    /// Zero.
    pub padding: u32,
}

/// `JetRecord`, shaders/evaluate.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct JetRecord {
    /// Relative to the patch's origin.
    pub position: [f32; 3],
    /// Zero.
    pub padding0: f32,
    /// Derivative by u.
    pub du: [f32; 3],
    /// Zero.
    pub padding1: f32,
    /// Derivative by v.
    pub dv: [f32; 3],
    /// Zero.
    pub padding2: f32,
    /// Unit normal or zero.
    pub normal: [f32; 3],
    /// Zero.
    pub padding3: f32,
}

/// `Light`, shaders/field/light.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct LightRecord {
    /// Centre relative to the viewpoint.
    pub center: [f32; 3],
    /// Period of the pattern.
    pub spacing: f32,
    /// First axis.
    pub axis_x: [f32; 3],
    /// Half extent along it.
    pub half_x: f32,
    /// Second axis.
    pub axis_y: [f32; 3],
    /// Half extent along it.
    pub half_y: f32,
    /// Direction of sight in an orthographic view, else zero.
    pub sight: [f32; 3],
    /// How much of the position relative to the viewpoint the line of sight takes: 1 in perspective, else 0.
    pub from_eye: f32,
    /// Which kind of its method a field is.
    pub kind: u32,
    /// A number of the method's.
    pub parameter: f32,
    /// Distance between light lines.
    pub lines: f32,
    /// World units in 1.
    pub unit: f32,
}

/// `Shade`, shaders/shade.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ShadeRecord {
    /// Linear RGB of the paint.
    pub paint: [f32; 3],
    /// Width or radius of the pattern's shape, in periods.
    pub width: f32,
    /// Linear RGB of the lights.
    pub tube: [f32; 3],
    /// Zero.
    pub padding0: u32,
    /// Linear RGB of the surroundings above.
    pub top: [f32; 3],
    /// Samples in a pixel's width.
    pub samples: f32,
    /// Linear RGB of the surroundings below.
    pub bottom: [f32; 3],
    /// Zero.
    pub padding1: f32,
    /// Unit vector up, world space.
    pub up: [f32; 3],
    /// Zero.
    pub padding2: f32,
    /// Unit vector to the key light, world space.
    pub key: [f32; 3],
    /// Zero.
    pub padding3: f32,
    /// From plane coordinates to texture coordinates.
    pub picture_scale: [f32; 2],
    /// Ends of the scale of false colours, in the shader's units of the field.
    pub range: [f32; 2],
}
