//! How far OpenSubdiv's end caps are from the limit, wherever one looks from.

use super::AdaptivePatches;
use crate::osd::FarPatch;
use crate::stam::LimitSurface;
use crate::statistics::{Spread, angle_deg, scatter};
use rayon::prelude::*;
use serde::Serialize;

/// Errors at points scattered over the patches that approximate: end caps, and regular patches over semi-sharp features that
/// refinement stopped short of, which OpenSubdiv takes for smooth.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Accuracy {
    /// How many patches approximate.
    pub patches: usize,
    /// Part of the parameter area that they cover, counting faces that are quads as 1 and the quadrants of others as 1/4.
    pub area: f64,
    /// Angle between the normals, degrees; where one of the two has none, nothing.
    pub normal_deg: Spread,
    /// Distance of the positions, in units of the control points' box diagonal.
    pub position: Spread,
}

impl AdaptivePatches {
    /// Compares the patches that approximate with the limit surface of the same mesh, at up to `samples` points, the same number
    /// on each of them and at least one.
    pub fn accuracy(&self, surface: &LimitSurface, samples: usize) -> Accuracy {
        /// Distance, in diagonals, from which a regular patch approximates: far above the rounding of exact ones.
        const OFF: f64 = 1e-9;
        /// Points at which that is looked for.
        const LOOKS: u32 = 2;
        let bounds = self.bounds();
        let diagonal = (bounds[1] - bounds[0]).length().max(f64::MIN_POSITIVE);
        // Angle and distance at a point.
        let error = |index: usize, uv: [f64; 2]| {
            let patch = &self.patches[index];
            let (_, exact) = surface.evaluate_ptex(patch.ptex, patch.to_ptex(uv))?;
            let theirs = self.evaluate(index, uv);
            let distance = exact.position.distance(theirs.position) / diagonal;
            Some([angle_deg(exact.normal, theirs.normal), distance])
        };
        let deepest = self.patches.iter().map(|patch| patch.level).max().unwrap_or(0);
        let approximates = |index: &usize| {
            let patch = &self.patches[*index];
            let is_off = |i: u32| error(*index, scatter(i)).is_some_and(|[_, distance]| distance > OFF);
            patch.is_end_cap || patch.level == deepest && (0..LOOKS).any(is_off)
        };
        let rough: Vec<usize> = (0..self.patches.len()).into_par_iter().filter(approximates).collect();
        let each = (samples / rough.len().max(1)).max(1);
        let errors: Vec<[f64; 2]> = rough
            .par_iter()
            .flat_map_iter(|&index| {
                (0..each).filter_map(move |i| error(index, scatter((index * each + i) as u32 % (1 << 20))))
            })
            .collect();
        let spread = |k: usize| Spread::of(errors.iter().map(|error| error[k]));
        let weight = |patch: &FarPatch| 0.25f64.powi(i32::from(patch.level));
        let all: f64 = self.patches.iter().map(weight).sum();
        let own = rough.iter().fold(0.0, |sum, &index| sum + weight(&self.patches[index]));
        let area = own / all.max(f64::MIN_POSITIVE);
        Accuracy { patches: rough.len(), area, normal_deg: spread(0), position: spread(1) }
    }
}
