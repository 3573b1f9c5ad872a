//! Contestants take turns.

use super::{Effort, Row};
use std::collections::BTreeMap;
use std::time::Instant;

/// Runs of each contest: what their ratios differ by is the spread.
pub(super) const RUNS: usize = 3;

/// The name under which we run.
const OURS: &str = "catoptric";
/// The name of the floor.
const FLOOR: &str = "floor";

/// A name, and what it does.
type Contestant<'a> = (&'static str, Box<dyn FnMut() + 'a>);

/// One piece of work, and all who do it.
pub struct Contest<'a> {
    name: String,
    unit: Unit,
    note: String,
    contestants: Vec<Contestant<'a>>,
}

/// What a figure is in.
#[derive(Debug, Clone, Copy)]
pub struct Unit {
    /// Its name.
    pub name: &'static str,
    /// How many of it a second of a turn is.
    pub in_a_second: f64,
}

impl Unit {
    /// Milliseconds of a turn.
    pub const MILLISECONDS: Self = Self { name: "ms", in_a_second: 1e3 };

    /// Nanoseconds a sample.
    pub fn nanoseconds_a_sample(samples: usize) -> Self {
        Self { name: "ns/sample", in_a_second: 1e9 / samples as f64 }
    }

    /// Microseconds a control face.
    pub fn microseconds_a_face(faces: usize) -> Self {
        Self { name: "us/face", in_a_second: 1e6 / faces as f64 }
    }
}

/// Medians of the runs.
#[derive(Debug, Clone, Copy)]
pub struct Figure(pub(super) [f64; RUNS]);

impl Figure {
    /// The median of the runs.
    pub fn median(&self) -> f64 {
        let mut sorted = self.0;
        sorted.sort_by(f64::total_cmp);
        sorted[RUNS / 2]
    }

    /// It over ours, least and largest of the runs.
    pub fn over(&self, ours: &Self) -> [f64; 2] {
        let ratios = self.0.iter().zip(&ours.0).map(|(theirs, ours)| theirs / ours);
        ratios.fold([f64::INFINITY, 0.0f64], |[low, high], r| [low.min(r), high.max(r)])
    }
}

impl std::fmt::Debug for Contest<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: ", self.name)?;
        f.debug_list().entries(self.contestants.iter().map(|(name, _)| name)).finish()
    }
}

impl<'a> Contest<'a> {
    /// With ours.
    pub fn new(name: impl Into<String>, unit: Unit, note: String, ours: impl FnMut() + 'a) -> Self {
        Self { name: name.into(), unit, note, contestants: vec![(OURS, Box::new(ours))] }
    }

    /// With a peer.
    pub fn against(mut self, peer: &'static str, work: impl FnMut() + 'a) -> Self {
        self.contestants.push((peer, Box::new(work)));
        self
    }

    /// With more to say.
    pub fn noting(mut self, more: &str) -> Self {
        self.note.push_str(more);
        self
    }

    /// With the least that the work cannot do without.
    pub fn floor(self, work: impl FnMut() + 'a) -> Self {
        self.against(FLOOR, work)
    }

    /// Name of the row.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Who does the work, and a turn of it.
    pub fn contestants(&mut self) -> impl Iterator<Item = (&'static str, &mut (dyn FnMut() + 'a))> {
        self.contestants.iter_mut().map(|(name, work)| (*name, &mut **work))
    }

    /// Seconds of each, in turns, each warmed up when its turn comes.
    pub fn run(&mut self, effort: Effort) -> BTreeMap<&'static str, Figure> {
        self.contestants.iter_mut().for_each(|(_, work)| work());
        let mut runs: Vec<[f64; RUNS]> = vec![[0.0; RUNS]; self.contestants.len()];
        for run in 0..RUNS {
            let mut times: Vec<Vec<f64>> = vec![Vec::new(); self.contestants.len()];
            for _ in 0..effort.turns {
                for ((_, work), times) in self.contestants.iter_mut().zip(&mut times) {
                    // What the others left in the caches is not to count.
                    work();
                    let start = Instant::now();
                    work();
                    times.push(start.elapsed().as_secs_f64());
                }
            }
            for (runs, mut times) in runs.iter_mut().zip(times) {
                times.sort_by(f64::total_cmp);
                runs[run] = times[effort.turns / 2];
            }
        }
        self.contestants.iter().zip(runs).map(|((name, _), runs)| (*name, Figure(runs))).collect()
    }

    /// The row of a report.
    pub fn row(mut self, effort: Effort) -> Row {
        let mut figures = self.run(effort);
        let ours = figures.remove(OURS).expect("we take part");
        let Unit { name: unit, in_a_second } = self.unit;
        let floor = figures.remove(FLOOR).map(|floor| in_a_second * floor.median());
        Row { floor, ..Row::new(self.name, unit, in_a_second, &ours, &figures, self.note) }
    }
}
