//! The transform of a prim: `UsdGeomXformable`'s list of operations.
//!
//! USD multiplies row vectors, so the last operation of `xformOpOrder` acts on the points first; here matrices are
//! columns, and the product in the order of the list is the same.

use glam::{DMat4, DVec3};
use openusd::sdf::Value;

use super::value::Node;
use crate::mesh::MeshError;
use crate::mesh::error::quote;

const RESET: &str = "!resetXformStack!";

/// The operations of `UsdGeomXformOp`.
const KINDS: [&str; 19] = [
    "translate",
    "translateX",
    "translateY",
    "translateZ",
    "scale",
    "scaleX",
    "scaleY",
    "scaleZ",
    "rotateX",
    "rotateY",
    "rotateZ",
    "rotateXYZ",
    "rotateXZY",
    "rotateYXZ",
    "rotateYZX",
    "rotateZXY",
    "rotateZYX",
    "orient",
    "transform",
];

/// What a prim does to its points, and whether its parents do theirs.
pub(super) struct Local {
    pub(super) matrix: DMat4,
    pub(super) resets: bool,
}

/// The operations of a prim, multiplied.
///
/// # Errors
/// An operation that is not one of USD's, or that has a value of another type.
pub(super) fn local(node: &Node<'_>) -> Result<Local, MeshError> {
    let order = node.tokens("xformOpOrder")?;
    let reset = order.iter().rposition(|op| op == RESET);
    let mut matrix = DMat4::IDENTITY;
    for op in &order[reset.map_or(0, |i| i + 1)..] {
        matrix *= operation(node, op)?;
    }
    Ok(Local { matrix, resets: reset.is_some() })
}

fn operation(node: &Node<'_>, op: &str) -> Result<DMat4, MeshError> {
    let (name, inverted) = op.strip_prefix("!invert!").map_or((op, false), |name| (name, true));
    let unknown = || MeshError::TransformUnknown { at: node.place(), op: quote(op.as_bytes()) };
    let kind = name.strip_prefix("xformOp:").ok_or_else(unknown)?.split(':').next().unwrap_or_default();
    if !KINDS.contains(&kind) {
        return Err(unknown());
    }
    // An operation without a value does nothing.
    let Some(value) = node.value(name)? else { return Ok(DMat4::IDENTITY) };
    let wrong = |expected| node.wrong_type(&quote(name.as_bytes()), expected);
    let vector = |value: Value| value.cast::<[f64; 3]>().map(DVec3::from).map_err(|_| wrong("three numbers"));
    let number = |value: Value| value.cast::<f64>().map_err(|_| wrong("a number"));
    let matrix = match kind {
        "translate" => DMat4::from_translation(vector(value)?),
        "translateX" => DMat4::from_translation(DVec3::X * number(value)?),
        "translateY" => DMat4::from_translation(DVec3::Y * number(value)?),
        "translateZ" => DMat4::from_translation(DVec3::Z * number(value)?),
        "scale" => scaling(vector(value)?),
        "scaleX" => scaling(DVec3::new(number(value)?, 1.0, 1.0)),
        "scaleY" => scaling(DVec3::new(1.0, number(value)?, 1.0)),
        "scaleZ" => scaling(DVec3::new(1.0, 1.0, number(value)?)),
        "rotateX" => rotation("X", DVec3::splat(number(value)?)),
        "rotateY" => rotation("Y", DVec3::splat(number(value)?)),
        "rotateZ" => rotation("Z", DVec3::splat(number(value)?)),
        "rotateXYZ" | "rotateXZY" | "rotateYXZ" | "rotateYZX" | "rotateZXY" | "rotateZYX" => {
            rotation(&kind["rotate".len()..], vector(value)?)
        }
        "orient" => {
            let [w, x, y, z] = value.cast::<[f64; 4]>().map_err(|_| wrong("a quaternion"))?;
            orientation(w, DVec3::new(x, y, z))
        }
        // Rows of theirs are columns of ours.
        "transform" => match value {
            Value::Matrix4d(matrix) => DMat4::from_cols_array(&matrix.0),
            _ => return Err(wrong("matrix4d")),
        },
        _ => return Err(unknown()),
    };
    Ok(if inverted { matrix.inverse() } else { matrix })
}

pub(super) fn scaling(factors: DVec3) -> DMat4 {
    // Not from_scale, which does not take zeros in debug builds.
    DMat4::from_diagonal(factors.extend(1.0))
}

/// A turn about an axis, of whatever length, by an angle in degrees.
pub(super) fn turning(axis: DVec3, degrees: f64) -> DMat4 {
    axis.try_normalize().map_or(DMat4::IDENTITY, |axis| DMat4::from_axis_angle(axis, degrees.to_radians()))
}

/// The turn of a quaternion, as `GfRotation::SetQuat` reads it: one whose length is not 1 turns by its real part.
fn orientation(real: f64, imaginary: DVec3) -> DMat4 {
    match imaginary.try_normalize() {
        Some(axis) => DMat4::from_axis_angle(axis, 2.0 * real.clamp(-1.0, 1.0).acos()),
        None => DMat4::IDENTITY,
    }
}

/// Turns about the axes, in degrees, the first letter first.
fn rotation(order: &str, degrees: DVec3) -> DMat4 {
    order.chars().fold(DMat4::IDENTITY, |turned, axis| {
        let turn = match axis {
            'X' => DMat4::from_rotation_x(degrees.x.to_radians()),
            'Y' => DMat4::from_rotation_y(degrees.y.to_radians()),
            _ => DMat4::from_rotation_z(degrees.z.to_radians()),
        };
        turn * turned
    })
}
