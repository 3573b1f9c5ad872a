//! SVG 1.1: the curves as the camera sees them.

use super::{Lines, groups, in_picture, shortest};
use glam::DVec2;
use std::io::{Result, Write};

/// Width of the lines on paper, in millimetres: a technical pen (ISO 128).
const PEN_MM: f64 = 0.25;
/// Width of the lines in a picture, in pixels.
const PEN_PX: f64 = 1.0;
/// Decimals of coordinates: a millionth of a pixel or millimetre, as much as any reader of SVG keeps.
const DECIMALS: usize = 6;

/// Text between tags or in an attribute; what XML 1.0 cannot hold is replaced.
fn escaped(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            // Else a reader takes them for a space.
            '\t' | '\n' | '\r' => out += &format!("&#{};", u32::from(c)),
            '\u{fffe}' | '\u{ffff}' | '\0'..='\u{1f}' => out.push(char::REPLACEMENT_CHARACTER),
            _ => out.push(c),
        }
        out
    })
}

/// A coordinate, without zeros at its end.
fn coordinate(x: f64) -> String {
    let text = format!("{x:.DECIMALS$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Points without those that are the one before as they are written; a closed path does not come back to its first one either.
fn without_repeats(mut points: Vec<String>, closed: bool) -> Vec<String> {
    points.dedup();
    while closed && points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    points
}

/// A group a light, closed curves as closed paths. The view box is the picture: in pixels, or in millimetres of paper.
pub(super) fn write(lines: &Lines<'_>, mm_per_pixel: Option<f64>, out: &mut dyn Write) -> Result<()> {
    let scale = mm_per_pixel.unwrap_or(1.0);
    let [width, height] = lines.camera.size.map(|side| coordinate(f64::from(side) * scale));
    let (unit, pen) = if mm_per_pixel.is_some() { ("mm", PEN_MM) } else { ("", PEN_PX) };
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    let spaces = r#"xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape""#;
    let size = format!(r#"width="{width}{unit}" height="{height}{unit}" viewBox="0 0 {width} {height}""#);
    writeln!(out, r#"<svg {spaces} version="1.1" {size}>"#)?;
    writeln!(out, "<title>{}</title>", escaped(lines.field))?;
    writeln!(out, "<desc>{}</desc>", escaped(lines.made_by))?;
    writeln!(
        out,
        r##"<g fill="none" stroke="#000" stroke-width="{pen}" stroke-linejoin="round" stroke-linecap="round">"##
    )?;
    for group in groups(lines.curves) {
        let drawn: Vec<_> = group.curves.iter().flat_map(|curve| in_picture(lines.camera, curve)).collect();
        if drawn.is_empty() {
            continue;
        }
        let (name, light, value) = (&group.name, group.light, shortest(group.value));
        let layer = format!(r#"id="{name}" inkscape:groupmode="layer" inkscape:label="{name}""#);
        writeln!(out, r#"<g {layer} data-light="{light}" data-value="{value}">"#)?;
        writeln!(out, "<title>light {light}: {value}</title>")?;
        for part in drawn {
            let points = part.points.iter().map(|&point| {
                let DVec2 { x, y } = point * scale;
                format!("{},{}", coordinate(x), coordinate(y))
            });
            let points = without_repeats(points.collect(), part.closed);
            // A line along the line of sight is a point, which round caps make a dot.
            let is_closed = part.closed || points.len() == 1;
            writeln!(out, r#"<path d="M{}{}"/>"#, points.join(" "), if is_closed { "Z" } else { "" })?;
        }
        writeln!(out, "</g>")?;
    }
    writeln!(out, "</g>\n</svg>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_written_once() {
        let of = |points: &[&str], closed: bool| {
            without_repeats(points.iter().map(|&point| point.to_owned()).collect(), closed)
        };
        assert_eq!(of(&["0,0", "0,0", "1,0", "1,0", "0,0"], false), ["0,0", "1,0", "0,0"]);
        assert_eq!(of(&["0,0", "0,0", "1,0", "1,0", "0,0"], true), ["0,0", "1,0"]);
        assert_eq!(of(&["0,0", "0,0"], true), ["0,0"]);
    }

    #[test]
    fn coordinates_are_short() {
        let cases = [(0.0, "0"), (-1e-9, "0"), (100.0, "100"), (0.125, "0.125"), (-2.5, "-2.5"), (1e-6, "0.000001")];
        for (x, text) in cases {
            assert_eq!(coordinate(x), text);
        }
    }
}
