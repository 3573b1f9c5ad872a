//! How far OpenSubdiv's end caps are from the limit, wherever one looks from.

use super::AdaptivePatches;
use crate::osd::FarPatch;
use crate::stam::LimitSurface;
use crate::statistics::{Spread, angle_deg};
use rayon::prelude::*;
use serde::Serialize;

/// Errors of end caps at points scattered over them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Accuracy {
    /// Angle between the normals, degrees; where one of the two has none, nothing.
    pub normal_deg: Spread,
    /// Distance of the positions, in units of the control points' box diagonal.
    pub position: Spread,
    /// Part of the parameter area that end caps cover, counting faces that are quads as 1 and the quadrants of others as 1/4.
    pub area: f64,
}

/// Point `i` of a sequence that fills the unit square evenly (Roberts' R2: multiples of the plastic number's powers).
fn scatter(i: usize) -> [f64; 2] {
    [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (0.5 + i as f64 * step).fract())
}

impl AdaptivePatches {
    /// Compares the end caps with the limit surface of the same mesh, at up to `samples` points, the same number on each cap and at
    /// least one.
    pub fn accuracy(&self, surface: &LimitSurface, samples: usize) -> Accuracy {
        let caps: Vec<(usize, &FarPatch)> =
            self.patches.iter().enumerate().filter(|(_, patch)| patch.is_end_cap).collect();
        let weight = |patch: &FarPatch| 0.25f64.powi(i32::from(patch.level));
        let (own, all): (f64, f64) =
            (caps.iter().map(|(_, patch)| weight(patch)).sum(), self.patches.iter().map(weight).sum());
        let each = (samples / caps.len().max(1)).max(1);
        let bounds = self.bounds();
        let diagonal = (bounds[1] - bounds[0]).length().max(f64::MIN_POSITIVE);
        let errors: Vec<[f64; 2]> = caps
            .par_iter()
            .flat_map_iter(|&(index, patch)| (0..each).map(move |i| (index, patch, scatter(index * each + i))))
            .filter_map(|(index, patch, uv)| {
                let (_, exact) = surface.evaluate_ptex(patch.ptex, patch.to_ptex(uv))?;
                let theirs = self.evaluate(index, uv);
                Some([angle_deg(exact.normal, theirs.normal), exact.position.distance(theirs.position) / diagonal])
            })
            .collect();
        let spread = |k: usize| Spread::of(errors.iter().map(|error| error[k]));
        Accuracy { normal_deg: spread(0), position: spread(1), area: if all > 0.0 { own / all } else { 0.0 } }
    }
}
