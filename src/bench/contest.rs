//! Contestants take turns.

use super::{Effort, Row};
use std::collections::BTreeMap;
use std::time::Instant;

/// Runs of each contest: what their ratios differ by is the spread.
const RUNS: usize = 3;

/// The name under which we run.
const OURS: &str = "catoptric";
/// The name of the floor.
const FLOOR: &str = "floor";

/// A name, and what it does.
type Contestant<'a> = (&'static str, Box<dyn FnMut() + 'a>);

/// Pieces of work that are measured against each other.
pub struct Contest<'a> {
    contestants: Vec<Contestant<'a>>,
}

/// Medians of the runs.
#[derive(Debug, Clone, Copy)]
pub struct Figure([f64; RUNS]);

impl Figure {
    /// The median of the runs.
    pub fn median(&self) -> f64 {
        let mut sorted = self.0;
        sorted.sort_by(f64::total_cmp);
        sorted[RUNS / 2]
    }
}

impl std::fmt::Debug for Contest<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.contestants.iter().map(|(name, _)| name)).finish()
    }
}

impl<'a> Contest<'a> {
    /// With ours.
    pub fn new(ours: impl FnMut() + 'a) -> Self {
        Self { contestants: vec![(OURS, Box::new(ours))] }
    }

    /// With a peer.
    pub fn against(mut self, peer: &'static str, work: impl FnMut() + 'a) -> Self {
        self.contestants.push((peer, Box::new(work)));
        self
    }

    /// With the least that the work cannot do without.
    pub fn floor(self, work: impl FnMut() + 'a) -> Self {
        self.against(FLOOR, work)
    }

    /// Seconds of each, in turns, each warmed up when its turn comes.
    pub fn run(mut self, effort: Effort) -> BTreeMap<&'static str, Figure> {
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

    /// The row of a report: seconds times `scale` are its unit.
    pub fn row(self, name: &str, unit: &'static str, scale: f64, note: String, effort: Effort) -> Row {
        let figures = self.run(effort);
        let ours = figures[OURS];
        let others = || figures.iter().filter(|(name, _)| **name != OURS && **name != FLOOR);
        let ratios = others().map(|(name, theirs)| {
            let ratios = theirs.0.iter().zip(&ours.0).map(|(theirs, ours)| theirs / ours);
            let ends = ratios.fold([f64::INFINITY, 0.0f64], |[low, high], r| [low.min(r), high.max(r)]);
            (*name, ends)
        });
        let mut peers: BTreeMap<&str, Option<f64>> = ["bfr", "osd", "embree"].map(|peer| (peer, None)).into();
        peers.extend(others().map(|(name, theirs)| (*name, Some(scale * theirs.median()))));
        Row {
            name: name.to_owned(),
            unit,
            catoptric: scale * ours.median(),
            peers,
            floor: figures.get(FLOOR).map(|floor| scale * floor.median()),
            ratios: ratios.collect(),
            note,
        }
    }
}
