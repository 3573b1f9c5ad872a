// The limit surface at one point of a triangle under Loop's scheme, in place of limit_point.wgsl: all patches of a mesh are
// triangles, or none is. f64 twins: stam::box_spline, stam::LoopWindow. Stam 1999.

// The 15 quartic Bernstein polynomials u^i v^j w^k, in the order of box_spline::EXPONENTS, and a zero.
fn quartic(u: f32, v: f32, w: f32) -> array<vec4f, 4> {
    let a = vec3f(u * u, v * v, w * w);
    return array(
        vec4f(a.z * a.z, 4.0 * u * w * a.z, 6.0 * a.x * a.z, 4.0 * u * w * a.x),
        vec4f(a.x * a.x, 4.0 * v * w * a.z, 12.0 * u * v * a.z, 12.0 * v * w * a.x),
        vec4f(4.0 * u * v * a.x, 6.0 * a.y * a.z, 12.0 * u * w * a.y, 6.0 * a.x * a.y),
        vec4f(4.0 * v * w * a.y, 4.0 * u * v * a.y, a.y * a.y, 0.0));
}

// Their derivatives by u and by v: differences of the 10 cubic ones.
struct Slopes { u: array<vec4f, 4>, v: array<vec4f, 4> }

fn quartic_derivatives(u: f32, v: f32, w: f32) -> Slopes {
    let c00 = w * w * w;
    let c10 = 3.0 * u * w * w;
    let c20 = 3.0 * u * u * w;
    let c30 = u * u * u;
    let c01 = 3.0 * v * w * w;
    let c11 = 6.0 * u * v * w;
    let c21 = 3.0 * u * u * v;
    let c02 = 3.0 * v * v * w;
    let c12 = 3.0 * u * v * v;
    let c03 = v * v * v;
    return Slopes(
        array(
            4.0 * vec4f(-c00, c00 - c10, c10 - c20, c20 - c30),
            4.0 * vec4f(c30, -c01, c01 - c11, c11 - c21),
            4.0 * vec4f(c21, -c02, c02 - c12, c12),
            4.0 * vec4f(-c03, c03, 0.0, 0.0)),
        array(
            4.0 * vec4f(-c00, -c10, -c20, -c30),
            4.0 * vec4f(0.0, c00 - c01, c10 - c11, c20 - c21),
            4.0 * vec4f(c30, c01 - c02, c11 - c12, c21),
            4.0 * vec4f(c02 - c03, c12, c03, 0.0)));
}

// Second derivatives, by uu, uv and vv: differences of the 6 quadratic ones.
struct Bends { uu: array<vec4f, 4>, uv: array<vec4f, 4>, vv: array<vec4f, 4> }

fn quartic_second(u: f32, v: f32, w: f32) -> Bends {
    let q00 = w * w;
    let q10 = 2.0 * u * w;
    let q20 = u * u;
    let q01 = 2.0 * v * w;
    let q11 = 2.0 * u * v;
    let q02 = v * v;
    return Bends(
        array(
            12.0 * vec4f(q00, q10 - 2.0 * q00, q00 - 2.0 * q10 + q20, q10 - 2.0 * q20),
            12.0 * vec4f(q20, q01, q11 - 2.0 * q01, q01 - 2.0 * q11),
            12.0 * vec4f(q11, q02, -2.0 * q02, q02),
            vec4f(0.0)),
        array(
            12.0 * vec4f(q00, q10 - q00, q20 - q10, -q20),
            12.0 * vec4f(0.0, q01 - q00, q00 - q01 - q10 + q11, q10 - q11 - q20),
            12.0 * vec4f(q20, q02 - q01, q01 - q02 - q11, q11),
            12.0 * vec4f(-q02, q02, 0.0, 0.0)),
        array(
            12.0 * vec4f(q00, q10, q20, 0.0),
            12.0 * vec4f(0.0, q01 - 2.0 * q00, q11 - 2.0 * q10, -2.0 * q20),
            12.0 * vec4f(0.0, q00 - 2.0 * q01 + q02, q10 - 2.0 * q11, q20),
            12.0 * vec4f(q01 - 2.0 * q02, q11, q02, 0.0)));
}

// Weights of the 12 control points from those of the 15 Bezier points.
fn control_weights(b: array<vec4f, 4>) -> array<vec4f, 3> {
    return array(
        BOX_SPLINE[0] * b[0] + BOX_SPLINE[1] * b[1] + BOX_SPLINE[2] * b[2] + BOX_SPLINE[3] * b[3],
        BOX_SPLINE[4] * b[0] + BOX_SPLINE[5] * b[1] + BOX_SPLINE[6] * b[2] + BOX_SPLINE[7] * b[3],
        BOX_SPLINE[8] * b[0] + BOX_SPLINE[9] * b[1] + BOX_SPLINE[10] * b[2] + BOX_SPLINE[11] * b[3]);
}

const WHOLE = 0u;
const AT_U = 1u;
const AT_V = 2u;
const MIDDLE = 3u;

// Weights of the 16 points of a level (LOOP_WINDOW) from those of a window's 12; of a regular triangle, its own and four zeros.
fn spread(c: array<vec4f, 3>, window: u32) -> array<vec4f, 4> {
    let a = c[0];
    let b = c[1];
    let d = c[2];
    switch window {
        case AT_U: {
            return array(a, vec4f(b.xyz, 0.0), vec4f(b.w, d.xy, 0.0), vec4f(d.zw, 0.0, 0.0));
        }
        case AT_V: {
            return array(vec4f(0.0, 0.0, 0.0, a.x), vec4f(a.yz, 0.0, a.w), b, d);
        }
        case MIDDLE: {
            return array(vec4f(d.wz, 0.0, d.y), vec4f(d.x, b.w, 0.0, b.z), vec4f(b.yx, a.wz), vec4f(a.yx, 0.0, 0.0));
        }
        default: {
            return array(a, b, d, vec4f(0.0));
        }
    }
}

fn weighted(first: u32, bernstein: array<vec4f, 4>, window: u32) -> vec3f {
    let weights = spread(control_weights(bernstein), window);
    var sum = vec3f(0.0);
    for (var g = 0u; g < 4u; g++) {
        let x = point_texel(first + 3u * g);
        let y = point_texel(first + 3u * g + 1u);
        let z = point_texel(first + 3u * g + 2u);
        sum += vec3f(dot(x, weights[g]), dot(y, weights[g]), dot(z, weights[g]));
    }
    return sum;
}

fn limit_point(record: vec4u, uv: vec2f) -> LimitPoint {
    var t = uv;
    var first = record.x;
    var scale = vec2f(1.0);
    var centre = false;
    var window = WHOLE;
    if is_irregular(record) {
        // n from the exponent of u + v, as for quads.
        let exponent = i32(bitcast<u32>(uv.x + uv.y) >> 23u) - 127;
        centre = exponent == -127;
        var n = u32(max(-exponent, 1));
        var ab = uv * bitcast<f32>((n + 127u) << 23u);
        if centre {
            n = CENTRE_LEVEL;
            ab = vec2f(1.0, 0.0);
        }
        window = select(select(MIDDLE, AT_V, ab.y >= 1.0), AT_U, ab.x >= 1.0);
        t = select(select(1.0 - ab, ab - vec2f(0.0, 1.0), window == AT_V), ab - vec2f(1.0, 0.0), window == AT_U);
        first += (min(n, expanded_levels(record)) - 1u) * LEVEL_TEXELS;
        scale = textureLoad(scales, at(record.z + n - 1u), 0).xy;
    }
    let w = 1.0 - t.x - t.y;
    let sign = select(1.0, -1.0, window == MIDDLE);
    let slopes = quartic_derivatives(t.x, t.y, w);
    var position = weighted(first, quartic(t.x, t.y, w), window);
    let du = weighted(first, slopes.u, window);
    let dv = weighted(first, slopes.v, window);
    // The window in the middle is turned by half a turn: both derivatives change their signs, the normal does not.
    var normal = unit_or_zero(cross(unit_or_zero(du), unit_or_zero(dv)));
    if centre {
        position = vec3f(0.0);
        normal = point_texel(normal_texel(record)).xyz;
    }
    var curvature = vec3f(0.0);
    if READS_CURVATURE && !centre {
        let bends = quartic_second(t.x, t.y, w);
        let second =
            mat3x3f(weighted(first, bends.uu, window), weighted(first, bends.uv, window), weighted(first, bends.vv, window));
        curvature = curvatures(du, dv, normal, second) * vec3f(1.0 / scale.x, 1.0 / (scale.x * scale.x), 1.0);
    }
    return LimitPoint(position * scale.x, du * (sign * scale.y), dv * (sign * scale.y), normal, curvature);
}
