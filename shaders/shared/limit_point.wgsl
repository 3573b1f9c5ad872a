// The limit surface at one point of a patch: the only place where WGSL evaluates it.
// f64 twin: stam::LimitSurface::evaluate. Yasui & Kanai 2004, eq. 4, 8 and 9, on normalised tables.

struct LimitPoint {
    position: vec3f,
    du: vec3f,
    dv: vec3f,
    // Zero where the surface has none.
    normal: vec3f,
}

// A texel a patch: first texel in `points`; kind (bits 0 to 7), refinement levels along u and v (4 bits each),
// levels of its table (from bit 16); first texel in `scales`; 0.
@group(0) @binding(0) var patches: texture_2d<u32>;
// Rows of 4 points, 3 texels each: the four x, the four y, the four z. A regular patch has 4 rows. A level of an irregular
// patch has 9: those of the windows at u >= 1 (5), then those of the window at u < 1 (4); after the last level comes
// one texel with the limit normal at (0,0).
@group(0) @binding(1) var points: texture_2d<f32>;
// lambda^(n-1) and 2^n lambda^(n-1), a texel a level n, of each class.
@group(0) @binding(2) var scales: texture_2d<f32>;

// Values of the four uniform cubic B-splines at t in [0,1].
fn basis(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s * s * s, t * t * (3.0 * t - 6.0) + 4.0, s * s * (3.0 * s - 6.0) + 4.0, t * t * t) / 6.0;
}

// Their derivatives.
fn basis_derivative(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), 0.5 * s * (4.0 - 3.0 * s), 0.5 * t * t);
}

fn unit_or_zero(v: vec3f) -> vec3f {
    let size = length(v);
    return select(vec3f(0.0), v / size, size > 0.0);
}

fn refinement_of(record: vec4u) -> vec2u {
    return vec2u(record.y >> 8u, record.y >> 12u) & vec2u(15u);
}

fn is_irregular(record: vec4u) -> bool {
    return (record.y & 255u) == KIND_IRREGULAR;
}

fn limit_point(record: vec4u, uv: vec2f) -> LimitPoint {
    var t = uv;
    var first = record.x;
    var scale = vec2f(1.0);
    var centre = false;
    if is_irregular(record) {
        // n from the exponent of the larger parameter: exact, where log2 would be off by one ulp. Zeros and denormals
        // (which the adapter may flush) are the extraordinary vertex.
        let exponent = i32(bitcast<u32>(max(uv.x, uv.y)) >> 23u) - 127;
        centre = exponent == -127;
        var n = u32(max(-exponent, 1));
        // 2^n from its bits, n at most 126: exact, which exp2 need not be.
        var ab = uv * bitcast<f32>((n + 127u) << 23u);
        if centre {
            n = CENTRE_LEVEL;
            ab = vec2f(1.0);
        }
        let window = select(vec2u(0u), vec2u(1u), ab >= vec2f(1.0));
        t = ab - vec2f(window);
        let level = min(n, record.y >> 16u) - 1u;
        // At u < 1 there is only the window with v >= 1.
        first += level * LEVEL_TEXELS + select(15u, window.y * 3u, window.x == 1u);
        scale = textureLoad(scales, at(record.z + n - 1u), 0).xy;
    }
    let bu = basis(t.x);
    let bv = basis(t.y);
    let cu = basis_derivative(t.x);
    let cv = basis_derivative(t.y);
    var position = vec3f(0.0);
    var du = vec3f(0.0);
    var dv = vec3f(0.0);
    for (var j = 0u; j < 4u; j++) {
        let x = textureLoad(points, at(first + 3u * j), 0);
        let y = textureLoad(points, at(first + 3u * j + 1u), 0);
        let z = textureLoad(points, at(first + 3u * j + 2u), 0);
        let line = vec3f(dot(x, bu), dot(y, bu), dot(z, bu));
        position += line * bv[j];
        du += vec3f(dot(x, cu), dot(y, cu), dot(z, cu)) * bv[j];
        dv += line * cv[j];
    }
    // The normal comes from the normalised derivatives, without any power of two (design.md 3.2).
    var normal = unit_or_zero(cross(unit_or_zero(du), unit_or_zero(dv)));
    if centre {
        position = vec3f(0.0);
        normal = textureLoad(points, at(record.x + (record.y >> 16u) * LEVEL_TEXELS), 0).xyz;
    }
    return LimitPoint(position * scale.x, du * scale.y, dv * scale.y, normal);
}
