// The same surface record from interpolated positions and normals: what everyone else does, for comparison
// (Yasui & Kanai 2004, fig. 7b). Host side: passes/limit.rs.

@group(1) @binding(0) var visible_patch: texture_2d<u32>;
@group(1) @binding(1) var proxy_position: texture_2d<f32>;
@group(1) @binding(2) var proxy_normal: texture_2d<f32>;

@fragment
fn polygon(@builtin(position) pixel: vec4f) -> Surface {
    let tile = in_tile(pixel.xy);
    if is_outside(tile) {
        return background();
    }
    let id = textureLoad(visible_patch, tile, 0).x;
    if id == 0u {
        return background();
    }
    return surface(id - 1u, textureLoad(proxy_position, tile, 0).xyz, textureLoad(proxy_normal, tile, 0).xyz);
}
