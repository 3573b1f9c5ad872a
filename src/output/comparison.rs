//! A comparison as pictures.

use super::heat::{Scale, heat_of};
use super::sheet::Panel;
use crate::compare::Comparison;
use crate::gpu::{Frame, NO_PATCH, SurfaceImage};
use crate::statistics::{Spread, short};

/// Of displacements, in pixels: a hundredth of a pixel is what our own pipeline is held to; beyond ten pixels a line is
/// another one.
pub const LINES_PX: Scale = Scale::logarithmic(1e-3, 10.0);
/// Of angles, in degrees: 1.4e-3 degrees move a line by some 1/100 pixel.
pub const NORMALS_DEG: Scale = Scale::logarithmic(1e-4, 10.0);

/// The exact surface, the other one, the displacement of the lines and the angle between the normals. `name`: of the other
/// surface; `seen`: what its pixels see.
pub fn comparison_panels(
    [exact, other]: [Frame; 2],
    seen: &SurfaceImage,
    comparison: &Comparison,
    name: String,
) -> [Panel; 4] {
    let spread = |what: &str, unit: &str, spread: &Spread| {
        let [mean, p99, max] = [spread.mean, spread.p99, spread.max].map(short);
        format!("{what}: mean {mean}, 99 % below {p99}, at most {max} {unit}")
    };
    let is_surface = |i: usize| seen.patch[i] != NO_PATCH;
    let heat = |values: &[f32], scale: Scale, caption: String, what: &str| Panel {
        caption,
        rgba8: heat_of(values, &scale, is_surface),
        legend: Some((scale, what.to_owned())),
    };
    let lines = "Displacement of reflection lines, pixels (grey: mirrors no light)";
    [
        Panel { caption: "Exact limit".to_owned(), rgba8: exact.rgba8, legend: None },
        Panel { caption: name, rgba8: other.rgba8, legend: None },
        heat(&comparison.lines_px, LINES_PX, spread("Lines", "px", &comparison.lines), lines),
        heat(
            &comparison.normal_deg,
            NORMALS_DEG,
            spread("Normals", "degrees", &comparison.normal),
            "Angle between normals, degrees",
        ),
    ]
}
