//! Errors as colours, on scales that read in grey too: certificates, and whatever else is measured at every pixel.

use crate::gpu::{Certificate, State, SurfaceImage};

/// What is coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heat {
    /// Distance between a pixel's centre and the point that it shows, on a logarithmic scale from 1e-6 to
    /// 1 pixel.
    Residual,
    /// Newton steps: a colour each, from none (solved on the host) to six.
    Steps,
}

/// A logarithmic scale of colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Value at the dark end; smaller ones have its colour.
    pub least: f32,
    /// Value at the light end; larger ones have its colour.
    pub most: f32,
}

impl Scale {
    /// Of residuals, in pixels.
    pub const RESIDUAL: Scale = Scale { least: 1e-6, most: 1.0 };

    /// Where a value stands, from 0 to 1.
    pub fn place(&self, value: f32) -> f32 {
        ((value.max(self.least) / self.least).log10() / (self.most / self.least).log10()).min(1.0)
    }

    /// The powers of ten on it.
    pub fn exponents(&self) -> std::ops::RangeInclusive<i32> {
        // A scale that begins at 1e-6 begins at a power of ten, whatever f32 makes of it.
        const ROUNDING: f32 = 1e-4;
        (self.least.log10() - ROUNDING).ceil() as i32..=(self.most.log10() + ROUNDING).floor() as i32
    }

    /// Colour of a value.
    pub fn colour(&self, value: f32) -> [u8; 3] {
        ramp(self.place(value))
    }
}

/// A picture of values on a scale, 4 bytes a pixel: where there is none (NaN), white, or grey where there is a surface.
pub fn heat_of(values: &[f32], scale: &Scale, is_surface: impl Fn(usize) -> bool) -> Vec<u8> {
    /// A surface of which nothing is known.
    const UNKNOWN: [u8; 3] = [222; 3];
    let colour = |(i, &value): (usize, &f32)| match value.is_nan() {
        false => scale.colour(value),
        true if is_surface(i) => UNKNOWN,
        true => BACKGROUND,
    };
    values.iter().enumerate().map(|pixel| opaque(colour(pixel))).collect::<Vec<_>>().into_flattened()
}

/// Steps at the light end.
const MOST_STEPS: f32 = 6.0;
/// A pixel in doubt.
const DOUBT: [u8; 3] = [255, 0, 255];
/// A pixel that sees no surface.
const BACKGROUND: [u8; 3] = [255; 3];

/// An sRGB picture of the certificates, rows from top to bottom, 4 bytes a pixel; a bar with the scale along its lower border,
/// one field for each power of ten or number of steps, where it is large enough. Not converged: magenta.
pub fn heat(image: &SurfaceImage, what: Heat) -> Vec<u8> {
    let mut pixels: Vec<[u8; 4]> = image.certificate.iter().map(|c| opaque(colour(c, what))).collect();
    let [width, height] = image.size.map(|n| n as usize);
    let fields = match what {
        Heat::Residual => Scale::RESIDUAL.exponents().count() - 1,
        Heat::Steps => MOST_STEPS as usize,
    };
    let bar = height / 64;
    for (k, pixel) in pixels.iter_mut().enumerate().skip((height - bar) * width) {
        let field = (k % width) * (fields + 1) / width;
        *pixel = opaque(ramp(field as f32 / fields as f32));
    }
    pixels.into_flattened()
}

fn opaque([r, g, b]: [u8; 3]) -> [u8; 4] {
    [r, g, b, 255]
}

fn colour(certificate: &Certificate, what: Heat) -> [u8; 3] {
    if certificate.state == State::Background {
        return BACKGROUND;
    }
    if certificate.doubtful || certificate.residual.is_nan() {
        return DOUBT;
    }
    match what {
        Heat::Residual => Scale::RESIDUAL.colour(certificate.residual),
        Heat::Steps => ramp(f32::from(certificate.steps) / MOST_STEPS),
    }
}

/// From dark blue over green to yellow, 0 to 1: lightness grows all the way, so that it reads in grey too. (Stops in the manner
/// of Smith & van der Walt's viridis.)
pub(super) fn ramp(t: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; 5] =
        [[68.0, 1.0, 84.0], [59.0, 82.0, 139.0], [33.0, 145.0, 140.0], [94.0, 201.0, 98.0], [253.0, 231.0, 37.0]];
    let at = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let k = (at as usize).min(STOPS.len() - 2);
    std::array::from_fn(|c| (STOPS[k][c] + (STOPS[k + 1][c] - STOPS[k][c]) * (at - k as f32)).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_say_what_is_wrong() {
        let of = |residual, doubtful| {
            colour(&Certificate { state: State::Chart, steps: 2, residual, doubtful }, Heat::Residual)
        };
        assert_eq!(of(1e-5, true), DOUBT);
        assert_eq!(of(f32::NAN, false), DOUBT);
        assert_eq!(colour(&Certificate::default(), Heat::Residual), BACKGROUND);
        assert_eq!([of(0.0, false), of(1e9, false)], [ramp(0.0), ramp(1.0)]);
        let light = |c: [u8; 3]| c.iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!(light(of(1e-4, false)) > light(of(1e-5, false)));
    }
}
