// Distance of the mirrored ray from the nearest light line. f64 twin: src/field/distance.rs.

fn field_value(seen: Seen) -> FieldValue {
    return nearest_line(seen.place, mirrored(seen));
}
