// Longitude and latitude, in degrees, on a sphere round the scene. f64 twin: src/field/sphere.rs.

fn field_value(seen: Seen) -> FieldValue {
    let d = normalize(select(seen.normal, mirrored(seen), light.kind == SPHERE_REFLECTION));
    let x = dot(d, light.axis_x);
    let y = dot(d, light.axis_y);
    let across = length(vec2f(x, y));
    return valued(degrees(atan2(y, x)), degrees(atan2(-dot(d, light_normal()), across)), across > 0.0);
}
