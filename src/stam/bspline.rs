//! The uniform cubic B-spline basis.

/// Values of the four basis functions at t from 0 to 1.
pub fn basis(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s / 6.0, (t * t * (3.0 * t - 6.0) + 4.0) / 6.0, (s * s * (3.0 * s - 6.0) + 4.0) / 6.0, t * t * t / 6.0]
}

/// First derivatives of the four basis functions at t from 0 to 1.
pub fn derivative(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), 0.5 * s * (4.0 - 3.0 * s), 0.5 * t * t]
}

/// Second derivatives of the four basis functions at t from 0 to 1.
pub fn second(t: f64) -> [f64; 4] {
    [1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t]
}

/// Weights of a 4x4 net (u fastest) for the value, the derivative by u and the derivative by v.
pub fn tensor(u: f64, v: f64) -> [[f64; 3]; 16] {
    let (bu, bv, du, dv) = (basis(u), basis(v), derivative(u), derivative(v));
    std::array::from_fn(|k| {
        let (i, j) = (k % 4, k / 4);
        [bu[i] * bv[j], du[i] * bv[j], bu[i] * dv[j]]
    })
}

/// Weights of a 4x4 net (u fastest) for the derivatives by uu, uv and vv.
pub fn tensor_second(u: f64, v: f64) -> [[f64; 3]; 16] {
    let [(bu, du, cu), (bv, dv, cv)] = [u, v].map(|t| (basis(t), derivative(t), second(t)));
    std::array::from_fn(|k| {
        let (i, j) = (k % 4, k / 4);
        [cu[i] * bv[j], du[i] * dv[j], bu[i] * cv[j]]
    })
}
