//! Numbers as files and flags may give them: one check for both.

use crate::field::MAX_FOV;
use serde::de::{Deserialize, Deserializer, Error};
use std::fmt::Debug;

/// Largest width and height of a picture in pixels, the texture limit of the software adapter.
pub const LARGEST_SIZE: u32 = 8192;

/// A finite number above 0.
///
/// # Errors
/// What to give instead.
pub fn checked_positive(x: f64) -> Result<f64, String> {
    if x > 0.0 && x.is_finite() { Ok(x) } else { Err("give a number above 0".to_owned()) }
}

/// A vertical field of view in degrees.
///
/// # Errors
/// What to give instead.
pub fn checked_fov(fov: f64) -> Result<f64, String> {
    let is_one = fov > 0.0 && fov <= MAX_FOV;
    if is_one { Ok(fov) } else { Err(format!("give a field of view above 0 and at most {MAX_FOV} degrees")) }
}

/// A part, 0 to 1.
///
/// # Errors
/// What to give instead.
pub fn checked_part(x: f64) -> Result<f64, String> {
    if (0.0..=1.0).contains(&x) { Ok(x) } else { Err("give a number from 0 to 1".to_owned()) }
}

/// Width and length of a light.
///
/// # Errors
/// What to give instead.
pub fn checked_extents(sides: [f64; 2]) -> Result<[f64; 2], String> {
    match sides.iter().all(|side| checked_positive(*side).is_ok()) {
        true => Ok(sides),
        false => Err("give two numbers above 0, W,L".to_owned()),
    }
}

/// Width and height of a picture in pixels.
///
/// # Errors
/// What to give instead.
pub fn checked_size(size: [u32; 2]) -> Result<[u32; 2], String> {
    match size.iter().all(|side| (1..=LARGEST_SIZE).contains(side)) {
        true => Ok(size),
        false => Err(format!("give WIDTHxHEIGHT, each 1 to {LARGEST_SIZE}")),
    }
}

/// Ends of a scale.
pub(super) fn checked_range(ends: [f64; 2]) -> Result<[f64; 2], String> {
    match ends.iter().all(|end| end.is_finite()) && ends[0] < ends[1] {
        true => Ok(ends),
        false => Err("give two numbers, the smaller first".to_owned()),
    }
}

fn read<'de, D, T>(from: D, check: impl Fn(T) -> Result<T, String>) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + Clone + Debug,
{
    let value = T::deserialize(from)?;
    check(value.clone()).map(Some).map_err(|what| D::Error::custom(format!("{value:?}: {what}")))
}

pub(super) fn positive<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    read(from, checked_positive)
}

pub(super) fn fov<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    read(from, checked_fov)
}

pub(super) fn part<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    read(from, checked_part)
}

pub(super) fn extents<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[f64; 2]>, D::Error> {
    read(from, checked_extents)
}

pub(super) fn size<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[u32; 2]>, D::Error> {
    read(from, checked_size)
}

pub(super) fn range<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[f64; 2]>, D::Error> {
    read(from, checked_range)
}

/// Vectors as lists of three finite numbers.
pub(super) mod vector {
    use glam::DVec3;
    use serde::{Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(vector: &Option<DVec3>, to: S) -> Result<S::Ok, S::Error> {
        vector.map(|v| v.to_array()).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<DVec3>, D::Error> {
        let finite = |v: [f64; 3]| match v.iter().all(|x| x.is_finite()) {
            true => Ok(v),
            false => Err("give three finite numbers X,Y,Z".to_owned()),
        };
        super::read(from, finite).map(|v| v.map(DVec3::from_array))
    }
}

/// What is written as it is on the command line.
pub(super) mod text {
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::{Serialize, Serializer};
    use std::fmt::Display;
    use std::str::FromStr;

    pub fn serialize<T: Display, S: Serializer>(value: &Option<T>, to: S) -> Result<S::Ok, S::Error> {
        value.as_ref().map(T::to_string).serialize(to)
    }

    pub fn deserialize<'de, T, D>(from: D) -> Result<Option<T>, D::Error>
    where
        T: FromStr<Err: Display>,
        D: Deserializer<'de>,
    {
        let text = String::deserialize(from)?;
        text.parse().map(Some).map_err(|what| D::Error::custom(format!("{text}: {what}")))
    }
}
