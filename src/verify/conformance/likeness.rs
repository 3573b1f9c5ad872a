//! How alike answers and those of another program are: to rounding, or not.

use super::diagnosis::{Judged, SINGLE};
use super::program::{Reply, Said};
use super::{Check, Judge, Normal};
use crate::verify::difference::{angle_deg, larger};
use crate::verify::rounding::turn_deg;

/// What rounding a program is forgiven.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Precision {
    /// That of 64 bits.
    Double,
    /// That of 32 bits, in world coordinates.
    Single,
}

/// Roundings of 32 bits that a program in 32 bits is forgiven are fewer than the worst case of [`Rounding`](crate::verify::rounding::Rounding)
/// by this factor: 16 half units, as weights of one sum have. The worst case would hide what is looked for.
pub(super) const TYPICAL: f64 = 8.0;

/// An error says which program made it if it is so many times what rounding is forgiven.
const TELLING: f64 = 4.0;

/// Details of a program that show where it is like another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Habit {
    /// Parameters are rounded to 32 bits before it evaluates.
    pub single_parameters: bool,
    /// Derivatives on the parts of n-gons are twice as long, as OpenSubdiv's evaluators hand them out.
    pub doubled: bool,
    /// Positions alone are compared.
    pub positions_alone: bool,
}

/// An answer that fails or not, and whether it lies on a part of an n-gon.
#[derive(Clone, Copy)]
pub(super) struct Witness<'a> {
    pub judged: &'a Judged,
    pub on_part: bool,
}

/// Answers beside those of a program.
#[derive(Debug, Clone)]
pub(super) struct Likeness {
    /// How far off each answer is, over what rounding is forgiven; `None` where the program was not asked.
    pub shares: Vec<Option<f64>>,
    /// Answers that fail,
    pub failing: usize,
    /// and are the program's.
    pub failing_fits: usize,
    /// Answers that fail by so much more than rounding that they tell programs apart,
    pub telling: usize,
    /// and are the program's.
    pub telling_fits: usize,
    /// All answers that were compared,
    pub all: usize,
    /// and are the program's.
    pub fits: usize,
    /// Largest distance to the program's position among answers that fit, in diagonals.
    pub residual: f64,
    /// Median distance of the failing answers that do not fit.
    pub missed: f64,
}

/// Of telling answers, of failing ones and of all of them, the part that must fit.
const SHARE: f64 = 0.99;

/// Two programs say different things where their distances from the answer differ by this part of what rounding is forgiven.
const DIFFERENCE: f64 = 0.02;

/// Fewest answers that tell something.
const FEWEST: usize = 4;

impl Likeness {
    pub fn of(
        judge: &Judge<'_>,
        witnesses: &[Witness<'_>],
        replies: &[Reply],
        habit: Habit,
        precision: Precision,
    ) -> Self {
        let mut out = Self {
            shares: Vec::with_capacity(witnesses.len()),
            failing: 0,
            failing_fits: 0,
            telling: 0,
            telling_fits: 0,
            all: 0,
            fits: 0,
            residual: 0.0,
            missed: 0.0,
        };
        let mut missed = Vec::new();
        for (witness, reply) in witnesses.iter().zip(replies) {
            let said = match *reply {
                Reply::NotAsked => {
                    out.shares.push(None);
                    continue;
                }
                Reply::NoSurface => None,
                Reply::Said(said) => Some(said),
            };
            let seen = compare(judge, *witness, said, habit, precision);
            out.shares.push(Some(seen.share));
            let fits = seen.share <= 1.0;
            out.all += 1;
            out.fits += usize::from(fits);
            out.failing += usize::from(seen.fails);
            out.failing_fits += usize::from(seen.fails && fits);
            out.telling += usize::from(seen.telling);
            out.telling_fits += usize::from(seen.telling && fits);
            if fits {
                out.residual = out.residual.max(seen.distance);
            } else if seen.fails {
                missed.push(seen.distance);
            }
        }
        missed.sort_by(f64::total_cmp);
        out.missed = missed.get(missed.len() / 2).copied().unwrap_or(0.0);
        out
    }

    /// Whether the program explains the answers.
    pub fn explains(&self) -> bool {
        let enough = |fits: usize, of: usize| fits as f64 >= SHARE * of as f64;
        self.tells()
            && enough(self.telling_fits, self.telling)
            && enough(self.failing_fits, self.failing)
            && enough(self.fits, self.all)
    }

    /// Whether the answers fail by enough to say whose they are.
    pub fn tells(&self) -> bool {
        self.telling >= FEWEST.min(self.failing.max(1))
    }

    /// Part of the failing answers that it explains.
    pub fn part(&self) -> f64 {
        self.failing_fits as f64 / self.failing.max(1) as f64
    }

    /// The likeness of this program's answers and others of it, for counts: where they differ is forgotten.
    pub fn and(self, other: Self) -> Self {
        Self {
            shares: Vec::new(),
            failing: self.failing + other.failing,
            failing_fits: self.failing_fits + other.failing_fits,
            telling: self.telling + other.telling,
            telling_fits: self.telling_fits + other.telling_fits,
            all: self.all + other.all,
            fits: self.fits + other.fits,
            residual: self.residual.max(other.residual),
            missed: self.missed.max(other.missed),
        }
    }

    /// Whether the answers are more like this program than like `other`, where it makes a difference.
    pub fn beats(&self, other: &Self) -> bool {
        let (mut mine, mut theirs) = (0.0, 0.0);
        for (ours, other) in self.shares.iter().zip(&other.shares) {
            let [ours, other] = [ours, other].map(|share| share.unwrap_or(0.0).min(1.0));
            if (ours - other).abs() > DIFFERENCE {
                mine += ours.powi(2);
                theirs += other.powi(2);
            }
        }
        theirs > 2.0 * mine
    }
}

/// What one answer says.
struct Seen {
    /// Largest difference over what is forgiven.
    share: f64,
    /// Difference of the positions, in diagonals.
    distance: f64,
    /// The answer fails.
    fails: bool,
    /// It fails by much more than is forgiven.
    telling: bool,
}

fn compare(judge: &Judge<'_>, witness: Witness<'_>, said: Option<Said>, habit: Habit, precision: Precision) -> Seen {
    let rounding = &judge.subject.rounding;
    let factor = match precision {
        Precision::Double => 1.0,
        Precision::Single => SINGLE / TYPICAL,
    };
    let (answer, judged) = witness.judged;
    let unit = rounding.unit;
    let mut seen = Seen { share: 0.0, distance: f64::INFINITY, fails: false, telling: false };
    let mut add = |check: Check, left: f64, forgiven: f64| {
        seen.share =
            larger(seen.share, if left <= forgiven { left / forgiven } else { left.max(2.0 * forgiven) / forgiven });
        let fails = check.share() > 1.0;
        seen.fails |= fails;
        // Not a number is far off.
        seen.telling |= fails && (check.error.is_nan() || check.error >= TELLING * forgiven);
    };
    let position =
        judged.map_or(Check { error: f64::INFINITY, allowed: judge.tolerances.position }, |(_, d)| d.position);
    let forgiven = factor * rounding.position();
    let distance = said.zip(answer.position).map_or(f64::INFINITY, |(s, p)| s.position.distance(p) / unit);
    add(position, distance, forgiven);
    if let (Some((_, difference)), Some(said), false) = (judged, said, habit.positions_alone) {
        let scale = if habit.doubled && witness.on_part { 2.0 } else { 1.0 };
        let [du, dv] = said.derivatives.map(|d| scale * d);
        let forgiven = factor * rounding.derivative(said.cell) * scale;
        if let (Some(check), Some(given)) = (difference.derivative, answer.derivatives) {
            add(check, larger(given[0].distance(du), given[1].distance(dv)) / unit, forgiven / unit);
        }
        if let (Normal::Judged(check), Some(given)) = (difference.normal, answer.normal) {
            let turn = turn_deg(du, dv, forgiven);
            // Where rounding turns the program's normal anyhow, normals say nothing.
            if turn < 1.0 {
                add(check, angle_deg(given, du.cross(dv)), turn.max(f64::EPSILON.to_degrees()));
            }
        }
    }
    seen.distance = distance;
    seen
}
