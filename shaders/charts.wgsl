// The point of the limit surface that each sample sees first: Newton's method on every chart that may cover it; the depth
// buffer keeps the nearest. Host side: passes/charts.rs; what a chart is, and why the method must converge:
// src/gpu/charts/mod.rs.

// A chart, the same for all its fragments. id: patch + 1; x, y (samples) and depth of its middle, as bits. inverse: of the
// linear map from (u,v) to samples, row by row. start: (u,v) that it gives the middle; half the side of the square round
// (1/2,1/2) where it sees all that the chart covers. place: origin and size in the patch. x0 .. z3: rows of v of Bezier points,
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

struct Found {
    // Patch + 1: 0 is the background.
    @location(0) patch_id: u32,
    @location(1) uv: vec2f,
    // Bits 0 to 15: distance in samples between the point and the sample's ray, as the upper half of an f32, rounded up. Then 8 bits: steps. Then: state.
    @location(2) certificate: u32,
    @builtin(frag_depth) depth: f32,
}

struct Lens {
    // Samples.
    size: vec2f,
    // 1 in perspective, else 0.
    perspective: f32,
    // Depth that the depth buffer shows as 1.
    near: f32,
    // Orthographic: depth that it shows as 0, and its scale.
    far: f32,
    scale: f32,
    padding: vec2f,
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
    let t = 0.5 + side * c.start.z - c.start.xy;
    let m = c.inverse;
    let d = vec2f(m.w * t.x - m.y * t.y, m.x * t.y - m.z * t.x) / (m.x * m.w - m.y * m.z);
    let ndc = (bitcast<vec2f>(c.id.yz) + d) / lens.size * 2.0 - 1.0;
    c.clip = vec4f(ndc.x, -ndc.y, 0.5, 1.0);
    return c;
}

fn bernstein(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
}

fn bernstein_derivative(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t);
}

@fragment
fn visible(c: Corner) -> Found {
    let d = c.clip.xy - bitcast<vec2f>(c.id.yz);
    let m = c.inverse;
    var t = clamp(c.start.xy + vec2f(dot(m.xy, d), dot(m.zw, d)), vec2f(0.0), vec2f(1.0));
    var steps = 0u;
    var moved = 0.0;
    var beyond = 0.0;
    loop {
        let bu = bernstein(t.x);
        let bv = bernstein(t.y);
        let cu = bernstein_derivative(t.x);
        let cv = bernstein_derivative(t.y);
        // x and y minus the sample's times weight: zero where it sees the point.
        let w = d * lens.perspective;
        let lx = vec4f(dot(c.x0, bu), dot(c.x1, bu), dot(c.x2, bu), dot(c.x3, bu));
        let ly = vec4f(dot(c.y0, bu), dot(c.y1, bu), dot(c.y2, bu), dot(c.y3, bu));
        let lz = vec4f(dot(c.z0, bu), dot(c.z1, bu), dot(c.z2, bu), dot(c.z3, bu));
        let g = vec2f(dot(lx, bv), dot(ly, bv)) - d - w * dot(lz, bv);
        let b = vec2f(dot(lx, cv), dot(ly, cv)) - w * dot(lz, cv);
        let sx = vec4f(dot(c.x0, cu), dot(c.x1, cu), dot(c.x2, cu), dot(c.x3, cu));
        let sy = vec4f(dot(c.y0, cu), dot(c.y1, cu), dot(c.y2, cu), dot(c.y3, cu));
        let sz = vec4f(dot(c.z0, cu), dot(c.z1, cu), dot(c.z2, cu), dot(c.z3, cu));
        let a = vec2f(dot(sx, bv), dot(sy, bv)) - w * dot(sz, bv);
        let goal = t + vec2f(g.y * b.x - g.x * b.y, g.x * a.y - g.y * a.x) / (a.x * b.y - a.y * b.x);
        let next = clamp(goal, vec2f(0.0), vec2f(1.0));
        moved = length(a * (next.x - t.x) + b * (next.y - t.y));
        beyond = length(a * (goal.x - next.x) + b * (goal.y - next.y));
        t = next;
        steps++;
        if !(moved >= SETTLED && steps < MOST_STEPS) {
            break;
        }
    }
    // What the sample sees of the point at the (u,v) that is handed on, with its rounding.
    let uv = c.place.xy + c.place.zw * t;
    let r = (uv - c.place.xy) / c.place.zw;
    let bu = bernstein(r.x);
    let bv = bernstein(r.y);
    let x = dot(vec4f(dot(c.x0, bu), dot(c.x1, bu), dot(c.x2, bu), dot(c.x3, bu)), bv);
    let y = dot(vec4f(dot(c.y0, bu), dot(c.y1, bu), dot(c.y2, bu), dot(c.y3, bu)), bv);
    let z = dot(vec4f(dot(c.z0, bu), dot(c.z1, bu), dot(c.z2, bu), dot(c.z3, bu)), bv);
    let weight = 1.0 + z * lens.perspective;
    let residual = length(vec2f(x, y) - d * weight) / weight;
    let middle = bitcast<f32>(c.id.w);
    let depth = select((lens.far - middle - z) * lens.scale, lens.near / (middle + middle * z), lens.perspective > 0.0);
    let converged = moved < SETTLED;
    // Greater than 1: before the near plane of an orthographic view.
    if depth > 1.0 || converged && beyond > BAND * weight {
        discard;
    }
    let state = select(STATE_DOUBTFUL, STATE_CHART, converged);
    return Found(c.id.x, uv, ((bitcast<u32>(residual) + 0xffffu) >> 16u) | (steps << 16u) | (state << 24u), depth);
}
