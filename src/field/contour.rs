//! Contours f = c as zero sets of smooth functions.
//!
//! Theory: fields have poles (a mirrored ray parallel to the light plane), jumps (from -180 to 180 degrees, from one nearest light
//! to the next) and roots; their contours have not. So each method gives at most four *functions* b(point), of which every contour is
//! a zero set, F = w . b with weights w that depend on the value and the light alone (Ulmet 2003, eq. 5.13 without the division
//! by s . k; Beier & Chen 1994, eq. 15 and 17). The zero set may be larger than the contour (rays that leave the plane behind, the
//! longitude on the other side): what counts of it is where a second such function V is above 0.
//! Practice: a tracer takes the functions once a point and has all values of a family.

use super::{CurvatureKind, Field, HighlightKind, Light, Method, PlaneCurve, Point, reflection_direction};
use crate::stam::LimitSurface;
use glam::DVec3;

/// Functions of a point; those that a method does not need are 0.
pub type Functions = [f64; 4];

/// A contour as part of a zero set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contour {
    /// Weights of F.
    pub zero: Functions,
    /// Weights of V; `None` where the whole zero set counts.
    pub valid: Option<Functions>,
}

impl Contour {
    fn whole(zero: Functions) -> Option<Contour> {
        Some(Contour { zero, valid: None })
    }

    fn where_valid(zero: Functions, valid: Functions) -> Option<Contour> {
        Some(Contour { zero, valid: Some(valid) })
    }
}

/// Sine of the angle to a place where a field is undefined (light at the horizon, a pole of the sphere) at which its contours end.
/// Values turn with one over its square there: nearer, the last digit of (u,v) would move them by more than 1e-10.
const POLE: f64 = 3e-4;

/// Sine of an isophote's angle below which the cosine does not tell it from 0 or 180 degrees.
const SMALLEST_ISOPHOTE: f64 = 1e-7;

/// A weighted sum.
#[inline]
pub(crate) fn weighted(weights: &Functions, functions: &Functions) -> f64 {
    (weights[0] * functions[0] + weights[1] * functions[1]) + (weights[2] * functions[2] + weights[3] * functions[3])
}

impl Field {
    /// The functions at a point; `None` where they are undefined.
    pub fn functions(&self, point: &Point) -> Option<Functions> {
        let Field { light, method } = self;
        let Point { position, normal, sight, curvature } = *point;
        if normal == DVec3::ZERO {
            return None;
        }
        let functions = match method {
            Method::Reflection => {
                let [x, _, w, valid] = mirrored(light, position, ray(normal, sight)?)?;
                [x, w, 0.0, valid]
            }
            Method::Curve(PlaneCurve::Circle) => conic(light, position, ray(normal, sight)?, 1.0)?,
            Method::Curve(PlaneCurve::Ellipse { aspect }) => conic(light, position, ray(normal, sight)?, *aspect)?,
            Method::Curve(_) | Method::Section => [self.value(point)?.x, 1.0, 0.0, 0.0],
            Method::RayDistance => distances(light, position, ray(normal, sight)?),
            Method::Highlight(HighlightKind::Array) => {
                let [x, _, w, _] = mirrored(light, position, normal)?;
                [x, w, 0.0, w * w - POLE * POLE]
            }
            Method::Highlight(HighlightKind::Nearest) => distances(light, position, normal),
            Method::Highlight(kind) => {
                let across = light.axes[1].cross(normal);
                let pseudo = across.dot(light.center - position);
                match kind {
                    HighlightKind::Alternative(radius) => [pseudo - radius * across.length(), 1.0, 0.0, 0.0],
                    _ => [pseudo, across.length(), 1.0, 0.0],
                }
            }
            Method::Sphere(mirrored) => {
                let d = mirrored.direction(normal, sight).try_normalize()?;
                [d.dot(light.axes[0]), d.dot(light.axes[1]), 1.0, 0.0]
            }
            Method::Isophote => [-normal.dot(light.normal()), 1.0, 0.0, 0.0],
            Method::Curvature(kind) => [kind.of(&curvature?).x, 1.0, 0.0, 0.0],
        };
        functions.iter().all(|x| x.is_finite()).then_some(functions)
    }

    /// The contour of a value; of light `light` where the field is the distance from the nearest one. `None` where no point has
    /// the value.
    pub fn contour(&self, light: i32, value: f64) -> Option<Contour> {
        if !value.is_finite() {
            return None;
        }
        let spacing = self.light.spacing;
        match &self.method {
            Method::Reflection | Method::Highlight(HighlightKind::Array) => {
                Contour::where_valid([1.0, -value, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])
            }
            Method::Curve(PlaneCurve::Circle | PlaneCurve::Ellipse { .. }) if value > 0.0 => {
                Contour::where_valid([1.0, -value * value, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])
            }
            Method::Curve(PlaneCurve::Circle | PlaneCurve::Ellipse { .. }) => None,
            Method::Curve(_) | Method::Section | Method::Curvature(_) => Contour::whole([1.0, -value, 0.0, 0.0]),
            Method::RayDistance | Method::Highlight(HighlightKind::Nearest) => {
                Contour::where_valid([1.0, f64::from(light) * spacing, -value, 0.0], [0.0, 0.0, -value.abs(), spacing])
            }
            Method::Highlight(HighlightKind::Signed) => {
                Contour::where_valid([1.0, -value, 0.0, 0.0], [0.0, 1.0, -POLE, 0.0])
            }
            Method::Highlight(HighlightKind::Pseudo) => Contour::whole([1.0, 0.0, -value, 0.0]),
            Method::Highlight(HighlightKind::Alternative(_)) => Contour::whole([1.0, -value, 0.0, 0.0]),
            Method::Sphere(_) => {
                let (sin, cos) = value.to_radians().sin_cos();
                Contour::where_valid([-sin, cos, 0.0, 0.0], [cos, sin, -POLE, 0.0])
            }
            // 0 and 180 degrees are where the angle is least and largest: points, or regions.
            Method::Isophote => {
                let (sin, cos) = value.to_radians().sin_cos();
                ((0.0..=180.0).contains(&value) && sin > SMALLEST_ISOPHOTE)
                    .then_some(Contour { zero: [1.0, -cos, 0.0, 0.0], valid: None })
            }
        }
    }

    /// The step that rounding makes in values of the field on a surface, about.
    pub(crate) fn rounding(&self, value: f64, surface: &LimitSurface) -> f64 {
        let light = &self.light;
        let diagonal = surface.diagonal();
        let distance = surface.bounds().map_or(0.0, |[low, high]| (0.5 * (low + high)).distance(light.center));
        let size = match self.method {
            Method::Sphere(_) | Method::Isophote => 180.0,
            Method::Curvature(CurvatureKind::Gaussian) => light.spacing.max(1.0 / (diagonal * diagonal)),
            Method::Curvature(_) => light.spacing.max(1.0 / diagonal),
            Method::Curve(_) => light.spacing,
            _ => light.spacing.max(diagonal + distance),
        };
        f64::EPSILON * size.max(value.abs())
    }
}

/// Direction of the mirrored line of sight, of unit length as the normal is.
#[inline]
fn ray(normal: DVec3, sight: DVec3) -> Option<DVec3> {
    Some(reflection_direction(normal, sight.try_normalize()?))
}

/// Homogeneous coordinates (x w, y w, w) of the point of the light plane on a line (Ulmet 2003, eq. 5.9, times s . k), and V: above
/// 0 where the ray along `direction` meets the plane in front of it.
#[inline]
fn mirrored(light: &Light, position: DVec3, direction: DVec3) -> Option<Functions> {
    let (plane, to_center) = (light.normal(), light.center - position);
    let (depth, w) = (to_center.dot(plane), direction.dot(plane));
    let [x, y] = light.axes.map(|axis| direction.dot(axis) * depth - to_center.dot(axis) * w);
    let distance = to_center.length();
    (distance > 0.0).then(|| [x, y, w, depth / distance * w - POLE])
}

/// Functions of the ellipses x^2 + (y / aspect)^2 = c^2 (Ulmet 2003, eq. 5.13).
fn conic(light: &Light, position: DVec3, ray: DVec3, aspect: f64) -> Option<Functions> {
    let [x, y, w, valid] = mirrored(light, position, ray)?;
    Some([x * x + (y / aspect).powi(2), w * w, 0.0, valid])
}

/// Functions of the distances from parallel lights (Ulmet 2003, eq. 4.2; Beier & Chen 1994, eq. 15): V is above 0 where half the
/// step from light to light is more than the distance.
fn distances(light: &Light, position: DVec3, direction: DVec3) -> Functions {
    let across = direction.cross(light.axes[1]);
    let step = across.dot(light.axes[0]);
    [across.dot(light.center - position), step, across.length(), 0.5 * step.abs() - POLE]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Curvature, Mirrored};
    use glam::dvec3;

    /// F vanishes where the field has the value, and nowhere else among what is valid.
    #[test]
    fn functions_vanish_on_the_contour() {
        let light = Light::new(dvec3(0.3, -0.2, 5.0), dvec3(0.1, 0.2, -1.0), dvec3(0.3, 1.0, 0.1), 0.7);
        let expression = |text: &str| PlaneCurve::Expression(text.parse().expect("it is one"));
        let methods = [
            Method::Reflection,
            Method::Curve(PlaneCurve::Circle),
            Method::Curve(PlaneCurve::Ellipse { aspect: 0.4 }),
            Method::Curve(expression("x * y")),
            Method::RayDistance,
            Method::Highlight(HighlightKind::Array),
            Method::Highlight(HighlightKind::Signed),
            Method::Highlight(HighlightKind::Nearest),
            Method::Highlight(HighlightKind::Pseudo),
            Method::Highlight(HighlightKind::Alternative(0.3)),
            Method::Sphere(Mirrored::Reflection),
            Method::Sphere(Mirrored::Normal),
            Method::Isophote,
            Method::Curvature(CurvatureKind::Largest),
            Method::Section,
        ];
        for method in methods {
            let field = Field { light, method };
            let mut count = 0;
            for k in 0..300 {
                let a = 0.37 * f64::from(k);
                let normal = dvec3(0.5 * a.cos(), 0.4 * (1.3 * a).sin(), 1.0).normalize();
                let position = dvec3((0.7 * a).sin(), (0.3 * a).cos(), 0.2 * a.sin());
                let curvature = Curvature { gaussian: 0.0, mean: 0.5 * a.sin(), principal: [a.sin().max(0.0), 0.0] };
                let sight = dvec3(0.2, 0.1 * a.sin(), -1.0);
                let point = Point { position, normal, sight, curvature: Some(curvature) };
                let Some(value) = field.value(&point) else { continue };
                let functions = field.functions(&point).expect("they are defined where the field is");
                let contour = field.contour(value.y as i32, value.x).expect("the value is taken");
                let zero = weighted(&contour.zero, &functions);
                assert!(zero.abs() < 1e-13 * (1.0 + value.x.abs().powi(2)), "{} {value}: {zero}", field.method);
                assert!(
                    contour.valid.is_none_or(|valid| weighted(&valid, &functions) > 0.0),
                    "{} {value}",
                    field.method
                );
                let other = field.contour(value.y as i32, value.x + 1e-3).expect("so is its neighbour");
                assert!(weighted(&other.zero, &functions).abs() > 1e-8, "{} {value}", field.method);
                count += 1;
            }
            assert!(count > 100, "{}: {count}", field.method);
        }
    }

    #[test]
    fn rays_away_from_the_light_are_not_valid() {
        let field = Field::reflection(Light::new(dvec3(0.0, 0.0, -7.0), DVec3::Z, DVec3::Y, 1.0));
        let point = Point { position: DVec3::ZERO, normal: DVec3::Z, sight: dvec3(0.0, -1.0, -1.0), curvature: None };
        assert_eq!(field.value(&point), None);
        let functions = field.functions(&point).expect("they are defined");
        let valid = field.contour(0, 0.0).and_then(|contour| contour.valid).expect("not everything is valid");
        assert!(weighted(&valid, &functions) < 0.0);
    }
}
