// The light that fields are read by, and what they say. Host side: src/gpu/fields.rs.

struct Light {
    // Relative to the viewpoint: the eye, or a point of an orthographic line of sight.
    center: vec3f,
    // Period of the pattern, in units of the field.
    spacing: f32,
    axis_x: vec3f,
    half_x: f32,
    axis_y: vec3f,
    half_y: f32,
    // Direction of sight in an orthographic view, else zero.
    sight: vec3f,
    // 1 in perspective, else 0.
    from_eye: f32,
    // Which kind of the method's: constants of the shader.
    kind: u32,
    // A number of the method's.
    parameter: f32,
    // Distance between light lines.
    lines: f32,
    // World units in 1.
    unit: f32,
}

// What a pixel shows, relative to the viewpoint.
struct Seen {
    place: vec3f,
    // Along the line of sight to it.
    sight: vec3f,
    // Of unit length.
    normal: vec3f,
    // Mean and Gaussian curvature; z: 1 where there are such.
    curvature: vec3f,
}

struct FieldValue {
    point: vec2f,
    // 1 where the field has a value, else 0.
    defined: f32,
    // Sine of a mirrored ray's elevation over the light plane; 1 for other fields.
    elevation: f32,
}

// Along the line of sight to a point, `place` relative to the viewpoint.
fn sight_to(place: vec3f) -> vec3f {
    return light.sight + place * light.from_eye;
}

// The mirrored line of sight: Yasui & Kanai 2004, eq. 1.
fn mirrored(seen: Seen) -> vec3f {
    return seen.sight - seen.normal * (2.0 * dot(seen.sight, seen.normal));
}

fn light_normal() -> vec3f {
    return cross(light.axis_x, light.axis_y);
}

fn valued(x: f32, y: f32, defined: bool) -> FieldValue {
    return FieldValue(select(vec2f(0.0), vec2f(x, y), defined), select(0.0, 1.0, defined), 1.0);
}
