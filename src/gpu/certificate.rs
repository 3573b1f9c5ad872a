//! How each sample came to its point, and how far that is from the sample's ray.

use super::shader::{STATE_CHART, STATE_DOUBTFUL, STATE_NONE, STATE_SOLVED};
use crate::field::Camera;
use glam::DVec3;

/// How a sample came to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// It sees no surface.
    #[default]
    Background,
    /// Solved in f64 on the host: silhouettes, and pieces smaller than a few samples.
    Solved,
    /// By Newton's method on a chart.
    Chart,
    /// At the parameters of the proxy: its ray is missed by the residual.
    Proxy,
}

/// What the exact pipeline says of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Certificate {
    /// How it came to its point.
    pub state: State,
    /// Newton steps on the chart that was hit; 0 where solved on the host.
    pub steps: u8,
    /// Distance between the sample's centre and the projection of the point at its (patch, u, v), in samples, to 8 bits, rounded
    /// up.
    pub residual: f32,
    /// On some chart that may lie before what was found, the method did not converge: by proof it must, so this is a defect,
    /// and it is counted.
    pub doubtful: bool,
}

impl Certificate {
    /// Of a pixel that was evaluated at the parameters of the proxy.
    pub(super) fn of_proxy(camera: &Camera, pixel: [u32; 2], position: DVec3) -> Certificate {
        let residual = match camera.project(position) {
            Some(at) => (0..2).map(|k| (at[k] - f64::from(pixel[k]) - 0.5).powi(2)).sum::<f64>().sqrt() as f32,
            None => f32::INFINITY,
        };
        Certificate { state: State::Proxy, residual, ..Certificate::default() }
    }

    /// From the bits that shaders/charts.wgsl writes.
    pub(super) fn from_bits(bits: u32) -> Certificate {
        let state = match bits >> 24 & (STATE_DOUBTFUL - 1) {
            STATE_NONE => State::Background,
            STATE_SOLVED => State::Solved,
            _ => State::Chart,
        };
        const { assert!(STATE_CHART < STATE_DOUBTFUL) };
        Certificate {
            state,
            steps: (bits >> 16 & 255) as u8,
            residual: f32::from_bits(bits << 16),
            doubtful: bits >> 24 & STATE_DOUBTFUL != 0 || !f32::from_bits(bits << 16).is_finite(),
        }
    }
}

/// The certificates of a picture, summed up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Summary {
    /// Samples in the picture.
    pub samples: u64,
    /// Those that see the surface.
    pub covered: u64,
    /// Those of them that were solved on the host.
    pub solved: u64,
    /// Samples where the method did not converge.
    pub unconverged: u64,
    /// Newton steps on charts.
    pub steps: u64,
    /// Largest residual, in samples.
    pub residual_max: f32,
}

impl Summary {
    /// Of certificates.
    pub fn of(certificates: &[Certificate]) -> Summary {
        certificates.iter().copied().map(Summary::one).fold(Summary::default(), Summary::and)
    }

    fn one(Certificate { state, steps, residual, doubtful }: Certificate) -> Summary {
        Summary {
            samples: 1,
            covered: u64::from(state != State::Background),
            solved: u64::from(state == State::Solved),
            unconverged: u64::from(doubtful),
            steps: u64::from(steps),
            residual_max: residual,
        }
    }

    /// Both together.
    pub fn and(self, other: Summary) -> Summary {
        Summary {
            samples: self.samples + other.samples,
            covered: self.covered + other.covered,
            solved: self.solved + other.solved,
            unconverged: self.unconverged + other.unconverged,
            steps: self.steps + other.steps,
            residual_max: self.residual_max.max(other.residual_max),
        }
    }
}
