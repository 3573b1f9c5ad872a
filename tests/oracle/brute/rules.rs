//! Sharpness: how it decays, and which rule it asks for (docs/LIMIT.md, section 1).
//!
//! Sharpness is f32 because OpenSubdiv's is: the fraction that is left at the last level is a weight of the geometry, and
//! Chaikin's averages round.

use catoptric::mesh::Creasing;

/// From here on an edge or vertex never becomes smooth.
pub const INFINITE: f32 = 10.0;

/// Finite and not smooth: the rules change as it decays.
pub fn is_finite(sharpness: f32) -> bool {
    sharpness > 0.0 && sharpness < INFINITE
}

/// A vertex rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    Smooth,
    Dart,
    Crease,
    Corner,
}

impl Rule {
    /// By the sharpness of a vertex and of its edges.
    pub fn new(vertex: f32, edges: &[f32]) -> Self {
        match edges.iter().filter(|&&s| s > 0.0).count() {
            _ if vertex > 0.0 => Self::Corner,
            0 => Self::Smooth,
            1 => Self::Dart,
            2 => Self::Crease,
            _ => Self::Corner,
        }
    }
}

/// Sharpness one level finer, of a vertex or (uniform creasing) of an edge.
pub fn decay(sharpness: f32) -> f32 {
    match sharpness {
        s if s >= INFINITE => INFINITE,
        s => (s - 1.0).max(0.0),
    }
}

/// Sharpness of the child, at one end, of an edge whose sharpness is `own`; `around` is that of all edges of the end.
pub fn child_of_edge(creasing: Creasing, own: f32, around: &[f32]) -> f32 {
    let finite: Vec<f32> = around.iter().copied().filter(|&s| is_finite(s)).collect();
    if creasing == Creasing::Uniform || !is_finite(own) || finite.len() < 2 {
        return decay(own);
    }
    // Chaikin: three quarters of its own and a quarter of the mean of the others.
    let others = (finite.iter().sum::<f32>() - own) / (finite.len() - 1) as f32;
    (0.75 * own + 0.25 * others - 1.0).max(0.0)
}

/// Weight of the parent's rule where the child's differs: the mean of what decays in this step, at most 1.
pub fn parent_weight(creasing: Creasing, vertex: [f32; 2], edges: &[f32], children: &[f32]) -> f32 {
    let ends = |&(&parent, &child): &(&f32, &f32)| match creasing {
        // In the uniform method sharpness of 1 and less decays, however large the child's.
        Creasing::Uniform => parent > 0.0 && parent <= 1.0,
        Creasing::Chaikin => parent > 0.0 && child <= 0.0,
    };
    let own = (vertex[0] > 0.0 && vertex[1] <= 0.0).then_some(vertex[0]);
    let decaying = own.into_iter().chain(edges.iter().zip(children).filter(ends).map(|(&parent, _)| parent));
    let (sum, count) = decaying.fold((0.0f32, 0.0f32), |(sum, count), s| (sum + s, count + 1.0));
    if count == 0.0 { 0.0 } else { (sum / count).min(1.0) }
}
