// A uniform bicubic B-spline whose control values are the texels of a picture. f64 twin: src/field/curve/grid.rs.

@group(0) @binding(5) var grid: texture_2d<f32>;

fn cubic_weights(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s * s * s, t * t * (3.0 * t - 6.0) + 4.0, s * s * (3.0 * s - 6.0) + 4.0, t * t * t) / 6.0;
}

// `texels`: from the picture's middle, y downwards. Beyond 3e38 where there is no value.
fn grid_value(texels: vec2f) -> f32 {
    let size = vec2f(textureDimensions(grid));
    let s = texels + 0.5 * size - 0.5;
    let last = size - 2.0;
    if !(all(s >= vec2f(1.0)) && all(s <= last)) {
        return 3.4e38;
    }
    let first = min(floor(s), last - 1.0);
    let across = cubic_weights(s.x - first.x);
    let down = cubic_weights(s.y - first.y);
    let corner = vec2i(first) - 1;
    var sum = 0.0;
    for (var j = 0; j < 4; j++) {
        var row = vec4f(0.0);
        for (var i = 0; i < 4; i++) {
            row[i] = textureLoad(grid, corner + vec2i(i, j), 0).x;
        }
        sum += down[j] * dot(row, across);
    }
    return sum;
}
