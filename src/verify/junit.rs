//! The report as JUnit XML, which CI systems show.

use super::report::{MeshReport, Report, Tier};
use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};
use std::fmt::Write;

impl Report {
    /// A test suite for each mesh and a test case for each row. Rows that judge nothing (the reference is known to be wrong, or
    /// the tier only reports) are skipped, with the reason: they are no passes.
    pub fn junit(&self) -> Result<String, quick_junit::SerializeError> {
        let mut report = quick_junit::Report::new("catoptric verify");
        let properties = [
            ("catoptric", Some(self.version)),
            ("opensubdiv", Some(&*self.opensubdiv)),
            ("adapter", self.adapter.as_deref()),
        ];
        report.add_test_suites(self.meshes.iter().map(|mesh| {
            let mut suite = suite(mesh);
            let known = properties.iter().filter_map(|(name, value)| Some((*name, (*value)?)));
            suite.add_properties(known);
            suite
        }));
        report.add_test_suites(self.refused.iter().map(|refused| {
            let status = match self.refused_allowed {
                true => skipped(&refused.reason),
                false => not_passed(NonSuccessKind::Error, &refused.reason),
            };
            one(&refused.path, "read", status)
        }));
        if let Some(baseline) = &self.baseline {
            let mut suite = TestSuite::new("baseline");
            suite.add_property(("verdict", &*self.verdict));
            for regression in &baseline.regressions {
                let row = regression.row.as_deref().unwrap_or("mesh");
                let what = format!("worse than in the baseline {}: {}", baseline.path, regression.what);
                let status = not_passed(NonSuccessKind::Failure, &what);
                suite.add_test_case(case(&regression.mesh, row, status));
            }
            if baseline.regressions.is_empty() {
                suite.add_test_case(case("baseline", &baseline.path, TestCaseStatus::success()));
            }
            report.add_test_suite(suite);
        }
        report.to_string()
    }
}

fn suite(mesh: &MeshReport) -> TestSuite {
    let name = mesh.path.as_deref().unwrap_or(&mesh.mesh);
    let mut suite = TestSuite::new(name);
    let reasons = mesh.reference_known_wrong.iter().map(|known| Some(known.reason));
    for (row, reason) in mesh.rows().zip(mesh.tiers.iter().map(|_| None).chain(reasons)) {
        let status = match (row.pass, reason) {
            (false, _) => not_passed(NonSuccessKind::Failure, &failure(mesh, row)),
            (true, Some(reason)) => skipped(&format!("reference wrong: {reason}")),
            (true, None) if row.tolerance_position.is_none() => {
                let normal = row.normal_max_deg.map(|angle| format!(", {angle:.1e} degrees")).unwrap_or_default();
                skipped(&format!(
                    "the reference's own error, reported only: {:.1e} of the diagonal{normal}",
                    row.position_max
                ))
            }
            (true, None) => TestCaseStatus::success(),
        };
        // Names tell test cases apart.
        let known = reason.map(|reason| format!(" (reference wrong: {reason})")).unwrap_or_default();
        let title = format!("{} {} / {}{known}", row.tier, row.kind, row.reference);
        suite.add_test_case(case(name, &title, status));
    }
    for unanswered in &mesh.reference_unanswered {
        let title = format!("{} - / {}", unanswered.tier, unanswered.reference);
        suite.add_test_case(case(name, &title, not_passed(NonSuccessKind::Error, &unanswered.reason)));
    }
    if mesh.limit_masks_not_asked > 0 {
        let status = skipped("not asked: more faces meet at a vertex than OpenSubdiv's limit masks have room for");
        suite.add_test_case(case(name, "vertex - / limit masks", status));
    }
    if let Some(results) = &mesh.results {
        let status = match results.missing() {
            Some(missing) => not_passed(NonSuccessKind::Failure, &missing),
            None => TestCaseStatus::success(),
        };
        suite.add_test_case(case(name, "results: standard samples answered", status));
    }
    suite
}

/// First line: how many samples failed and the worst; then the patches and the command that shows it.
fn failure(mesh: &MeshReport, row: &Tier) -> String {
    let mut text = match (&row.failures, row.samples) {
        (_, 0) => "no samples".to_owned(),
        (Some(failures), _) => format!("failed: {failures}"),
        (None, _) => "the 99.99th percentile of the normals is beyond what is allowed".to_owned(),
    };
    if let Some(worst) = row.worst {
        let _ = write!(text, "; worst at {},{},{}", worst.face, worst.u, worst.v);
    }
    let patches = row.failures.iter().flat_map(|failures| &failures.worst);
    patches.for_each(|patch| text.push_str(&format!("\n{patch}")));
    let _ = write!(text, "\n{}: {row}", mesh.mesh);
    if let Some(command) = &row.reproduce {
        let _ = write!(text, "\nlook: {command}");
    }
    text
}

fn case(class: &str, name: &str, status: TestCaseStatus) -> TestCase {
    let mut case = TestCase::new(name, status);
    case.set_classname(class);
    case
}

fn one(suite: &str, name: &str, status: TestCaseStatus) -> TestSuite {
    let mut made = TestSuite::new(suite);
    made.add_test_case(case(suite, name, status));
    made
}

fn skipped(reason: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::skipped();
    status.set_message(reason);
    status
}

/// The first line of the text is the message.
fn not_passed(kind: NonSuccessKind, text: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status.set_message(text.lines().next().unwrap_or_default());
    status.set_description(text);
    status
}
