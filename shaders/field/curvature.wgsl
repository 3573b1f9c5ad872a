// A curvature. f64 twin: src/field/curvature.rs, stam/curvature.rs.

fn field_value(seen: Seen) -> FieldValue {
    let mean = seen.curvature.x;
    let gaussian = seen.curvature.y;
    let spread = sqrt(max(mean * mean - gaussian, 0.0));
    var value = mean;
    switch light.kind {
        case CURVATURE_GAUSSIAN: { value = gaussian; }
        case CURVATURE_LARGEST: { value = mean + spread; }
        case CURVATURE_SMALLEST: { value = mean - spread; }
        default: {}
    }
    return valued(value, 0.0, seen.curvature.z > 0.0);
}
