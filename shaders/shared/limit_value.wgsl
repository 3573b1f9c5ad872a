// What the limit surface has at a point.

struct LimitPoint {
    position: vec3f,
    du: vec3f,
    dv: vec3f,
    // Zero where the surface has none.
    normal: vec3f,
    // Mean and Gaussian; z: 1 where there are such. Computed for fields that read it.
    curvature: vec3f,
}

fn unit_or_zero(v: vec3f) -> vec3f {
    let size = length(v);
    return select(vec3f(0.0), v / size, size > 0.0);
}
