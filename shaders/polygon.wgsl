// The same from interpolated positions and normals: what everyone else does, for comparison (Yasui & Kanai 2004,
// fig. 7b). Host side: passes/limit.rs.

@group(1) @binding(0) var visible_patch: texture_2d<u32>;
@group(1) @binding(1) var proxy_position: texture_2d<f32>;
@group(1) @binding(2) var proxy_normal: texture_2d<f32>;

@fragment
fn polygon(@builtin(position) position: vec4f) -> @location(0) vec4u {
    let pixel = vec2u(position.xy);
    let patch_id = textureLoad(visible_patch, pixel, 0).x - 1u;
    return packed_surface(patch_id, textureLoad(proxy_position, pixel, 0).xyz, textureLoad(proxy_normal, pixel, 0).xyz,
        vec3f(0.0));
}

@fragment
fn polygon_full(@builtin(position) position: vec4f) -> Surface {
    let pixel = vec2u(position.xy);
    let patch_id = textureLoad(visible_patch, pixel, 0).x - 1u;
    return surface(patch_id, textureLoad(proxy_position, pixel, 0).xyz, textureLoad(proxy_normal, pixel, 0).xyz,
        vec3f(0.0));
}
