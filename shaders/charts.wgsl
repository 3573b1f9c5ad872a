// The point of the limit surface that each sample sees first: Newton's method on the charts that may cover it, nearest
// first. Host side: passes/charts.rs; what a chart is, and why the method must converge: src/gpu/charts/mod.rs.

// CHART_TEXELS a chart. 0: centre (samples), depth that nothing of it is nearer than, depth in the middle. 1: inverse of the
// linear map, row by row. 2: (u,v) that it gives the centre; half the side of the square round (1/2,1/2) where it sees all
// that the chart covers; patch. 3: origin and size in the patch. 4..15: rows of v of Bezier points: x, y, depth, where x and y
// are samples from the centre times weight, and depth and weight are relative to those in the middle.
@group(0) @binding(0) var charts: texture_2d<u32>;
// First and end of the list of every tile of CHART_TILE samples.
@group(0) @binding(1) var tiles: texture_2d<u32>;
@group(0) @binding(2) var list: texture_2d<u32>;
// What has been solved already: patch + 1, u, v, depth.
@group(0) @binding(3) var specks: texture_2d<u32>;
@group(0) @binding(4) var<uniform> sight_in: SightIn;

struct SightIn {
    // 1 in perspective: weight is depth; else 0: weight is 1.
    perspective: f32,
    padding0: f32,
    padding1: f32,
    padding2: f32,
}

struct Found {
    // Patch id + 1: 0 is the background.
    @location(0) patch_id: u32,
    @location(1) uv: vec2f,
    // Bits 0 to 15: distance in samples between the point and the sample's ray, as f16. Then 8 bits: steps. Then: state.
    @location(2) certificate: u32,
    // The mask of the passes that follow.
    @builtin(frag_depth) mask: f32,
}

struct Net {
    rows: array<mat3x4f, 4>,
}

struct ChartPoint {
    value: vec3f,
    du: vec3f,
    dv: vec3f,
}

fn chart_texel(index: u32) -> vec4f {
    return bitcast<vec4f>(textureLoad(charts, at(index), 0));
}

fn bernstein(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t);
}

fn bernstein_derivative(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t);
}

// x and y minus the sample's times weight: zero where it sees the point.
fn miss(value: vec3f, d: vec2f) -> vec2f {
    return value.xy - d * mix(1.0, value.z, sight_in.perspective);
}

@fragment
fn visible(@builtin(position) position: vec4f) -> Found {
    let sample = vec2u(position.xy);
    let speck = textureLoad(specks, sample, 0);
    var patch_id = speck.x;
    var uv = bitcast<vec2f>(speck.yz);
    var depth = select(3.0e38, bitcast<f32>(speck.w), patch_id > 0u);
    var certificate = select(0u, STATE_SOLVED << 24u, patch_id > 0u);

    let range = textureLoad(tiles, sample / CHART_TILE, 0).xy;
    var k = range.x;
    var doubt = 0u;
    loop {
        // The next chart that may cover the sample. Charts are looked for in a loop of their own because software adapters compute
        // whatever stands in a branch or before a break for samples that do not need it.
        var chart = 0u;
        var start = vec2f(0.0);
        var d = vec2f(0.0);
        var covers = false;
        loop {
            if k >= range.y {
                break;
            }
            chart = CHART_TEXELS * textureLoad(list, at(k), 0).x;
            let c = chart_texel(chart);
            let inverse = chart_texel(chart + 1u);
            let s = chart_texel(chart + 2u);
            if c.z >= depth {
                k = range.y;
                break;
            }
            k++;
            d = position.xy - c.xy;
            start = s.xy + vec2f(dot(inverse.xy, d), dot(inverse.zw, d));
            covers = max(abs(start.x - 0.5), abs(start.y - 0.5)) <= s.z;
            if covers {
                break;
            }
        }
        if !covers {
            break;
        }
        var x: array<vec4f, 4>;
        var y: array<vec4f, 4>;
        var z: array<vec4f, 4>;
        for (var j = 0u; j < 4u; j++) {
            x[j] = chart_texel(chart + 4u + 3u * j);
            y[j] = chart_texel(chart + 5u + 3u * j);
            z[j] = chart_texel(chart + 6u + 3u * j);
        }
        var t = clamp(start, vec2f(0.0), vec2f(1.0));
        var steps = 0u;
        var moved = 0.0;
        var beyond = 0.0;
        var value = vec3f(0.0);
        loop {
            let bu = bernstein(t.x);
            let bv = bernstein(t.y);
            let cu = bernstein_derivative(t.x);
            let cv = bernstein_derivative(t.y);
            value = vec3f(0.0);
            var du = vec3f(0.0);
            var dv = vec3f(0.0);
            for (var j = 0u; j < 4u; j++) {
                let line = vec3f(dot(x[j], bu), dot(y[j], bu), dot(z[j], bu));
                value += line * bv[j];
                du += vec3f(dot(x[j], cu), dot(y[j], cu), dot(z[j], cu)) * bv[j];
                dv += line * cv[j];
            }
            let g = miss(value, d);
            let a = du.xy - d * (du.z * sight_in.perspective);
            let b = dv.xy - d * (dv.z * sight_in.perspective);
            let step = vec2f(g.y * b.x - g.x * b.y, g.x * a.y - g.y * a.x) / (a.x * b.y - a.y * b.x);
            let goal = t + step;
            let next = clamp(goal, vec2f(0.0), vec2f(1.0));
            moved = length(a * (next.x - t.x) + b * (next.y - t.y));
            beyond = length(a * (goal.x - next.x) + b * (goal.y - next.y));
            value += du * (next.x - t.x) + dv * (next.y - t.y);
            t = next;
            steps++;
            if !(moved >= SETTLED && steps < MOST_STEPS) {
                break;
            }
        }
        let weight = mix(1.0, value.z, sight_in.perspective);
        let own = mix(value.z + chart_texel(chart).w, value.z * chart_texel(chart).w, sight_in.perspective);
        let converged = moved < SETTLED;
        if !converged {
            doubt = STATE_DOUBTFUL;
        }
        if converged && beyond <= BAND * weight && own < depth {
            let place = chart_texel(chart + 3u);
            patch_id = bitcast<u32>(chart_texel(chart + 2u).w) + 1u;
            depth = own;
            uv = place.xy + place.zw * t;
            // What the sample sees of the point at the (u,v) that is handed on, with its rounding.
            let r = (uv - place.xy) / place.zw;
            let bu = bernstein(r.x);
            let bv = bernstein(r.y);
            var point = vec3f(0.0);
            for (var j = 0u; j < 4u; j++) {
                point += vec3f(dot(x[j], bu), dot(y[j], bu), dot(z[j], bu)) * bv[j];
            }
            let residual = length(miss(point, d)) / weight;
            certificate = pack2x16float(vec2f(residual, 0.0)) | (steps << 16u) | (STATE_CHART << 24u);
        }
    }
    certificate |= doubt << 24u;
    return Found(patch_id, uv, certificate, select(0.0, 0.5, patch_id > 0u));
}
