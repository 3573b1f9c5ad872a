//! Errors as colours, on scales that read in grey too: certificates, and whatever else is measured at every pixel.

use crate::field::colours;
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

/// A scale of colours. A linear one with 0 inside goes from blue over white, at 0, to red.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Value at the dark end; smaller ones have its colour.
    pub least: f32,
    /// Value at the light end; larger ones have its colour.
    pub most: f32,
    /// Both ends are above 0, and powers of ten are as far apart.
    pub logarithmic: bool,
}

impl Scale {
    /// Of residuals, in pixels.
    pub const RESIDUAL: Scale = Scale::logarithmic(1e-6, 1.0);

    /// A logarithmic scale.
    pub const fn logarithmic(least: f32, most: f32) -> Scale {
        Scale { least, most, logarithmic: true }
    }

    /// A linear scale.
    pub const fn linear(least: f32, most: f32) -> Scale {
        Scale { least, most, logarithmic: false }
    }

    fn diverges(&self) -> bool {
        !self.logarithmic && self.least < 0.0 && self.most > 0.0
    }

    /// Where a value stands, from 0 to 1.
    pub fn place(&self, value: f32) -> f32 {
        match self.logarithmic {
            true => ((value.max(self.least) / self.least).log10() / (self.most / self.least).log10()).min(1.0),
            false => ((value - self.least) / (self.most - self.least)).clamp(0.0, 1.0),
        }
    }

    /// Values at which a scale has ticks, with labels: powers of ten, or whole multiples of 1, 2 or 5 times one.
    pub fn ticks(&self) -> Vec<(f32, String)> {
        if self.logarithmic {
            return self.exponents().map(|exponent| (10f32.powi(exponent), power_of_ten(exponent))).collect();
        }
        let span = f64::from(self.most) - f64::from(self.least);
        let rough = span / 4.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
        let Some(step) = step.filter(|step| step.is_finite() && *step > 0.0) else { return Vec::new() };
        let first = (f64::from(self.least) / step - 1e-6).ceil() as i64;
        let last = (f64::from(self.most) / step + 1e-6).floor() as i64;
        // No digit more than the step has.
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let label = |value: f64| match (1e-3..1e5).contains(&step) {
            true => format!("{value:.digits$}"),
            false => format!("{value:.1e}"),
        };
        (first..=last).map(|k| k as f64 * step).map(|value| (value as f32, label(value))).collect()
    }

    /// The powers of ten on it.
    fn exponents(&self) -> std::ops::RangeInclusive<i32> {
        // A scale that begins at 1e-6 begins at a power of ten, whatever f32 makes of it.
        const ROUNDING: f32 = 1e-4;
        (self.least.log10() - ROUNDING).ceil() as i32..=(self.most.log10() + ROUNDING).floor() as i32
    }

    /// Colour of a value.
    pub fn colour(&self, value: f32) -> [u8; 3] {
        if !self.diverges() {
            return colours::at(&colours::HEAT, self.place(value));
        }
        let signed = if value > 0.0 { value / self.most } else { -value / self.least };
        colours::at(&colours::DIVERGING, 0.5 + 0.5 * signed.clamp(-1.0, 1.0))
    }

    /// Colour at a place, from 0 to 1.
    pub fn colour_at(&self, place: f32) -> [u8; 3] {
        match self.logarithmic {
            true => colours::at(&colours::HEAT, place),
            false => self.colour(self.least + place * (self.most - self.least)),
        }
    }
}

/// As people write it: 0.01, but 1e-6.
fn power_of_ten(exponent: i32) -> String {
    match exponent {
        -3..=3 => format!("{}", 10f64.powi(exponent)),
        _ => format!("1e{exponent}"),
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
const DOUBT: [u8; 3] = colours::UNDEFINED;
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
        *pixel = opaque(colours::at(&colours::HEAT, field as f32 / fields as f32));
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
        Heat::Steps => colours::at(&colours::HEAT, f32::from(certificate.steps) / MOST_STEPS),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        let labels = |scale: Scale| scale.ticks().into_iter().map(|(_, label)| label).collect::<Vec<_>>().join(" ");
        assert_eq!(labels(Scale::logarithmic(1e-6, 1.0)), "1e-6 1e-5 1e-4 0.001 0.01 0.1 1");
        assert_eq!(labels(Scale::linear(-1.0, 1.0)), "-1.0 -0.5 0.0 0.5 1.0");
        assert_eq!(labels(Scale::linear(0.0, 180.0)), "0 50 100 150");
        assert_eq!(labels(Scale::linear(-3.2e-5, 1e-5)), "-2.0e-5 0.0e0");
        assert_eq!(labels(Scale::linear(1.0, 1.0)), "");
        let scale = Scale::linear(-2.0, 1.0);
        assert_eq!([scale.colour(0.0), scale.colour_at(2.0 / 3.0)], [colours::DIVERGING[2]; 2]);
        assert_eq!([scale.colour(-9.0), scale.colour(9.0)], [colours::DIVERGING[0], colours::DIVERGING[4]]);
    }

    #[test]
    fn colours_say_what_is_wrong() {
        let of = |residual, doubtful| {
            colour(&Certificate { state: State::Chart, steps: 2, residual, doubtful }, Heat::Residual)
        };
        assert_eq!(of(1e-5, true), DOUBT);
        assert_eq!(of(f32::NAN, false), DOUBT);
        assert_eq!(colour(&Certificate::default(), Heat::Residual), BACKGROUND);
        assert_eq!([of(0.0, false), of(1e9, false)], [0.0, 1.0].map(|t| colours::at(&colours::HEAT, t)));
        let light = |c: [u8; 3]| c.iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!(light(of(1e-4, false)) > light(of(1e-5, false)));
    }
}
