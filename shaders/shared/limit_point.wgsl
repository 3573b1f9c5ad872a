// The limit surface at one point of a patch: the only place where WGSL evaluates it.
// f64 twin: stam::LimitSurface::evaluate. Yasui & Kanai 2004, eq. 4, 8 and 9, on normalised tables.

struct LimitPoint {
    position: vec3f,
    du: vec3f,
    dv: vec3f,
    // Zero where the surface has none.
    normal: vec3f,
}

@group(0) @binding(0) var<storage, read> patches: array<PatchRecord>;
@group(0) @binding(1) var<storage, read> points: array<f32>;
@group(0) @binding(2) var<storage, read> scales: array<Scale>;

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

fn limit_point(patch_id: u32, uv: vec2f) -> LimitPoint {
    let record = patches[patch_id];
    var t = uv;
    var first = record.first;
    var row = 12u;
    var scale = Scale(1.0, 1.0);
    var centre = false;
    if record.kind == KIND_IRREGULAR {
        // n from the exponent of the larger parameter: exact, where log2 would be off by one ulp. Zeros and denormals
        // (which the adapter may flush) are the extraordinary vertex.
        let exponent = i32(bitcast<u32>(max(uv.x, uv.y)) >> 23u) - 127;
        centre = exponent == -127;
        var n = u32(max(-exponent, 1));
        var ab = vec2f(1.0);
        if centre {
            n = CENTRE_LEVEL;
        } else {
            // 2^n from its bits, n at most 126: exact, which exp2 need not be.
            ab = uv * bitcast<f32>((n + 127u) << 23u);
        }
        let window = select(vec2u(0u), vec2u(1u), ab >= vec2f(1.0));
        t = ab - vec2f(window);
        let level = min(n, record.levels) - 1u;
        // The grid of a level has rows of 5 points and leaves out its first one.
        first += (level * WINDOW_POINTS + window.y * 5u + window.x) * 3u - 3u;
        row = 15u;
        scale = scales[record.scales + n - 1u];
    }
    let bu = basis(t.x);
    let bv = basis(t.y);
    let cu = basis_derivative(t.x);
    let cv = basis_derivative(t.y);
    var position = vec3f(0.0);
    var du = vec3f(0.0);
    var dv = vec3f(0.0);
    for (var j = 0u; j < 4u; j++) {
        let at = first + j * row;
        let p0 = vec3f(points[at], points[at + 1u], points[at + 2u]);
        let p1 = vec3f(points[at + 3u], points[at + 4u], points[at + 5u]);
        let p2 = vec3f(points[at + 6u], points[at + 7u], points[at + 8u]);
        let p3 = vec3f(points[at + 9u], points[at + 10u], points[at + 11u]);
        let line = p0 * bu.x + p1 * bu.y + p2 * bu.z + p3 * bu.w;
        position += line * bv[j];
        du += (p0 * cu.x + p1 * cu.y + p2 * cu.z + p3 * cu.w) * bv[j];
        dv += line * cv[j];
    }
    // The normal comes from the normalised derivatives, without any power of two (design.md 3.2).
    var normal = unit_or_zero(cross(unit_or_zero(du), unit_or_zero(dv)));
    if centre {
        position = vec3f(0.0);
        normal = record.normal;
    }
    return LimitPoint(position * scale.position, du * scale.derivative, dv * scale.derivative, normal);
}
