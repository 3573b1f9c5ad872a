//! Where points and instances are between time samples: interpolated, or carried on from the sample before by velocities.
//!
//! The rules are those of `UsdGeomPointBased::ComputePointsAtTime` and `UsdGeomPointInstancer::ComputeInstanceTransformsAtTime`:
//! velocities count where their samples are those of what they carry, and as many.

use glam::{DMat4, DVec3};
use openusd::sdf::Value;

use super::value::{Held, Node, points_of, quaternions_of};
use super::xform;
use crate::mesh::MeshError;

/// The points of a mesh.
pub(super) fn points(node: &Node<'_>) -> Result<Option<Vec<DVec3>>, MeshError> {
    match carried(node, "points")? {
        Some(points) => Ok(Some(points)),
        None => node.points("points"),
    }
}

/// What a point instancer does to its prototypes; arrays have one entry an instance, or none at all.
pub(super) struct Places {
    pub(super) positions: Option<Vec<DVec3>>,
    /// Quaternions, the real part first.
    pub(super) turns: Vec<[f64; 4]>,
    pub(super) scales: Vec<DVec3>,
    /// What angular velocities have turned since the sample before.
    pub(super) turned: Vec<DMat4>,
}

pub(super) fn places(node: &Node<'_>) -> Result<Places, MeshError> {
    let moved = carried(node, "positions")?;
    let name = match quaternions(node, "orientationsf", node.value("orientationsf")?)? {
        turns if turns.is_empty() => "orientations",
        _ => "orientationsf",
    };
    let turned = turned(node, name)?;
    if moved.is_none() && turned.is_empty() {
        return Ok(Places {
            positions: node.points("positions")?,
            turns: quaternions(node, name, node.value(name)?)?,
            scales: node.points("scales")?.unwrap_or_default(),
            turned,
        });
    }
    // Nothing is interpolated where velocities count.
    let at_sample = |name| match node.held(name)? {
        Some(held) => Ok(Some(held.value)),
        None => node.value(name),
    };
    let points_at_sample = |name| {
        let value = at_sample(name)?;
        value.map(|value| points_of(value).ok_or_else(|| node.wrong_type(name, "float3[]"))).transpose()
    };
    Ok(Places {
        positions: if moved.is_some() { moved } else { points_at_sample("positions")? },
        turns: quaternions(node, name, at_sample(name)?)?,
        scales: points_at_sample("scales")?.unwrap_or_default(),
        turned,
    })
}

fn quaternions(node: &Node<'_>, name: &str, value: Option<Value>) -> Result<Vec<[f64; 4]>, MeshError> {
    let turns = value.map(|value| quaternions_of(value).ok_or_else(|| node.wrong_type(name, "quath[]")));
    Ok(turns.transpose()?.unwrap_or_default())
}

/// Positions from the sample before on, along velocities and accelerations; `None` where those do not count.
fn carried(node: &Node<'_>, name: &str) -> Result<Option<Vec<DVec3>>, MeshError> {
    let Some(positions) = node.held(name)? else { return Ok(None) };
    let seconds = seconds(node, positions.at);
    let times = Held { value: (), at: positions.at, between: positions.between };
    let Some(mut positions) = points_of(positions.value) else { return Ok(None) };
    let Some(velocities) = aligned(node, "velocities", &times, positions.len())? else { return Ok(None) };
    let accelerations = aligned(node, "accelerations", &times, positions.len())?;
    for (k, position) in positions.iter_mut().enumerate() {
        let acceleration = accelerations.as_ref().map_or(DVec3::ZERO, |accelerations| accelerations[k]);
        *position += seconds * (velocities[k] + 0.5 * seconds * acceleration);
    }
    Ok(Some(positions))
}

/// What angular velocities have turned since the sample before; empty where they do not count.
fn turned(node: &Node<'_>, orientations: &str) -> Result<Vec<DMat4>, MeshError> {
    let Some(turns) = node.held(orientations)? else { return Ok(Vec::new()) };
    let seconds = seconds(node, turns.at);
    let times = Held { value: (), at: turns.at, between: turns.between };
    let count = quaternions_of(turns.value).map_or(0, |turns| turns.len());
    let velocities = aligned(node, "angularVelocities", &times, count)?.unwrap_or_default();
    Ok(velocities.into_iter().map(|velocity| xform::turning(velocity, seconds * velocity.length())).collect())
}

/// Velocities whose samples are those of what they carry, and as many.
fn aligned<T>(node: &Node<'_>, name: &str, to: &Held<T>, count: usize) -> Result<Option<Vec<DVec3>>, MeshError> {
    let Some(held) = node.held(name)? else { return Ok(None) };
    let are_close = |a: f64, b: f64| a == b || (a - b).abs() < f64::EPSILON;
    let is_aligned = are_close(held.at, to.at)
        && are_close(held.between[0], to.between[0])
        && are_close(held.between[1], to.between[1]);
    Ok(points_of(held.value).filter(|values| is_aligned && values.len() == count && count > 0))
}

/// Seconds from a sample to the time.
fn seconds(node: &Node<'_>, sample: f64) -> f64 {
    node.time.map_or(0.0, |time| (time - sample) / node.prim.stage().time_codes_per_second())
}
