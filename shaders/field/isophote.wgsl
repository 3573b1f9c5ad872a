// Angle between the normal and the direction to a light far away, in degrees. f64 twin: src/field/isophote.rs.

fn field_value(seen: Seen) -> FieldValue {
    let to_light = -light_normal();
    return valued(degrees(atan2(length(cross(seen.normal, to_light)), dot(seen.normal, to_light))), 0.0, true);
}
