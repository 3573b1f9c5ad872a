//! Attributes of a prim as the types that a mesh needs.

use glam::DVec3;
use openusd::sdf::{Path, Value};
use openusd::usd::{Prim, TimeCode};

use crate::mesh::MeshError;
use crate::mesh::error::{Place, Spot, quote};

/// A prim, and how messages name it: `FILE: /Prim/Path`.
pub(super) struct Node<'a> {
    pub(super) prim: &'a Prim,
    pub(super) source: &'a str,
    /// When; `None` is the default time.
    pub(super) time: Option<f64>,
}

/// `UsdTimeCode::SafeStep()`: twice the spacing of doubles at 1e6, times ten.
const SAFE_STEP: f64 = f64::EPSILON * 1e6 * 10.0 * 2.0;

/// What an attribute is at the last sample before a time.
#[derive(Debug, Clone)]
pub(super) struct Held<T> {
    pub(super) value: T,
    /// The time of that sample.
    pub(super) at: f64,
    /// The samples before and behind the time.
    pub(super) between: [f64; 2],
}

impl Node<'_> {
    pub(super) fn place(&self) -> Place {
        Place::with(self.source, Spot::Whole)
    }

    /// The value of an attribute at the time; at the default time, where there are only time samples, the first of them.
    pub(super) fn value(&self, name: &str) -> Result<Option<Value>, MeshError> {
        self.value_at(name, self.time)
    }

    /// The value of an attribute at its last sample before the time, and between which samples the time is; `None` at the
    /// default time, and of an attribute without samples.
    pub(super) fn held(&self, name: &str) -> Result<Option<Held<Value>>, MeshError> {
        let Some(time) = self.time else { return Ok(None) };
        let between = |time| {
            let samples = self.prim.attribute(name).bracketing_time_samples(TimeCode::new(time));
            samples.map_err(|error| self.unreadable(name, &error))
        };
        let Some((at, next)) = between(time)? else { return Ok(None) };
        // At a sample the one that follows counts, as in UsdGeom's `samplingUtils`.
        let (from, to) = if at == next { between(time + SAFE_STEP)?.unwrap_or((at, next)) } else { (at, next) };
        Ok(self.value_at(name, Some(at))?.map(|value| Held { value, at, between: [from, to] }))
    }

    fn value_at(&self, name: &str, time: Option<f64>) -> Result<Option<Value>, MeshError> {
        let attribute = self.prim.attribute(name);
        if time.is_some() && attribute.has_authored_metadata("spline").map_err(|error| self.unreadable(name, &error))? {
            return Err(MeshError::AttributeSpline { at: self.place(), name: quote(name.as_bytes()) });
        }
        let value = match time {
            Some(time) => attribute.get_at::<Value>(TimeCode::new(time)),
            None => match attribute.get::<Value>() {
                Ok(None) => attribute.get_at::<Value>(TimeCode::EARLIEST),
                value => value,
            },
        };
        let value = value.map_err(|error| self.unreadable(name, &error))?;
        Ok(value.filter(|value| !matches!(value, Value::None | Value::ValueBlock)))
    }

    /// Whether an attribute has a value or time samples, whatever they are.
    pub(super) fn has_value(&self, name: &str) -> Result<bool, MeshError> {
        self.prim.attribute(name).has_authored_value().map_err(|error| self.unreadable(name, &error))
    }

    fn unreadable(&self, name: &str, error: &dyn std::error::Error) -> MeshError {
        MeshError::UsdUnreadable { at: self.place(), reason: format!("{name}: {}", one_line(error)) }
    }

    /// An attribute that a mesh cannot be without.
    pub(super) fn required<T>(&self, name: &'static str, value: Option<T>) -> Result<T, MeshError> {
        value.ok_or_else(|| MeshError::AttributeMissing { at: self.place(), name })
    }

    pub(super) fn wrong_type(&self, name: &str, expected: &'static str) -> MeshError {
        MeshError::AttributeType { at: self.place(), name: name.to_owned(), expected }
    }

    pub(super) fn token(&self, name: &'static str) -> Result<Option<String>, MeshError> {
        match self.value(name)? {
            None => Ok(None),
            Some(Value::Token(token)) => Ok(Some(quote(token.as_str().as_bytes()))),
            Some(Value::String(text)) => Ok(Some(quote(text.as_bytes()))),
            Some(_) => Err(self.wrong_type(name, "token")),
        }
    }

    pub(super) fn tokens(&self, name: &'static str) -> Result<Vec<String>, MeshError> {
        match self.value(name)? {
            None => Ok(Vec::new()),
            Some(Value::TokenVec(tokens)) => Ok(tokens.iter().map(|token| token.as_str().to_owned()).collect()),
            Some(Value::StringVec(texts)) => Ok(texts),
            Some(_) => Err(self.wrong_type(name, "token[]")),
        }
    }

    /// Indices or counts, from 0; `None` where the attribute has no value.
    pub(super) fn indices(&self, name: &'static str) -> Result<Option<Vec<u32>>, MeshError> {
        let values = match self.value(name)? {
            None => return Ok(None),
            Some(Value::IntVec(values)) => values,
            Some(_) => return Err(self.wrong_type(name, "int[]")),
        };
        let index = |value: i32| {
            u32::try_from(value).map_err(|_| MeshError::AttributeNegative { at: self.place(), name, value })
        };
        values.into_iter().map(index).collect::<Result<_, _>>().map(Some)
    }

    pub(super) fn floats(&self, name: &'static str) -> Result<Vec<f32>, MeshError> {
        match self.value(name)? {
            None => Ok(Vec::new()),
            Some(Value::FloatVec(values)) => Ok(values),
            Some(_) => Err(self.wrong_type(name, "float[]")),
        }
    }

    /// Integers of 64 bits; those of another type count as none, as in OpenUSD.
    pub(super) fn longs(&self, name: &'static str) -> Result<Vec<i64>, MeshError> {
        match self.value(name)? {
            Some(Value::Int64Vec(values)) => Ok(values),
            _ => Ok(Vec::new()),
        }
    }

    /// Prims that a relationship leads to.
    pub(super) fn targets(&self, name: &'static str) -> Result<Vec<Path>, MeshError> {
        self.prim.relationship(name).forwarded_targets().map_err(|error| self.unreadable(name, &error))
    }

    /// Points in whichever precision they have.
    pub(super) fn points(&self, name: &'static str) -> Result<Option<Vec<DVec3>>, MeshError> {
        let value = self.value(name)?;
        value.map(|value| points_of(value).ok_or_else(|| self.wrong_type(name, "point3f[]"))).transpose()
    }
}

/// The points of a value, if it has some.
pub(super) fn points_of(value: Value) -> Option<Vec<DVec3>> {
    Some(match value {
        Value::Vec3fVec(points) => points.into_iter().map(|p| DVec3::new(p.x.into(), p.y.into(), p.z.into())).collect(),
        Value::Vec3dVec(points) => points.into_iter().map(|p| DVec3::new(p.x, p.y, p.z)).collect(),
        Value::Vec3hVec(points) => points.into_iter().map(|p| DVec3::new(p.x.into(), p.y.into(), p.z.into())).collect(),
        _ => return None,
    })
}

/// The quaternions of a value, the real part first, if it has some.
pub(super) fn quaternions_of(value: Value) -> Option<Vec<[f64; 4]>> {
    Some(match value {
        Value::QuathVec(values) => {
            values.into_iter().map(|q| [q.w.into(), q.x.into(), q.y.into(), q.z.into()]).collect()
        }
        Value::QuatfVec(values) => {
            values.into_iter().map(|q| [q.w.into(), q.x.into(), q.y.into(), q.z.into()]).collect()
        }
        _ => return None,
    })
}

/// `error: WHAT --> FILE:LINE:COLUMN | EXCERPT`, as the text reader says it, without what the message has already.
fn without_excerpt(text: &str) -> String {
    let line = |place: &str| place.split(' ').next()?.rsplit(':').nth(1)?.parse::<u32>().ok();
    match text.split_once(" --> ").and_then(|(what, place)| Some((what, line(place)?))) {
        Some((what, line)) => format!("line {line}: {}", what.trim_start_matches("error: ")),
        None => text.to_owned(),
    }
}

/// An error of the reader and what caused it, as one line.
pub(super) fn one_line(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let more = error.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = error.source();
    }
    line_of(&text)
}

/// A message of the reader as one line.
pub(super) fn line_of(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let line = without_excerpt(&words.join(" "));
    let cut: String = line.chars().filter(|c| !c.is_control()).take(200).collect();
    if cut.len() < line.len() { format!("{cut}...") } else { cut }
}
