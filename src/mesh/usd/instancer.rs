//! PointInstancer: a few prototypes in many places (`UsdGeomPointInstancer`).

use std::collections::HashSet;

use glam::{DMat3, DMat4, DVec3};
use openusd::sdf;
use openusd::usd::Prim;

use super::prim::{self, Unplaced};
use super::value::{Node, one_line};
use super::{Found, Reader, State, xform};
use crate::mesh::MeshError;
use crate::mesh::validate::check_limit;

/// A mesh of a prototype.
struct Body {
    /// Its path below the prototype, with a slash, or nothing.
    below: String,
    mesh: Unplaced,
    /// What the prims from the prototype on do to its points.
    local: DMat4,
}

impl Reader<'_> {
    /// Adds the meshes of all instances that are shown; `name` is the path of the instancer. Those of instance 12 are called
    /// `/Path/To[12]/...`.
    pub(super) fn instances(
        &self,
        node: &Node<'_>,
        name: &str,
        state: &State,
        found: &mut Found,
    ) -> Result<(), MeshError> {
        let prototypes = node.targets("prototypes")?;
        let which = required(node, "protoIndices", node.indices("protoIndices")?)?;
        let places = places(node, which.len())?;
        let hidden: HashSet<i64> = node.longs("invisibleIds")?.unwrap_or_default().into_iter().collect();
        let ids = node.longs("ids")?.filter(|ids| ids.len() == which.len());
        let mut bodies: Vec<Option<Vec<Body>>> = prototypes.iter().map(|_| None).collect();
        let mut vertices = 0_usize;
        for (k, (&prototype, place)) in which.iter().zip(places).enumerate() {
            if hidden.contains(&ids.as_ref().map_or(k as i64, |ids| ids[k])) {
                continue;
            }
            let count = prototypes.len();
            let unknown = || MeshError::PrototypeUnknown { at: node.place(), index: prototype, count };
            let body = bodies.get_mut(prototype as usize).ok_or_else(unknown)?;
            let bodies = match body {
                Some(bodies) => bodies,
                None => body.insert(self.prototype(&prototypes[prototype as usize], state)?),
            };
            for Body { below, mesh, local } in bodies {
                let name = format!("{name}[{k}]{below}");
                if self.choice.takes(&name) {
                    // Before the memory is taken.
                    vertices += mesh.vertex_count();
                    check_limit("vertices", vertices, &node.place())?;
                    found.meshes.push(mesh.clone().place(name.clone(), state.world * place * *local)?);
                }
                found.shown.push(name);
            }
        }
        Ok(())
    }

    fn prototype(&self, root: &sdf::Path, instancer: &State) -> Result<Vec<Body>, MeshError> {
        let above = State { world: DMat4::IDENTITY, visible: true, purpose: instancer.purpose.clone() };
        let mut bodies = Vec::new();
        self.gather(root, root.to_string().len(), &above, &mut bodies)?;
        Ok(bodies)
    }

    /// The meshes of a prim and those below it; the first `start` bytes of their paths are the prototype's.
    fn gather(&self, path: &sdf::Path, start: usize, above: &State, bodies: &mut Vec<Body>) -> Result<(), MeshError> {
        let source = self.source(path);
        let (prim, kind) = self.prim(path, &source)?;
        let node = self.node(&prim, &source);
        let unreadable =
            |error: openusd::Error| MeshError::UsdUnreadable { at: node.place(), reason: one_line(&error) };
        if !prim.is_active().map_err(unreadable)? {
            return Ok(());
        }
        let state = self.handed_down(&node, &kind, above.clone())?;
        match kind.as_str() {
            "Mesh" if state.is_shown() && !prim::is_empty(&node)? => {
                let below = path.to_string()[start..].to_owned();
                bodies.push(Body { below, mesh: prim::read(&node)?, local: state.world });
            }
            "PointInstancer" if state.is_shown() => {
                return Err(MeshError::InstancerUnsupported { at: node.place() });
            }
            _ => {}
        }
        let children: Vec<Prim> = prim.children().map_err(unreadable)?;
        children.iter().try_for_each(|child| self.gather(child.path(), start, &state, bodies))
    }
}

fn required<T>(node: &Node<'_>, name: &'static str, value: Option<T>) -> Result<T, MeshError> {
    value.ok_or_else(|| MeshError::InstancerIncomplete { at: node.place(), name })
}

/// What puts a prototype where each instance is: scaled, turned, moved.
fn places(node: &Node<'_>, count: usize) -> Result<Vec<DMat4>, MeshError> {
    let fits = |name: &'static str, found: usize| {
        let expected = format!("{count}, one for each of protoIndices");
        match found == count {
            true => Ok(()),
            false => Err(MeshError::AttributeLength { at: node.place(), name, found, expected }),
        }
    };
    let positions = required(node, "positions", node.points("positions")?)?;
    fits("positions", positions.len())?;
    let turns = match node.quaternions("orientationsf")?.filter(|turns| !turns.is_empty()) {
        Some(turns) => turns,
        None => node.quaternions("orientations")?.unwrap_or_default(),
    };
    let scales = node.points("scales")?.unwrap_or_default();
    // Empty ones say nothing.
    for (name, found) in [("orientations", turns.len()), ("scales", scales.len())] {
        if found > 0 {
            fits(name, found)?;
        }
    }
    let place = |k: usize| {
        let turn = turns.get(k).map_or(DMat4::IDENTITY, |&turn| turned(turn));
        let scale = scales.get(k).map_or(DMat4::IDENTITY, |&scale| xform::scaling(scale));
        DMat4::from_translation(positions[k]) * turn * scale
    };
    Ok((0..count).map(place).collect())
}

/// The matrix of a quaternion as `GfMatrix4d::SetRotate` writes it: of one whose length is not 1, as those of 16 bits, it is
/// not quite a turn.
fn turned([w, x, y, z]: [f64; 4]) -> DMat4 {
    DMat4::from_mat3(DMat3::from_cols(
        DVec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (z * x - y * w)),
        DVec3::new(2.0 * (x * y - z * w), 1.0 - 2.0 * (z * z + x * x), 2.0 * (y * z + x * w)),
        DVec3::new(2.0 * (z * x + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (y * y + x * x)),
    ))
}
