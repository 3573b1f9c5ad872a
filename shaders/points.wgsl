// The last passes of Yasui & Kanai's own pipeline (2004, sec. 4.4, fig. 5): the exact position at every texel of the
// parameters, and the texels drawn as points where those positions project to. Follows visibility.wgsl. Host side:
// passes/points.rs.

@group(1) @binding(1) var visible_patch: texture_2d<u32>;
@group(1) @binding(2) var visible_uv: texture_2d<f32>;
@group(1) @binding(3) var positions: texture_2d<f32>;
@group(1) @binding(4) var colours: texture_2d<f32>;

// "Positions are computed in the fragment program": relative to the patch's origin.
@fragment
fn position(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let record = textureLoad(patches, at(textureLoad(visible_patch, texel, 0).x - 1u), 0);
    return vec4f(limit_point(record, textureLoad(visible_uv, texel, 0).xy).position, 1.0);
}

struct Point {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) texel: vec2u,
}

// "The data in each fragment corresponds to the position or the color of one vertex."
@vertex
fn point(@builtin(vertex_index) index: u32) -> Point {
    let width = textureDimensions(visible_patch).x;
    let texel = vec2u(index % width, index / width);
    let patch_id = textureLoad(visible_patch, texel, 0).x;
    if patch_id == 0u {
        return Point(vec4f(2.0, 2.0, 0.0, 1.0), texel);
    }
    return Point(projected(patch_id - 1u, textureLoad(positions, texel, 0).xyz), texel);
}

@fragment
fn landed(p: Point) -> @location(0) vec4f {
    return textureLoad(colours, p.texel, 0);
}

// For reading back: what landed on a pixel, rather than its colour.
@fragment
fn landed_full(p: Point) -> Visible {
    return Visible(textureLoad(visible_patch, p.texel, 0).x, textureLoad(visible_uv, p.texel, 0).xy);
}
