//! Host twins of the structs in `shaders/`, field by field; `tests/shaders.rs` compares offsets with naga's layout.
//!
//! Lengths are in units of [`Tables::unit`](super::Tables::unit). Padding is explicit: `vec3f` aligns to 16 bytes.

use bytemuck::{Pod, Zeroable};

/// `PatchRecord`, shaders/shared/records.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable, PartialEq)]
pub struct PatchRecord {
    /// Limit normal at local (0,0) of an irregular patch.
    pub normal: [f32; 3],
    /// First f32 of the patch in the points.
    pub first: u32,
    /// [`KIND_REGULAR`](super::shader::KIND_REGULAR) or [`KIND_IRREGULAR`](super::shader::KIND_IRREGULAR).
    pub kind: u32,
    /// First [`Scale`] of the patch's class.
    pub scales: u32,
    /// Depth in the quadtree of the ptex face.
    pub depth: u32,
    /// Levels stored for an irregular patch.
    pub levels: u32,
}

/// `Scale`, shaders/shared/records.wgsl: lambda^(n-1) and 2^n lambda^(n-1).
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable, PartialEq)]
pub struct Scale {
    /// Of positions.
    pub position: f32,
    /// Of first derivatives.
    pub derivative: f32,
}

/// `PatchView`, shaders/shared/records.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct PatchView {
    /// Clip-space x, y, w of the patch's origin.
    pub clip: [f32; 3],
    /// Zero.
    pub padding0: f32,
    /// Eye relative to the origin.
    pub eye: [f32; 3],
    /// Zero.
    pub padding1: f32,
}

/// `Frame`, shaders/shared/records.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct FrameRecord {
    /// Row of clip-space x.
    pub clip_x: [f32; 3],
    /// Near distance.
    pub near: f32,
    /// Row of clip-space y.
    pub clip_y: [f32; 3],
    /// Pixels per unit at distance 1.
    pub focal: f32,
    /// Row of clip-space w.
    pub clip_w: [f32; 3],
    /// Level of the proxy tessellation.
    pub proxy_level: u32,
    /// Scale of clip-space x and y to this pass's part of the picture.
    pub scale: [f32; 2],
    /// Shift, times w.
    pub shift: [f32; 2],
    /// Target size in pixels.
    pub size: [f32; 2],
    /// Zero.
    pub padding: [f32; 2],
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

/// `Light`, shaders/field/reflection.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct LightRecord {
    /// Centre relative to the eye.
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
    /// One of the `PATTERN_` constants of [`shader`](super::shader).
    pub pattern: u32,
    /// Linear RGB of the background at the top of the picture.
    pub top: [f32; 3],
    /// 1 / samples.
    pub pixel: f32,
    /// Linear RGB of the background at the bottom.
    pub bottom: [f32; 3],
    /// 1 / samples^2.
    pub weight: f32,
    /// Unit vector up, world space.
    pub up: [f32; 3],
    /// First row of the target in the picture.
    pub row: f32,
    /// From plane coordinates to texture coordinates.
    pub picture_scale: [f32; 2],
    /// Rows of the picture.
    pub rows: f32,
    /// Zero.
    pub padding: f32,
}
