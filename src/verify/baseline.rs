//! Comparison with the report of an earlier run.

use super::report::{MeshReport, Report, Tier};
use super::{dyadic, regular, vertex};
use crate::line::count;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Why an earlier report cannot be compared with.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    /// It is no report.
    #[error("not a report of verify --json ({0}); make it again")]
    NoReport(#[from] serde_json::Error),
    /// It has another form.
    #[error("a report of schema {found}, but this version compares schema {expected}; make it again", expected = Report::SCHEMA)]
    Schema {
        /// Its schema.
        found: u32,
    },
    /// It looked at other pixels.
    #[error("made with --size {}x{}, this run has {}x{}; give the same --size", .baseline[0], .baseline[1], .run[0], .run[1])]
    Size {
        /// Size of the earlier view.
        baseline: [u32; 2],
        /// Size of this one.
        run: [u32; 2],
    },
}

/// An earlier report, as far as it is compared.
#[derive(Debug, Deserialize)]
pub struct Baseline {
    size: [u32; 2],
    meshes: Vec<OldMesh>,
}

#[derive(Debug, Deserialize)]
struct OldMesh {
    mesh: String,
    path: Option<String>,
    patches_unjudged: usize,
    tiers: Vec<OldRow>,
    reference_known_wrong: Vec<OldRow>,
}

#[derive(Debug, Deserialize)]
struct OldRow {
    tier: String,
    kind: String,
    reference: String,
    reason: Option<String>,
    samples: usize,
    position_max: Option<f64>,
    normal_max_deg: Option<f64>,
    normal_p9999_deg: Option<f64>,
    derivative_max: Option<f64>,
    histogram: OldHistograms,
    pass: bool,
}

#[derive(Debug, Deserialize)]
struct OldHistograms {
    normal_deg: OldHistogram,
}

#[derive(Debug, Deserialize)]
struct OldHistogram {
    zero: u64,
    not_finite: u64,
    counts: Vec<u64>,
}

/// Something that is worse than in the earlier run.
#[derive(Debug, Clone, Serialize)]
pub struct Regression {
    /// The mesh, by path if it has one.
    pub mesh: String,
    /// The row (tier, kind and reference); absent where the mesh as a whole is concerned.
    pub row: Option<String>,
    /// What is worse, in one line.
    pub what: String,
}

/// What the comparison with an earlier run found.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// File of the earlier report.
    pub path: String,
    /// Rows that both runs have.
    pub rows_compared: usize,
    /// What is worse.
    pub regressions: Vec<Regression>,
}

/// Errors may differ by this factor when the same sums are rounded in another order, by another compiler or processor.
const GROWTH: f64 = 2.0;

/// Part of a budget below which growth says nothing. Rows of tier `fragment` are held to budgets of the picture, and adapters
/// round f32 in their own ways: a tenth of the budget is nothing that a picture shows.
const BUDGET_PART: f64 = 0.1;

/// Part of its samples that a row of tier `fragment` may lose: whether a pixel on a silhouette is seen is rounding.
const PIXELS: f64 = 0.01;

impl Baseline {
    /// Reads an earlier report.
    ///
    /// # Errors
    /// It is no report, one of another schema, or one of a view of another size.
    pub fn read(json: &[u8], size: [u32; 2]) -> Result<Self, BaselineError> {
        #[derive(Deserialize)]
        struct Form {
            // Reports had no number before 2.
            #[serde(default = "first")]
            schema: u32,
            #[serde(rename = "meshes")]
            _meshes: Vec<serde::de::IgnoredAny>,
        }
        fn first() -> u32 {
            1
        }
        let form: Form = serde_json::from_slice(json)?;
        if form.schema != Report::SCHEMA {
            return Err(BaselineError::Schema { found: form.schema });
        }
        let baseline: Self = serde_json::from_slice(json)?;
        if baseline.size != size {
            return Err(BaselineError::Size { baseline: baseline.size, run: size });
        }
        Ok(baseline)
    }

    /// What of a run is worse; `path` is the baseline's file.
    pub fn compare(&self, path: String, meshes: &[MeshReport]) -> Comparison {
        let mut comparison = Comparison { path, rows_compared: 0, regressions: Vec::new() };
        for old in &self.meshes {
            let name = old.path.clone().unwrap_or_else(|| old.mesh.clone());
            // By file; elsewhere the same files may have other paths, then names tell if they are unique.
            let same_path = meshes.iter().find(|new| new.path == old.path && new.mesh == old.mesh);
            let mut same_name = meshes.iter().filter(|new| new.mesh == old.mesh);
            let unique = same_name.next().filter(|_| same_name.next().is_none());
            match same_path.or(unique) {
                Some(new) => old.compare(&name, new, &mut comparison),
                None => comparison.note(&name, None, "the mesh was verified then and is not now".to_owned()),
            }
        }
        comparison
    }
}

impl Comparison {
    fn note(&mut self, mesh: &str, row: Option<String>, what: String) {
        self.regressions.push(Regression { mesh: mesh.to_owned(), row, what });
    }
}

impl OldMesh {
    fn compare(&self, name: &str, new: &MeshReport, comparison: &mut Comparison) {
        if new.patches_unjudged > self.patches_unjudged {
            let [old, new] = [self.patches_unjudged, new.patches_unjudged];
            comparison.note(name, None, format!("{} without a judged sample inside, {old} then", count(new, "patch")));
        }
        let plain = new.tiers.iter().map(|row| (None, row));
        let known = new.reference_known_wrong.iter().map(|known| (Some(known.reason), &known.row));
        let rows: BTreeMap<_, _> =
            plain.chain(known).map(|(reason, row)| ((row.tier, row.kind, row.reference, reason), row)).collect();
        for old in self.tiers.iter().chain(&self.reference_known_wrong) {
            let key = (&*old.tier, &*old.kind, &*old.reference, old.reason.as_deref());
            let label = format!("{} {} / {}", old.tier, old.kind, old.reference);
            let Some(row) = rows.get(&key) else {
                comparison.note(name, Some(label), "the row was there then and is not now".to_owned());
                continue;
            };
            comparison.rows_compared += 1;
            for what in old.worse(row) {
                comparison.note(name, Some(label.clone()), what);
            }
        }
    }
}

impl OldRow {
    fn worse(&self, new: &Tier) -> Vec<String> {
        let mut worse = Vec::new();
        if self.pass && !new.pass {
            worse.push("it passed then and fails now".to_owned());
        }
        let lost = |what: &str, old: u64, new: u64, may_lose: f64| {
            let least = old as f64 * (1.0 - may_lose);
            ((new as f64) < least).then(|| format!("{new} {what}, {old} then"))
        };
        let may_lose = if self.tier == "fragment" { PIXELS } else { 0.0 };
        let judged = &self.histogram.normal_deg;
        let judged = judged.zero + judged.not_finite + judged.counts.iter().sum::<u64>();
        worse.extend(lost("samples", self.samples as u64, new.samples as u64, may_lose));
        worse.extend(lost("judged normals", judged, new.histogram.normal_deg.total(), may_lose));
        // The fragment tier judges a percentile of its normals.
        let normals = match &*self.tier {
            "fragment" => [self.normal_p9999_deg, new.normal_p9999_deg],
            _ => [self.normal_max_deg, new.normal_max_deg],
        };
        let floors = floors(new, self.reason.is_some());
        let columns = [
            ("position", [self.position_max, Some(new.position_max)]),
            ("normal", normals),
            ("derivative", [self.derivative_max, new.derivative_max]),
        ];
        for ((name, [old, new]), floor) in columns.into_iter().zip(floors) {
            // What is no number is null in JSON, which the verdict tells.
            let (Some(old), Some(new)) = (old, new) else { continue };
            if new > GROWTH * old && new > floor {
                worse.push(format!("{name} error {new:.2e}, {old:.2e} then"));
            }
        }
        worse
    }
}

/// Errors of position, normal and derivative below which growth is noise: in f64 what rounding of world coordinates may do
/// to either answer, which is what a row's tolerance is above that of its tier.
fn floors(row: &Tier, known_wrong: bool) -> [f64; 3] {
    let tolerances = [row.tolerance_position, row.tolerance_normal_deg, row.tolerance_derivative];
    let judged = match row.tier {
        "vertex" => [vertex::POSITION, vertex::NORMAL_DEG, 0.0],
        "regular" => regular::TOLERANCES,
        _ => [dyadic::POSITION, dyadic::NORMAL_DEG, dyadic::DERIVATIVE],
    };
    std::array::from_fn(|k| match (row.tier, tolerances[k]) {
        ("fragment", Some(budget)) => BUDGET_PART * budget,
        // The reference's own error: any growth beyond what is judged elsewhere is news.
        ("endcap", _) | (_, None) => judged[k],
        _ if known_wrong => judged[k],
        (_, Some(tolerance)) => (tolerance - judged[k]).max(0.0),
    })
}
