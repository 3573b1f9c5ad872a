//! The report: what JSON and the terminal show.

use super::bin::{Bin, Bins, Key, Sample};
use super::conformance::Results;
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
    /// `vertex`, `dyadic`, `regular`, `fragment` or `endcap`; `results` for another program's answers.
    pub tier: &'static str,
    /// Patch kind.
    pub kind: &'static str,
    /// What was compared with.
    pub reference: &'static str,
    /// Number of samples.
    pub samples: usize,
    /// Samples with an error beyond what they may have. In tier `fragment` a normal counts beyond 100 times as much,
    /// because it is the percentile that is judged.
    pub failed: usize,
    /// Samples whose normal was not judged: rounding alone turns the reference's by more than 1e-3 degrees there, in tier
    /// `fragment` by more than 0.1 (folds, vanishing derivatives, coordinates far from the origin).
    pub normals_skipped: usize,
    /// Largest distance / diagonal (of a mesh without extent: / largest coordinate).
    pub position_max: f64,
    /// Largest angle between normals, degrees; absent where the reference has none.
    pub normal_max_deg: Option<f64>,
    /// 99.99th percentile of the angles, degrees.
    pub normal_p9999_deg: Option<f64>,
    /// Largest difference of a first derivative / diagonal.
    pub derivative_max: Option<f64>,
    /// Allowed distance / diagonal: the tier's own plus the rounding of world coordinates; absent where the tier only
    /// reports.
    pub tolerance_position: Option<f64>,
    /// Allowed angle, degrees: of the largest, in the fragment tier of the 99.99th percentile. Rounding depends on the
    /// sample; this is the most that one was allowed.
    pub tolerance_normal_deg: Option<f64>,
    /// Allowed difference of derivatives / diagonal, the most that a sample was allowed.
    pub tolerance_derivative: Option<f64>,
    /// The sample that uses most of its tolerance.
    pub worst: Option<Sample>,
    /// No sample failed, and there were samples.
    pub pass: bool,
}

/// Samples at which the reference is known to be wrong: only gross errors fail.
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
    /// Samples of the tiers `regular` and `endcap` that Bfr was not asked: 3.5.0 reads out of bounds at interior vertices
    /// of valence 2.
    pub reference_not_asked: usize,
    /// All tiers pass.
    pub pass: bool,
    /// The rows.
    pub tiers: Vec<Tier>,
    /// Where the reference is wrong.
    pub reference_known_wrong: Vec<KnownWrong>,
    /// What was found about another program's answers; absent where the tiers ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub results: Option<Results>,
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
        let percentile = |column: usize| {
            let mut values: Vec<f64> = bin.normals.iter().map(|normal| normal[column]).collect();
            values.sort_by(f64::total_cmp);
            let index = ((values.len() as f64 * PERCENTILE).ceil() as usize).saturating_sub(1);
            values.get(index).copied()
        };
        let [normal_p9999_deg, share] = [0, 1].map(percentile);
        let percentile_holds = !key.judges_percentile() || share.is_none_or(|share| share <= 1.0);
        Self {
            tier: key.tier,
            kind: key.kind.map_or("hole", PatchKind::name),
            reference: key.reference,
            samples: bin.samples,
            failed: bin.failed,
            normals_skipped: bin.normals_skipped,
            position_max: bin.position.largest.unwrap_or(0.0),
            normal_max_deg: bin.normal.largest,
            normal_p9999_deg,
            derivative_max: bin.derivative.largest,
            tolerance_position: bin.position.allowed,
            tolerance_normal_deg: bin.normal.allowed,
            tolerance_derivative: bin.derivative.allowed,
            worst: bin.worst,
            pass: bin.samples > 0 && bin.failed == 0 && percentile_holds,
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
            pass: tiers.iter().chain(reference_known_wrong.iter().map(|known| &known.row)).all(|row| row.pass),
            tiers,
            reference_known_wrong,
            results: None,
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
            "  {:<8} {:<7} {:<15} {:>7} {:>15} {:>15} {:>7} {:>15} {:>7}  worst (face, u, v)",
            "tier",
            "kind",
            "reference",
            "samples",
            "position/limit",
            "normal/limit",
            "p99.99",
            "derivat./limit",
            "skipped"
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
            let verdict = if known.row.pass { "" } else { "  <- FAIL" };
            writeln!(f, "  {}  [reference wrong: {}]{verdict}", known.row, known.reason)?;
        }
        let skipped: usize = self.tiers.iter().map(|tier| tier.normals_skipped).sum();
        if skipped > 0 {
            writeln!(f, "  skipped: {skipped} normals that rounding alone turns too far to be judged")?;
        }
        if self.reference_not_asked > 0 {
            let count = self.reference_not_asked;
            writeln!(f, "  Bfr: {count} samples not asked: it reads out of bounds at interior vertices of valence 2")?;
        }
        Ok(())
    }
}

impl fmt::Display for Tier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.1e}"));
        let judged = |x: Option<f64>, limit: Option<f64>| match limit {
            Some(limit) => format!("{}/{limit:.1e}", error(x)),
            None => error(x),
        };
        write!(
            f,
            "{:<8} {:<7} {:<15} {:>7} {:>15} {:>15} {:>7} {:>15} {:>7}",
            self.tier,
            self.kind,
            self.reference,
            self.samples,
            judged(Some(self.position_max), self.tolerance_position),
            judged(self.normal_max_deg, self.tolerance_normal_deg),
            error(self.normal_p9999_deg),
            judged(self.derivative_max, self.tolerance_derivative),
            self.normals_skipped,
        )?;
        match self.worst {
            Some(Sample { face, u, v }) => write!(f, "  {face} {u} {v}"),
            None => Ok(()),
        }
    }
}
