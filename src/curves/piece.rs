//! The limit surface in pieces that are bicubic: a regular patch, or a third of a level of an extraordinary vertex.

use crate::field::{Camera, CurvatureKind, Field, Functions, Method, Point};
use crate::stam::{Curvature, Jet, Jet2, LimitSurface, Net, Window};
use glam::DVec3;

/// Part of the square of a derivative below which that of the other vanishes.
const VANISHING: f64 = 1e-20;
/// Sine of the angle between derivatives below which the normal has lost six of sixteen digits.
const FOLDED: f64 = 3e-6;
/// The same for curvature, which has the square of it below.
const FOLDED_CURVATURE: f64 = 1e-3;
/// Part of a curvature, or of the step between lines, that rounding may be.
const KNOWN: f64 = 3e-11;

/// What is looked at: the functions of a field on a surface, as a camera sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene<'a> {
    pub surface: &'a LimitSurface,
    pub field: &'a Field,
    pub camera: &'a Camera,
}

impl Scene<'_> {
    /// The functions at a patch-local point, by the reference evaluation.
    pub fn functions(&self, patch: usize, uv: [f64; 2]) -> Option<Functions> {
        let (jet, curvature) = if self.field.method.reads_curvature() {
            let jet = self.surface.evaluate_second(patch, uv);
            (jet.first, jet.curvature())
        } else {
            (self.surface.evaluate(patch, uv), None)
        };
        self.of(jet, curvature)
    }

    fn of(&self, jet: Jet, curvature: Option<Curvature>) -> Option<Functions> {
        let sight = self.camera.sight(jet.position);
        self.field.functions(&Point { position: jet.position, normal: jet.normal, sight, curvature })
    }
}

/// A square of a patch on which the surface is one bicubic polynomial.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub patch: usize,
    /// First corner, patch-local.
    pub corner: [f64; 2],
    /// Extent, patch-local.
    pub size: f64,
    /// Uniform B-spline points, u fastest, relative to `origin` and divided by `scale`: near extraordinary vertices they keep
    /// their digits.
    net: [DVec3; 16],
    origin: DVec3,
    scale: f64,
}

impl Piece {
    /// A regular patch, if the net is one.
    pub fn regular(patch: usize, net: &Net) -> Option<Piece> {
        let Net::Regular(points) = net else { return None };
        let origin = points[5];
        Some(Piece { patch, corner: [0.0; 2], size: 1.0, net: points.map(|p| p - origin), origin, scale: 1.0 })
    }

    /// The three pieces of a level of an irregular patch, round the square of half the size that the next levels fill.
    pub fn level(patch: usize, net: &Net, level: usize) -> Vec<Piece> {
        let Net::Irregular { limit, lambda, levels } = net else { return Vec::new() };
        let size = 0.5f64.powi(level as i32);
        let thirds = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let piece = |corner: [f64; 2]| {
            let corner = corner.map(|x| x * size);
            let window = Window::at(corner.map(|x| x + 0.5 * size));
            let net = std::array::from_fn(|k| levels[level - 1][window.point(k)]);
            Piece { patch, corner, size, net, origin: *limit, scale: lambda.powi(level as i32 - 1) }
        };
        thirds.map(piece).into()
    }

    /// Patch-local parameters of a point of the piece.
    pub fn to_patch(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        [self.corner[0] + self.size * s, self.corner[1] + self.size * t]
    }

    /// Bezier points, u fastest.
    pub fn bezier(&self) -> [DVec3; 16] {
        let of_line = |[a, b, c, d]: [DVec3; 4]| {
            [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
        };
        let rows: [[DVec3; 4]; 4] = std::array::from_fn(|j| of_line(std::array::from_fn(|i| self.net[4 * j + i])));
        let columns: [[DVec3; 4]; 4] = std::array::from_fn(|i| of_line(std::array::from_fn(|j| rows[j][i])));
        std::array::from_fn(|k| self.origin + self.scale * columns[k % 4][k / 4])
    }

    /// Position at parameters of the piece, each 0 to 1.
    pub fn position(&self, [s, t]: [f64; 2]) -> DVec3 {
        let (bs, bt) = (basis(s)[0], basis(t)[0]);
        let rows: &[[DVec3; 4]] = self.net.as_chunks().0;
        self.origin + self.scale * weighted(&bt, &[0, 1, 2, 3].map(|j| weighted(&bs, &rows[j])))
    }

    /// Coefficients of x^i t^j of the position less the origin, a row an i, world units; and the origin. x is the parameter of `axis`, t the
    /// other one.
    pub fn powers(&self, axis: usize) -> ([[DVec3; 4]; 4], DVec3) {
        let of_line = |[a, b, c, d]: [DVec3; 4]| {
            [(a + 4.0 * b + c) / 6.0, (c - a) / 2.0, (a - 2.0 * b + c) / 2.0, (d - a + 3.0 * (b - c)) / 6.0]
        };
        let of = |i: usize, j: usize| self.net[if axis == 0 { 4 * j + i } else { 4 * i + j }];
        let by_t: [[DVec3; 4]; 4] = std::array::from_fn(|i| of_line(std::array::from_fn(|j| of(i, j))));
        let by_x: [[DVec3; 4]; 4] = std::array::from_fn(|j| of_line(std::array::from_fn(|i| by_t[i][j])));
        (std::array::from_fn(|i| std::array::from_fn(|j| self.scale * by_x[j][i])), self.origin)
    }

    /// Largest second derivatives of the position, which the second differences of the B-spline points bound: twice along `axis`, along
    /// both parameters, and twice along the other one.
    pub fn bend(&self, axis: usize) -> [f64; 3] {
        let of = |i: usize, j: usize| self.net[4 * j + i];
        let [mut u, mut mixed, mut v] = [0.0f64; 3];
        for k in 0..4 {
            for i in 1..3 {
                u = u.max((of(i - 1, k) - 2.0 * of(i, k) + of(i + 1, k)).length());
                v = v.max((of(k, i - 1) - 2.0 * of(k, i) + of(k, i + 1)).length());
            }
        }
        for j in 1..4 {
            for i in 1..4 {
                mixed = mixed.max((of(i, j) - of(i - 1, j) - of(i, j - 1) + of(i - 1, j - 1)).length());
            }
        }
        let [u, mixed, v] = [u, mixed, v].map(|bend| self.scale * bend);
        if axis == 0 { [u, mixed, v] } else { [v, mixed, u] }
    }

    /// Whether rounding leaves ten digits of a curvature: it is a second difference of points over the square of their distance.
    fn is_known(&self, curvature: &Curvature, field: &Field) -> bool {
        let Method::Curvature(kind) = &field.method else { return true };
        let extent = self.scale * self.net[5].distance(self.net[10]).max(self.net[6].distance(self.net[9]));
        let largest = curvature.principal[0].abs().max(curvature.principal[1].abs());
        let rounding = 8.0 * f64::EPSILON * (1.0 / extent + largest);
        let rounding = if *kind == CurvatureKind::Gaussian { rounding * largest } else { rounding };
        rounding <= KNOWN * kind.of(curvature).x.abs().max(field.light.spacing)
    }

    /// The functions at parameters of the piece; `None` where they are undefined.
    pub fn functions(&self, scene: &Scene, [s, t]: [f64; 2]) -> Option<Functions> {
        self.functions_on(scene, &self.line(scene, s), t)
    }

    /// The line of the piece at a value of its first parameter.
    pub fn line(&self, scene: &Scene, s: f64) -> Line {
        let second = scene.field.method.reads_curvature();
        let [b, d, c] = basis(s);
        let mut points = [[DVec3::ZERO; 3]; 4];
        for (points, row) in points.iter_mut().zip(self.net.as_chunks().0) {
            points[0] = weighted(&b, row);
            points[1] = weighted(&d, row);
            if second {
                points[2] = weighted(&c, row);
            }
        }
        Line { s, points }
    }

    /// The functions on a line, at a value of the second parameter.
    pub fn functions_on(&self, scene: &Scene, line: &Line, t: f64) -> Option<Functions> {
        let second = scene.field.method.reads_curvature();
        let [e, f, g] = basis(t);
        let [p, q, r, s] = &line.points;
        let sum = |weights: &[f64; 4], k: usize| weighted(weights, &[p[k], q[k], r[k], s[k]]);
        let (du, dv) = (sum(&e, 1), sum(&f, 0));
        let across = du.cross(dv);
        // Where derivatives vanish, the reference knows the limit of the normals; where they are parallel the patch is folded, and the
        // normal is rounding.
        let [long, wide, area] = [du, dv, across].map(DVec3::length_squared);
        if long.min(wide) <= VANISHING * long.max(wide) {
            return scene.functions(self.patch, self.to_patch([line.s, t]));
        }
        let folded = if second { FOLDED_CURVATURE } else { FOLDED };
        if area <= folded * folded * long * wide {
            return None;
        }
        // By the parameters of the piece and in its own scale: neither turns the normal.
        let first = Jet { position: self.origin + self.scale * sum(&e, 0), du, dv, normal: across / area.sqrt() };
        let curvature = second.then(|| {
            let of_net = Jet2 { first, duu: sum(&e, 2), duv: sum(&f, 1), dvv: sum(&g, 0) };
            let curvature = of_net.curvature()?;
            let curvature = Curvature {
                gaussian: curvature.gaussian / (self.scale * self.scale),
                mean: curvature.mean / self.scale,
                principal: curvature.principal.map(|k| k / self.scale),
            };
            self.is_known(&curvature, scene.field).then_some(curvature)
        });
        scene.of(first, curvature.flatten())
    }
}

/// A line of a piece: what is the same for all its points.
#[derive(Debug)]
pub(super) struct Line {
    s: f64,
    /// B-spline points along the line, of the position and its first and second derivatives across it.
    points: [[DVec3; 3]; 4],
}

#[inline]
fn weighted(weights: &[f64; 4], points: &[DVec3; 4]) -> DVec3 {
    (weights[0] * points[0] + weights[1] * points[1]) + (weights[2] * points[2] + weights[3] * points[3])
}

/// Values, first and second derivatives of the four uniform cubic B-splines.
#[inline]
fn basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    let (s2, t2) = (s * s, t * t);
    let sixth = 1.0 / 6.0;
    [
        [s2 * s * sixth, (t2 * (3.0 * t - 6.0) + 4.0) * sixth, (s2 * (3.0 * s - 6.0) + 4.0) * sixth, t2 * t * sixth],
        [-0.5 * s2, 0.5 * t * (3.0 * t - 4.0), 0.5 * s * (4.0 - 3.0 * s), 0.5 * t2],
        [s, 3.0 * t - 2.0, 1.0 - 3.0 * t, t],
    ]
}
