// Mean of each pixel's samples over the background, in linear light, into sRGB. Host side: passes/resolve.rs.

struct Resolve {
    // Linear RGB of the background at the top and at the bottom of the picture.
    top: vec3f,
    padding0: u32,
    bottom: vec3f,
    // First row of the tile, and rows of the picture.
    row: f32,
    rows: f32,
}

@group(0) @binding(0) var samples: texture_2d<f32>;
@group(0) @binding(1) var<uniform> resolve_in: Resolve;

// Samples a pixel each way. No uniform: software adapters would compile the shader again for each picture.
override SAMPLES: i32 = 1;

// IEC 61966-2-1.
fn srgb(x: vec3f) -> vec3f {
    let c = clamp(x, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

fn mean_at(pixel: vec2i) -> vec4f {
    let n = SAMPLES;
    var sum = vec4f(0.0);
    for (var k = 0; k < n * n; k++) {
        sum += textureLoad(samples, pixel * n + vec2i(k % n, k / n), 0);
    }
    return sum / f32(n * n);
}

@fragment
fn resolve(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let mean = mean_at(vec2i(position.xy));
    let height = (position.y + resolve_in.row) / resolve_in.rows;
    let background = mix(resolve_in.top, resolve_in.bottom, smoothstep(0.0, 1.0, height));
    return vec4f(srgb(mean.rgb + background * (1.0 - mean.a)), 1.0);
}

// The mean itself: linear, premultiplied, without a background.
@fragment
fn resolve_linear(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return mean_at(vec2i(position.xy));
}
