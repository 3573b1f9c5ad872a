//! USD (usda, usdc, usdz), by the openusd crate, which composes the stage: references, payloads, variants, instances.
//!
//! Every Mesh prim that is visible and of purpose default or render counts, with its points in world space, in the units
//! of the stage. Values are those at the default time; where an attribute has time samples alone, the first counts.
//! What skeletons and blend shapes would do to points is passed over, as are other primitives, subsets and primvars.
//!
//! Schema: `UsdGeomMesh`, `UsdGeomImageable` and `UsdGeomXformable` of OpenUSD.

mod prim;
mod scene;
mod value;
mod xform;

use std::collections::HashMap;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

use glam::{DMat4, DVec3};
use openusd::sdf::{self, Value};
use openusd::usd::{PrimPredicate, Stage};

use super::error::{Place, Spot};
use super::{MeshError, SubdivMesh};
use value::{Node, one_line};

/// What a prim hands down to those below it.
#[derive(Clone)]
struct State {
    world: DMat4,
    visible: bool,
    /// Purpose as authored here or nearest above.
    purpose: String,
}

impl State {
    fn is_shown(&self) -> bool {
        self.visible && matches!(self.purpose.as_str(), "default" | "render")
    }
}

/// Reads and validates the meshes of the file, as one; see [`super::read`].
pub(super) fn read(path: &Path) -> Result<SubdivMesh, MeshError> {
    let at = || Place::file(path);
    check_readable(path)?;
    let unreadable = |error: openusd::Error| MeshError::UsdUnreadable { at: at(), reason: one_line(&error) };
    let absolute = std::path::absolute(path).map_err(|error| MeshError::Unreadable { at: at(), error })?;
    let absolute = absolute.to_str().ok_or_else(|| MeshError::PathNotText { at: at() })?;
    let stage = Stage::open(absolute).map_err(unreadable)?;
    let mut paths = Vec::new();
    stage.traverse(PrimPredicate::DEFAULT_PROXIES, |path| paths.push(path.clone())).map_err(unreadable)?;
    if let Some(error) = stage.composition_errors().first() {
        return Err(MeshError::UsdIncomplete { at: at(), reason: one_line(error) });
    }
    let file = path.display().to_string();
    let mut states = HashMap::new();
    let mut meshes = Vec::new();
    for path in paths {
        if let Some(mesh) = visit(&stage, path, &file, &mut states)? {
            meshes.push(mesh);
        }
    }
    if meshes.is_empty() {
        return Err(MeshError::NoMeshPrims { at: at() });
    }
    let mut scene = scene::join(meshes, &file, &path.file_stem().unwrap_or_default().to_string_lossy())?;
    scene.up = up_axis(&stage);
    Ok(scene)
}

/// Reads the prim's own part of the state, and the mesh if it is one that is shown. Parents come before children.
fn visit(
    stage: &Stage,
    path: sdf::Path,
    file: &str,
    states: &mut HashMap<sdf::Path, State>,
) -> Result<Option<SubdivMesh>, MeshError> {
    let inherited = path.parent().and_then(|parent| states.get(&parent));
    let mut state =
        inherited.cloned().unwrap_or(State { world: DMat4::IDENTITY, visible: true, purpose: "default".to_owned() });
    let source = format!("{file}: {path}");
    let unreadable = |error: &dyn std::error::Error| MeshError::UsdUnreadable {
        at: Place::with(&source, Spot::Whole),
        reason: one_line(error),
    };
    let prim = stage.prim(&path).map_err(|error| unreadable(&error))?;
    let node = Node { prim: &prim, source: &source };
    let kind = prim.type_name().map_err(|error| unreadable(&error))?;
    let kind = kind.as_ref().map(|kind| kind.as_str()).unwrap_or_default();
    // A prim without a type is not imageable: it hands on what it got. A scope has no transform.
    if !kind.is_empty() {
        state.visible &= node.token("visibility")?.as_deref() != Some("invisible");
        state.purpose = node.token("purpose")?.unwrap_or(state.purpose);
    }
    if !matches!(kind, "" | "Scope") {
        let local = xform::local(&node)?;
        state.world = if local.resets { local.matrix } else { state.world * local.matrix };
    }
    let mesh = match kind {
        "Mesh" if state.is_shown() => Some(prim::read(&node, state.world)?),
        "PointInstancer" if state.is_shown() => return Err(MeshError::InstancerUnsupported { at: node.place() }),
        _ => None,
    };
    states.insert(path, state);
    Ok(mesh)
}

/// Says what other formats say of files that are not there, or empty.
fn check_readable(path: &Path) -> Result<(), MeshError> {
    let at = || Place::file(path);
    let mut first = [0];
    match File::open(path).and_then(|mut file| file.read(&mut first)) {
        Ok(0) => Err(MeshError::EmptyFile { at: at() }),
        Ok(_) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(MeshError::NotFound { at: at() }),
        Err(error) => Err(MeshError::Unreadable { at: at(), error }),
    }
}

/// The stage's up axis, Y where it does not say.
fn up_axis(stage: &Stage) -> Option<DVec3> {
    match stage.stage_metadata("upAxis") {
        Ok(Some(Value::Token(axis))) if axis.as_str() == "Z" => Some(DVec3::Z),
        _ => Some(DVec3::Y),
    }
}
