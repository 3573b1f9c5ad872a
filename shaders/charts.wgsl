// The point of the limit surface that each sample sees first: Newton's method on every chart that may cover it; the depth
// buffer keeps the nearest. Host side: passes/charts.rs; what a chart is, and why the method must converge:
// src/gpu/charts/mod.rs.

struct Found {
    // Patch + 1: 0 is the background.
    @location(0) patch_id: u32,
    @location(1) uv: vec2f,
    // Bits 0 to 15: distance in samples between the point and the sample's ray (residual_bits); 16 to 23: steps; then: state.
    @location(2) certificate: u32,
    @builtin(frag_depth) depth: f32,
}

fn bernstein(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
}

fn bernstein_derivative(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t);
}

// How far a point is beyond the diagonal where a triangle ends, if the chart is one that crosses it: half of what u + v is too
// much for each, but none is left below zero. The diagonal is at the next power of two above u + v of the chart's first corner; of charts in triangles
// that are turned, whose size is below zero, at the next one below.
fn overshoot(c: Corner, t: vec2f) -> vec2f {
    if c.start.z > 0.0 {
        return vec2f(0.0);
    }
    let turned = c.place.z < 0.0;
    let first = c.place.x + c.place.y;
    let bits = bitcast<u32>(first);
    // Below a power of two, and above anything else, the exponents differ by one.
    let exponent = (bits >> 23u) - select(0u, 1u, turned && (bits & 0x7fffffu) == 0u);
    let diagonal = bitcast<f32>((exponent + select(1u, 0u, turned)) << 23u);
    let size = abs(c.place.zw);
    let inside = select(diagonal - first, first - diagonal, turned);
    let place = size * t;
    let excess = max(place.x + place.y - inside, 0.0);
    let from_v = min(excess - min(0.5 * excess, place.x), place.y);
    return vec2f(excess - from_v, from_v) / size;
}

@fragment
fn visible(c: Corner) -> Found {
    let d = c.clip.xy - bitcast<vec2f>(c.id.yz);
    let m = c.inverse;
    var t = clamp(c.start.xy + vec2f(dot(m.xy, d), dot(m.zw, d)), vec2f(0.0), vec2f(1.0));
    var steps = 0u;
    var moved = 0.0;
    var beyond = 0.0;
    var a = vec2f(0.0);
    var b = vec2f(0.0);
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
        b = vec2f(dot(lx, cv), dot(ly, cv)) - w * dot(lz, cv);
        let sx = vec4f(dot(c.x0, cu), dot(c.x1, cu), dot(c.x2, cu), dot(c.x3, cu));
        let sy = vec4f(dot(c.y0, cu), dot(c.y1, cu), dot(c.y2, cu), dot(c.y3, cu));
        let sz = vec4f(dot(c.z0, cu), dot(c.z1, cu), dot(c.z2, cu), dot(c.z3, cu));
        a = vec2f(dot(sx, bv), dot(sy, bv)) - w * dot(sz, bv);
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
    // What lies beyond the diagonal of a triangle goes back to it.
    let past = overshoot(c, t);
    t -= past;
    beyond = max(beyond, length(a * past.x + b * past.y));
    let uv = c.place.xy + c.place.zw * t;
    let bu = bernstein(t.x);
    let bv = bernstein(t.y);
    let x = dot(vec4f(dot(c.x0, bu), dot(c.x1, bu), dot(c.x2, bu), dot(c.x3, bu)), bv);
    let y = dot(vec4f(dot(c.y0, bu), dot(c.y1, bu), dot(c.y2, bu), dot(c.y3, bu)), bv);
    let z = dot(vec4f(dot(c.z0, bu), dot(c.z1, bu), dot(c.z2, bu), dot(c.z3, bu)), bv);
    let weight = 1.0 + z * lens.perspective;
    // What the sample sees of the point, and what rounding moves it by where (u,v) are handed on: a bound, for compilers undo
    // the rounding of sums that they see through.
    let rounding = (length(a) * uv.x / abs(c.place.z) + length(b) * uv.y / abs(c.place.w)) * 5.9604645e-8;
    let residual = (length(vec2f(x, y) - d * weight) + rounding) / weight;
    let depth = lens.scale * (bitcast<f32>(c.id.w) - z) / weight;
    let converged = moved < SETTLED;
    // Greater than 1: before the near plane of an orthographic view.
    if depth > 1.0 || converged && beyond > BAND * weight {
        discard;
    }
    let state = select(STATE_DOUBTFUL, STATE_CHART, converged);
    return Found(c.id.x, uv, residual_bits(residual) | (steps << 16u) | (state << 24u), depth);
}
