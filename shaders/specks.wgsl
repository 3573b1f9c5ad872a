// Samples that were solved on the host, as points. Host side: passes/charts.rs.

struct Speck {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) found: vec4u,
}

// place: centre of the sample in normalised device coordinates.
@vertex
fn vertex(@location(0) place: vec2f, @location(1) patch_id: u32, @location(2) uv: vec2f, @location(3) depth: f32) -> Speck {
    return Speck(vec4f(place, 0.5, 1.0), vec4u(patch_id, bitcast<vec2u>(uv), bitcast<u32>(depth)));
}

@fragment
fn speck(v: Speck) -> @location(0) vec4u {
    return v.found;
}
