//! USD as text: linear basis curves.
//!
//! `/lines` is moved by the middle of the curves, and their points, which USD keeps in 32 bits, are relative to it, so
//! that none is farther off than half an ulp of the object's size, wherever it stands. A light is a scope with its
//! number and value as attributes; in it, open curves and closed ones are a prim each, for `wrap` belongs to the prim.
//! Vertices have their ptex faces and parameters as primvars.

use super::{Lines, groups, shortest};
use crate::curves::Curve;
use glam::{DVec3, Vec3};
use std::fmt::Write as _;
use std::io::{Result, Write};

/// A string literal.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out += "\\\"",
            '\\' => out += "\\\\",
            '\n' => out += "\\n",
            '\r' => out += "\\r",
            '\t' => out += "\\t",
            c if c.is_ascii_control() => {
                let _ = write!(out, "\\x{:02x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out + "\""
}

fn tuple(point: Vec3) -> String {
    let Vec3 { x, y, z } = point;
    format!("({x:?}, {y:?}, {z:?})")
}

fn array(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}

/// A curve as it is written.
struct Written<'a> {
    curve: &'a Curve,
    /// Its points, in order.
    indices: Vec<usize>,
    /// It is one of a periodic prim: those have three points at least.
    wraps: bool,
}

impl Written<'_> {
    /// Without points that are the one before in 32 bits; `None` where a single one is left, which no curve has.
    fn new(curve: &Curve, middle: DVec3) -> Option<Written<'_>> {
        let at = |k: usize| relative(curve.points[k], middle);
        let mut indices: Vec<usize> = (0..curve.points.len()).collect();
        indices.dedup_by_key(|&mut k| at(k).to_array());
        while curve.closed && indices.len() > 1 && at(indices[0]) == at(indices[indices.len() - 1]) {
            indices.pop();
        }
        if indices.len() < 2 {
            return None;
        }
        let wraps = curve.closed && indices.len() > 2;
        if curve.closed && !wraps {
            indices.push(indices[0]);
        }
        Some(Written { curve, indices, wraps })
    }
}

fn relative(point: DVec3, middle: DVec3) -> Vec3 {
    (point - middle).as_vec3()
}

pub(super) fn write(lines: &Lines<'_>, meters_per_unit: f64, out: &mut dyn Write) -> Result<()> {
    let groups = groups(lines.curves);
    let points = || groups.iter().flat_map(|group| &group.curves).flat_map(|curve| &curve.points).copied();
    let bounds = points().reduce(DVec3::min).zip(points().reduce(DVec3::max));
    let middle = bounds.map_or(DVec3::ZERO, |(low, high)| low + 0.5 * (high - low));
    let up = lines.camera.up.abs();
    let axis = if up.y > up.z { "Y" } else { "Z" };
    let [x, y, z] = middle.to_array().map(shortest);
    writeln!(out, "#usda 1.0\n(")?;
    writeln!(out, "    customLayerData = {{\n        string catoptric = {}\n    }}", quoted(lines.made_by))?;
    writeln!(out, "    defaultPrim = \"lines\"")?;
    writeln!(out, "    doc = {}", quoted(&format!("Lines of the field {}", lines.field)))?;
    writeln!(out, "    metersPerUnit = {}\n    upAxis = \"{axis}\"\n)\n", shortest(meters_per_unit))?;
    writeln!(out, "def Xform \"lines\" (\n    kind = \"component\"\n)\n{{")?;
    writeln!(out, "    double3 xformOp:translate = ({x}, {y}, {z})")?;
    writeln!(out, "    uniform token[] xformOpOrder = [\"xformOp:translate\"]")?;
    for group in groups {
        writeln!(out, "\n    def Scope \"{}\"\n    {{", group.name)?;
        writeln!(out, "        custom int catoptric:light = {}", group.light)?;
        writeln!(out, "        custom double catoptric:value = {}", shortest(group.value))?;
        let written = group.curves.iter().filter_map(|curve| Written::new(curve, middle));
        let (closed, open): (Vec<Written<'_>>, Vec<Written<'_>>) = written.partition(|curve| curve.wraps);
        for (name, wrap, curves) in [("open", "nonperiodic", open), ("closed", "periodic", closed)] {
            if !curves.is_empty() {
                write_curves(name, wrap, &curves, middle, out)?;
            }
        }
        writeln!(out, "    }}")?;
    }
    writeln!(out, "}}")
}

fn write_curves(name: &str, wrap: &str, curves: &[Written<'_>], middle: DVec3, out: &mut dyn Write) -> Result<()> {
    let vertices = || curves.iter().flat_map(|written| written.indices.iter().map(|&i| (written.curve, i)));
    let points = || vertices().map(|(curve, i)| relative(curve.points[i], middle));
    // Not empty: curves have points.
    let [low, high] = [points().reduce(Vec3::min), points().reduce(Vec3::max)].map(Option::unwrap_or_default);
    writeln!(out, "\n        def BasisCurves \"{name}\"\n        {{")?;
    writeln!(out, "            uniform token type = \"linear\"")?;
    writeln!(out, "            uniform token wrap = \"{wrap}\"")?;
    let counts = array(curves.iter().map(|written| written.indices.len().to_string()));
    writeln!(out, "            int[] curveVertexCounts = {counts}")?;
    writeln!(out, "            float3[] extent = {}", array([low, high].into_iter().map(tuple)))?;
    writeln!(out, "            point3f[] points = {}", array(points().map(tuple)))?;
    if curves.iter().all(|Written { curve, .. }| curve.places.len() == curve.points.len()) {
        let places = || vertices().map(|(curve, i)| curve.places[i]);
        let vertex = "(\n                interpolation = \"vertex\"\n            )";
        let faces = array(places().map(|place| place.face.to_string()));
        writeln!(out, "            int[] primvars:ptex:face = {faces} {vertex}")?;
        let uvs = array(places().map(|place| format!("({:?}, {:?})", place.u, place.v)));
        writeln!(out, "            double2[] primvars:ptex:uv = {uvs} {vertex}")?;
    }
    writeln!(out, "        }}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_escaped() {
        assert_eq!(quoted("a \"b\" \\ \u{fc}\n\u{1}"), "\"a \\\"b\\\" \\\\ \u{fc}\\n\\x01\"");
    }
}
