// Exact limit position, normal and field at every pixel's (patch, u, v). Host side: passes/limit.rs.
// The depth test of these passes skips pixels that see nothing.

@group(1) @binding(0) var visible_patch: texture_2d<u32>;
@group(1) @binding(1) var visible_uv: texture_2d<f32>;

fn limit_at(pixel: vec2u, patch_id: u32) -> LimitPoint {
    return limit_point(textureLoad(patches, at(patch_id), 0), textureLoad(visible_uv, pixel, 0).xy);
}

@fragment
fn limit(@builtin(position) position: vec4f) -> @location(0) vec4u {
    let pixel = vec2u(position.xy);
    let patch_id = textureLoad(visible_patch, pixel, 0).x - 1u;
    let p = limit_at(pixel, patch_id);
    return packed_surface(patch_id, p.position, p.normal, p.curvature);
}

@fragment
fn limit_full(@builtin(position) position: vec4f) -> Surface {
    let pixel = vec2u(position.xy);
    let patch_id = textureLoad(visible_patch, pixel, 0).x - 1u;
    let p = limit_at(pixel, patch_id);
    return surface(patch_id, p.position, p.normal, p.curvature);
}

// The same as a compute pass: `--stage compute`.
@group(2) @binding(0) var packed_out: texture_storage_2d<rgba32uint, write>;

@compute @workgroup_size(TILE_SIDE, TILE_SIDE)
fn limit_compute(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(visible_patch)) {
        return;
    }
    let found = textureLoad(visible_patch, id.xy, 0).x;
    var packed = vec4u(0u);
    if found > 0u {
        let p = limit_at(id.xy, found - 1u);
        packed = packed_surface(found - 1u, p.position, p.normal, p.curvature);
    }
    textureStore(packed_out, id.xy, packed);
}
