//! The report as text.

use super::baseline::{Comparison, Regression};
use super::difference::Sample;
use super::report::{MeshReport, Report, Tier, Unanswered};
use crate::line::{count, counted};
use std::fmt::{self, Write};

impl MeshReport {
    /// One line: verdict, name padded to `width`, size, and how close to its tolerance the closest row came.
    pub fn line(&self, width: usize) -> String {
        let verdict = if self.pass { "pass" } else { "FAIL" };
        let samples: usize = self.rows().map(|row| row.samples).sum();
        let patches: usize = self.patches.values().sum();
        let mut line = format!(
            "{verdict}  {:<width$} {:>8} {:<5} {patches:>9} {:<7} {samples:>9} {}",
            self.mesh,
            self.faces,
            counted(self.faces, "face"),
            counted(patches, "patch"),
            counted(samples, "sample")
        );
        let share = |row: &Tier| row.times_allowed.unwrap_or_default();
        let closest = self.tiers.iter().filter(|row| row.pass && row.times_allowed.is_some());
        if let Some(first) = self.reference_unanswered.first() {
            write!(line, "  {first}").expect("strings take all text");
        }
        match (&self.failures, closest.max_by(|a, b| share(a).total_cmp(&share(b)))) {
            (Some(failures), _) => write!(line, "  {failures}"),
            (None, _) if !self.reference_unanswered.is_empty() => Ok(()),
            (None, Some(row)) => {
                let percent = 100.0 * share(row);
                write!(line, "  {percent:>4.1}% of its tolerance ({} {} / {})", row.tier, row.kind, row.reference)
            }
            (None, None) => Ok(()),
        }
        .expect("strings take all text");
        line
    }

    /// The rows as a table, all or the failed ones, and where samples failed.
    pub fn table(&self, failed_only: bool) -> String {
        let mut out = String::new();
        self.write_table(&mut out, failed_only).expect("strings take all text");
        out
    }

    fn write_table(&self, f: &mut dyn Write, failed_only: bool) -> fmt::Result {
        writeln!(
            f,
            "  {:<8} {:<7} {:<23} {:>7} {:>15} {:>15} {:>7} {:>15} {:>7}  worst (face,u,v)",
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
        for tier in self.tiers.iter().filter(|row| !(failed_only && row.pass)) {
            let verdict = match (tier.pass, tier.tolerance_position) {
                (true, Some(_)) => "",
                (true, None) => "  [reported only]",
                (false, _) => "  <- FAIL",
            };
            writeln!(f, "  {tier}{verdict}")?;
        }
        for unanswered in &self.reference_unanswered {
            let Unanswered { tier, reference, reason } = unanswered;
            writeln!(f, "  {tier:<8} {:<7} {reference:<23} {reason}  <- FAIL", "-")?;
        }
        for known in self.reference_known_wrong.iter().filter(|known| !(failed_only && known.row.pass)) {
            let verdict = if known.row.pass { "" } else { "  <- FAIL" };
            writeln!(f, "  {}  [reference wrong: {}]{verdict}", known.row, known.reason)?;
        }
        if !failed_only {
            self.write_notes(f)?;
        }
        self.write_failures(f)
    }

    fn write_notes(&self, f: &mut dyn Write) -> fmt::Result {
        let skipped: usize = self.tiers.iter().map(|tier| tier.normals_skipped).sum();
        if skipped > 0 {
            writeln!(f, "  skipped: {} that rounding alone turns too far to be judged", count(skipped, "normal"))?;
        }
        if self.reference_not_asked > 0 {
            let samples = count(self.reference_not_asked, "sample");
            writeln!(
                f,
                "  Bfr: {samples} not asked: it reads out of bounds where two faces share two edges at a vertex"
            )?;
        }
        if self.limit_masks_not_asked > 0 {
            let vertices = count(self.limit_masks_not_asked, "vertex");
            writeln!(f, "  limit masks: not asked: {vertices} with so many faces that it writes beyond its arrays")?;
        }
        if self.reference_too_slow > 0 {
            let samples = count(self.reference_too_slow, "sample");
            writeln!(
                f,
                "  limit stencils, Bfr: {samples} at vertices of many faces not asked: they take time with the cube and the \
                 square of the valence"
            )?;
        }
        if self.patches_unjudged > 0 {
            let are = if self.patches_unjudged == 1 { "is" } else { "are" };
            let patches = count(self.patches_unjudged, "patch");
            writeln!(f, "  {patches} {are} judged at dyadic points alone: OpenSubdiv has an end cap all over")?;
        }
        for timing in self.timings.iter().flatten() {
            writeln!(f, "  {:<32} {:>8.3} s", timing.step, timing.seconds)?;
        }
        Ok(())
    }

    fn write_failures(&self, f: &mut dyn Write) -> fmt::Result {
        let Some(failures) = &self.failures else { return Ok(()) };
        writeln!(f, "  failed: {failures}; worst first:")?;
        for patch in &failures.worst {
            writeln!(f, "    {patch}")?;
        }
        let mut commands: Vec<_> = self.rows().filter_map(|row| row.reproduce.as_deref()).collect();
        commands.sort_unstable();
        commands.dedup();
        commands.iter().try_for_each(|command| writeln!(f, "    look: {command}"))
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.pass { "pass" } else { "FAIL" };
        let patches: Vec<_> =
            self.patches.iter().filter(|(_, n)| **n > 0).map(|(kind, n)| format!("{n} {kind}")).collect();
        writeln!(f, "{}: {verdict} ({}; patches: {})", self.mesh, count(self.faces, "face"), patches.join(", "))?;
        f.write_str(&self.table(false))
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
            "{:<8} {:<7} {:<23} {:>7} {:>15} {:>15} {:>7} {:>15} {:>7}",
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
            Some(Sample { face, u, v }) => write!(f, "  {face},{u},{v}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Unanswered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} / {})", self.reason, self.tier, self.reference)
    }
}

impl Comparison {
    /// How a run compares with the baseline, in a few words.
    pub fn verdict(&self) -> String {
        match self.regressions.len() {
            0 => format!("nothing is worse than in the baseline {}", self.path),
            1 => format!("1 thing is worse than in the baseline {}", self.path),
            number => format!("{number} things are worse than in the baseline {}", self.path),
        }
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let regressions = count(self.regressions.len(), "regression");
        writeln!(f, "baseline {}: {} compared, {regressions}", self.path, count(self.rows_compared, "row"))?;
        self.regressions.iter().try_for_each(|Regression { mesh, row, what }| {
            let row = row.as_ref().map(|row| format!("{row}: ")).unwrap_or_default();
            writeln!(f, "  worse  {mesh}: {row}{what}")
        })
    }
}

impl Report {
    /// The last line: verdict and counts.
    pub fn verdict(&self) -> String {
        let verdict = if self.pass { "pass" } else { "FAIL" };
        let failed = self.meshes.iter().filter(|mesh| !mesh.pass).count();
        let mut counts = vec![format!("{} passed", self.meshes.len() - failed)];
        counts.extend((failed > 0).then(|| format!("{failed} failed")));
        let allowed = if self.refused_allowed { " (allowed)" } else { "" };
        counts.extend((!self.refused.is_empty()).then(|| format!("{} refused{allowed}", self.refused.len())));
        let meshes = count(self.meshes.len() + self.refused.len(), "mesh");
        let baseline =
            self.baseline.as_ref().map(|comparison| format!("; {}", comparison.verdict())).unwrap_or_default();
        format!("{verdict}: {meshes} against OpenSubdiv {}: {}{baseline}", self.opensubdiv, counts.join(", "))
    }
}
