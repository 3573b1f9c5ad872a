//! What a verification asks of OpenSubdiv, and who answers it: plain data, so that questions can go to another process.

use crate::mesh::SubdivMesh;
use crate::osd::{
    Bfr, Error, Far, Level, LimitMasks, LimitStencils, Location, MAX_ISOLATION, Reference, ReferenceJet, Refiner,
    Stencil,
};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What one of OpenSubdiv's evaluators is asked.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Question {
    /// `PrimvarRefiner::Limit` after a uniform refinement to this level.
    LimitMasks { level: u32 },
    /// Limit stencils at samples, grouped by face in each portion; `portions` has the lengths of all portions but the last.
    Stencils { samples: Vec<Location>, portions: Vec<usize> },
    /// The limit stencil of a sample.
    Stencil(Location),
    /// Far's patches at samples.
    Far(Vec<Location>),
    /// Bfr's surfaces, of these approximation levels, at samples that are grouped by face.
    Bfr { levels: (u32, u32), samples: Vec<Location> },
    /// To end as OpenSubdiv does when it reads out of bounds: a test of who asks.
    Crash,
}

/// The answer to a [`Question`].
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Answer {
    Masks(Box<Masks>),
    Jets(Vec<ReferenceJet>),
    Stencil(Stencil),
}

/// A uniform refinement, and what OpenSubdiv's masks make of its last level.
#[derive(Debug, Serialize, Deserialize)]
pub(in super::super) struct Masks {
    /// All levels, the control mesh first.
    pub levels: Vec<Level>,
    /// Points of the last level.
    pub points: Vec<DVec3>,
    /// Their limits, or how many of them there is no room for.
    pub limits: LimitMasks,
}

impl Masks {
    /// The last level.
    pub fn last(&self) -> &Level {
        &self.levels[self.levels.len() - 1]
    }
}

/// OpenSubdiv's evaluators of one mesh, made when they are first asked.
#[derive(Debug)]
pub(super) struct Oracle {
    mesh: SubdivMesh,
    stencils: Option<LimitStencils>,
    far: Option<Far>,
}

impl Oracle {
    pub fn new(mesh: SubdivMesh) -> Self {
        Self { mesh, stencils: None, far: None }
    }

    /// Asks OpenSubdiv.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    pub fn answer(&mut self, question: Question) -> Result<Answer, Error> {
        match question {
            Question::LimitMasks { level } => Ok(Answer::Masks(Box::new(self.masks(level)?))),
            Question::Stencils { samples, portions } => Ok(Answer::Jets(self.in_portions(&samples, &portions)?)),
            Question::Stencil(sample) => Ok(Answer::Stencil(self.stencils()?.stencil(sample)?)),
            Question::Far(samples) => Ok(Answer::Jets(self.far()?.evaluate(&samples)?)),
            Question::Bfr { levels, samples } => Ok(Answer::Jets(Bfr::new(&self.mesh, levels)?.evaluate(&samples)?)),
            Question::Crash => crash(),
        }
    }

    /// Limit stencils portion by portion, as each call refines the faces that it asks about.
    fn in_portions(&mut self, samples: &[Location], portions: &[usize]) -> Result<Vec<ReferenceJet>, Error> {
        let mut rest = samples;
        let mut parts: Vec<&[Location]> = Vec::with_capacity(portions.len() + 1);
        for &length in portions {
            let (part, others) = rest.split_at(length.min(rest.len()));
            parts.push(part);
            rest = others;
        }
        parts.push(rest);
        let stencils = self.stencils()?;
        let answers: Vec<_> = parts.into_par_iter().map(|part| stencils.evaluate(part)).collect::<Result<_, _>>()?;
        Ok(answers.concat())
    }

    fn masks(&self, level: u32) -> Result<Masks, Error> {
        let refiner = Refiner::uniform(&self.mesh, level)?;
        let levels = (0..refiner.level_count()).map(|i| refiner.level(i)).collect::<Result<Vec<_>, _>>()?;
        let mut points = refiner.interpolate(&self.mesh.points)?;
        let last = levels.last().map_or(0, Level::vertex_count);
        points.drain(..points.len() - last);
        let limits = refiner.limit(&points)?;
        Ok(Masks { levels, points, limits })
    }

    fn stencils(&mut self) -> Result<&LimitStencils, Error> {
        Ok(match &mut self.stencils {
            Some(stencils) => stencils,
            none => none.insert(LimitStencils::new(&self.mesh, MAX_ISOLATION)?),
        })
    }

    fn far(&mut self) -> Result<&Far, Error> {
        Ok(match &mut self.far {
            Some(far) => far,
            none => none.insert(Far::new(&self.mesh, MAX_ISOLATION)?),
        })
    }
}

/// Ends the process as a read out of bounds does.
fn crash() -> ! {
    #[cfg(unix)]
    let _ = signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGSEGV);
    std::process::abort()
}
