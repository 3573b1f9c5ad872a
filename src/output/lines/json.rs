//! JSON, numbers in as few digits as bring them back:
//! ```json
//! {"field": "reflection", "made_by": "...", "curves": [
//!   {"value": 0.5, "light": 1, "closed": false, "points": [[x, y, z], ...], "params": [[face, u, v], ...]}, ...]}
//! ```
//! Curves on meshes of a USD stage have a `prim` each, its path.

use super::Lines;
use crate::curves::Curve;
use rayon::prelude::*;
use serde::Serialize;
use serde::ser::{SerializeSeq, Serializer};
use std::io::{Result, Write};

/// A curve as the contract has it.
#[derive(Serialize)]
struct Record<'a> {
    value: f64,
    light: i32,
    closed: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    prim: Option<&'a str>,
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

/// Curves whose texts are made at once, in parallel.
const AT_ONCE: usize = 1024;

/// A line a curve, numbers in as few digits as bring them back.
pub(super) fn write(lines: &Lines<'_>, out: &mut dyn Write) -> Result<()> {
    let (field, made_by) = (serde_json::to_string(lines.field)?, serde_json::to_string(lines.made_by)?);
    write!(out, "{{\"field\":{field},\n\"made_by\":{made_by},\n\"curves\":[")?;
    let text = |curve: &Curve| {
        let Curve { value, light, closed, .. } = *curve;
        let prim = lines.parts.zip(curve.places.first()).and_then(|(parts, place)| parts.name(place.face));
        serde_json::to_vec(&Record { value, light, closed, prim, points: curve, params: curve })
    };
    for (i, some) in lines.curves.chunks(AT_ONCE).enumerate() {
        let texts: Vec<_> = some.par_iter().map(text).collect();
        for (k, text) in texts.into_iter().enumerate() {
            out.write_all(if i + k == 0 { b"\n" } else { b",\n" })?;
            out.write_all(&text?)?;
        }
    }
    out.write_all(b"\n]}\n")
}
