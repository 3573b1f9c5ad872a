//! The colours of pictures, and false colours, which shaders and legends share.

/// Five colours, sRGB, evenly spaced.
pub type Ramp = [[u8; 3]; 5];

/// From dark blue over green to yellow: lightness grows all the way, so that it reads in grey too (in the manner of Smith & van der
/// Walt's viridis).
pub const HEAT: Ramp = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
/// From blue over white, in the middle, to red (in the manner of Moreland's diverging maps).
pub const DIVERGING: Ramp = [[33, 71, 160], [120, 160, 220], [240, 240, 238], [230, 140, 110], [165, 20, 40]];
/// Where there is no value.
pub const UNDEFINED: [u8; 3] = [255, 0, 255];

/// The colour at t, from 0 to 1.
pub fn at(ramp: &Ramp, t: f32) -> [u8; 3] {
    let at = t.clamp(0.0, 1.0) * (ramp.len() - 1) as f32;
    let k = (at as usize).min(ramp.len() - 2);
    std::array::from_fn(|c| {
        let [low, high] = [ramp[k][c], ramp[k + 1][c]].map(f32::from);
        (low + (high - low) * (at - k as f32)).round() as u8
    })
}

/// Colours of a picture, linear RGB from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Palette {
    /// The object where it mirrors no light.
    pub paint: [f32; 3],
    /// The lights.
    pub tube: [f32; 3],
    /// Background at the top of the picture.
    pub top: [f32; 3],
    /// Background at the bottom.
    pub bottom: [f32; 3],
}

impl Default for Palette {
    /// Dark blue-grey paint and slightly warm white tubes before a light neutral background.
    fn default() -> Self {
        Palette {
            paint: [0.028, 0.040, 0.060],
            tube: [0.955, 0.945, 0.920],
            top: [0.830, 0.840, 0.850],
            bottom: [0.560, 0.575, 0.590],
        }
    }
}

/// Inverse of the sRGB transfer function (IEC 61966-2-1), 0 to 1.
pub fn srgb_to_linear(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB transfer function, 0 to 1.
pub fn linear_to_srgb(x: f64) -> f64 {
    if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}
