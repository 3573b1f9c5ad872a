//! Hits of one bicubic Bezier piece: halving until the hit is alone, then Newton's method.

use glam::DVec3;

/// Bezier points of a uniform bicubic B-spline patch, u fastest (Boehm 1981: each end of a span is (1, 4, 1)/6, the points
/// between are its thirds).
pub fn from_b_spline(net: &[DVec3; 16]) -> [DVec3; 16] {
    let curve = |[a, b, c, d]: [DVec3; 4]| {
        [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
    };
    let rows: [[DVec3; 4]; 4] = std::array::from_fn(|j| curve(std::array::from_fn(|i| net[4 * j + i])));
    let columns: [[DVec3; 4]; 4] = std::array::from_fn(|i| curve(std::array::from_fn(|j| rows[j][i])));
    std::array::from_fn(|k| columns[k % 4][k / 4])
}

/// A hit.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    pub piece: usize,
    /// Parameters of the piece.
    pub uv: [f64; 2],
    /// Distance along the ray.
    pub z: f64,
}

/// What is looked for and what was found.
#[derive(Debug)]
pub struct Search {
    start: f64,
    /// Farther hits do not count.
    end: f64,
    nearest: bool,
    /// The part looked at last has a hit.
    added: bool,
    pub found: Vec<Found>,
}

/// Bezier points in coordinates of the ray.
#[derive(Clone, Copy)]
struct Patch {
    x: [f64; 16],
    y: [f64; 16],
    z: [f64; 16],
    /// The part of the piece that it is: first parameters and extents.
    corner: [f64; 2],
    size: [f64; 2],
}

/// Halvings in each direction after which doubles are used up. Pieces are as small as their tolerance long before.
const MAX_DEPTH: usize = 110;

impl Search {
    pub fn nearest(start: f64) -> Search {
        Search { start, end: f64::INFINITY, nearest: true, added: false, found: Vec::new() }
    }

    pub fn all(start: f64) -> Search {
        Search { nearest: false, ..Search::nearest(start) }
    }

    /// Whether something at these distances would still count.
    pub fn looks_at(&self, near: f64, far: f64) -> bool {
        near < self.end && far >= self.start
    }

    /// Looks for hits of a piece given by Bezier points in coordinates of the ray.
    pub fn piece(&mut self, piece: usize, net: &[DVec3; 16], tolerance: f64) {
        let [x, y, z] = [0, 1, 2].map(|axis| net.map(|p| p[axis]));
        self.part(piece, &Patch { x, y, z, corner: [0.0; 2], size: [1.0; 2] }, tolerance, 0);
    }

    fn part(&mut self, piece: usize, patch: &Patch, tolerance: f64, depth: usize) {
        self.added = false;
        let [near, far] = range(&patch.z);
        if !self.looks_at(near, far) {
            return;
        }
        let reach = [range(&patch.x), range(&patch.y)];
        if reach.iter().any(|[low, high]| *low > tolerance || *high < -tolerance) || patch.misses(tolerance) {
            return;
        }
        if reach.iter().all(|[low, high]| high - low <= tolerance) || depth >= MAX_DEPTH {
            self.add(piece, patch, [0.5; 2]);
        } else if let Some(uv) = patch.only_root(tolerance) {
            self.add(piece, patch, uv);
        } else {
            let mut halves = patch.halves();
            if range(&halves[1].z)[0] < range(&halves[0].z)[0] {
                halves.swap(0, 1);
            }
            // Thinner than the tolerance, every point of a part of the line is a hit: one will do.
            let one = patch.is_line(tolerance);
            for half in &halves {
                self.part(piece, half, tolerance, depth + 1);
                if one && self.added {
                    break;
                }
            }
        }
    }

    fn add(&mut self, piece: usize, patch: &Patch, uv: [f64; 2]) {
        let z = patch.at(uv).z[0];
        if !self.looks_at(z, z) {
            return;
        }
        if self.nearest {
            self.end = z;
            self.found.clear();
        }
        self.added = true;
        let uv = [0, 1].map(|k| patch.corner[k] + patch.size[k] * uv[k]);
        self.found.push(Found { piece, uv, z });
    }
}

/// Value, derivative by u, derivative by v of each coordinate.
struct Jet {
    x: [f64; 3],
    y: [f64; 3],
    z: [f64; 3],
}

impl Patch {
    /// Whether all points lie on one side of the ray across one of the two mean directions of the patch: slanted patches
    /// are slivers, which boxes along x and y hold badly.
    fn misses(&self, tolerance: f64) -> bool {
        let side = |c: &[f64; 16]| [c[3] - c[0] + c[15] - c[12], c[12] - c[0] + c[15] - c[3]];
        let (ex, ey) = (side(&self.x), side(&self.y));
        [0, 1].into_iter().any(|k| {
            let length = ex[k].hypot(ey[k]);
            let across: [f64; 16] = std::array::from_fn(|i| self.x[i] * ey[k] - self.y[i] * ex[k]);
            let [low, high] = range(&across);
            low > tolerance * length || high < -tolerance * length
        })
    }

    /// Whether all points lie within the tolerance of a line: so do spikes and cusps at extraordinary vertices, where one
    /// direction shrinks much faster than the other.
    fn is_line(&self, tolerance: f64) -> bool {
        let point = |i: usize| DVec3::new(self.x[i], self.y[i], self.z[i]);
        let far = (1..16)
            .max_by(|&a, &b| point(a).distance_squared(point(0)).total_cmp(&point(b).distance_squared(point(0))));
        let along = (point(far.expect("15 points")) - point(0)).normalize_or_zero();
        (1..16).all(|i| (point(i) - point(0)).cross(along).length() <= tolerance)
    }

    /// The only point with x = y = 0 where there is at most one and it is found; `None` otherwise.
    fn only_root(&self, tolerance: f64) -> Option<[f64; 2]> {
        self.is_injective().then(|| self.newton(tolerance)).flatten()
    }

    /// Whether (u,v) -> (x,y) is provably one to one. The difference of two values is (du) U + (dv) V with U and V means
    /// of derivatives, so in the convex hulls of the derivatives' Bezier points. The cross product of U and V is a mean
    /// of the products of these: if all have one sign it is not zero, nor is the difference.
    fn is_injective(&self) -> bool {
        let u = |k: usize| {
            let i = 4 * (k / 3) + k % 3;
            [self.x[i + 1] - self.x[i], self.y[i + 1] - self.y[i]]
        };
        let v = |k: usize| [self.x[k + 4] - self.x[k], self.y[k + 4] - self.y[k]];
        let [us, vs]: [[[f64; 2]; 12]; 2] = [std::array::from_fn(u), std::array::from_fn(v)];
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let sign = cross(us[0], vs[0]).signum();
        us.iter().all(|&a| vs.iter().all(|&b| sign * cross(a, b) > 0.0))
    }

    /// Newton's method from the middle, to the last digit; `None` if it leaves the patch by more than the tolerance.
    fn newton(&self, tolerance: f64) -> Option<[f64; 2]> {
        const STEPS: usize = 20;
        let mut uv = [0.5; 2];
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let Jet { x, y, .. } = self.at(uv);
            let det = x[1] * y[2] - x[2] * y[1];
            let step = [(x[2] * y[0] - x[0] * y[2]) / det, (x[0] * y[1] - x[1] * y[0]) / det];
            let next = [uv[0] + step[0], uv[1] + step[1]];
            if !next.iter().all(|t| (-0.5..=1.5).contains(t)) {
                return None;
            }
            uv = next;
            // Quadratic, then rounding: over when steps are rounding or grow again near it.
            let length = step[0].abs().max(step[1].abs());
            if length <= 4.0 * f64::EPSILON || (length < 1e-10 && length >= last) {
                break;
            }
            last = length;
        }
        let inside = uv.map(|t| t.clamp(0.0, 1.0));
        let Jet { x, y, .. } = self.at(inside);
        (x[0].abs() <= tolerance && y[0].abs() <= tolerance).then_some(inside)
    }

    /// De Casteljau in Bernstein form (Farin 2002, section 5).
    fn at(&self, [u, v]: [f64; 2]) -> Jet {
        let values = |t: f64| {
            let s = 1.0 - t;
            (
                [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
                [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
            )
        };
        let ((bu, du), (bv, dv)) = (values(u), values(v));
        let jet = |c: &[f64; 16]| {
            let mut out = [0.0; 3];
            for j in 0..4 {
                let row = |b: &[f64; 4]| (0..4).map(|i| b[i] * c[4 * j + i]).sum::<f64>();
                let (value, slope) = (row(&bu), row(&du));
                out[0] += bv[j] * value;
                out[1] += bv[j] * slope;
                out[2] += dv[j] * value;
            }
            out
        };
        Jet { x: jet(&self.x), y: jet(&self.y), z: jet(&self.z) }
    }

    /// Two halves across the longer direction.
    fn halves(&self) -> [Patch; 2] {
        // Length of the two outer control polygons each way.
        let length = |step: usize, other: usize| {
            let leg = |i: usize| {
                let d = |c: &[f64; 16]| c[i + step] - c[i];
                (d(&self.x).powi(2) + d(&self.y).powi(2) + d(&self.z).powi(2)).sqrt()
            };
            [0, 3 * other].iter().map(|first| (0..3).map(|k| leg(first + k * step)).sum::<f64>()).sum::<f64>()
        };
        let axis = usize::from(length(4, 1) > length(1, 4));
        let [step, other] = if axis == 0 { [1, 4] } else { [4, 1] };
        let (mut first, mut second) = (*self, *self);
        let split = [self.x, self.y, self.z].map(|c| split(&c, step, other));
        [first.x, first.y, first.z] = split.map(|[low, _]| low);
        [second.x, second.y, second.z] = split.map(|[_, high]| high);
        first.size[axis] *= 0.5;
        second.size[axis] *= 0.5;
        second.corner[axis] += second.size[axis];
        [first, second]
    }
}

/// De Casteljau at 1/2 along the direction of `step`.
fn split(c: &[f64; 16], step: usize, other: usize) -> [[f64; 16]; 2] {
    let (mut low, mut high) = ([0.0; 16], [0.0; 16]);
    for line in 0..4 {
        let at = |k: usize| line * other + k * step;
        let [p0, p1, p2, p3] = [0, 1, 2, 3].map(|k| c[at(k)]);
        let (a, b, d) = (0.5 * (p0 + p1), 0.5 * (p1 + p2), 0.5 * (p2 + p3));
        let (e, f) = (0.5 * (a + b), 0.5 * (b + d));
        let middle = 0.5 * (e + f);
        for (k, (l, h)) in [(p0, middle), (a, f), (e, d), (middle, p3)].into_iter().enumerate() {
            low[at(k)] = l;
            high[at(k)] = h;
        }
    }
    [low, high]
}

fn range(c: &[f64; 16]) -> [f64; 2] {
    let mut range = [c[0]; 2];
    for &x in &c[1..] {
        range = [if x < range[0] { x } else { range[0] }, if x > range[1] { x } else { range[1] }];
    }
    range
}
