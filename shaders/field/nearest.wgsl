// Distance of a line from the light lines. f64 twin: src/field/distance.rs.

// Signed distance of the line through `place` from the nearest of the light lines, and which that is (Ulmet 2003, eq. 4.2;
// Beier & Chen 1994, eq. 7).
fn nearest_line(place: vec3f, ray: vec3f) -> FieldValue {
    let across = cross(normalize(ray), light.axis_y);
    let size = length(across);
    let defined = size > 0.0;
    let over = 1.0 / select(1.0, size, defined);
    let first = dot(across, light.center - place) * over;
    let step = dot(across, light.axis_x) * over * light.lines;
    let last = floor(light.half_x / light.lines);
    let nearest = select(clamp(round(-first / select(1.0, step, step != 0.0)), -last, last), 0.0, step == 0.0);
    return valued(first + nearest * step, nearest, defined);
}
