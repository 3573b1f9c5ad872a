//! The references that several tiers ask.

use super::expense::Expense;
use super::{Subject, VerifyError};
use crate::osd::{self, Far, LimitStencils, Location, MAX_ISOLATION, ReferenceJet};
use rayon::prelude::*;

/// OpenSubdiv's exact evaluators, at the deepest isolation.
#[derive(Debug)]
pub(super) struct References {
    stencils: LimitStencils,
    pub far: Far,
    pub expense: Expense,
}

/// Samples that limit stencils are asked about.
pub(super) struct Asked {
    /// All of them.
    pub samples: Vec<Location>,
    /// Lengths of their portions, each asked about by itself; at the end comes the rest.
    portions: Vec<usize>,
    /// Samples at vertices of many faces that are left out, because OpenSubdiv would take too long.
    pub left_out: usize,
}

impl References {
    pub fn new(subject: &Subject<'_>) -> Result<Self, VerifyError> {
        let (stencils, far) =
            rayon::join(|| LimitStencils::new(subject.mesh, MAX_ISOLATION), || Far::new(subject.mesh, MAX_ISOLATION));
        Ok(Self { stencils: stencils?, far: far?, expense: Expense::new(subject.mesh) })
    }

    /// Which of some samples, which come grouped by face, limit stencils are asked about.
    pub fn for_stencils(&self, samples: &[Location]) -> Asked {
        let (cheap, dear) = self.expense.for_stencils(samples);
        let portions: Vec<usize> = dear.iter().map(Vec::len).collect();
        let left_out = samples.len() - cheap.len() - portions.iter().sum::<usize>();
        let samples = dear.into_iter().chain([thinned(&cheap)]).flatten().collect();
        Asked { samples, portions, left_out }
    }

    /// What limit stencils say.
    pub fn stencils(&self, asked: &Asked) -> Result<Vec<ReferenceJet>, osd::Error> {
        let (mut rest, mut portions) = (&asked.samples[..], Vec::new());
        for &length in &asked.portions {
            let (portion, others) = rest.split_at(length);
            portions.push(portion);
            rest = others;
        }
        portions.push(rest);
        let answers: Vec<_> =
            portions.into_par_iter().map(|portion| self.stencils.evaluate(portion)).collect::<Result<_, _>>()?;
        Ok(answers.concat())
    }
}

/// Faces that limit stencils are made for, in each set of samples: a face takes a millisecond, and they say what Far's
/// patches say at every sample, in another way. They come in runs, because a stencil needs the faces round its own.
const STENCIL_FACES: usize = 2048;
const RUN: usize = 16;

/// The samples of evenly spread faces, no more than limit stencils are made for. Samples come grouped by face.
fn thinned(samples: &[Location]) -> Vec<Location> {
    let faces = samples.chunk_by(|a, b| a.0 == b.0);
    let stride = faces.clone().count().div_ceil(STENCIL_FACES).max(1);
    let kept = faces.enumerate().filter(|(i, _)| (i / RUN).is_multiple_of(stride));
    kept.flat_map(|(_, face)| face).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_whole_faces_all_over() {
        for (faces, kept_at_most) in [(1, 1), (2048, 2048), (2049, 1040), (100_000, STENCIL_FACES + RUN)] {
            let samples: Vec<Location> = (0..faces).flat_map(|face| [(face, 0.1, 0.2), (face, 0.3, 0.4)]).collect();
            let kept = thinned(&samples);
            assert!(kept.len().is_multiple_of(2) && !kept.is_empty() && kept.len() / 2 <= kept_at_most, "{faces}");
            assert!(kept.chunks(2).all(|pair| pair[0].0 == pair[1].0 && pair[1].1 == 0.3));
            let last = kept[kept.len() - 1].0;
            assert!(f64::from(last) >= 0.98 * f64::from(faces - 1) - RUN as f64, "{faces}: {last}");
        }
    }
}
