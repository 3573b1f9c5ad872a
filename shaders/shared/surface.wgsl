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

// A point relative to its patch's origin, as the viewpoint sees it; the difference loses no digits far away.
fn seen_at(patch_id: u32, position: vec3f, normal: vec3f, curvature: vec3f) -> Seen {
    let place = position - textureLoad(views, at(2u * patch_id + 1u), 0).xyz;
    return Seen(place, sight_to(place), normal, curvature);
}

fn surface(patch_id: u32, position: vec3f, normal: vec3f, curvature: vec3f) -> Surface {
    let value = field_value(seen_at(patch_id, position, normal, curvature));
    return Surface(vec4f(position, 0.0), vec4f(normal, 0.0), vec4f(value.point, value.defined, 0.0));
}

// x, y: field value; z: the normal; w: cosine between the normal and the line of sight (negative where the back is seen)
// and the elevation of the field value, -1 where the field is undefined. Zero: no surface.
fn packed_surface(patch_id: u32, position: vec3f, normal: vec3f, curvature: vec3f) -> vec4u {
    let seen = seen_at(patch_id, position, normal, curvature);
    let value = field_value(seen);
    let facing = -dot(normal, seen.sight) / length(seen.sight);
    let elevation = select(-1.0, max(value.elevation, 1e-4), value.defined > 0.0);
    return vec4u(bitcast<vec2u>(value.point), pack2x16snorm(octahedral(normal)),
        pack2x16snorm(vec2f(facing, elevation)));
}
