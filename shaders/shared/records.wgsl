// What every pass over patches reads; the host side is src/gpu/records.rs and src/gpu/tables/.
// Lengths are in units of Tables::unit, positions relative to the origin of their patch.
//
// Tables are textures TABLE_WIDTH texels wide, read by index. Software adapters gather texels of 8 invocations at once,
// but walk through storage buffers one invocation at a time (measured on lavapipe: 4 times slower).

fn at(index: u32) -> vec2u {
    return vec2u(index % TABLE_WIDTH, index / TABLE_WIDTH);
}

struct Frame {
    // Rows of the linear part of the projection: x, y, and w in perspective or z in an orthographic view.
    clip_x: vec3f,
    // Clip-space z in perspective: the near distance (reversed, infinite depth: z/w = near/distance).
    near: f32,
    clip_y: vec3f,
    // Pixels per unit where w is 1.
    focal: f32,
    clip_depth: vec3f,
    proxy_level: u32,
    // Part of the picture that this pass draws: clip.xy * scale + shift * clip.w.
    scale: vec2f,
    shift: vec2f,
    // Size of the target in pixels.
    size: vec2f,
    orthographic: u32,
    padding: u32,
}
