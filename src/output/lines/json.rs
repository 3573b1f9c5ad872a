//! JSON, numbers in as few digits as bring them back:
//! ```json
//! {"field": "reflection", "made_by": "...", "curves": [
//!   {"value": 0.5, "light": 1, "closed": false, "points": [[x, y, z], ...], "params": [[face, u, v], ...]}, ...]}
//! ```

use super::Lines;
use crate::curves::Curve;
use serde::Serialize;
use serde::ser::{SerializeSeq, Serializer};
use std::io::{Result, Write};

/// A curve as the contract has it.
#[derive(Serialize)]
struct Record<'a> {
    value: f64,
    light: i32,
    closed: bool,
    #[serde(serialize_with = "points")]
    points: &'a Curve,
    #[serde(serialize_with = "params")]
    params: &'a Curve,
}

fn points<S: Serializer>(curve: &&Curve, to: S) -> std::result::Result<S::Ok, S::Error> {
    let mut list = to.serialize_seq(Some(curve.points.len()))?;
    curve.points.iter().try_for_each(|point| list.serialize_element(&point.to_array()))?;
    list.end()
}

fn params<S: Serializer>(curve: &&Curve, to: S) -> std::result::Result<S::Ok, S::Error> {
    let mut list = to.serialize_seq(Some(curve.places.len()))?;
    curve.places.iter().try_for_each(|place| list.serialize_element(&(place.face, place.u, place.v)))?;
    list.end()
}

/// A line a curve, numbers in as few digits as bring them back.
pub(super) fn write(lines: &Lines<'_>, out: &mut dyn Write) -> Result<()> {
    let (field, made_by) = (serde_json::to_string(lines.field)?, serde_json::to_string(lines.made_by)?);
    write!(out, "{{\"field\":{field},\n\"made_by\":{made_by},\n\"curves\":[")?;
    for (i, curve) in lines.curves.iter().enumerate() {
        out.write_all(if i == 0 { b"\n" } else { b",\n" })?;
        let Curve { value, light, closed, .. } = *curve;
        serde_json::to_writer(&mut *out, &Record { value, light, closed, points: curve, params: curve })?;
    }
    out.write_all(b"\n]}\n")
}
