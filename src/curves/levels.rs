//! Whether a contour may be further in, where a level of an extraordinary vertex has it not.

use super::model::Model;
use crate::field::{Functions, weighted};

/// Part of the range of a level and the vertex by which values on the square between may be outside it.
const EXCESS: f64 = 0.5;
/// Levels looked at before their trend is trusted.
const TREND: usize = 4;
/// What a trend may be better than it looks.
const TRUST: f64 = 2.0;

/// What is known of the square that a level leaves.
#[derive(Debug, Default)]
pub(super) struct Ahead {
    /// The limit at the vertex, if there is one.
    pub vertex: Option<Functions>,
    /// Values on the next levels: modes of different signs may go one way first and then the other.
    pub further: Vec<Functions>,
}

/// How near the values of the levels came to 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approach {
    distance: f64,
    /// By how much the last level was nearer than the one before.
    step: f64,
}

impl Approach {
    pub const NONE: Approach = Approach { distance: f64::INFINITY, step: f64::INFINITY };

    /// Takes in the next level. Where the field has a limit at the vertex, its values further in are between that, the level and what is
    /// seen ahead, about; where it has none (curvatures, normals without a tangent plane), they go on as they did, in a geometric
    /// series.
    pub fn may_arrive(
        &mut self,
        level: usize,
        models: &[Option<Model>],
        weights: &Functions,
        Ahead { vertex, further }: &Ahead,
    ) -> bool {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for model in models {
            // Undefined somewhere: by the levels alone, as far as the cells go.
            let Some(model) = model else { return level <= 12 };
            let [low, high] = model.sum(weights).range();
            range = [range[0].min(low), range[1].max(high)];
        }
        for functions in vertex.iter().chain(further) {
            let value = weighted(weights, functions);
            range = [range[0].min(value), range[1].max(value)];
        }
        let excess = EXCESS * (range[1] - range[0]);
        let distance = (range[0] - excess).max(-range[1] - excess).max(0.0);
        let step = self.distance - distance;
        let ratio = step / self.step;
        *self = Approach { distance, step };
        if distance == 0.0 || vertex.is_some() || level < TREND {
            return distance == 0.0 || vertex.is_none();
        }
        step > 0.0 && (ratio >= 0.95 || TRUST * step * ratio / (1.0 - ratio) > distance)
    }
}
