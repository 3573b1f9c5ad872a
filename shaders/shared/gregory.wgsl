// The Gregory patches of OpenSubdiv's end caps: bicubic Bezier patches whose inner points depend on (u,v). f64 twin:
// src/adaptive/gregory.rs.

// The cubic Bernstein polynomials at t in [0,1].
fn bernstein(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
}

// Their derivatives.
fn bernstein_derivative(t: f32) -> vec4f {
    let s = 1.0 - t;
    return 3.0 * vec4f(-s * s, s * (s - 2.0 * t), t * (2.0 * s - t), t * t);
}

// Weights of f+ - f- at the four corners, counter-clockwise from (0,0): a / (a + b), with a the parameter along the corner's
// first edge and b along its second.
fn gregory_weights(uv: vec2f) -> vec4f {
    let s = 1.0 - uv;
    let a = vec4f(uv.x, uv.y, s.x, s.y);
    let sum = a + a.yzwx;
    return select(vec4f(0.0), a / sum, sum > vec4f(0.0));
}

// Of a tensor product, what the four inner points weigh.
fn inner(u: vec4f, v: vec4f) -> vec4f {
    return u.yzzy * v.yyzz;
}
