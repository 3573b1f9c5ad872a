//! The report: what JSON and the terminal show.

use super::bin::{Bin, Bins, Key, Sample, larger};
use crate::mesh::SubdivMesh;
use crate::patch::PatchKind;
use crate::stam::LimitSurface;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Percentile of the angles that the fragment tier is judged by.
const PERCENTILE: f64 = 0.9999;

/// One row: a tier, a reference and a patch kind.
#[derive(Debug, Clone, Serialize)]
pub struct Tier {
    /// `vertex`, `dyadic`, `regular`, `fragment` or `endcap`.
    pub tier: &'static str,
    /// Patch kind.
    pub kind: &'static str,
    /// What was compared with.
    pub reference: &'static str,
    /// Number of samples.
    pub samples: usize,
    /// Largest distance / diagonal.
    pub position_max: f64,
    /// Largest angle between normals, degrees; absent where the reference has none.
    pub normal_max_deg: Option<f64>,
    /// 99.99th percentile of the angles, degrees.
    pub normal_p9999_deg: Option<f64>,
    /// Largest difference of a first derivative / diagonal.
    pub derivative_max: Option<f64>,
    /// Allowed distance / diagonal; absent where the tier only reports.
    pub tolerance_position: Option<f64>,
    /// Allowed angle, degrees: of the largest, in the fragment tier of the 99.99th percentile.
    pub tolerance_normal_deg: Option<f64>,
    /// Allowed difference of derivatives / diagonal.
    pub tolerance_derivative: Option<f64>,
    /// The sample that uses most of its tolerance.
    pub worst: Option<Sample>,
    /// All tolerances hold.
    pub pass: bool,
}

/// Samples at which the reference is known to be wrong: neither a pass nor a failure.
#[derive(Debug, Clone, Serialize)]
pub struct KnownWrong {
    /// The row it would have been.
    #[serde(flatten)]
    pub row: Tier,
    /// What the reference gets wrong.
    pub reason: &'static str,
}

/// All tiers of one mesh.
#[derive(Debug, Clone, Serialize)]
pub struct MeshReport {
    /// Name of the mesh.
    pub mesh: String,
    /// Control faces.
    pub faces: usize,
    /// Patches by kind.
    pub patches: BTreeMap<&'static str, usize>,
    /// Samples of tier `endcap` that Bfr was not asked: 3.5.0 reads out of bounds at interior vertices of valence 2.
    pub reference_not_asked: usize,
    /// All tiers pass.
    pub pass: bool,
    /// The rows.
    pub tiers: Vec<Tier>,
    /// Where the reference is wrong.
    pub reference_known_wrong: Vec<KnownWrong>,
}

/// The report of a run over meshes.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Version of catoptric.
    pub version: &'static str,
    /// Version of OpenSubdiv.
    pub opensubdiv: String,
    /// All meshes pass.
    pub pass: bool,
    /// The meshes.
    pub meshes: Vec<MeshReport>,
}

impl Report {
    /// Collects mesh reports.
    pub fn new(meshes: Vec<MeshReport>) -> Self {
        let pass = meshes.iter().all(|mesh| mesh.pass);
        Self { version: env!("CARGO_PKG_VERSION"), opensubdiv: crate::osd::version(), pass, meshes }
    }
}

impl Tier {
    fn new(key: Key, bin: Bin) -> Self {
        let mut normals = bin.normals;
        normals.sort_by(f64::total_cmp);
        let normal_max_deg = normals.iter().copied().reduce(larger);
        let percentile = ((normals.len() as f64 * PERCENTILE).ceil() as usize).saturating_sub(1);
        let normal_p9999_deg = normals.get(percentile).copied();
        let judged = if key.tier == "fragment" { normal_p9999_deg } else { normal_max_deg };
        let tolerance = bin.tolerance;
        // Written so that NaN fails.
        let holds = |error: Option<f64>, limit: Option<f64>| error.zip(limit).is_none_or(|(e, l)| e <= l);
        let pass = holds(Some(bin.position), tolerance.position)
            && holds(judged, tolerance.normal_deg)
            && holds(bin.derivative, tolerance.derivative);
        Self {
            tier: key.tier,
            kind: key.kind.name(),
            reference: key.reference,
            samples: bin.samples,
            position_max: bin.position,
            normal_max_deg,
            normal_p9999_deg,
            derivative_max: bin.derivative,
            tolerance_position: tolerance.position,
            tolerance_normal_deg: tolerance.normal_deg,
            tolerance_derivative: tolerance.derivative,
            worst: bin.worst,
            pass,
        }
    }
}

impl MeshReport {
    pub(super) fn new(mesh: &SubdivMesh, surface: &LimitSurface, bins: Bins) -> Self {
        let mut patches: BTreeMap<_, usize> = PatchKind::ALL.iter().map(|kind| (kind.name(), 0)).collect();
        for patch in surface.patches() {
            *patches.entry(patch.kind.name()).or_default() += 1;
        }
        let reference_not_asked = bins.not_asked;
        let (mut tiers, mut reference_known_wrong) = (Vec::new(), Vec::new());
        for (key, bin) in bins.bins {
            let row = Tier::new(key, bin);
            match key.known_wrong {
                Some(reason) => reference_known_wrong.push(KnownWrong { row, reason }),
                None => tiers.push(row),
            }
        }
        let order =
            |tier: &Tier| ["vertex", "dyadic", "regular", "fragment", "endcap"].iter().position(|t| *t == tier.tier);
        tiers.sort_by_key(order);
        Self {
            mesh: mesh.name.clone(),
            faces: mesh.face_count(),
            patches,
            reference_not_asked,
            pass: tiers.iter().all(|tier| tier.pass),
            tiers,
            reference_known_wrong,
        }
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.pass { "pass" } else { "FAIL" };
        let patches: Vec<_> =
            self.patches.iter().filter(|(_, n)| **n > 0).map(|(kind, n)| format!("{n} {kind}")).collect();
        writeln!(f, "{}: {verdict} ({} faces; patches: {})", self.mesh, self.faces, patches.join(", "))?;
        writeln!(
            f,
            "  {:<9} {:<8} {:<13} {:>9} {:>10} {:>10} {:>10} {:>10}  worst (face, u, v)",
            "tier", "kind", "reference", "samples", "position", "normal max", "p99.99", "derivative"
        )?;
        for tier in &self.tiers {
            let verdict = match (tier.pass, tier.tolerance_position) {
                (true, Some(_)) => "",
                (true, None) => "  [reported only]",
                (false, _) => "  <- FAIL",
            };
            writeln!(f, "  {tier}{verdict}")?;
        }
        for known in &self.reference_known_wrong {
            writeln!(f, "  {}  [reference wrong: {}]", known.row, known.reason)?;
        }
        if self.reference_not_asked > 0 {
            let count = self.reference_not_asked;
            writeln!(
                f,
                "  endcap: {count} samples not asked: Bfr reads out of bounds at interior vertices of valence 2"
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for Tier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.2e}"));
        write!(
            f,
            "{:<9} {:<8} {:<13} {:>9} {:>10} {:>10} {:>10} {:>10}",
            self.tier,
            self.kind,
            self.reference,
            self.samples,
            error(Some(self.position_max)),
            error(self.normal_max_deg),
            error(self.normal_p9999_deg),
            error(self.derivative_max),
        )?;
        match self.worst {
            Some(Sample { face, u, v }) => write!(f, "  {face} {u} {v}"),
            None => Ok(()),
        }
    }
}
