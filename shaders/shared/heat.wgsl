// False colours, linear RGB. Twin: output::Scale.

// Between five colours, t from 0 to 1.
fn stops(colours: array<vec3f, 5>, t: f32) -> vec3f {
    let at = clamp(t, 0.0, 1.0) * 4.0;
    var table = colours;
    let k = min(u32(at), 3u);
    return mix(table[k], table[k + 1u], at - f32(k));
}

fn to_linear(srgb: vec3f) -> vec3f {
    return select(pow((srgb + 0.055) / 1.055, vec3f(2.4)), srgb / 12.92, srgb <= vec3f(0.04045));
}

// A value on a scale from range.x to range.y; from blue over white to red where that has 0 inside.
fn false_colour(value: f32, range: vec2f, defined: bool) -> vec3f {
    let t = clamp((value - range.x) / (range.y - range.x), 0.0, 1.0);
    var colour = stops(HEAT_COLOURS, t);
    if range.x * range.y < 0.0 {
        let signed = select(-value / range.x, value / range.y, value > 0.0);
        colour = stops(DIVERGING_COLOURS, 0.5 + 0.5 * clamp(signed, -1.0, 1.0));
    }
    return to_linear(select(UNDEFINED_COLOUR, colour, defined));
}
