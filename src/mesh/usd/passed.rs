//! What of a stage is passed over, told in one line a kind.

use std::collections::BTreeMap;

use openusd::pcp::CompositionDiagnostic;
use openusd::sdf;

use super::value::{line_of, one_line};

/// Types of prims that have a shape and are no meshes.
const SHAPES: [&str; 19] = [
    "BasisCurves",
    "Capsule",
    "Capsule_1",
    "Cone",
    "Cube",
    "Cylinder",
    "Cylinder_1",
    "HermiteCurves",
    "NurbsCurves",
    "NurbsPatch",
    "ParticleField",
    "ParticleField3DGaussianSplat",
    "ParticleField_3DGaussianSplat",
    "Plane",
    "Points",
    "Sphere",
    "TetMesh",
    "Text",
    "Volume",
];

/// Prims that have a shape and are no meshes, by type: their number and the first of them.
#[derive(Debug, Default)]
pub(super) struct Passed(BTreeMap<String, (usize, String)>);

impl Passed {
    /// Counts a prim, if it has a shape.
    pub(super) fn add(&mut self, kind: &str, path: &sdf::Path) {
        if SHAPES.contains(&kind) {
            self.0.entry(kind.to_owned()).or_insert_with(|| (0, path.to_string())).0 += 1;
        }
    }

    /// `2 NurbsPatch (the first is /a), 1 Sphere (/b)`, if there are any.
    pub(super) fn list(&self) -> Option<String> {
        let name = |(kind, (count, first)): (&String, &(usize, String))| {
            let first = if *count == 1 { first.clone() } else { format!("the first is {first}") };
            format!("{count} {kind} ({first})")
        };
        let names: Vec<String> = self.0.iter().map(name).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }
}

/// What references, payloads and sublayers lead to and cannot be read, in one clause: the first, and how many more.
pub(super) fn missing(errors: &[CompositionDiagnostic]) -> Option<String> {
    // A layer that is not there says more than a prim that is not in it.
    let first = errors.iter().min_by_key(|error| rank(error))?;
    let first: String = clause(first).chars().filter(|c| !c.is_control()).take(300).collect();
    let more = errors.len() - 1;
    Some(if more == 0 { first } else { format!("{first}; and {more} more") })
}

fn rank(error: &CompositionDiagnostic) -> usize {
    match error {
        CompositionDiagnostic::UnresolvedLayer { .. } | CompositionDiagnostic::UnresolvedSublayer { .. } => 0,
        CompositionDiagnostic::MalformedLayer { .. } | CompositionDiagnostic::MalformedSublayer { .. } => 1,
        _ => 2,
    }
}

fn clause(error: &CompositionDiagnostic) -> String {
    match error {
        CompositionDiagnostic::UnresolvedLayer { asset_path, site_path, .. } => {
            format!("{site_path} refers to {asset_path}, which is not there")
        }
        CompositionDiagnostic::MalformedLayer { asset_path, site_path, reason, .. } => {
            format!("{site_path} refers to {asset_path}, which is not readable as USD ({})", line_of(reason))
        }
        CompositionDiagnostic::UnresolvedSublayer { asset_path, introduced_by } => {
            format!("{introduced_by} has the sublayer {asset_path}, which is not there")
        }
        CompositionDiagnostic::MalformedSublayer { asset_path, introduced_by, reason } => {
            format!("{introduced_by} has the sublayer {asset_path}, which is not readable as USD ({})", line_of(reason))
        }
        CompositionDiagnostic::UnresolvedPrimPath { target_layer, prim_path, site_path, .. } => {
            format!("{site_path} refers to {prim_path} of {target_layer}, which has no such prim")
        }
        other => one_line(other),
    }
}
