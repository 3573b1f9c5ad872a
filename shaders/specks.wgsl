// Samples that were solved on the host, as points. Host side: passes/charts.rs.

struct Speck {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) patch_id: u32,
    @location(1) @interpolate(flat, either) uv: vec2f,
    @location(2) @interpolate(flat, either) residual: f32,
}

struct Found {
    @location(0) patch_id: u32,
    @location(1) uv: vec2f,
    @location(2) certificate: u32,
}

// place: centre of the sample in normalised device coordinates, and depth.
@vertex
fn speck(@location(0) place: vec3f, @location(1) patch_id: u32, @location(2) uv: vec2f, @location(3) residual: f32) -> Speck {
    return Speck(vec4f(place, 1.0), patch_id, uv, residual);
}

@fragment
fn solved(v: Speck) -> Found {
    return Found(v.patch_id, v.uv, residual_bits(v.residual) | (STATE_SOLVED << 24u));
}
