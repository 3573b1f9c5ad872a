//! Curvature from second derivatives.

use super::{Jet, Jet2};

/// Curvatures of a surface at a point, in inverse model units; positive where the surface bends towards its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// Product of the principal curvatures.
    pub gaussian: f64,
    /// Mean of the principal curvatures.
    pub mean: f64,
    /// Principal curvatures, the larger first.
    pub principal: [f64; 2],
}

impl Jet2 {
    /// The same point with the normal on the other side: the two parameters change places.
    #[must_use]
    pub fn turned(&self) -> Jet2 {
        let Jet { position, du, dv, normal } = self.first;
        let first = Jet { position, du: dv, dv: du, normal: -normal };
        Jet2 { first, duu: self.dvv, duv: self.duv, dvv: self.duu }
    }

    /// Curvature from the two fundamental forms (do Carmo 1976, section 3.3); `None` where the first derivatives are
    /// parallel or vanish, or second derivatives are not finite: at extraordinary vertices curvature need not exist.
    pub fn curvature(&self) -> Option<Curvature> {
        let (du, dv, n) = (self.first.du, self.first.dv, self.first.normal);
        let (e, f, g) = (du.dot(du), du.dot(dv), dv.dot(dv));
        let (l, m, k) = (self.duu.dot(n), self.duv.dot(n), self.dvv.dot(n));
        let area = e * g - f * f;
        let gaussian = (l * k - m * m) / area;
        let mean = (e * k - 2.0 * f * m + g * l) / (2.0 * area);
        let spread = (mean * mean - gaussian).max(0.0).sqrt();
        let curvature = Curvature { gaussian, mean, principal: [mean + spread, mean - spread] };
        // Written so that NaN has no curvature.
        let plane = area > 1e-24 * e * g && n != glam::DVec3::ZERO;
        (plane && gaussian.is_finite() && mean.is_finite()).then_some(curvature)
    }
}
