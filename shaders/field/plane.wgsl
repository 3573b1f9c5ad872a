// Where a ray meets the light plane. f64 twin: src/field/reflection.rs.

// Yasui & Kanai 2004, sec. 3.1; Ulmet 2003, eq. 5.7. As a line, the ray counts in both directions.
fn on_plane(place: vec3f, ray: vec3f, as_line: bool) -> FieldValue {
    let plane = light_normal();
    let to_center = light.center - place;
    let along = dot(ray, plane);
    let height = dot(to_center, plane);
    // t > 0: numerator and denominator have the same sign.
    let meets = select(along * height > 0.0, along != 0.0, as_line);
    let t = height / select(1.0, along, meets);
    let hit = ray * t - to_center;
    let point = select(vec2f(0.0), vec2f(dot(hit, light.axis_x), dot(hit, light.axis_y)), meets);
    return FieldValue(point, select(0.0, 1.0, meets), abs(along) / length(ray));
}
