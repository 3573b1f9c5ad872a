//! USD (usda, usdc, usdz), by the openusd crate, which composes the stage: references, payloads, variants, instances.
//!
//! Every Mesh prim that is visible and of purpose default or render counts, with its points in world space, in the units
//! of the stage. Values are those at the time that was asked for, else at the default time; where an attribute has time
//! samples alone, the first counts.
//! What skeletons and blend shapes would do to points, prims of other shapes, and layers that are not there or are no USD are passed
//! over with a note, subsets and primvars without one. Prims without faces are passed over where there are others.
//!
//! Schema: `UsdGeomMesh`, `UsdGeomImageable` and `UsdGeomXformable` of OpenUSD.

mod circles;
mod ids;
mod instancer;
mod instances;
mod mixture;
mod motion;
mod nesting;
mod open;
mod passed;
mod prim;
mod scene;
mod text;
mod value;
mod xform;

use std::collections::HashMap;
use std::fmt;
use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

use glam::{DMat4, DVec3};
use openusd::sdf::{self, Value};
use openusd::usd::{Prim, PrimPredicate, Stage};

use super::error::{Place, Spot, quote};
use super::{BadFace, Choice, MeshError, SubdivMesh};
use passed::Passed;
use scene::Placed;
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

/// Meshes of the stage, as they are found.
#[derive(Default)]
struct Found {
    /// Those that were read.
    meshes: Vec<Placed>,
    /// The first one without faces, and where it stands. Exporters leave such behind, so others do without it.
    empty: Option<(sdf::Path, DMat4)>,
    /// Those that are shown, whether they were asked for or not.
    shown: Vec<String>,
    /// The PointInstancer that came last.
    instancer: Option<sdf::Path>,
    /// The first one that a skeleton or blend shapes would move, and their number.
    posed: Option<(String, usize)>,
    /// Prims that are shown and are no meshes.
    passed: Passed,
}

impl Found {
    fn pass_over(&mut self, kind: &str, path: &sdf::Path) {
        self.passed.add(kind, path);
    }
}

/// A stage that is open, and its prims.
pub(super) struct File {
    stage: Stage,
    paths: Vec<sdf::Path>,
    /// How messages name it.
    file: String,
    /// Its stem.
    name: String,
}

impl fmt::Debug for File {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("File").field("file", &self.file).field("prims", &self.paths.len()).finish_non_exhaustive()
    }
}

impl File {
    /// Composes the stage; `file` is what messages call it, `name` what its mesh is called.
    pub(super) fn open(path: &Path, file: &str, name: &str) -> Result<Self, MeshError> {
        let at = || Place::with(file, Spot::Whole);
        check_readable(path)?;
        let unreadable = |error: openusd::Error| MeshError::UsdUnreadable { at: at(), reason: one_line(&error) };
        let absolute = std::path::absolute(path).map_err(|error| MeshError::Unreadable { at: at(), error })?;
        let absolute = absolute.to_str().ok_or_else(|| MeshError::PathNotText { at: at() })?;
        let stage = open::open(absolute, file)?;
        let mut paths = Vec::new();
        stage.traverse(PrimPredicate::DEFAULT_PROXIES, |path| paths.push(path.clone())).map_err(unreadable)?;
        Ok(Self { stage, paths, file: file.to_owned(), name: name.to_owned() })
    }

    /// Reads and validates the meshes that are chosen, as one.
    pub(super) fn read(&self, choice: &Choice) -> Result<SubdivMesh, MeshError> {
        let reader = Reader { stage: &self.stage, file: &self.file, choice };
        let mut states = HashMap::new();
        let mut found = Found::default();
        for path in &self.paths {
            reader.visit(path, &mut states, &mut found)?;
        }
        reader.check_found(&found)?;
        let mut scene = scene::join(found.meshes, &self.file, &self.name)?;
        scene.up = up_axis(&self.stage);
        scene.meters_per_unit = Some(meters_per_unit(&self.stage));
        let missing = passed::missing(&self.stage.composition_errors());
        scene.notes.extend(missing.map(|what| format!("passed over: {what}")));
        let shapes = found.passed.list();
        scene.notes.extend(shapes.map(|shapes| format!("passed over, since meshes alone are read: {shapes}")));
        scene.notes.extend(found.posed.map(|(first, count)| {
            let others = if count == 1 { String::new() } else { format!(" and {} more", count - 1) };
            format!("{first}{others}: skeletons and blend shapes are not applied; points are those of the rest pose")
        }));
        Ok(scene)
    }

    /// What is wrong with a face of a mesh that was read, as an error.
    pub(super) fn fault(&self, mesh: &SubdivMesh, bad: &BadFace) -> MeshError {
        let part = mesh.parts.iter().find(|part| part.faces.contains(&bad.face));
        let (name, start) = part.map_or(("", 0), |part| (part.name.as_str(), part.faces.start));
        let spot = |face: usize| Spot::Part("face", face);
        let at = Place::with(&format!("{}: {name}", self.file), spot((bad.face - start) as usize));
        bad.fault.error(at, 0, spot)
    }
}

/// A stage that is being read.
struct Reader<'a> {
    stage: &'a Stage,
    file: &'a str,
    choice: &'a Choice,
}

impl Reader<'_> {
    /// Reads the prim's own part of the state, and what it is if that is shown. Parents come before children.
    fn visit(
        &self,
        path: &sdf::Path,
        states: &mut HashMap<sdf::Path, State>,
        found: &mut Found,
    ) -> Result<(), MeshError> {
        if found.instancer.as_ref().is_some_and(|instancer| path.has_prefix(instancer)) {
            return Ok(());
        }
        let inherited = path.parent().and_then(|parent| states.get(&parent));
        let state = inherited.cloned().unwrap_or(State {
            world: DMat4::IDENTITY,
            visible: true,
            purpose: "default".to_owned(),
        });
        let source = self.source(path);
        let (prim, kind) = self.prim(path, &source)?;
        let node = self.node(&prim, &source);
        let state = self.handed_down(&node, &kind, state)?;
        let name = path.to_string();
        match kind.as_str() {
            "Mesh" if state.is_shown() => {
                if self.choice.takes(&name) {
                    if prim::is_empty(&node)? {
                        found.empty.get_or_insert((path.clone(), state.world));
                    } else {
                        if prim::is_posed(&node)? {
                            found.posed.get_or_insert_with(|| (name.clone(), 0)).1 += 1;
                        }
                        found.meshes.push(prim::read(&node)?.place(name.clone(), state.world)?);
                    }
                }
                found.shown.push(name);
            }
            "PointInstancer" => {
                if state.is_shown() {
                    self.instances(&node, &name, &state, found)?;
                }
                // What is below is there to be instanced.
                found.instancer = Some(path.clone());
            }
            kind if state.is_shown() && self.choice.takes(&name) => found.pass_over(kind, path),
            _ => {}
        }
        states.insert(path.clone(), state);
        Ok(())
    }

    /// What a prim of a type hands down of what it got.
    fn handed_down(&self, node: &Node<'_>, kind: &str, mut state: State) -> Result<State, MeshError> {
        // A prim without a type is not imageable: it hands on what it got. A scope has no transform.
        if !kind.is_empty() {
            state.visible &= node.token("visibility")?.as_deref() != Some("invisible");
            state.purpose = node.token("purpose")?.unwrap_or(state.purpose);
        }
        if !matches!(kind, "" | "Scope") {
            let local = xform::local(node)?;
            state.world = if local.resets { local.matrix } else { state.world * local.matrix };
        }
        Ok(state)
    }

    fn node<'n>(&self, prim: &'n Prim, source: &'n str) -> Node<'n> {
        Node { prim, source, time: self.choice.time }
    }

    /// How messages name a prim.
    fn source(&self, path: &sdf::Path) -> String {
        format!("{}: {path}", self.file)
    }

    /// A prim and its type.
    fn prim(&self, path: &sdf::Path, source: &str) -> Result<(Prim, String), MeshError> {
        let unreadable = |error: &dyn std::error::Error| MeshError::UsdUnreadable {
            at: Place::with(source, Spot::Whole),
            reason: one_line(error),
        };
        let prim = self.stage.prim(path).map_err(|error| unreadable(&error))?;
        let kind = prim.type_name().map_err(|error| unreadable(&error))?;
        Ok((prim, kind.map(|kind| kind.as_str().to_owned()).unwrap_or_default()))
    }

    /// Refuses a stage without meshes, and a choice that chooses none.
    fn check_found(&self, found: &Found) -> Result<(), MeshError> {
        let at = || Place::with(self.file, Spot::Whole);
        if found.shown.is_empty() {
            if let Some(reason) = passed::missing(&self.stage.composition_errors()) {
                return Err(MeshError::UsdIncomplete { at: at(), reason });
            }
            let passed = found.passed.list().map(|shapes| format!(" (passed over: {shapes})")).unwrap_or_default();
            return Err(MeshError::NoMeshPrims { at: at(), passed });
        }
        for prim in &self.choice.prims {
            let alone = Choice { prims: vec![prim.clone()], ..self.choice.clone() };
            if !found.shown.iter().any(|name| alone.takes(name)) {
                let prim = quote(prim.as_bytes());
                return Err(MeshError::PrimUnknown { at: at(), prim, found: some_of(&found.shown) });
            }
        }
        match &found.empty {
            // What it lacks is said as if there were no others.
            Some((path, world)) if found.meshes.is_empty() => {
                let source = self.source(path);
                let (prim, _) = self.prim(path, &source)?;
                prim::read(&self.node(&prim, &source))?.place(String::new(), *world).map(drop)
            }
            _ => Ok(()),
        }
    }
}

impl Choice {
    /// Whether the prim is one that was asked for, or below one.
    fn takes(&self, name: &str) -> bool {
        let above = |prim: &String| {
            let prim = prim.trim_end_matches('/');
            // Instances of a PointInstancer are called /Path/To[12].
            name.strip_prefix(prim).is_some_and(|rest| rest.is_empty() || rest.starts_with(['/', '[']))
        };
        self.prims.is_empty() || self.prims.iter().any(above)
    }
}

/// Names for a message: the first ones, and how many more there are.
fn some_of(names: &[String]) -> String {
    const SOME: usize = 8;
    let mut text = names.iter().take(SOME).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > SOME {
        text += &format!(" and {} more", names.len() - SOME);
    }
    text
}

/// Says what other formats say of files that are not there, or empty.
fn check_readable(path: &Path) -> Result<(), MeshError> {
    let at = || Place::file(path);
    let mut first = [0];
    match fs::File::open(path).and_then(|mut file| file.read(&mut first)) {
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

/// Metres of a unit; centimetres where the stage does not say, as in `UsdGeomGetStageMetersPerUnit`.
fn meters_per_unit(stage: &Stage) -> f64 {
    let value = match stage.stage_metadata("metersPerUnit") {
        Ok(Some(Value::Double(meters))) => meters,
        Ok(Some(Value::Float(meters))) => f64::from(meters),
        Ok(Some(Value::Int(meters))) => f64::from(meters),
        _ => 0.01,
    };
    if value.is_finite() && value > 0.0 { value } else { 0.01 }
}
