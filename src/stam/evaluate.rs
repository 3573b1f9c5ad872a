//! Position, derivatives and normals of a patch in f64.

use super::box_spline::{self, POINTS};
use super::bspline::{tensor, tensor_second};
use super::class::{ClassTable, LEVELS, WINDOW_POINTS};
use super::pole::{PoleVertex, Tangents};
use super::{Jet, Jet2, LOOP_WINDOW, LimitSurface, LoopWindow, Window};
use crate::patch::Patch;
use glam::DVec3;

/// The net that holds a point, and what turns its derivatives into those of the patch.
struct Local {
    /// Net relative to `origin`: 4x4 points, or the 12 of a triangle and its corner 4 times.
    net: [DVec3; 16],
    origin: DVec3,
    /// Parameters inside the net.
    t: [f64; 2],
    /// The net is that of a triangle.
    triangle: bool,
    /// Factor of the net's points: lambda^(n-1).
    scale: f64,
    /// Net parameters over one patch parameter: 2^n, or -2^n in a window that is turned by half a turn.
    zoom: f64,
    /// Normal of the tangent plane at the extraordinary vertex, asked for or as a stand-in where derivatives are parallel
    /// to rounding.
    tip: Option<DVec3>,
    at_vertex: bool,
}

/// Part of the net's size below which a derivative, or its part across the other one, is rounding.
const ROUNDING: f64 = 1e-14;

impl Local {
    fn regular(surface: &LimitSurface, patch: usize, uv: [f64; 2]) -> Self {
        let net = surface.regular_net(patch);
        // Relative to a corner: world coordinates would cost digits of the derivatives.
        let origin = net[5];
        Self::of_net(net.map(|p| p - origin), origin, uv, false)
    }

    fn regular_triangle(surface: &LimitSurface, patch: usize, uv: [f64; 2]) -> Self {
        let net = surface.triangle_net(patch);
        let origin = net[4];
        Self::of_net(padded(net.map(|p| p - origin)), origin, uv, true)
    }

    fn of_net(net: [DVec3; 16], origin: DVec3, t: [f64; 2], triangle: bool) -> Self {
        Self { net, origin, t, triangle, scale: 1.0, zoom: 1.0, tip: None, at_vertex: false }
    }

    fn irregular_triangle(surface: &LimitSurface, patch: usize, table: &ClassTable, uv: [f64; 2]) -> Self {
        let window = LoopWindow::at(uv);
        let level = (window.level as usize).min(LEVELS);
        let at_vertex = window.at_vertex;
        let wants_tip = at_vertex || level > LEVELS / 2;
        let (net, origin, tip) = match surface.pole_vertex(patch) {
            Some(PoleVertex { limit, tangents }) => {
                let net = surface.pole_window::<{ LOOP_WINDOW.len() }, _>(patch, level, |k| window.point(k));
                (net, limit, wants_tip.then(|| tangents.normal()).flatten())
            }
            None => {
                let (points, origin) = surface.irregular_net(patch, table);
                let net = table.window_points(level, |k| window.point(k), &points);
                (net, origin, wants_tip.then(|| Tangents::new(table, &points).normal()).flatten())
            }
        };
        Self {
            scale: table.lambda.powi(window.level as i32 - 1),
            zoom: window.sign * 2f64.powi(window.level as i32),
            tip,
            at_vertex,
            ..Self::of_net(padded(net), origin, window.t, true)
        }
    }

    fn irregular(surface: &LimitSurface, patch: usize, table: &ClassTable, uv: [f64; 2]) -> Self {
        let window = Window::at(uv);
        let level = (window.level as usize).min(LEVELS);
        let at_vertex = window.at_vertex;
        let wants_tip = at_vertex || level > LEVELS / 2;
        let (net, origin, tip) = match surface.pole_vertex(patch) {
            Some(PoleVertex { limit, tangents }) => {
                let net = surface.pole_window::<WINDOW_POINTS, _>(patch, level, |k| window.point(k));
                (net, limit, wants_tip.then(|| tangents.normal()).flatten())
            }
            None => {
                let (points, origin) = surface.irregular_net(patch, table);
                let net = table.window_points(level, |k| window.point(k), &points);
                (net, origin, wants_tip.then(|| Tangents::new(table, &points).normal()).flatten())
            }
        };
        Self {
            net,
            origin,
            t: window.t,
            triangle: false,
            scale: table.lambda.powi(window.level as i32 - 1),
            zoom: 2f64.powi(window.level as i32),
            tip,
            at_vertex,
        }
    }

    /// Value, derivative by u and by v, by the net's own parameters.
    fn first(&self) -> [DVec3; 3] {
        let [u, v] = self.t;
        if self.triangle { self.sum(&box_spline::first(u, v)) } else { self.sum(&tensor(u, v)) }
    }

    /// Derivatives by uu, uv and vv, by the net's own parameters.
    fn second_sums(&self) -> [DVec3; 3] {
        let [u, v] = self.t;
        if self.triangle { self.sum(&box_spline::second(u, v)) } else { self.sum(&tensor_second(u, v)) }
    }

    fn sum(&self, weights: &[[f64; 3]]) -> [DVec3; 3] {
        let mut out = [DVec3::ZERO; 3];
        for (p, w) in self.net.iter().zip(weights) {
            out.iter_mut().zip(w).for_each(|(x, &w)| *x += w * *p);
        }
        out
    }

    fn jet(&self) -> Jet {
        let [offset, du, dv] = self.first();
        let normal = self.normal(du, dv);
        let stretch = self.zoom * self.scale;
        let position = if self.at_vertex { self.origin } else { self.origin + self.scale * offset };
        Jet { position, du: stretch * du, dv: stretch * dv, normal }
    }

    fn second(&self) -> [DVec3; 3] {
        let stretch = self.zoom * self.zoom * self.scale;
        self.second_sums().map(|d| stretch * d)
    }

    /// Unit normal: the limit of the normals inside the patch. Where the derivatives vanish or are parallel, the
    /// derivative of their product towards the middle of the patch gives it; zero where that vanishes too.
    fn normal(&self, du: DVec3, dv: DVec3) -> DVec3 {
        let plain = unit(du, dv);
        if self.at_vertex
            && let Some(tip) = self.tip
        {
            return tip;
        }
        let size = self.net.iter().fold(0.0f64, |size, p| size.max(p.distance(self.net[5])));
        let across = du.cross(dv).length() / du.length().max(dv.length()).max(f64::MIN_POSITIVE);
        // Near the vertex of a triangle the shorter direction may be far shorter, (1/2)^n at a crease of one face, and rounding
        // has turned the normal by 1e-9 when the plane at the vertex is right to 2^-26.
        let least = if self.triangle && self.tip.is_some() { 1e-7 } else { ROUNDING };
        if across > least * size {
            return plain;
        }
        if let Some(tip) = self.tip {
            return tip;
        }
        let [duu, duv, dvv] = self.second_sums();
        let middle = if self.triangle { 1.0 / 3.0 } else { 0.5 };
        let [a, b] = self.t.map(|t| middle - t);
        let [du_inward, dv_inward] = [a * duu + b * duv, a * duv + b * dvv];
        // Derivatives that are rounding must not speak.
        let clean = |d: DVec3| if d.length() > ROUNDING * size { d } else { DVec3::ZERO };
        let first = du_inward.cross(clean(dv)) + clean(du).cross(dv_inward);
        let second = du_inward.cross(dv_inward);
        [first, second]
            .into_iter()
            .find(|n| n.length() > ROUNDING * size * size)
            .map_or(DVec3::ZERO, DVec3::normalize_or_zero)
    }
}

/// The net of a triangle, one of its corners again in place of what it lacks.
fn padded(net: [DVec3; POINTS]) -> [DVec3; 16] {
    std::array::from_fn(|k| net.get(k).copied().unwrap_or(net[5]))
}

/// Unit normal of two tangents; zero where they are parallel or vanish.
pub(super) fn unit(du: DVec3, dv: DVec3) -> DVec3 {
    // Normalised first: the product of derivatives of tiny models would underflow.
    du.normalize_or_zero().cross(dv.normalize_or_zero()).normalize_or_zero()
}

impl LimitSurface {
    fn local(&self, patch: usize, uv: [f64; 2]) -> Local {
        match (self.class(patch), self.has_triangles()) {
            (None, false) => Local::regular(self, patch, uv),
            (None, true) => Local::regular_triangle(self, patch, uv),
            (Some(class), false) => Local::irregular(self, patch, &self.tables()[class], uv),
            (Some(class), true) => Local::irregular_triangle(self, patch, &self.tables()[class], uv),
        }
    }

    /// Evaluates a patch at its local (u,v), each 0 to 1 (of a triangle u + v too); derivatives by the local parameters.
    ///
    /// At the extraordinary vertex itself the derivatives are those of the innermost level: their limits are zero or
    /// infinite unless lambda is 1/2.
    pub fn evaluate(&self, patch: usize, uv: [f64; 2]) -> Jet {
        self.local(patch, uv).jet()
    }

    /// The normal at local (0,0) of a patch, that of [`evaluate`](Self::evaluate).
    pub(crate) fn vertex_normal(&self, patch: usize) -> DVec3 {
        let pole = self.pole_vertex(patch).and_then(|vertex| vertex.tangents.normal());
        pole.unwrap_or_else(|| self.evaluate(patch, [0.0; 2]).normal)
    }

    /// Evaluates a patch at its local (u,v) with second derivatives. Near an extraordinary vertex they grow like
    /// (4 lambda)^n with the level n, in general: the surface is not C2 there.
    pub fn evaluate_second(&self, patch: usize, uv: [f64; 2]) -> Jet2 {
        let local = self.local(patch, uv);
        let [duu, duv, dvv] = local.second();
        Jet2 { first: local.jet(), duu, duv, dvv }
    }

    /// Evaluates a ptex face at (u,v), each 0 to 1 (of a triangle u + v too): the patch and the jet, derivatives by the ptex parameters; `None`
    /// in a hole.
    ///
    /// # Panics
    /// `ptex` is not below [`ptex_count`](Self::ptex_count).
    pub fn evaluate_ptex(&self, ptex: u32, uv: [f64; 2]) -> Option<(usize, Jet)> {
        let (patch, local) = self.locate(ptex, uv)?;
        Some((patch, self.patches()[patch].jet_to_ptex(self.evaluate(patch, local))))
    }

    /// The same with second derivatives by the ptex parameters.
    ///
    /// # Panics
    /// As [`evaluate_ptex`](Self::evaluate_ptex).
    pub fn evaluate_second_ptex(&self, ptex: u32, uv: [f64; 2]) -> Option<(usize, Jet2)> {
        let (patch, local) = self.locate(ptex, uv)?;
        Some((patch, self.patches()[patch].jet2_to_ptex(self.evaluate_second(patch, local))))
    }
}

impl Patch {
    /// Turns a jet by patch-local parameters into one by the parameters of the ptex face.
    pub fn jet_to_ptex(&self, jet: Jet) -> Jet {
        let [du, dv] = self.local_by_ptex().map(|[s, t]| s * jet.du + t * jet.dv);
        Jet { du, dv, ..jet }
    }

    /// The same with second derivatives.
    pub fn jet2_to_ptex(&self, jet: Jet2) -> Jet2 {
        let by = self.local_by_ptex();
        let second = |[a, b]: [f64; 2], [c, d]: [f64; 2]| a * c * jet.duu + (a * d + b * c) * jet.duv + b * d * jet.dvv;
        let [u, v] = by;
        Jet2 { first: self.jet_to_ptex(jet.first), duu: second(u, u), duv: second(u, v), dvv: second(v, v) }
    }
}
