// The limit surface at one point of a patch: the only place where WGSL evaluates it, but for triangles (triangle_point.wgsl).
// f64 twin: stam::LimitSurface::evaluate. Yasui & Kanai 2004, eq. 4, 8 and 9, on normalised tables.

fn limit_point(record: vec4u, uv: vec2f) -> LimitPoint {
    var t = uv;
    var first = record.x;
    var scale = vec2f(1.0);
    var centre = false;
    // Groups of picked points to combine; where they are, and their weights.
    var groups = 0u;
    var picked = 0u;
    var weights = 0u;
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
        // At u < 1 there is only the window with v >= 1.
        let row = select(5u, window.y, window.x == 1u);
        let expanded = expanded_levels(record);
        let level = min(n, select(expanded, TABLE_LEVELS, groups_of(record) > 0u)) - 1u;
        if HAS_TAIL && level >= expanded {
            groups = groups_of(record);
            picked = record.x + expanded * LEVEL_TEXELS;
            weights = record.w + (level - expanded) * groups * 36u + row;
        } else {
            first += level * LEVEL_TEXELS + 3u * row;
        }
        scale = textureLoad(scales, at(first_scale(record) + n - 1u), 0).xy;
    }
    var bu = basis(t.x);
    var bv = basis(t.y);
    var cu = basis_derivative(t.x);
    var cv = basis_derivative(t.y);
    let gregory = HAS_GREGORY && is_gregory(record);
    if gregory {
        bu = bernstein(t.x);
        bv = bernstein(t.y);
        cu = bernstein_derivative(t.x);
        cv = bernstein_derivative(t.y);
    }
    var position = vec3f(0.0);
    var du = vec3f(0.0);
    var dv = vec3f(0.0);
    let rb = row_weights(bv, 1.0, record);
    let rc = row_weights(cv, 0.0, record);
    for (var j = 0u; j < 4u; j++) {
        let x = point_texel(first + 3u * j);
        let y = point_texel(first + 3u * j + 1u);
        let z = point_texel(first + 3u * j + 2u);
        let line = vec3f(dot(x, bu), dot(y, bu), dot(z, bu));
        position += line * rb[j];
        du += vec3f(dot(x, cu), dot(y, cu), dot(z, cu)) * rb[j];
        dv += line * rc[j];
    }
    if gregory {
        let x = point_texel(first + 12u);
        let y = point_texel(first + 13u);
        let z = point_texel(first + 14u);
        // OpenSubdiv's derivatives hold the weights still.
        let w = gregory_weights(t);
        let a = w * inner(bu, bv);
        let b = w * inner(cu, bv);
        let c = w * inner(bu, cv);
        position += vec3f(dot(x, a), dot(y, a), dot(z, a));
        du += vec3f(dot(x, b), dot(y, b), dot(z, b));
        dv += vec3f(dot(x, c), dot(y, c), dot(z, c));
    }
    // Not in a branch round the loop above: software adapters compute both sides. This loop mostly ends at once, but on
    // them it costs the pass a quarter even so (it spills registers); hence the constant.
    if HAS_TAIL && groups > 0u {
        position = vec3f(0.0);
        du = vec3f(0.0);
        dv = vec3f(0.0);
    }
    for (var g = 0u; HAS_TAIL && g < groups; g++) {
        var a = vec4f(0.0);
        var b = vec4f(0.0);
        var c = vec4f(0.0);
        for (var k = 0u; k < 4u; k++) {
            for (var j = 0u; j < 4u; j++) {
                let w = point_texel(weights + g * 36u + k * 9u + j);
                let line = dot(w, bu);
                a[k] += line * bv[j];
                b[k] += dot(w, cu) * bv[j];
                c[k] += line * cv[j];
            }
        }
        let x = point_texel(picked + 3u * g);
        let y = point_texel(picked + 3u * g + 1u);
        let z = point_texel(picked + 3u * g + 2u);
        position += vec3f(dot(x, a), dot(y, a), dot(z, a));
        du += vec3f(dot(x, b), dot(y, b), dot(z, b));
        dv += vec3f(dot(x, c), dot(y, c), dot(z, c));
    }
    var moved = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    if is_instance(record) {
        moved = transform_of(record);
        position = moved * position;
        du = moved * du;
        dv = moved * dv;
    }
    // The normal comes from the normalised derivatives, without any power of two (docs/LIMIT.md, section 4).
    var normal = unit_or_zero(cross(unit_or_zero(du), unit_or_zero(dv)));
    if centre {
        position = vec3f(0.0);
        normal = point_texel(normal_texel(record)).xyz;
        if is_instance(record) {
            // Cofactors move the product of two vectors as the matrix moves both.
            let cofactors = mat3x3f(cross(moved[1], moved[2]), cross(moved[2], moved[0]), cross(moved[0], moved[1]));
            normal = unit_or_zero(cofactors * normal);
        }
    }
    var curvature = vec3f(0.0);
    if READS_CURVATURE && !centre {
        let stored = second_derivatives(record, first, t);
        var second = stored;
        if is_instance(record) {
            second = moved * stored;
        }
        // Second derivatives scale as du du / s, with s the scale of positions, so curvatures as 1 / s.
        curvature = curvatures(du, dv, normal, second) * vec3f(1.0 / scale.x, 1.0 / (scale.x * scale.x), 1.0);
    }
    return LimitPoint(position * scale.x, du * scale.y, dv * scale.y, normal, curvature);
}
