// The point of a plane light source that the surface mirrors into the eye. f64 twin: src/field/reflection.rs.

fn field_value(seen: Seen) -> FieldValue {
    return on_plane(seen.place, mirrored(seen), false);
}
