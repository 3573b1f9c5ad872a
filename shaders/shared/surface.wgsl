// What the limit and polygon passes find out at a pixel: in full for reading back, packed for shading.

struct Surface {
    // Relative to the patch's origin.
    @location(0) position: vec4f,
    // Unit normal of the parametrisation.
    @location(1) normal: vec4f,
    // Field value; z: 1 where it is defined.
    @location(2) field: vec4f,
}

@group(0) @binding(3) var views: texture_2d<f32>;
@group(0) @binding(4) var<uniform> light: Light;

// From the viewpoint to a surface point: both relative to the patch's origin, so no digits are lost far away.
fn from_viewpoint(patch_id: u32, position: vec3f) -> vec3f {
    return position - textureLoad(views, at(2u * patch_id + 1u), 0).xyz;
}

fn surface(patch_id: u32, position: vec3f, normal: vec3f) -> Surface {
    let place = from_viewpoint(patch_id, position);
    let value = field_value(place, sight_to(place), normal);
    return Surface(vec4f(position, 0.0), vec4f(normal, 0.0), vec4f(value.point, value.defined, 0.0));
}

// x, y: field value; z: the normal; w: cosine between the normal and the line of sight (negative where the back is seen)
// and sine of the mirrored ray's elevation over the light plane, -1 where the field is undefined. Zero: no surface.
fn packed_surface(patch_id: u32, position: vec3f, normal: vec3f) -> vec4u {
    let place = from_viewpoint(patch_id, position);
    let line = sight_to(place);
    let value = field_value(place, line, normal);
    let facing = -dot(normal, line) / length(line);
    let elevation = select(-1.0, max(value.elevation, 1e-4), value.defined > 0.0);
    return vec4u(bitcast<vec2u>(value.point), pack2x16snorm(octahedral(normal)),
        pack2x16snorm(vec2f(facing, elevation)));
}
