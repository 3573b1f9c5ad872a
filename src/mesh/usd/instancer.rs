//! PointInstancer: a few prototypes in many places (`UsdGeomPointInstancer`).

use std::rc::Rc;

use glam::{DMat3, DMat4, DVec3};
use openusd::sdf;
use openusd::usd::Prim;

use super::motion::Places;
use super::prim::{self, Unplaced};
use super::value::{Node, one_line};
use super::{Found, Reader, State, ids, motion, xform};
use crate::memory;
use crate::mesh::MeshError;
use crate::mesh::validate::check_limit;

/// Most PointInstancers one in a prototype of the other.
const DEEPEST: usize = 16;

/// Bytes of the name of an instance, about.
const A_NAME: usize = 64;

/// A mesh of a prototype.
#[derive(Clone)]
struct Body {
    /// Its path below the prototype, with a slash, or nothing.
    below: String,
    mesh: Rc<Unplaced>,
    /// What the prims from the prototype on do to its points.
    local: DMat4,
}

/// An instance that is shown.
struct Instance {
    /// Its number among all.
    number: usize,
    prototype: usize,
    place: DMat4,
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
        let mut vertices = 0_usize;
        for Body { below, mesh, local } in self.instance_bodies(node, state, found, 0)? {
            let name = format!("{name}{below}");
            if self.choice.takes(&name) {
                // Before the memory is taken.
                vertices += mesh.vertex_count();
                check_limit("vertices", vertices, &node.place())?;
                found.meshes.push(Unplaced::clone(&mesh).place(name.clone(), state.world * local)?);
            }
            found.shown.push(name);
        }
        Ok(())
    }

    /// The meshes of all instances that are shown, where the instancer has them; `depth` instancers are round this one.
    fn instance_bodies(
        &self,
        node: &Node<'_>,
        state: &State,
        found: &mut Found,
        depth: usize,
    ) -> Result<Vec<Body>, MeshError> {
        if depth == DEEPEST {
            return Err(MeshError::InstancerInCircle { at: node.place() });
        }
        let prototypes = node.targets("prototypes")?;
        let mut bodies: Vec<Option<Vec<Body>>> = prototypes.iter().map(|_| None).collect();
        let mut all = Vec::new();
        for Instance { number, prototype, place } in instances(node, prototypes.len())? {
            let bodies = match &mut bodies[prototype] {
                Some(bodies) => bodies,
                none => none.insert(self.prototype(&prototypes[prototype], state, found, depth)?),
            };
            let count = all.len() + bodies.len();
            // Instancers in instancers multiply; now and then, because asking takes time.
            if count >> 16 > all.len() >> 16 {
                let bytes = count as u64 * (size_of::<Body>() + A_NAME) as u64;
                memory::check(bytes).map_err(|needs| MeshError::Memory { at: node.place(), needs })?;
            }
            all.extend(bodies.iter().map(|body| Body {
                below: format!("[{number}]{}", body.below),
                local: place * body.local,
                ..body.clone()
            }));
        }
        Ok(all)
    }

    fn prototype(
        &self,
        root: &sdf::Path,
        instancer: &State,
        found: &mut Found,
        depth: usize,
    ) -> Result<Vec<Body>, MeshError> {
        let above = State { world: DMat4::IDENTITY, visible: true, purpose: instancer.purpose.clone() };
        let mut prototype = Prototype { start: root.to_string().len(), depth, bodies: Vec::new() };
        self.gather(root, &above, &mut prototype, found)?;
        Ok(prototype.bodies)
    }

    /// The meshes of a prim and those below it.
    fn gather(
        &self,
        path: &sdf::Path,
        above: &State,
        prototype: &mut Prototype,
        found: &mut Found,
    ) -> Result<(), MeshError> {
        let source = self.source(path);
        let (prim, kind) = self.prim(path, &source)?;
        let node = self.node(&prim, &source);
        let unreadable =
            |error: openusd::Error| MeshError::UsdUnreadable { at: node.place(), reason: one_line(&error) };
        if !prim.is_active().map_err(unreadable)? {
            return Ok(());
        }
        let state = self.handed_down(&node, &kind, above.clone())?;
        let below = path.to_string()[prototype.start..].to_owned();
        match kind.as_str() {
            "Mesh" if state.is_shown() && !prim::is_empty(&node)? => {
                prototype.bodies.push(Body { below, mesh: Rc::new(prim::read(&node)?), local: state.world });
            }
            "PointInstancer" => {
                if state.is_shown() {
                    let inner = self.instance_bodies(&node, &state, found, prototype.depth + 1)?;
                    prototype.bodies.extend(inner.into_iter().map(|body| Body {
                        below: format!("{below}{}", body.below),
                        local: state.world * body.local,
                        mesh: body.mesh,
                    }));
                }
                // What is below is there to be instanced.
                return Ok(());
            }
            kind if state.is_shown() => found.pass_over(kind, path),
            _ => {}
        }
        let children: Vec<Prim> = prim.children().map_err(unreadable)?;
        children.iter().try_for_each(|child| self.gather(child.path(), &state, prototype, found))
    }
}

/// A prototype that is being read.
struct Prototype {
    /// How much of the paths is its own.
    start: usize,
    /// How many instancers are round the one that it is of.
    depth: usize,
    bodies: Vec<Body>,
}

fn required<T>(node: &Node<'_>, name: &'static str, value: Option<T>) -> Result<T, MeshError> {
    value.ok_or_else(|| MeshError::InstancerIncomplete { at: node.place(), name })
}

/// The instances that are not left out, in their order, of `prototypes` prototypes.
fn instances(node: &Node<'_>, prototypes: usize) -> Result<Vec<Instance>, MeshError> {
    let which = required(node, "protoIndices", node.indices("protoIndices")?)?;
    let places = matrices(node, motion::places(node)?, which.len())?;
    let hidden = ids::left_out(node)?;
    let ids = node.longs("ids")?;
    let id = |number: usize| if ids.len() == which.len() { ids[number] } else { number as i64 };
    let mut instances = Vec::new();
    for (number, (&index, place)) in which.iter().zip(places).enumerate() {
        if hidden.contains(&id(number)) {
            continue;
        }
        let prototype = index as usize;
        if prototype >= prototypes {
            return Err(MeshError::PrototypeUnknown { at: node.place(), index, count: prototypes });
        }
        instances.push(Instance { number, prototype, place });
    }
    Ok(instances)
}

/// What puts a prototype where each of `count` instances is: scaled, turned, moved.
fn matrices(node: &Node<'_>, places: Places, count: usize) -> Result<Vec<DMat4>, MeshError> {
    let Places { positions, turns, scales, turned } = places;
    let positions = required(node, "positions", positions)?;
    let lengths = [("positions", positions.len()), ("orientations", turns.len()), ("scales", scales.len())];
    for (name, found) in lengths {
        // Empty ones say nothing, but there are as many positions as instances.
        if found != count && (found > 0 || name == "positions") {
            let expected = format!("{count}, one for each of protoIndices");
            return Err(MeshError::AttributeLength { at: node.place(), name, found, expected });
        }
    }
    let place = |k: usize| {
        let mut place = DMat4::from_translation(positions[k]);
        if let Some(&turned) = turned.get(k) {
            place *= turned;
        }
        if let Some(&turn) = turns.get(k) {
            place *= matrix(turn);
        }
        if let Some(&scale) = scales.get(k) {
            place *= xform::scaling(scale);
        }
        place
    };
    Ok((0..count).map(place).collect())
}

/// The matrix of a quaternion as `GfMatrix4d::SetRotate` writes it: of one whose length is not 1, as those of 16 bits, it is
/// not quite a turn.
fn matrix([w, x, y, z]: [f64; 4]) -> DMat4 {
    DMat4::from_mat3(DMat3::from_cols(
        DVec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (z * x - y * w)),
        DVec3::new(2.0 * (x * y - z * w), 1.0 - 2.0 * (z * z + x * x), 2.0 * (y * z + x * w)),
        DVec3::new(2.0 * (z * x + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (y * y + x * x)),
    ))
}
