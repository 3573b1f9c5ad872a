// Mean of each pixel's samples, in linear light, into sRGB. Host side: passes/resolve.rs.

struct Resolve {
    // Samples a pixel each way.
    samples: i32,
}

@group(0) @binding(0) var samples: texture_2d<f32>;
@group(0) @binding(1) var<uniform> resolve_in: Resolve;

// IEC 61966-2-1.
fn srgb(x: vec3f) -> vec3f {
    let c = clamp(x, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

@fragment
fn resolve(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let n = resolve_in.samples;
    let first = vec2i(pixel.xy) * n;
    var sum = vec3f(0.0);
    for (var k = 0; k < n * n; k++) {
        sum += textureLoad(samples, first + vec2i(k % n, k / n), 0).rgb;
    }
    return vec4f(srgb(sum / f32(n * n)), 1.0);
}
