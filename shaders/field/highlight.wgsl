// Highlight lines and bands: the surface normal, as a line, against the light lines (Beier & Chen 1994). f64 twin:
// src/field/highlight.rs.

fn field_value(seen: Seen) -> FieldValue {
    let across = cross(light.axis_y, seen.normal);
    let pseudo = dot(across, light.center - seen.place);
    let size = length(across);
    switch light.kind {
        case HIGHLIGHT_SIGNED: { return valued(pseudo / select(1.0, size, size > 0.0), 0.0, size > 0.0); }
        case HIGHLIGHT_NEAREST: { return nearest_line(seen.place, seen.normal); }
        case HIGHLIGHT_PSEUDO: { return valued(pseudo, 0.0, true); }
        case HIGHLIGHT_ALTERNATIVE: { return valued(pseudo - light.parameter * size, 0.0, true); }
        default: { return on_plane(seen.place, seen.normal, true); }
    }
}
