// What the limit and polygon passes write: all that shading needs to know of the surface at a pixel.

struct Surface {
    // Relative to the patch's origin; w: cosine between the normal and the line of sight, 0 to 1.
    @location(0) position: vec4f,
    // Unit normal of the parametrisation; w: sine of the mirrored ray's elevation over the light plane.
    @location(1) normal: vec4f,
    // Field value; z: 1 where it is defined; w: 1 where the pixel is covered.
    @location(2) field: vec4f,
}

@group(0) @binding(3) var views: texture_2d<f32>;
@group(0) @binding(4) var<uniform> light: Light;
@group(0) @binding(5) var<uniform> band: Band;

fn surface(patch_id: u32, position: vec3f, normal: vec3f) -> Surface {
    // From the eye to the surface point: both relative to the patch's origin, so no digits are lost far away.
    let sight = position - textureLoad(views, at(2u * patch_id + 1u), 0).xyz;
    let value = field_value(sight, normal);
    let facing = abs(dot(normal, sight)) / length(sight);
    return Surface(vec4f(position, facing), vec4f(normal, value.elevation), vec4f(value.point, value.defined, 1.0));
}

fn background() -> Surface {
    return Surface(vec4f(0.0), vec4f(0.0), vec4f(0.0));
}

// Tile coordinates of a pixel of the surface textures, and whether the tile has it.
fn in_tile(pixel: vec2f) -> vec2i {
    return vec2i(pixel) + vec2i(0, band.first);
}

fn is_outside(at: vec2i) -> bool {
    return at.y < 0 || at.y >= band.rows;
}
