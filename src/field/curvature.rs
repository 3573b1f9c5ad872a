//! Curvatures as fields.

use crate::stam::Curvature;
use glam::{DVec2, dvec2};

/// Which curvature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurvatureKind {
    /// Product of the principal curvatures, one over squared world units.
    Gaussian,
    /// Their mean, one over world units.
    Mean,
    /// The larger one.
    Largest,
    /// The smaller one.
    Smallest,
}

impl CurvatureKind {
    /// The value at a point with this curvature.
    pub fn of(self, curvature: &Curvature) -> DVec2 {
        let value = match self {
            CurvatureKind::Gaussian => curvature.gaussian,
            CurvatureKind::Mean => curvature.mean,
            CurvatureKind::Largest => curvature.principal[0],
            CurvatureKind::Smallest => curvature.principal[1],
        };
        dvec2(value, 0.0)
    }
}
