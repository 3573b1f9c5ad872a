//! What a report says about answers: coverage, errors by quantity, diagnosis.

use super::diagnosis::Diagnosis;
use super::{Answer, Finding, Nearest, Sample, Terms, Tolerances, sample_set};
use crate::line::count;
use crate::patch::PatchKind;
use crate::stam::LimitSurface;
use crate::verify::difference::{Check, Difference, Normal};
use crate::verify::key::{Against, Key};
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};
use std::fmt;

/// How the answers of a program fared.
#[derive(Debug, Clone, Serialize)]
pub struct Results {
    /// What they may be off.
    pub tolerances: Tolerances,
    /// Points of each face that the standard set has.
    pub per_face: usize,
    /// Points of the standard set that have a surface.
    pub standard: usize,
    /// Those that have an answer.
    pub standard_answered: usize,
    /// The first that has none.
    pub first_unanswered: Option<Sample>,
    /// The standard set was answered, or a part of it was asked for.
    pub complete: bool,
    /// Answers, those beside the standard set included.
    pub answered: usize,
    /// Points of the surface for which the program said that it has no answer.
    pub refused: usize,
    /// Answers in holes, where there is no surface.
    pub in_holes: usize,
    /// Errors by kind, reference and quantity.
    pub quantities: Vec<Quantity>,
    /// Mistakes that explain what fails.
    pub diagnosis: Vec<Finding>,
    /// The program that comes nearest to the answers, where none explains them and no usual mistake does.
    pub nearest: Option<Nearest>,
}

/// Errors of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// Patch kind.
    pub kind: &'static str,
    /// `limit`, the exact limit, or `Far level 10`, OpenSubdiv where it is exact.
    pub reference: &'static str,
    /// `position` and `derivative`, both in parts of the diagonal, or `normal`, in degrees.
    pub quantity: &'static str,
    /// Answers that were judged.
    pub samples: usize,
    /// Those beyond their tolerance.
    pub failed: usize,
    /// Normals that were not judged: the surface has no tangent plane there, or rounding alone turns them too far.
    pub skipped: usize,
    /// Median of the errors.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest error.
    pub max: f64,
    /// The most that one was allowed.
    pub tolerance: f64,
    /// The one that uses most of its tolerance.
    pub worst: Option<Sample>,
}

/// Errors of one quantity, kind and reference as they come in.
#[derive(Debug, Default)]
struct Errors {
    errors: Vec<f64>,
    failed: usize,
    skipped: usize,
    tolerance: f64,
    worst: Option<(f64, Sample)>,
}

impl Errors {
    fn add(&mut self, check: Check, at: Sample) {
        self.errors.push(check.error);
        self.failed += usize::from(check.share() > 1.0);
        self.tolerance = self.tolerance.max(check.allowed);
        if self.worst.is_none_or(|(share, _)| check.share() > share) {
            self.worst = Some((check.share(), at));
        }
    }
}

/// In the order of the report: the exact limit first, then kind and quantity.
type Row = (Against, Option<PatchKind>, usize);

const QUANTITIES: [&str; 3] = ["position", "normal", "derivative"];

#[derive(Debug, Default)]
pub(super) struct Collected {
    rows: BTreeMap<Row, Errors>,
    refused: usize,
    in_holes: usize,
}

impl Collected {
    pub fn add(&mut self, key: Key, at: Sample, difference: &Difference) {
        let Difference { position, normal, derivative } = *difference;
        let row = |quantity| (key.against, key.kind, quantity);
        let normal_check = match normal {
            Normal::Judged(check) => Some(check),
            Normal::Skipped | Normal::Unknown => None,
        };
        for (quantity, check) in [Some(position), normal_check, derivative].into_iter().enumerate() {
            if let Some(check) = check {
                self.rows.entry(row(quantity)).or_default().add(check, at);
            }
        }
        if let Normal::Skipped = normal {
            self.rows.entry(row(1)).or_default().skipped += 1;
        }
    }

    /// One side says that there is no surface.
    pub fn mismatch(&mut self, key: Key) {
        match key.kind {
            Some(_) => self.refused += 1,
            None => self.in_holes += 1,
        }
    }

    pub fn finish(self, surface: &LimitSurface, answers: &[Answer], terms: &Terms, diagnosis: Diagnosis) -> Results {
        // Programs may write parameters as 32-bit floats.
        let place = |at: Sample| (at.face, [at.u, at.v].map(|x| (x as f32).to_bits()));
        let given: HashSet<_> = answers.iter().filter(|a| a.position.is_some()).map(|a| place(a.at)).collect();
        let wanted = sample_set(surface, terms.per_face).filter(|s| surface.locate(s.face, [s.u, s.v]).is_some());
        let (mut standard, mut standard_answered, mut first_unanswered) = (0, 0, None);
        for sample in wanted {
            standard += 1;
            if given.contains(&place(sample)) {
                standard_answered += 1;
            } else {
                first_unanswered = first_unanswered.or(Some(sample));
            }
        }
        Results {
            tolerances: terms.tolerances,
            per_face: terms.per_face,
            standard,
            standard_answered,
            first_unanswered,
            complete: terms.partial || standard_answered == standard,
            answered: answers.iter().filter(|a| a.position.is_some()).count(),
            refused: self.refused,
            in_holes: self.in_holes,
            quantities: self.rows.into_iter().map(quantity).collect(),
            diagnosis: diagnosis.findings,
            nearest: diagnosis.nearest,
        }
    }
}

fn quantity(((against, kind, quantity), mut found): (Row, Errors)) -> Quantity {
    found.errors.sort_by(f64::total_cmp);
    // Not a number sorts behind infinity, as it must: it is the worst. So does it with a sign.
    let negative = found.errors.partition_point(|error| error.is_nan() && error.is_sign_negative());
    found.errors.rotate_left(negative);
    let count = found.errors.len();
    let at = |part: f64| found.errors.get(((count as f64 * part).ceil() as usize).saturating_sub(1));
    let [p50, p99, max] = [0.5, 0.99, 1.0].map(|part| at(part).copied().unwrap_or(0.0));
    Quantity {
        kind: kind.map_or("hole", PatchKind::name),
        reference: against.name(),
        quantity: QUANTITIES[quantity],
        samples: count,
        failed: found.failed,
        skipped: found.skipped,
        p50,
        p99,
        max,
        tolerance: found.tolerance,
        worst: found.worst.map(|(_, at)| at),
    }
}

impl Results {
    /// What of the standard set is missing, if that matters.
    pub fn missing(&self) -> Option<String> {
        let Sample { face, u, v } = self.first_unanswered.filter(|_| !self.complete)?;
        let missing = self.standard - self.standard_answered;
        Some(format!(
            "{missing} of {} standard samples without an answer, the first is face {face} u {u} v {v}; answer them, or say --partial",
            self.standard
        ))
    }

    /// Answers that are beyond a tolerance, or right to refuse.
    fn failed(&self) -> usize {
        self.quantities.iter().map(|q| q.failed).sum::<usize>() + self.refused + self.in_holes
    }
}

impl fmt::Display for Results {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { standard, standard_answered, .. } = self;
        writeln!(
            f,
            "  answered: {standard_answered} of {}; {} in all",
            count(*standard, "standard sample"),
            count(self.answered, "answer")
        )?;
        writeln!(
            f,
            "  {:<8} {:<13} {:<10} {:>8} {:>7} {:>7} {:>8} {:>8} {:>8} {:>8}  worst (face, u, v)",
            "kind", "reference", "quantity", "compared", "failed", "skipped", "p50", "p99", "max", "limit"
        )?;
        for quantity in &self.quantities {
            writeln!(f, "  {quantity}")?;
        }
        if self.refused > 0 {
            let points = count(self.refused, "point");
            writeln!(f, "  FAIL: {points} of the surface without an answer (empty or not a number)")?;
        }
        if self.in_holes > 0 {
            writeln!(
                f,
                "  FAIL: {} where the mesh has no surface (holes, or boundary rule none)",
                count(self.in_holes, "answer")
            )?;
        }
        if let Some(missing) = self.missing() {
            writeln!(f, "  FAIL: {missing}")?;
        }
        for finding in &self.diagnosis {
            writeln!(f, "  diagnosis: {finding}")?;
        }
        if self.diagnosis.is_empty() && self.failed() > 0 {
            writeln!(f, "  diagnosis: none of the usual mistakes explains it")?;
        }
        if let Some(nearest) = &self.nearest {
            writeln!(f, "  nearest: {nearest}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, reference, quantity, samples, failed, skipped, p50, p99, max, tolerance, .. } = self;
        write!(
            f,
            "{kind:<8} {reference:<13} {quantity:<10} {samples:>8} {failed:>7} {skipped:>7} {p50:>8.1e} {p99:>8.1e} {max:>8.1e} {tolerance:>8.1e}"
        )?;
        if let Some(Sample { face, u, v }) = self.worst {
            write!(f, "  {face} {u} {v}")?;
        }
        if *failed > 0 { f.write_str("  <- FAIL") } else { Ok(()) }
    }
}
