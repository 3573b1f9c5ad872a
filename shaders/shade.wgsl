// Field and pattern into colour, in linear light, one sample a pixel; alpha is 1. Pixels that see nothing are skipped by the
// depth test and stay transparent. Host side: passes/shade.rs.

struct Shade {
    // Linear RGB.
    paint: vec3f,
    // Pattern shape: width or radius, in periods.
    width: f32,
    tube: vec3f,
    padding0: u32,
    // Linear RGB of the surroundings that the paint reflects faintly, above and below.
    top: vec3f,
    // Samples in a pixel's width.
    samples: f32,
    bottom: vec3f,
    padding1: f32,
    // Direction up and direction to the key light, world space.
    up: vec3f,
    padding2: f32,
    key: vec3f,
    padding3: f32,
    picture_scale: vec2f,
    // Ends of the scale of false colours.
    range: vec2f,
}

@group(0) @binding(0) var packed: texture_2d<u32>;
@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var picture_sampler: sampler;
@group(0) @binding(3) var<uniform> shade_in: Shade;
@group(0) @binding(4) var<uniform> light: Light;

// One of the PATTERN_ constants. No uniform: software adapters compute both sides of a branch, or compile the shader again for each
// picture where a uniform says which.
override PATTERN: u32 = PATTERN_STRIPES;

// Field value at a pixel; z above 0 where it is defined.
fn field_at(pixel: vec2i) -> vec3f {
    let s = textureLoad(packed, pixel, 0);
    return vec3f(bitcast<vec2f>(s.xy), unpack2x16snorm(s.w).y);
}

// Change of the field over one pixel, from the neighbours on both sides. Where one side changes 4 times as much as the
// other it lies across a silhouette or a crease, and the other side counts; else the larger one does.
fn change(f: vec2f, pixel: vec2i, step: vec2i) -> vec2f {
    let a = field_at(pixel + step);
    let b = field_at(pixel - step);
    let da = a.xy - f;
    let db = f - b.xy;
    if a.z <= 0.0 || b.z <= 0.0 {
        return select(select(vec2f(0.0), db, b.z > 0.0), da, a.z > 0.0);
    }
    let la = dot(da, da);
    let lb = dot(db, db);
    let similar = max(la, lb) <= 16.0 * min(la, lb);
    return select(db, da, (la > lb) == similar);
}

// Light from the plane, linear RGB.
fn radiance(field: vec2f, jx: vec2f, jy: vec2f) -> vec3f {
    let s = field / light.spacing;
    let sx = jx / light.spacing;
    let sy = jy / light.spacing;
    let w = sqrt(sx * sx + sy * sy);
    let inside = slab(field.x, light.half_x, w.x * light.spacing) * slab(field.y, light.half_y, w.y * light.spacing);
    let n = shade_in.samples;
    var on = vec3f(0.0);
    switch PATTERN {
        case PATTERN_STRIPES: { on = vec3f(stripe(s.x, shade_in.width, w.x, n)); }
        case PATTERN_LATTICE: {
            on = vec3f(1.0 - (1.0 - stripe(s.x, shade_in.width, w.x, n)) * (1.0 - stripe(s.y, shade_in.width, w.y, n)));
        }
        case PATTERN_BAND: { on = vec3f(slab(s.x, 0.5 * shade_in.width, w.x)); }
        case PATTERN_CIRCLES: { on = vec3f(disc(s, shade_in.width, sx, sy, n)); }
        default: {
            let k = shade_in.picture_scale;
            on = textureSampleGrad(picture, picture_sampler, field * k + 0.5, jx * k, jy * k).rgb;
        }
    }
    return on * inside;
}

fn shaded(pixel: vec2i, s: vec4u) -> vec4f {
    let angles = unpack2x16snorm(s.w);
    let facing = abs(angles.x);
    // Towards the eye, whichever side is seen.
    let normal = from_octahedral(unpack2x16snorm(s.z)) * sign(angles.x);
    // The form where no light is mirrored: satin paint under a soft key light and the surroundings, which gleam at
    // grazing sight.
    let around = mix(shade_in.bottom, shade_in.top, 0.5 + 0.5 * dot(normal, shade_in.up));
    let wrap = 0.5 + 0.5 * dot(normal, shade_in.key);
    let fresnel = 0.04 + 0.5 * pow(1.0 - min(facing, 1.0), 4.0);
    let body = mix(shade_in.paint * (0.25 + 1.25 * wrap * wrap), around, fresnel * wrap);
    let f = bitcast<vec2f>(s.xy);
    if PATTERN == PATTERN_HEAT {
        return vec4f(false_colour(f.x, shade_in.range, angles.y > 0.0) * (0.35 + 0.65 * wrap), 1.0);
    }
    let jx = change(f, pixel, vec2i(1, 0));
    let jy = change(f, pixel, vec2i(0, 1));
    // Tubes far along the plane fade out before its horizon cuts them off.
    let lit = radiance(f, jx, jy) * smoothstep(0.0, 0.15, angles.y);
    return vec4f(mix(body, shade_in.tube, lit), 1.0);
}

@fragment
fn shade(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    return shaded(pixel, textureLoad(packed, pixel, 0));
}

// The same as a compute pass: `--stage compute`.
@group(1) @binding(0) var samples_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(TILE_SIDE, TILE_SIDE)
fn shade_compute(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(packed)) {
        return;
    }
    let pixel = vec2i(id.xy);
    let s = textureLoad(packed, pixel, 0);
    var colour = vec4f(0.0);
    if any(s != vec4u(0u)) {
        colour = shaded(pixel, s);
    }
    textureStore(samples_out, pixel, colour);
}
