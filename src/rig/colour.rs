//! Colours as they are written: `#rrggbb` in sRGB, or three linear numbers.

use crate::field::colours::{linear_to_srgb, srgb_to_linear};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A colour in linear RGB, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour(pub [f32; 3]);

impl Colour {
    /// A colour in sRGB.
    pub fn srgb(bytes: [u8; 3]) -> Colour {
        Colour(bytes.map(|byte| srgb_to_linear(f64::from(byte) / 255.0) as f32))
    }

    /// Its bytes in sRGB, if these say all of it.
    fn bytes(self) -> Option<[u8; 3]> {
        let bytes = self.0.map(|x| (linear_to_srgb(f64::from(x)) * 255.0).round() as u8);
        (Colour::srgb(bytes) == self).then_some(bytes)
    }

    fn linear(numbers: [f64; 3]) -> Option<Colour> {
        numbers.iter().all(|x| (0.0..=1.0).contains(x)).then(|| Colour(numbers.map(|x| x as f32)))
    }

    /// Its numbers in as few digits as bring them back.
    fn numbers(self) -> [f64; 3] {
        self.0.map(|x| x.to_string().parse().unwrap_or_else(|_| f64::from(x)))
    }
}

const FORMS: &str = "give #rrggbb in sRGB, or three linear numbers R,G,B from 0 to 1";

impl FromStr for Colour {
    type Err = String;

    fn from_str(text: &str) -> Result<Colour, String> {
        let colour = match text.strip_prefix('#') {
            Some(digits) if digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit()) => {
                u32::from_str_radix(digits, 16)
                    .ok()
                    .map(|rgb| Colour::srgb([rgb >> 16, rgb >> 8, rgb].map(|x| x as u8)))
            }
            Some(_) => None,
            None => {
                let numbers: Option<Vec<f64>> = text.split(',').map(|x| x.trim().parse().ok()).collect();
                numbers.and_then(|numbers| Colour::linear(numbers.try_into().ok()?))
            }
        };
        colour.ok_or_else(|| FORMS.to_owned())
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bytes() {
            Some([r, g, b]) => write!(f, "#{r:02x}{g:02x}{b:02x}"),
            None => write!(f, "{},{},{}", self.0[0], self.0[1], self.0[2]),
        }
    }
}

impl Serialize for Colour {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.bytes() {
            Some(_) => to.collect_str(self),
            None => self.numbers().serialize(to),
        }
    }
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a colour is \"#rrggbb\" in sRGB, or three linear numbers [R, G, B] from 0 to 1")]
enum Written {
    Text(String),
    Numbers([f64; 3]),
}

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Colour, D::Error> {
        match Written::deserialize(from)? {
            Written::Text(text) => text.parse().map_err(|what| D::Error::custom(format!("{text}: {what}"))),
            Written::Numbers(numbers) => {
                Colour::linear(numbers).ok_or_else(|| D::Error::custom(format!("{numbers:?}: {FORMS}")))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_written_as_they_are_read() {
        for text in ["#000000", "#ffffff", "#0a64c8", "0.028,0.04,0.06", "0.1,0.2,0.3"] {
            assert_eq!(text.parse::<Colour>().map(|colour| colour.to_string()), Ok(text.to_owned()));
        }
        for byte in 0..=255 {
            let colour = Colour::srgb([byte, 255 - byte, byte / 2]);
            assert_eq!(colour.to_string().parse(), Ok(colour));
        }
        for text in
            ["", "#fff", "#12345", "#gggggg", "red", "1,2,3", "0,0", "0,0,0,0", "-0.1,0,0", "nan,0,0", "#+12345"]
        {
            assert!(text.parse::<Colour>().is_err(), "{text}");
        }
        // IEC 61966-2-1: mid grey.
        let [r, ..] = Colour::srgb([188, 0, 0]).0;
        assert!((r - 0.5028865).abs() < 1e-6, "{r}");
    }
}
