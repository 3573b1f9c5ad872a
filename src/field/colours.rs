//! False colours, which shaders and legends share.

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
