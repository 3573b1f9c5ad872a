// The point itself, in coordinates of the light plane. f64 twin: Light::coordinates.

fn field_value(seen: Seen) -> FieldValue {
    let d = seen.place - light.center;
    return valued(dot(d, light.axis_x), dot(d, light.axis_y), true);
}
