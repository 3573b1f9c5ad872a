// Unit vectors in two numbers from -1 to 1: the octahedron, unfolded (Cigolle et al. 2014, "A survey of efficient
// representations for independent unit vectors", listing 1).

fn sign_not_zero(v: vec2f) -> vec2f {
    return select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

fn octahedral(n: vec3f) -> vec2f {
    let p = n.xy / max(abs(n.x) + abs(n.y) + abs(n.z), 1e-20);
    return select(p, (1.0 - abs(p.yx)) * sign_not_zero(p), n.z < 0.0);
}

fn from_octahedral(e: vec2f) -> vec3f {
    let z = 1.0 - abs(e.x) - abs(e.y);
    return normalize(vec3f(select(e, (1.0 - abs(e.yx)) * sign_not_zero(e), z < 0.0), z));
}
