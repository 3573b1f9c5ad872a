// The point of a plane light source that the surface mirrors into the eye. f64 twin: src/field/reflection.rs.

struct Light {
    // Relative to the viewpoint: the eye, or a point of an orthographic line of sight.
    center: vec3f,
    spacing: f32,
    axis_x: vec3f,
    half_x: f32,
    axis_y: vec3f,
    half_y: f32,
    // Direction of sight in an orthographic view, else zero.
    sight: vec3f,
    // 1 in perspective, else 0.
    from_eye: f32,
}

struct FieldValue {
    point: vec2f,
    // 1 where the mirrored ray meets the plane, else 0.
    defined: f32,
    elevation: f32,
}

// Along the line of sight to a point, `place` relative to the viewpoint.
fn sight_to(place: vec3f) -> vec3f {
    return light.sight + place * light.from_eye;
}

// `place`: the surface point relative to the viewpoint; `sight`: along the line of sight to it. Yasui & Kanai 2004, eq. 1
// and sec. 3.1; Ulmet 2003, eq. 5.7.
fn field_value(place: vec3f, sight: vec3f, normal: vec3f) -> FieldValue {
    let ray = sight - normal * (2.0 * dot(sight, normal));
    let plane = cross(light.axis_x, light.axis_y);
    let to_center = light.center - place;
    let along = dot(ray, plane);
    let height = dot(to_center, plane);
    // t > 0: numerator and denominator have the same sign.
    let meets = along * height > 0.0;
    let t = height / select(1.0, along, meets);
    let hit = ray * t - to_center;
    let point = select(vec2f(0.0), vec2f(dot(hit, light.axis_x), dot(hit, light.axis_y)), meets);
    return FieldValue(point, select(0.0, 1.0, meets), abs(along) / length(ray));
}
