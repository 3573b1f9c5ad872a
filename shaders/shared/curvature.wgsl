// Curvature from second derivatives, for fields that read it. f64 twin: src/stam/curvature.rs.

// Second derivatives of the four uniform cubic B-splines.
fn basis_second(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s, 3.0 * t - 2.0, 1.0 - 3.0 * t, t);
}

// Of the cubic Bernstein polynomials.
fn bernstein_second(t: f32) -> vec4f {
    let s = 1.0 - t;
    return 6.0 * vec4f(s, t - 2.0 * s, s - 2.0 * t, t);
}

// By uu, uv and vv, of a patch whose rows of points start at `first`, at parameters inside its window. Of Gregory patches, as of
// their first derivatives: the inner points are held still. Levels that are given by picked points have none: HAS_TAIL excludes
// READS_CURVATURE.
fn second_derivatives(record: vec4u, first: u32, t: vec2f) -> mat3x3f {
    var bu = basis(t.x);
    var bv = basis(t.y);
    var cu = basis_derivative(t.x);
    var cv = basis_derivative(t.y);
    var du = basis_second(t.x);
    var dv = basis_second(t.y);
    let gregory = HAS_GREGORY && is_gregory(record);
    if gregory {
        bu = bernstein(t.x);
        bv = bernstein(t.y);
        cu = bernstein_derivative(t.x);
        cv = bernstein_derivative(t.y);
        du = bernstein_second(t.x);
        dv = bernstein_second(t.y);
    }
    let rb = row_weights(bv, 1.0, record);
    let rc = row_weights(cv, 0.0, record);
    let rd = row_weights(dv, 0.0, record);
    var uu = vec3f(0.0);
    var uv = vec3f(0.0);
    var vv = vec3f(0.0);
    for (var j = 0u; j < 4u; j++) {
        let x = point_texel(first + 3u * j);
        let y = point_texel(first + 3u * j + 1u);
        let z = point_texel(first + 3u * j + 2u);
        uu += vec3f(dot(x, du), dot(y, du), dot(z, du)) * rb[j];
        uv += vec3f(dot(x, cu), dot(y, cu), dot(z, cu)) * rc[j];
        vv += vec3f(dot(x, bu), dot(y, bu), dot(z, bu)) * rd[j];
    }
    if gregory {
        let x = point_texel(first + 12u);
        let y = point_texel(first + 13u);
        let z = point_texel(first + 14u);
        let w = gregory_weights(t);
        let a = w * inner(du, bv);
        let b = w * inner(cu, cv);
        let c = w * inner(bu, dv);
        uu += vec3f(dot(x, a), dot(y, a), dot(z, a));
        uv += vec3f(dot(x, b), dot(y, b), dot(z, b));
        vv += vec3f(dot(x, c), dot(y, c), dot(z, c));
    }
    return mat3x3f(uu, uv, vv);
}

// Mean and Gaussian curvature from the two fundamental forms (do Carmo 1976, section 3.3); z: 1 where the surface has such.
fn curvatures(du: vec3f, dv: vec3f, normal: vec3f, second: mat3x3f) -> vec3f {
    let e = dot(du, du);
    let f = dot(du, dv);
    let g = dot(dv, dv);
    let l = dot(second[0], normal);
    let m = dot(second[1], normal);
    let k = dot(second[2], normal);
    let area = e * g - f * f;
    // f32 tells parallel derivatives apart to some 1e-6 of their squares.
    let defined = area > 1e-6 * e * g && dot(normal, normal) > 0.5;
    let over = 1.0 / select(1.0, area, defined);
    let mean = 0.5 * (e * k - 2.0 * f * m + g * l) * over;
    return vec3f(mean, (l * k - m * m) * over, 1.0) * select(0.0, 1.0, defined);
}
