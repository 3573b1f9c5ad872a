// Field and pattern into colour, in linear light, one sample a pixel. Host side: passes/shade.rs.

struct Shade {
    // Linear RGB.
    paint: vec3f,
    // Pattern shape: width or radius, in periods.
    width: f32,
    tube: vec3f,
    pattern: u32,
    top: vec3f,
    // First row of the tile in the picture.
    row: f32,
    bottom: vec3f,
    // Rows of the picture.
    rows: f32,
    // Direction up in world space.
    up: vec3f,
    padding0: f32,
    picture_scale: vec2f,
    padding1: vec2f,
}

@group(0) @binding(0) var surface_position: texture_2d<f32>;
@group(0) @binding(1) var surface_normal: texture_2d<f32>;
@group(0) @binding(2) var surface_field: texture_2d<f32>;
@group(0) @binding(3) var picture: texture_2d<f32>;
@group(0) @binding(4) var picture_sampler: sampler;
@group(0) @binding(5) var<uniform> shade_in: Shade;
@group(0) @binding(6) var<uniform> light: Light;
@group(0) @binding(7) var<uniform> band: Band;

// Change of the field towards the two neighbours on a line, the smaller one: across a silhouette or a crease the other
// belongs to another sheet. Neighbours without a value do not count.
fn one_sided(f: vec4f, at: vec2i, step: vec2i) -> vec2f {
    let a = textureLoad(surface_field, at + step, 0);
    let b = textureLoad(surface_field, at - step, 0);
    let da = a.xy - f.xy;
    let db = f.xy - b.xy;
    let use_a = a.z > 0.0 && (b.z == 0.0 || dot(da, da) <= dot(db, db));
    return select(select(vec2f(0.0), db, b.z > 0.0), da, use_a);
}

// Light from the plane, linear RGB.
fn radiance(field: vec4f, jx: vec2f, jy: vec2f) -> vec3f {
    let s = field.xy / light.spacing;
    let sx = jx / light.spacing;
    let sy = jy / light.spacing;
    let w = sqrt(sx * sx + sy * sy);
    let inside = slab(field.x, light.half_x, w.x * light.spacing) * slab(field.y, light.half_y, w.y * light.spacing);
    var on = vec3f(0.0);
    switch shade_in.pattern {
        case PATTERN_STRIPES: { on = vec3f(stripe(s.x, shade_in.width, w.x)); }
        case PATTERN_LATTICE: {
            on = vec3f(1.0 - (1.0 - stripe(s.x, shade_in.width, w.x)) * (1.0 - stripe(s.y, shade_in.width, w.y)));
        }
        case PATTERN_CIRCLES: { on = vec3f(disc(s, shade_in.width, sx, sy)); }
        default: {
            let k = shade_in.picture_scale;
            on = textureSampleGrad(picture, picture_sampler, field.xy * k + 0.5, jx * k, jy * k).rgb;
        }
    }
    return on * inside;
}

@fragment
fn shade(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let at = vec2i(pixel.xy) - vec2i(0, band.first);
    let height = (pixel.y + shade_in.row) / shade_in.rows;
    let f = textureLoad(surface_field, at, 0);
    if f.w == 0.0 {
        return vec4f(mix(shade_in.top, shade_in.bottom, smoothstep(0.0, 1.0, height)), 1.0);
    }
    let position = textureLoad(surface_position, at, 0);
    let normal = textureLoad(surface_normal, at, 0);
    let facing = position.w;
    let fresnel = pow(1.0 - min(facing, 1.0), 5.0);
    // The form where no light is mirrored: paint under a soft sky, darker towards grazing sight, and a faint gleam of the
    // background at the rim.
    let sky = 0.5 + 0.5 * abs(dot(normal.xyz, shade_in.up));
    let diffuse = shade_in.paint * (0.25 + 0.75 * facing) * sky;
    let body = mix(diffuse, mix(shade_in.bottom, shade_in.top, 0.5), 0.35 * fresnel);
    var lit = vec3f(0.0);
    if f.z > 0.0 {
        let jx = one_sided(f, at, vec2i(1, 0));
        let jy = one_sided(f, at, vec2i(0, 1));
        // Tubes far along the plane fade out before its horizon cuts them off.
        lit = radiance(f, jx, jy) * smoothstep(0.0, 0.2, normal.w);
    }
    return vec4f(mix(body, shade_in.tube, lit), 1.0);
}
