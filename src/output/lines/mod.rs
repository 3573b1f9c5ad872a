//! Curves as files, a format each: what other programs draw, measure and plot.
//!
//! Practice: [`Lines`] says what is written, [`LinesFormat`] how. Curves of the same light and value are a group, which
//! every format keeps together under one name ([`groups`]). Space is written in world units; only SVG is a picture.

mod dxf;
mod json;
mod obj;
mod picture;
mod svg;
mod usda;

pub use picture::{Drawn, in_picture};

use crate::curves::Curve;
use crate::field::Camera;
use crate::mesh::PtexParts;
use std::io::{Result, Write};

/// Millimetres that a pixel takes on paper: CSS has 96 of them in an inch.
pub const MM_PER_PIXEL: f64 = 25.4 / 96.0;

/// What is written.
#[derive(Debug, Clone, Copy)]
pub struct Lines<'a> {
    /// The curves, in world space.
    pub curves: &'a [Curve],
    /// Their field as it is written on the command line.
    pub field: &'a str,
    /// From where SVG shows them. Its direction up says which axis is up in USD.
    pub camera: &'a Camera,
    /// How the file was made.
    pub made_by: &'a str,
    /// Whose faces the curves lie on, if they have names.
    pub parts: Option<&'a PtexParts<'a>>,
}

/// How curves are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinesFormat {
    /// JSON: all that is known of every curve.
    Json,
    /// SVG 1.1: the picture that the camera takes, as paths; a group (and Inkscape layer) a light.
    Svg {
        /// Millimetres a pixel of the camera's picture, as which coordinates are written; `None`: in pixels.
        mm_per_pixel: Option<f64>,
    },
    /// DXF of release 12: 3D polylines, a layer a light.
    Dxf,
    /// Wavefront OBJ: `l` elements, an object a light.
    Obj,
    /// USD text: linear `BasisCurves`, a scope a light.
    Usda {
        /// Metres that a world unit takes.
        meters_per_unit: f64,
    },
}

impl Lines<'_> {
    /// Writes the curves, in UTF-8 whatever the format.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, format: LinesFormat, out: &mut dyn Write) -> Result<()> {
        match format {
            LinesFormat::Json => json::write(self, out),
            LinesFormat::Svg { mm_per_pixel } => svg::write(self, mm_per_pixel, out),
            LinesFormat::Dxf => dxf::write(self, out),
            LinesFormat::Obj => obj::write(self, out),
            LinesFormat::Usda { meters_per_unit } => usda::write(self, meters_per_unit, out),
        }
    }
}

/// The curves of one light with one value.
struct Group<'a> {
    /// Letters, digits and underscores, not a digit first: `light_3`, `light_minus_3`, and with several values a light
    /// `light_3_1`, `light_3_2`.
    name: String,
    light: i32,
    value: f64,
    /// Those that have two points at least, as they come.
    curves: Vec<&'a Curve>,
}

/// Curves by light, then value. Curves of a single point are left out: nothing can draw them.
fn groups(curves: &[Curve]) -> Vec<Group<'_>> {
    let mut sorted: Vec<&Curve> = curves.iter().filter(|curve| curve.points.len() > 1).collect();
    // Stable: within a group they stay as they come.
    sorted.sort_by(|a, b| a.light.cmp(&b.light).then(a.value.total_cmp(&b.value)));
    let mut groups = Vec::new();
    for of_light in sorted.chunk_by(|a, b| a.light == b.light) {
        let light = of_light[0].light;
        let name = format!("light_{}{}", if light < 0 { "minus_" } else { "" }, light.unsigned_abs());
        let values: Vec<&[&Curve]> =
            of_light.chunk_by(|a, b| a.value.total_cmp(&b.value) == std::cmp::Ordering::Equal).collect();
        for (i, curves) in values.iter().enumerate() {
            let name = if values.len() == 1 { name.clone() } else { format!("{name}_{}", i + 1) };
            groups.push(Group { name, light, value: curves[0].value, curves: curves.to_vec() });
        }
    }
    groups
}

/// A number in as few digits as bring it back.
fn shortest(x: f64) -> String {
    // Unlike `Display`, this has an exponent where there would be rows of zeros.
    format!("{x:?}")
}

/// Text for a comment of one line: what would end the line, or join the next one to it, is replaced.
fn one_line(text: &str) -> String {
    let mut line: String = text.chars().map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c }).collect();
    if line.ends_with('\\') {
        line.push('.');
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn curve(light: i32, value: f64, points: usize) -> Curve {
        Curve { value, light, closed: false, points: vec![DVec3::ZERO; points], places: Vec::new() }
    }

    #[test]
    fn groups_are_lights_and_values() {
        let curves = [curve(2, 0.5, 2), curve(-1, 0.25, 2), curve(2, -0.5, 3), curve(2, 0.5, 4), curve(0, 0.0, 1)];
        let groups: Vec<_> =
            groups(&curves).iter().map(|group| (group.name.clone(), group.value, group.curves.len())).collect();
        let expected = [("light_minus_1", 0.25, 1), ("light_2_1", -0.5, 1), ("light_2_2", 0.5, 2)];
        assert_eq!(groups, expected.map(|(name, value, count)| (name.to_owned(), value, count)));
    }

    #[test]
    fn comments_stay_on_their_line() {
        assert_eq!(one_line("a\nb\tc"), "a\u{fffd}b\u{fffd}c");
        assert_eq!(one_line("ends \\"), "ends \\.");
    }
}
