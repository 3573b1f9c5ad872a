// Sum of the samples, linear, into sRGB. Host side: passes/resolve.rs.

@group(0) @binding(0) var sum: texture_2d<f32>;

// IEC 61966-2-1.
fn srgb(x: vec3f) -> vec3f {
    let c = clamp(x, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

@fragment
fn resolve(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    return vec4f(srgb(textureLoad(sum, vec2u(pixel.xy), 0).rgb), 1.0);
}
