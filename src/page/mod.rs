//! The report of `verify` as one HTML page that needs nothing but itself: tables, histograms, pictures.
//!
//! [`Pictures::take`] draws a mesh while it is at hand; [`page`] puts the report and all pictures together. The page is the same
//! for the same report: it has no date.

mod chart;
mod pictures;

pub use pictures::Pictures;

use crate::line::counted;
use crate::statistics::short;
use crate::verify::{MeshReport, Report, Sample, Tier};
use askama::Template;
use chart::{Axis, Chart};
use std::borrow::Borrow;

/// The report as HTML. `pictures`: of each mesh, in the order of the report, or none.
///
/// # Errors
/// A value cannot be written as text, which does not happen.
pub fn page(report: &Report, pictures: &[Pictures]) -> Result<String, askama::Error> {
    let none = Pictures::default();
    let meshes = report.meshes.iter().enumerate().map(|(i, mesh)| Mesh::new(mesh, pictures.get(i).unwrap_or(&none)));
    Page { report, meshes: meshes.collect() }.render()
}

#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    report: &'a Report,
    meshes: Vec<Mesh<'a>>,
}

impl Page<'_> {
    /// The verdict's line without its first word, which is there in large letters.
    fn counts(&self) -> String {
        let verdict = self.report.verdict();
        verdict.split_once(": ").map_or(verdict.clone(), |(_, counts)| counts.to_owned())
    }
}

/// A mesh and what is shown of it.
struct Mesh<'a> {
    report: &'a MeshReport,
    rows: Vec<Row<'a>>,
    charts: Vec<Chart>,
    pictures: &'a Pictures,
}

/// A row and what became of it.
struct Row<'a> {
    tier: &'a Tier,
    /// First of its tier: a line is drawn above.
    first: bool,
    verdict: Verdict<'a>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict<'a> {
    Pass,
    Fail,
    /// It judges nothing.
    Reported,
    /// What the reference gets wrong.
    KnownWrong(&'a str),
}

impl Verdict<'_> {
    /// Class of the badge.
    fn class(&self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Reported => "reported",
            Self::KnownWrong(_) => "known",
        }
    }

    /// Text of the badge.
    fn text(&self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::Reported => "reported only",
            Self::KnownWrong(_) => "reference wrong",
        }
    }
}

impl<'a> Mesh<'a> {
    fn new(report: &'a MeshReport, pictures: &'a Pictures) -> Self {
        let reasons = report.tiers.iter().map(|_| None);
        let reasons = reasons.chain(report.reference_known_wrong.iter().map(|known| Some(known.reason)));
        let mut before = "";
        let rows = report.rows().zip(reasons).map(|(tier, reason)| {
            let first = std::mem::replace(&mut before, tier.tier) != tier.tier;
            let verdict = match (tier.pass, reason) {
                (false, _) => Verdict::Fail,
                (true, Some(reason)) => Verdict::KnownWrong(reason),
                (true, None) if tier.tolerance_position.is_none() => Verdict::Reported,
                (true, None) => Verdict::Pass,
            };
            Row { tier, first, verdict }
        });
        let charts = [Axis::POSITION, Axis::NORMAL].map(|axis| Chart::new(report, axis));
        Self { report, rows: rows.collect(), charts: charts.into_iter().flatten().collect(), pictures }
    }

    fn samples(&self) -> usize {
        self.report.rows().map(|row| row.samples).sum()
    }

    fn patches(&self) -> usize {
        self.report.patches.values().sum()
    }

    /// Samples in all and patches by kind, in words.
    fn kinds(&self) -> String {
        let kinds = self.report.patches.iter().filter(|(_, count)| **count > 0);
        kinds.map(|(kind, count)| format!("{} {kind}", grouped(*count))).collect::<Vec<_>>().join(", ")
    }

    /// Error over tolerance of the sample that uses most of it.
    fn closest(&self) -> String {
        let share = self.report.tiers.iter().filter_map(|row| row.times_allowed).reduce(f64::max);
        match share {
            None => "–".to_owned(),
            Some(share) if share < 10.0 => format!("{} %", short(100.0 * share)),
            Some(share) => format!("{share:.1e} times"),
        }
    }

    /// Largest error of OpenSubdiv's end caps: position, degrees.
    fn end_caps(&self) -> Option<(f64, String)> {
        let rows = || self.report.tiers.iter().filter(|row| row.tier == "endcap");
        let position = rows().map(|row| row.position_max).reduce(f64::max)?;
        let normal = rows().filter_map(|row| row.normal_max_deg).reduce(f64::max);
        Some((position, normal.map_or("–".to_owned(), short)))
    }

    /// Normals that were not judged.
    fn skipped(&self) -> usize {
        self.report.rows().map(|row| row.normals_skipped).sum()
    }

    /// Samples at which the reference is known to be wrong.
    fn known_wrong(&self) -> usize {
        self.report.reference_known_wrong.iter().map(|known| known.row.samples).sum()
    }

    /// Commands that show the worst samples of failed rows.
    fn commands(&self) -> Vec<&str> {
        let mut commands: Vec<_> = self.report.rows().filter_map(|row| row.reproduce.as_deref()).collect();
        commands.sort_unstable();
        commands.dedup();
        commands
    }
}

/// An error that a template has at hand, by value or reference.
trait MaybeError {
    fn value(&self) -> Option<f64>;
}

impl MaybeError for f64 {
    fn value(&self) -> Option<f64> {
        Some(*self)
    }
}

impl MaybeError for Option<f64> {
    fn value(&self) -> Option<f64> {
        *self
    }
}

impl<T: MaybeError + ?Sized> MaybeError for &T {
    fn value(&self) -> Option<f64> {
        (**self).value()
    }
}

/// An error in two digits; a dash where there is none.
fn error(x: impl MaybeError) -> String {
    match x.value() {
        None => "–".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(x) if x.is_finite() => format!("{x:.1e}"),
        Some(_) => "not finite".to_owned(),
    }
}

/// A count with thin spaces between its thousands.
fn grouped(n: impl Borrow<usize>) -> String {
    let digits = n.borrow().to_string();
    let head = (digits.len() - 1) % 3 + 1;
    let mut out = digits[..head].to_owned();
    for at in (head..digits.len()).step_by(3) {
        out.push('\u{202f}');
        out.push_str(&digits[at..at + 3]);
    }
    out
}

/// As [`grouped`], with the noun behind it.
fn grouped_count(n: impl Borrow<usize>, noun: impl AsRef<str>) -> String {
    let n = *n.borrow();
    format!("{} {}", grouped(n), counted(n, noun.as_ref()))
}

/// A sample in digits that a table has room for.
fn place(sample: &Sample) -> String {
    let [u, v] = [sample.u, sample.v].map(|x| match x {
        x if x == 0.0 || x == 1.0 => format!("{x}"),
        x if (1e-3..0.9995).contains(&x) => format!("{x:.3}"),
        x if x > 0.5 => format!("1−{:.0e}", 1.0 - x),
        x => format!("{x:.0e}"),
    });
    format!("{} ({u}, {v})", sample.face)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!([1, 123, 1234, 1_234_567].map(grouped), ["1", "123", "1\u{202f}234", "1\u{202f}234\u{202f}567"]);
        assert_eq!([Some(0.0), Some(1.26e-7), Some(f64::NAN), None].map(error), ["0", "1.3e-7", "not finite", "–"]);
        let sample = Sample { face: 7, u: 1.0 - 3e-6, v: 0.25 };
        assert_eq!(place(&sample), "7 (1−3e-6, 0.250)");
    }
}
