//! Position, derivatives and normals of a patch in f64.

use super::bspline::{tensor, tensor_second};
use super::class::{ClassTable, LEVELS};
use super::surface::combine;
use super::{Jet, Jet2, LimitSurface, Window};
use crate::patch::Patch;
use glam::DVec3;

/// The 4x4 net that holds a point, and what turns its derivatives into those of the patch.
struct Local {
    /// Net relative to `origin`.
    net: [DVec3; 16],
    origin: DVec3,
    /// Parameters inside the net.
    t: [f64; 2],
    /// Factor of the net's points: lambda^(n-1).
    scale: f64,
    /// Net parameters over one patch parameter: 2^n.
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
        Self { net: net.map(|p| p - origin), origin, t: uv, scale: 1.0, zoom: 1.0, tip: None, at_vertex: false }
    }

    fn irregular(surface: &LimitSurface, patch: usize, table: &ClassTable, uv: [f64; 2]) -> Self {
        let (points, origin) = surface.irregular_net(patch, table);
        let window = Window::at(uv);
        let level = (window.level as usize).min(LEVELS);
        let net = table.window_points(level, &window, &points);
        let at_vertex = window.at_vertex;
        let tip = (at_vertex || level > LEVELS / 2).then(|| tip_normal(table, &points)).flatten();
        Self {
            net,
            origin,
            t: window.t,
            scale: table.lambda.powi(window.level as i32 - 1),
            zoom: 2f64.powi(window.level as i32),
            tip,
            at_vertex,
        }
    }

    fn sum(&self, weights: &[[f64; 3]; 16]) -> [DVec3; 3] {
        let mut out = [DVec3::ZERO; 3];
        for (p, w) in self.net.iter().zip(weights) {
            out.iter_mut().zip(w).for_each(|(x, &w)| *x += w * *p);
        }
        out
    }

    fn jet(&self) -> Jet {
        let [offset, du, dv] = self.sum(&tensor(self.t[0], self.t[1]));
        let normal = self.normal(du, dv);
        let stretch = self.zoom * self.scale;
        let position = if self.at_vertex { self.origin } else { self.origin + self.scale * offset };
        Jet { position, du: stretch * du, dv: stretch * dv, normal }
    }

    fn second(&self) -> [DVec3; 3] {
        let stretch = self.zoom * self.zoom * self.scale;
        self.sum(&tensor_second(self.t[0], self.t[1])).map(|d| stretch * d)
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
        if across > ROUNDING * size {
            return plain;
        }
        if let Some(tip) = self.tip {
            return tip;
        }
        let [duu, duv, dvv] = self.sum(&tensor_second(self.t[0], self.t[1]));
        let [a, b] = self.t.map(|t| 0.5 - t);
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

/// Unit normal of two tangents; zero where they are parallel or vanish.
pub(super) fn unit(du: DVec3, dv: DVec3) -> DVec3 {
    // Normalised first: the product of derivatives of tiny models would underflow.
    du.normalize_or_zero().cross(dv.normalize_or_zero()).normalize_or_zero()
}

/// Normal of the tangent plane at the extraordinary vertex; `None` without a plane.
fn tip_normal(table: &ClassTable, points: &[DVec3]) -> Option<DVec3> {
    let [first, second] = table.tangents.as_ref()?.each_ref().map(|weights| combine(weights, points));
    let size = points.iter().fold(0.0f64, |size, p| size.max(p.length()));
    let normal = |a: DVec3, b: DVec3| {
        let across = a.normalize_or_zero().cross(b.normalize_or_zero());
        let clear = a.length().min(b.length()) > 1e-12 * size && across.length() > 1e-12;
        clear.then(|| across.normalize())
    };
    normal(first, second).or_else(|| normal(first, combine(table.spare.as_ref()?, points)))
}

impl LimitSurface {
    fn local(&self, patch: usize, uv: [f64; 2]) -> Local {
        match self.class(patch) {
            None => Local::regular(self, patch, uv),
            Some(class) => Local::irregular(self, patch, &self.tables()[class], uv),
        }
    }

    /// Evaluates a patch at its local (u,v), each 0 to 1; derivatives by the local parameters.
    ///
    /// At the extraordinary vertex itself the derivatives are those of the innermost level: their limits are zero or
    /// infinite unless lambda is 1/2.
    pub fn evaluate(&self, patch: usize, uv: [f64; 2]) -> Jet {
        self.local(patch, uv).jet()
    }

    /// Evaluates a patch at its local (u,v) with second derivatives. Near an extraordinary vertex they grow like
    /// (4 lambda)^n with the level n, in general: the surface is not C2 there.
    pub fn evaluate_second(&self, patch: usize, uv: [f64; 2]) -> Jet2 {
        let local = self.local(patch, uv);
        let [duu, duv, dvv] = local.second();
        Jet2 { first: local.jet(), duu, duv, dvv }
    }

    /// Evaluates a ptex face at (u,v), each 0 to 1: the patch and the jet, derivatives by the ptex parameters; `None`
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
        let (du, dv) = match self.rotation {
            0 => (jet.du, jet.dv),
            1 => (-jet.dv, jet.du),
            2 => (-jet.du, -jet.dv),
            _ => (jet.dv, -jet.du),
        };
        let scale = self.scale();
        Jet { du: scale[0] * du, dv: scale[1] * dv, ..jet }
    }

    /// The same with second derivatives.
    pub fn jet2_to_ptex(&self, jet: Jet2) -> Jet2 {
        let (duu, duv, dvv) = match self.rotation {
            0 | 2 => (jet.duu, jet.duv, jet.dvv),
            _ => (jet.dvv, -jet.duv, jet.duu),
        };
        let [u, v] = self.scale();
        Jet2 { first: self.jet_to_ptex(jet.first), duu: u * u * duu, duv: u * v * duv, dvv: v * v * dvv }
    }
}
