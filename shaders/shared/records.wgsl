// Buffers that every pass over patches reads; the host twins are in src/gpu/records.rs, compared by tests/shaders.rs.
// Lengths are in units of Tables::unit, positions relative to the origin of their patch.

struct PatchRecord {
    // Limit normal at local (0,0) of an irregular patch.
    normal: vec3f,
    // First f32 of the patch in `points`.
    first: u32,
    kind: u32,
    // First entry of the patch's class in `scales`.
    scales: u32,
    // Depth in the quadtree of its ptex face.
    depth: u32,
    // Levels in the table of an irregular patch.
    levels: u32,
}

// lambda^(n-1) and 2^n lambda^(n-1) of one level.
struct Scale {
    position: f32,
    derivative: f32,
}

// What the camera makes of a patch, composed in f64.
struct PatchView {
    // Clip-space x, y and w of the patch's origin.
    clip: vec3f,
    // The eye relative to the origin.
    eye: vec3f,
}

struct Frame {
    // Rows x, y and w of the linear part of the projection.
    clip_x: vec3f,
    // Clip-space z of everything: the near distance (reversed, infinite depth: z/w = near/distance).
    near: f32,
    clip_y: vec3f,
    // Pixels per unit at distance 1.
    focal: f32,
    clip_w: vec3f,
    proxy_level: u32,
    // Part of the picture that this pass draws: clip.xy * scale + shift * clip.w.
    scale: vec2f,
    shift: vec2f,
    // Size of the target in pixels.
    size: vec2f,
    padding: vec2f,
}
