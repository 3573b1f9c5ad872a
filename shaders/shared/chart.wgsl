// A chart on its way from the table to its fragments. Host side: src/gpu/charts, records.rs.

// A chart, the same for all its fragments. id: patch + 1; x, y (samples) of its middle and how far its depth is before the farthest, in
// perspective as part of itself, as bits. inverse: of the
// linear map from (u,v) to samples, row by row. start: (u,v) that it gives the middle; half the sides of the rectangle round
// (1/2,1/2) where it sees all that the chart covers, the first of them below zero if the chart ends at a diagonal. place: origin and size in the patch. x0 .. z3: rows of v of Bezier points,
// x and y in samples from the middle, times weight, and depth. Weight and depth are parts of those of the middle, less one
// (perspective); or the weight is one, and the depth is less that of the middle.
struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) id: vec4u,
    @location(1) @interpolate(flat, either) inverse: vec4f,
    @location(2) @interpolate(flat, either) start: vec4f,
    @location(3) @interpolate(flat, either) place: vec4f,
    @location(4) @interpolate(flat, either) x0: vec4f,
    @location(5) @interpolate(flat, either) y0: vec4f,
    @location(6) @interpolate(flat, either) z0: vec4f,
    @location(7) @interpolate(flat, either) x1: vec4f,
    @location(8) @interpolate(flat, either) y1: vec4f,
    @location(9) @interpolate(flat, either) z1: vec4f,
    @location(10) @interpolate(flat, either) x2: vec4f,
    @location(11) @interpolate(flat, either) y2: vec4f,
    @location(12) @interpolate(flat, either) z2: vec4f,
    @location(13) @interpolate(flat, either) x3: vec4f,
    @location(14) @interpolate(flat, either) y3: vec4f,
    @location(15) @interpolate(flat, either) z3: vec4f,
}

struct Lens {
    // Samples.
    size: vec2f,
    // 1 in perspective, else 0.
    perspective: f32,
    // What makes 1 of the nearest depth in the depth buffer; the farthest is 0.
    scale: f32,
}

@group(0) @binding(0) var<uniform> lens: Lens;
// CHART_TEXELS a chart, as in Corner. (Instances cost software adapters microseconds each, and charts are many and small.)
@group(0) @binding(1) var charts: texture_2d<u32>;

fn texel(index: u32) -> vec4u {
    return textureLoad(charts, vec2u(index % TABLE_WIDTH, index / TABLE_WIDTH), 0);
}

// The parallelogram that the linear map makes of the square.
@vertex
fn corner(@builtin(vertex_index) i: u32) -> Corner {
    let first = (i >> 2u) * CHART_TEXELS;
    var c: Corner;
    c.id = texel(first);
    c.inverse = bitcast<vec4f>(texel(first + 1u));
    c.start = bitcast<vec4f>(texel(first + 2u));
    c.place = bitcast<vec4f>(texel(first + 3u));
    c.x0 = bitcast<vec4f>(texel(first + 4u));
    c.y0 = bitcast<vec4f>(texel(first + 5u));
    c.z0 = bitcast<vec4f>(texel(first + 6u));
    c.x1 = bitcast<vec4f>(texel(first + 7u));
    c.y1 = bitcast<vec4f>(texel(first + 8u));
    c.z1 = bitcast<vec4f>(texel(first + 9u));
    c.x2 = bitcast<vec4f>(texel(first + 10u));
    c.y2 = bitcast<vec4f>(texel(first + 11u));
    c.z2 = bitcast<vec4f>(texel(first + 12u));
    c.x3 = bitcast<vec4f>(texel(first + 13u));
    c.y3 = bitcast<vec4f>(texel(first + 14u));
    c.z3 = bitcast<vec4f>(texel(first + 15u));
    let side = vec2f(f32(i & 1u), f32((i >> 1u) & 1u)) * 2.0 - 1.0;
    let t = 0.5 + side * abs(c.start.zw) - c.start.xy;
    let m = c.inverse;
    let d = vec2f(m.w * t.x - m.y * t.y, m.x * t.y - m.z * t.x) / (m.x * m.w - m.y * m.z);
    let ndc = (bitcast<vec2f>(c.id.yz) + d) / lens.size * 2.0 - 1.0;
    c.clip = vec4f(ndc.x, -ndc.y, 0.5, 1.0);
    return c;
}
