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

impl Node<'_> {
    pub(super) fn place(&self) -> Place {
        Place::with(self.source, Spot::Whole)
    }

    /// The value of an attribute at the time; at the default time, where there are only time samples, the first of them.
    pub(super) fn value(&self, name: &str) -> Result<Option<Value>, MeshError> {
        let attribute = self.prim.attribute(name);
        let value = match self.time {
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

    pub(super) fn longs(&self, name: &'static str) -> Result<Option<Vec<i64>>, MeshError> {
        match self.value(name)? {
            None => Ok(None),
            Some(Value::Int64Vec(values)) => Ok(Some(values)),
            Some(_) => Err(self.wrong_type(name, "int64[]")),
        }
    }

    /// Quaternions in whichever precision they have, the real part first.
    pub(super) fn quaternions(&self, name: &'static str) -> Result<Option<Vec<[f64; 4]>>, MeshError> {
        Ok(Some(match self.value(name)? {
            None => return Ok(None),
            Some(Value::QuathVec(values)) => {
                values.into_iter().map(|q| [q.w.into(), q.x.into(), q.y.into(), q.z.into()]).collect()
            }
            Some(Value::QuatfVec(values)) => {
                values.into_iter().map(|q| [q.w.into(), q.x.into(), q.y.into(), q.z.into()]).collect()
            }
            Some(_) => return Err(self.wrong_type(name, "quath[]")),
        }))
    }

    /// Prims that a relationship leads to.
    pub(super) fn targets(&self, name: &'static str) -> Result<Vec<Path>, MeshError> {
        self.prim.relationship(name).forwarded_targets().map_err(|error| self.unreadable(name, &error))
    }

    /// Points in whichever precision they have.
    pub(super) fn points(&self, name: &'static str) -> Result<Option<Vec<DVec3>>, MeshError> {
        Ok(Some(match self.value(name)? {
            None => return Ok(None),
            Some(Value::Vec3fVec(points)) => {
                points.into_iter().map(|p| DVec3::new(p.x.into(), p.y.into(), p.z.into())).collect()
            }
            Some(Value::Vec3dVec(points)) => points.into_iter().map(|p| DVec3::new(p.x, p.y, p.z)).collect(),
            Some(Value::Vec3hVec(points)) => {
                points.into_iter().map(|p| DVec3::new(p.x.into(), p.y.into(), p.z.into())).collect()
            }
            Some(_) => return Err(self.wrong_type(name, "point3f[]")),
        }))
    }
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
    let words: Vec<&str> = text.split_whitespace().collect();
    let line = without_excerpt(&words.join(" "));
    let cut: String = line.chars().filter(|c| !c.is_control()).take(200).collect();
    if cut.len() < line.len() { format!("{cut}...") } else { cut }
}
