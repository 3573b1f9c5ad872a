//! The report: what JSON, JUnit and the terminal show.

use super::baseline::{Baseline, Comparison};
use super::bin::{self, Bin, Bins, FailedPatches, note};
use super::clock::Timing;
use super::conformance::Results;
use super::difference::Sample;
use super::failures::{Failures, control_faces};
use super::histogram::Histogram;
use super::key::Key;
use crate::mesh::{PtexParts, SubdivMesh};
use crate::patch::PatchKind;
use crate::stam::LimitSurface;
use serde::Serialize;
use std::collections::BTreeMap;

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
    /// Where they are; absent where none failed.
    pub failures: Option<Failures>,
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
    /// How the errors are spread.
    pub histogram: Histograms,
    /// The sample that uses most of its tolerance.
    pub worst: Option<Sample>,
    /// Path of the prim that the worst sample lies on; absent for meshes that are not from a stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prim: Option<String>,
    /// Error of the worst sample over what it may have; absent where the tier only reports, and where either is no number.
    pub times_allowed: Option<f64>,
    /// Command that shows the worst sample of a failed row by itself.
    pub reproduce: Option<String>,
    /// No sample failed, and there were samples.
    pub pass: bool,
}

/// How the errors of a row are spread.
#[derive(Debug, Clone, Serialize)]
pub struct Histograms {
    /// Distances / diagonal, one a sample.
    pub position: Histogram,
    /// Angles between normals in degrees, one a judged normal.
    pub normal_deg: Histogram,
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

/// A reference that did not answer in a tier: its process ended, or it reported an error.
#[derive(Debug, Clone, Serialize)]
pub struct Unanswered {
    /// The tier.
    pub tier: &'static str,
    /// What was asked.
    pub reference: &'static str,
    /// Why there is no answer, such as `OpenSubdiv ended with SIGSEGV`.
    pub reason: String,
}

/// All tiers of one mesh.
#[derive(Debug, Clone, Serialize)]
pub struct MeshReport {
    /// Name of the mesh.
    pub mesh: String,
    /// File it was read from, as the command line or a folder names it; absent for the sample.
    pub path: Option<String>,
    /// Control faces.
    pub faces: usize,
    /// Patches by kind.
    pub patches: BTreeMap<&'static str, usize>,
    /// Samples of the tiers `regular` and `endcap` that Bfr was not asked: OpenSubdiv (3.5.0 to 3.6.0) reads out of bounds at
    /// interior vertices of valence 2.
    pub reference_not_asked: usize,
    /// Refined vertices that OpenSubdiv's limit masks have no room for, because many more faces than edges meet there; if there is
    /// one, tier `vertex` is not asked at all.
    pub limit_masks_not_asked: usize,
    /// References that did not answer; each fails the mesh.
    pub reference_unanswered: Vec<Unanswered>,
    /// Samples at vertices of many faces that limit stencils and Bfr were not asked, because they take time with the cube and the
    /// square of the number of faces there.
    pub reference_too_slow: usize,
    /// Patches that no sample inside judged in tier `regular`: OpenSubdiv has an end cap all over them, so they are compared
    /// at dyadic points alone.
    pub patches_unjudged: usize,
    /// All tiers pass.
    pub pass: bool,
    /// Where samples of all tiers failed; absent where none did.
    pub failures: Option<Failures>,
    /// The rows.
    pub tiers: Vec<Tier>,
    /// Where the reference is wrong.
    pub reference_known_wrong: Vec<KnownWrong>,
    /// What was found about another program's answers; absent where the tiers ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub results: Option<Results>,
    /// How long each step took; absent unless it is asked for, because it differs from run to run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timings: Option<Vec<Timing>>,
}

/// A mesh of a folder or pattern that was not verified.
#[derive(Debug, Clone, Serialize)]
pub struct Refused {
    /// Its file.
    pub path: String,
    /// Why, in one line.
    pub reason: String,
}

/// The report of a run over meshes.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Version of this form: docs/verify-report.schema.json describes it.
    pub schema: u32,
    /// Version of catoptric.
    pub version: &'static str,
    /// Version of OpenSubdiv.
    pub opensubdiv: String,
    /// Name of the GPU adapter whose pictures tier `fragment` checks; absent where none took part (`--results`).
    pub adapter: Option<String>,
    /// All meshes pass, none was refused that must not be, and nothing is worse than in the baseline.
    pub pass: bool,
    /// The same in words, with counts: what failed the run.
    pub verdict: String,
    /// Width and height of the view that the fragment tier checks.
    pub size: [u32; 2],
    /// The meshes.
    pub meshes: Vec<MeshReport>,
    /// Meshes that were found and refused.
    pub refused: Vec<Refused>,
    /// Refused meshes do not fail the run.
    pub refused_allowed: bool,
    /// Comparison with an earlier run, if one was asked for.
    pub baseline: Option<Comparison>,
}

impl Report {
    /// Version of the JSON form; it grows when a reader of the old one would be misled.
    pub const SCHEMA: u32 = 2;

    /// Collects mesh reports, of views of `size`, and the meshes that were refused.
    pub fn new(size: [u32; 2], meshes: Vec<MeshReport>, refused: Vec<Refused>) -> Self {
        let version = env!("CARGO_PKG_VERSION");
        let opensubdiv = crate::osd::version().to_string();
        let report = Self {
            schema: Self::SCHEMA,
            version,
            opensubdiv,
            adapter: None,
            pass: true,
            verdict: String::new(),
            size,
            meshes,
            refused,
            refused_allowed: false,
            baseline: None,
        };
        report.judged()
    }

    /// Names the adapter that took part.
    pub fn with_adapter(self, name: &str) -> Self {
        Self { adapter: Some(name.to_owned()), ..self }
    }

    /// Lets refused meshes pass.
    pub fn allow_refused(self) -> Self {
        Self { refused_allowed: true, ..self }.judged()
    }

    /// Fails on what is worse than in an earlier run, whose report is in the file `path`.
    pub fn with_baseline(self, path: String, baseline: &Baseline) -> Self {
        let comparison = Some(baseline.compare(path, &self.meshes));
        Self { baseline: comparison, ..self }.judged()
    }

    fn judged(self) -> Self {
        let meshes = self.meshes.iter().all(|mesh| mesh.pass);
        let refused = self.refused_allowed || self.refused.is_empty();
        let baseline = self.baseline.as_ref().is_none_or(|comparison| comparison.regressions.is_empty());
        let judged = Self { pass: meshes && refused && baseline, ..self };
        Self { verdict: judged.verdict(), ..judged }
    }
}

impl Tier {
    fn new(key: Key, bin: Bin, failures: Option<Failures>, parts: &PtexParts<'_>) -> Self {
        let percentile = |column: usize| {
            let mut values: Vec<f64> = bin.normals.iter().map(|normal| normal[column]).collect();
            let index = ((values.len() as f64 * PERCENTILE).ceil() as usize).saturating_sub(1);
            (index < values.len()).then(|| *values.select_nth_unstable_by(index, f64::total_cmp).1)
        };
        let [normal_p9999_deg, share] = [0, 1].map(percentile);
        let judged = bin.position.allowed.is_some();
        let percentile_holds = !key.judges_percentile() || share.is_none_or(|share| share <= 1.0);
        Self {
            tier: key.tier.name(),
            kind: key.kind.map_or("hole", PatchKind::name),
            reference: key.against.name(),
            samples: bin.samples,
            failed: bin.failed,
            failures,
            normals_skipped: bin.normals_skipped,
            position_max: bin.position.largest.unwrap_or(0.0),
            normal_max_deg: bin.normal.largest,
            normal_p9999_deg,
            derivative_max: bin.derivative.largest,
            tolerance_position: bin.position.allowed,
            tolerance_normal_deg: bin.normal.allowed,
            tolerance_derivative: bin.derivative.allowed,
            histogram: Histograms { position: bin.position.histogram, normal_deg: bin.normal.histogram },
            worst: bin.worst.map(|worst| worst.sample),
            prim: bin.worst.and_then(|worst| parts.name(worst.sample.face)).map(str::to_owned),
            times_allowed: bin.worst.filter(|worst| judged && worst.share.is_finite()).map(|worst| worst.share),
            reproduce: None,
            pass: bin.samples > 0 && bin.failed == 0 && percentile_holds,
        }
    }
}

impl MeshReport {
    pub(super) fn new(mesh: &SubdivMesh, surface: &LimitSurface, bins: Bins, timings: Vec<Timing>) -> Self {
        let mut patches: BTreeMap<_, usize> = PatchKind::ALL.iter().map(|kind| (kind.name(), 0)).collect();
        for patch in surface.patches() {
            *patches.entry(patch.kind.name()).or_default() += 1;
        }
        let Bins { not_asked, too_slow, crowded, unjudged, .. } = bins;
        let unanswered = |bin::Unanswered { tier, against, why }: bin::Unanswered| Unanswered {
            tier: tier.name(),
            reference: against.name(),
            reason: why.to_string(),
        };
        let reference_unanswered: Vec<_> = bins.unanswered.into_iter().map(unanswered).collect();
        let control_faces = control_faces(mesh);
        let parts = mesh.ptex_parts();
        let failures = |failed: &FailedPatches| Failures::new(failed, surface, &control_faces, &parts);
        let mut all_failed = FailedPatches::new();
        let (mut tiers, mut reference_known_wrong) = (Vec::new(), Vec::new());
        for (key, bin) in bins.bins {
            bin.failed_patches.iter().for_each(|(&patch, &failed)| note(&mut all_failed, patch, failed));
            let failures = failures(&bin.failed_patches);
            let row = Tier::new(key, bin, failures, &parts);
            match key.known_wrong {
                Some(flaw) => reference_known_wrong.push(KnownWrong { row, reason: flaw.reason() }),
                None => tiers.push(row),
            }
        }
        Self {
            mesh: mesh.name.clone(),
            path: None,
            faces: mesh.face_count(),
            patches,
            reference_not_asked: not_asked,
            reference_too_slow: too_slow,
            limit_masks_not_asked: crowded,
            patches_unjudged: unjudged,
            pass: reference_unanswered.is_empty()
                && tiers.iter().chain(reference_known_wrong.iter().map(|known| &known.row)).all(|row| row.pass),
            reference_unanswered,
            failures: failures(&all_failed),
            tiers,
            reference_known_wrong,
            results: None,
            timings: Some(timings),
        }
    }

    /// All rows, those where the reference is known to be wrong last.
    pub fn rows(&self) -> impl Iterator<Item = &Tier> {
        self.tiers.iter().chain(self.reference_known_wrong.iter().map(|known| &known.row))
    }

    /// Says where the mesh came from, and how to look at the worst sample of each failed row: `program` and its flags, the
    /// mesh, `--only face,u,v`.
    pub fn set_source(&mut self, path: Option<&str>, flags: &str) {
        self.path = path.map(str::to_owned);
        let known = self.reference_known_wrong.iter_mut().map(|known| &mut known.row);
        for row in self.tiers.iter_mut().chain(known).filter(|row| !row.pass) {
            let mesh = path.map(|path| format!(" {}", quoted(path))).unwrap_or_default();
            row.reproduce = row.worst.map(|Sample { face, u, v }| format!("{flags}{mesh} --only {face},{u},{v}"));
        }
    }
}

/// A word as a POSIX shell reads it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
