//! How a field changes along a surface.

use super::form::Form;
use crate::field::{Camera, Field, Method, Mirrored, Point};
use crate::stam::{Jet, Jet2};
use glam::{DVec2, DVec3};

/// Value of a field at a point of a surface. `None` where it is undefined.
pub(super) fn value(field: &Field, camera: &Camera, jet: &Jet2) -> Option<DVec2> {
    let Jet { position, normal, .. } = jet.first;
    let curvature = if field.method.reads_curvature() { jet.curvature() } else { None };
    field.value(&Point { position, normal, sight: camera.sight(position), curvature })
}

/// How much of a field's first coordinate rounding may be, where curvatures may be off by `rounding`: over the width w of the patch that
/// turns the normal by rounding w and moves the point by rounding w^2. `None` where the field is undefined at a point as near as that.
pub(super) fn blur(field: &Field, camera: &Camera, jet: &Jet2, rounding: f64) -> Option<f64> {
    let Jet { du, dv, normal, .. } = jet.first;
    let width = du.length().max(dv.length());
    let exact = value(field, camera, jet)?;
    let mut most = 0.0f64;
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for sign in [rounding, -rounding] {
            let (mut moved, mut turned) = (*jet, *jet);
            moved.first.position += axis * sign * width * width;
            turned.first.normal = (normal + axis * sign * width).try_normalize()?;
            for near in [moved, turned] {
                most = most.max(difference(&field.method, value(field, camera, &near)?, exact).unwrap_or(0.0).abs());
            }
        }
    }
    if field.method.reads_curvature() {
        for sign in [rounding, -rounding] {
            // All normal curvatures the same amount larger.
            let mut bent = *jet;
            bent.duu += normal * sign * du.dot(du);
            bent.duv += normal * sign * du.dot(dv);
            bent.dvv += normal * sign * dv.dot(dv);
            most = most.max(difference(&field.method, value(field, camera, &bent)?, exact).unwrap_or(0.0).abs());
        }
    }
    Some(most)
}

/// Difference of two values' first coordinates. `None` where they are not on the same sheet: at the edges between nearest lights.
pub(super) fn difference(method: &Method, a: DVec2, b: DVec2) -> Option<f64> {
    match method {
        // Longitudes wrap.
        Method::Sphere(Mirrored::Reflection | Mirrored::Normal) => {
            let turn = (a.x - b.x) / 360.0;
            Some(360.0 * (turn - turn.round()))
        }
        Method::RayDistance | Method::Highlight(crate::field::HighlightKind::Nearest) => {
            (a.y == b.y).then_some(a.x - b.x)
        }
        _ => Some(a.x - b.x),
    }
}

/// Angle between two slopes, and so between the contours across them, degrees, 0 to 180; exact for small ones.
pub(super) fn turn_deg(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b).abs().atan2(a.dot(b)).to_degrees()
}

/// Derivative of a field's first coordinate along a surface in each of two perpendicular unit tangents, field units a model unit.
///
/// The field is a function of position and normal, and on the surface the normal turns as the second fundamental form says (Weingarten's
/// equations): the slope is the sum of the two partial derivatives. These are differences of fourth order, over steps of a
/// thousandth of the patch and of a radian, or finer ones where the field asks for them.
///
/// `rounding`: how far the form may be off. `None` where the slope is not known to a thousandth, so that directions are good to 0.06
/// degrees: the field is undefined nearby, constant, or too steep; or it reads curvature, whose derivative needs third derivatives of
/// the surface.
pub(super) fn slope(field: &Field, camera: &Camera, jet: &Jet2, axes: [DVec3; 2], rounding: f64) -> Option<DVec2> {
    const KNOWN: f64 = 1e-3;
    if field.method.reads_curvature() {
        return None;
    }
    let Jet { position, du, dv, normal } = jet.first;
    let form = Form::of(jet, axes)?;
    let at = |position: DVec3, normal: DVec3| {
        let normal = normal.try_normalize()?;
        field.value(&Point { position, normal, sight: camera.sight(position), curvature: None })
    };
    let width = du.length().max(dv.length());
    let (mut moved, mut turned, mut error) = (DVec2::ZERO, DVec2::ZERO, 0.0);
    for i in 0..2 {
        let (by_position, off) = derivative(&field.method, width, |step| at(position + axes[i] * step, normal))?;
        let (by_normal, off_too) = derivative(&field.method, 1.0, |step| at(position, normal + axes[i] * step))?;
        (moved[i], turned[i]) = (by_position, by_normal);
        error += off + off_too * form.norm();
    }
    let turns = form.turns();
    let slope = moved + DVec2::new(turns[0].dot(turned), turns[1].dot(turned));
    error += rounding * turned.length();
    (error <= KNOWN * slope.length() && slope != DVec2::ZERO).then_some(slope)
}

/// Derivative at 0 of a function that is smooth over lengths of about `scale`, and how far it may be off. The difference of the two
/// estimates that are combined is the error of the coarser one, so it bounds that of their combination by far, but for rounding.
fn derivative(method: &Method, scale: f64, at: impl Fn(f64) -> Option<DVec2>) -> Option<(f64, f64)> {
    /// Part of the derivative that the estimates may differ by before a finer step is taken.
    const CLOSE: f64 = 1e-5;
    let mut best: Option<(f64, f64)> = None;
    for step in [1e-3 * scale, 1e-4 * scale, 1e-5 * scale] {
        let apart = |steps: f64| difference(method, at(steps * step)?, at(-steps * step)?);
        let Some((near, far)) = apart(1.0).zip(apart(2.0)) else { continue };
        let [near, far] = [near / (2.0 * step), far / (4.0 * step)];
        let found = ((4.0 * near - far) / 3.0, (near - far).abs());
        if best.is_none_or(|best| found.1 < best.1) {
            best = Some(found);
        }
        if found.1 <= CLOSE * found.0.abs() {
            break;
        }
    }
    best
}
