//! The second fundamental form in directions of one's choice.

use crate::stam::{Jet, Jet2};
use glam::{DVec2, DVec3};

/// The second fundamental form of a surface at a point, in two perpendicular unit directions of its tangent plane; one over
/// model units, positive where the surface bends towards its normal (do Carmo 1976, section 3.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form {
    /// Normal curvature in the first direction.
    pub first: f64,
    /// Off the diagonal: the twist.
    pub mixed: f64,
    /// Normal curvature in the second direction.
    pub second: f64,
}

impl Form {
    /// The form of a jet. `axes`: perpendicular unit tangents; parts along the normal do not count. `None` where the jet has
    /// no tangent plane, or second derivatives are not finite.
    pub fn of(jet: &Jet2, axes: [DVec3; 2]) -> Option<Form> {
        let Jet { du, dv, normal, .. } = jet.first;
        let (e, f, g) = (du.dot(du), du.dot(dv), dv.dot(dv));
        let area = e * g - f * f;
        // A direction as parameters: a du + b dv.
        let [x, y] = axes.map(|axis| {
            let (p, q) = (axis.dot(du), axis.dot(dv));
            DVec2::new(g * p - f * q, e * q - f * p) / area
        });
        let [l, m, k] = [jet.duu, jet.duv, jet.dvv].map(|d| d.dot(normal));
        let apply = |a: DVec2, b: DVec2| l * a.x * b.x + m * (a.x * b.y + a.y * b.x) + k * a.y * b.y;
        let form = Form { first: apply(x, x), mixed: apply(x, y), second: apply(y, y) };
        // Written so that NaN has no form; sine of the angle between the derivatives as in `Jet2::curvature`.
        let plane = area > 1e-24 * e * g && normal != DVec3::ZERO;
        let finite = [form.first, form.mixed, form.second].iter().all(|x| x.is_finite());
        (plane && finite).then_some(form)
    }

    /// The largest principal curvature, by size.
    pub fn norm(&self) -> f64 {
        let mean = 0.5 * (self.first + self.second);
        mean.abs() + (0.5 * (self.first - self.second)).hypot(self.mixed)
    }

    /// What is left of it without another one.
    pub fn minus(&self, other: &Form) -> Form {
        Form { first: self.first - other.first, mixed: self.mixed - other.mixed, second: self.second - other.second }
    }

    /// Change of the unit normal for a step of length 1 in each of the two directions, as components along them
    /// (Weingarten's equations).
    pub fn turns(&self) -> [DVec2; 2] {
        [DVec2::new(-self.first, -self.mixed), DVec2::new(-self.mixed, -self.second)]
    }
}

/// Two perpendicular unit tangents of a jet, the first along `along`, the second to its left seen from the normal's side;
/// `None` where there is no normal or `along` is parallel to it.
pub(super) fn axes(jet: &Jet2, along: DVec3) -> Option<[DVec3; 2]> {
    let normal = jet.first.normal;
    let along = along.try_normalize()?;
    let first = (along - normal * along.dot(normal)).try_normalize().filter(|_| normal != DVec3::ZERO)?;
    Some([first, normal.cross(first)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    /// z = (a x^2 + 2 b xy + c y^2) / 2 at 0, in skew parameters: the form is the matrix, and its norm that of its eigenvalues.
    #[test]
    fn a_paraboloid_has_its_own_form() {
        let (a, b, c) = (0.7, -0.4, -1.9);
        let tangents = [dvec3(2.0, 0.5, 0.0), dvec3(-0.3, 0.8, 0.0)];
        let bend = |p: DVec3, q: DVec3| DVec3::Z * (a * p.x * q.x + b * (p.x * q.y + p.y * q.x) + c * p.y * q.y);
        let [u, v] = tangents;
        let first = Jet::new(DVec3::ZERO, u, v);
        let jet = Jet2 { first, duu: bend(u, u) + 3.0 * u, duv: bend(u, v) - v, dvv: bend(v, v) };
        let form = Form::of(&jet, [DVec3::X, DVec3::Y]).expect("it has a plane");
        for (value, expected) in [(form.first, a), (form.mixed, b), (form.second, c)] {
            assert!((value - expected).abs() < 1e-14, "{form:?}");
        }
        let principal = jet.curvature().expect("it has a plane").principal;
        assert!((form.norm() - principal[0].abs().max(principal[1].abs())).abs() < 1e-14);
        let left = axes(&jet, dvec3(0.0, 2.0, 5.0)).expect("it has a normal");
        assert!(left[0].distance(DVec3::Y) + left[1].distance(DVec3::NEG_X) < 1e-15);
        assert_eq!(Form::of(&Jet2 { first: Jet::new(DVec3::ZERO, u, u), ..jet }, left), None);
    }
}
