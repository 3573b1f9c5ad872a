// The uniform cubic B-splines. f64 twin: src/stam/bspline.rs.

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
