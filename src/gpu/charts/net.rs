//! Nets of 4x4 control values, in loops over fixed arrays: they become vectors where closures over arrays do not.

/// Four control values along u.
pub(super) type Row = [f64; 4];
/// Rows of v.
pub(super) type Net = [Row; 4];

/// The larger of two numbers: `f64::max` asks for NaN, which keeps loops from becoming vectors.
#[inline(always)]
pub(super) fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(super) fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// A row of what `value` makes of each column.
#[inline(always)]
pub(super) fn row(value: impl Fn(usize) -> f64) -> Row {
    let mut row = [0.0; 4];
    for (k, x) in row.iter_mut().enumerate() {
        *x = value(k);
    }
    row
}

#[inline(always)]
pub(super) fn dot(a: &Row, b: &Row) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

/// The sum of the rows of a net, each times its weight.
#[inline(always)]
pub(super) fn combined(net: &Net, weights: &Row) -> Row {
    let [a, b, c, d] = net;
    row(|k| (a[k] * weights[0] + b[k] * weights[1]) + (c[k] * weights[2] + d[k] * weights[3]))
}

#[inline(always)]
pub(super) fn transposed(net: &Net) -> Net {
    let mut out = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            out[i][j] = net[j][i];
        }
    }
    out
}

/// From a uniform cubic B-spline to Bezier points, across the rows.
#[inline(always)]
fn bezier([a, b, c, d]: &Net) -> Net {
    let sixth = 1.0 / 6.0;
    let third = 1.0 / 3.0;
    [
        row(|k| (a[k] + 4.0 * b[k] + c[k]) * sixth),
        row(|k| (2.0 * b[k] + c[k]) * third),
        row(|k| (b[k] + 2.0 * c[k]) * third),
        row(|k| (b[k] + 4.0 * c[k] + d[k]) * sixth),
    ]
}

/// The Bezier net of a uniform bicubic B-spline.
#[inline]
pub(super) fn bezier_of_spline(net: &Net) -> Net {
    transposed(&bezier(&transposed(&bezier(net))))
}

/// The cubic Bezier points of curves through their values at 0, 1/3, 2/3 and 1, across the rows.
fn through([a, b, c, d]: &Net) -> Net {
    let sixth = 1.0 / 6.0;
    [
        *a,
        row(|k| sixth * (-5.0 * a[k] + 18.0 * b[k] - 9.0 * c[k] + 2.0 * d[k])),
        row(|k| sixth * (2.0 * a[k] - 9.0 * b[k] + 18.0 * c[k] - 5.0 * d[k])),
        *d,
    ]
}

/// The bicubic Bezier net through a grid of values at thirds.
pub(super) fn bezier_through(values: &Net) -> Net {
    transposed(&through(&transposed(&through(values))))
}

/// De Casteljau at 1/2, across the rows: leaves the lower half, returns the upper one.
#[inline(always)]
fn halve_rows(net: &mut Net) -> Net {
    let mean = |p: &Row, q: &Row| row(|k| 0.5 * (p[k] + q[k]));
    let [a, b, c, d] = *net;
    let (ab, bc, cd) = (mean(&a, &b), mean(&b, &c), mean(&c, &d));
    let (abc, bcd) = (mean(&ab, &bc), mean(&bc, &cd));
    let middle = mean(&abc, &bcd);
    *net = [a, ab, abc, middle];
    [middle, bcd, cd, d]
}

/// Leaves the lower half of a Bezier net along u or v, returns the upper one.
#[inline]
pub(super) fn halve(net: &mut Net, along_v: bool) -> Net {
    if along_v {
        return halve_rows(net);
    }
    let mut low = transposed(net);
    let high = halve_rows(&mut low);
    *net = transposed(&low);
    transposed(&high)
}

/// How much the derivatives of a Bezier net may change from one side of it to the other: a bound on its second derivatives, which
/// are convex combinations of second differences.
#[inline(always)]
pub(super) fn bend(net: &Net) -> f64 {
    let steps = net.each_ref().map(|row| [row[1] - row[0], row[2] - row[1], row[3] - row[2]]);
    let [mut along_u, mut along_v, mut twist] = [[0.0f64; 4]; 3];
    for step in &steps {
        for k in 0..2 {
            along_u[k] = max(along_u[k], (step[k + 1] - step[k]).abs());
        }
    }
    for j in 0..2 {
        for k in 0..4 {
            along_v[k] = max(along_v[k], ((net[j + 2][k] - net[j + 1][k]) - (net[j + 1][k] - net[j][k])).abs());
        }
    }
    for j in 0..3 {
        for k in 0..3 {
            twist[k] = max(twist[k], (steps[j + 1][k] - steps[j][k]).abs());
        }
    }
    6.0 * (greatest(&along_u) + greatest(&along_v)) + 18.0 * greatest(&twist)
}

#[inline(always)]
pub(super) fn greatest(values: &Row) -> f64 {
    max(max(values[0], values[1]), max(values[2], values[3]))
}

#[inline(always)]
pub(super) fn least(values: &Row) -> f64 {
    min(min(values[0], values[1]), min(values[2], values[3]))
}
