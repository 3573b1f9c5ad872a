// Exact limit position, normal and field at every pixel's (patch, u, v). Host side: passes/limit.rs.

@group(1) @binding(0) var visible_patch: texture_2d<u32>;
@group(1) @binding(1) var visible_uv: texture_2d<f32>;

@fragment
fn limit(@builtin(position) pixel: vec4f) -> Surface {
    let tile = in_tile(pixel.xy);
    if is_outside(tile) {
        return background();
    }
    let id = textureLoad(visible_patch, tile, 0).x;
    if id == 0u {
        return background();
    }
    let p = limit_point(textureLoad(patches, at(id - 1u), 0), textureLoad(visible_uv, tile, 0).xy);
    return surface(id - 1u, p.position, p.normal);
}
