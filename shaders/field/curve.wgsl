// A function g of the point of the light plane that the surface mirrors into the eye (Ulmet 2003, Theorem RC). `curve` is
// written by src/gpu/fields.rs, in world units. f64 twin: src/field/curve.rs.

fn field_value(seen: Seen) -> FieldValue {
    let hit = on_plane(seen.place, mirrored(seen), false);
    let at = hit.point * light.unit;
    let value = curve(at.x, at.y);
    // Written so that NaN has no value.
    let finite = abs(value) < 3e38;
    return FieldValue(vec2f(select(0.0, value, finite), 0.0), select(0.0, hit.defined, finite), hit.elevation);
}
