//! Rigs by name, which suit themselves to an object.

use super::{Colour, Colours, LightRig, PatternName, PatternRig, Rig};
use crate::field::{Camera, Field, HighlightKind, Light, Method, Mirrored, Scout};
use crate::nearest::nearest;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A light rig that is known by name. Its directions are those of the object and the camera; its lengths are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// An arch of tubes along the object, far away: where bodywork is inspected.
    Tunnel,
    /// A ceiling of three wide panels across the object.
    Showroom,
    /// Narrow stripes, as wide as the gaps, on a sphere.
    Zebra,
    /// Two families of tubes.
    Lattice,
    /// Discs.
    Circles,
    /// The array of highlight lines of Beier & Chen 1994, colour plate 2.
    Highlight,
}

impl Preset {
    /// All of them.
    pub const ALL: [Preset; 6] =
        [Preset::Tunnel, Preset::Showroom, Preset::Zebra, Preset::Lattice, Preset::Circles, Preset::Highlight];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Preset::Tunnel => "tunnel",
            Preset::Showroom => "showroom",
            Preset::Zebra => "zebra",
            Preset::Lattice => "lattice",
            Preset::Circles => "circles",
            Preset::Highlight => "highlight",
        }
    }

    /// What it reads off the surface.
    pub fn method(self) -> Method {
        match self {
            Preset::Tunnel | Preset::Zebra => Method::Sphere(Mirrored::Reflection),
            Preset::Showroom | Preset::Lattice | Preset::Circles => Method::Reflection,
            Preset::Highlight => Method::Highlight(HighlightKind::Array),
        }
    }

    /// What it says of every object. Widths and colours are empirical: chosen by looking.
    pub(super) fn rig(self) -> Rig {
        let pattern = |name, width| PatternRig { name: Some(name), width: Some(width), range: None };
        let paint = |bytes| Colours { paint: Some(Colour::srgb(bytes)), ..Colours::default() };
        let degrees = |spacing| LightRig { spacing: Some(spacing), ..LightRig::default() };
        let (light, pattern, colours) = match self {
            Preset::Tunnel => {
                // The arch ends 25 degrees below the horizon, where flanks seen from above look; latitude has no ends.
                let light = LightRig { size: Some([230.0, 360.0]), ..degrees(12.0) };
                (light, pattern(PatternName::Stripes, 0.3), paint([0x1c, 0x22, 0x2b]))
            }
            Preset::Showroom => (LightRig::default(), pattern(PatternName::Stripes, 0.62), paint([0x5a, 0x0e, 0x12])),
            Preset::Zebra => {
                let [black, white] = [[0x0a; 3], [0xff; 3]].map(|bytes| Some(Colour::srgb(bytes)));
                let colours = Colours { paint: black, light: white, ..Colours::default() };
                (degrees(8.0), pattern(PatternName::Stripes, 0.5), colours)
            }
            Preset::Lattice => (LightRig::default(), pattern(PatternName::Lattice, 0.14), Colours::default()),
            Preset::Circles => (LightRig::default(), pattern(PatternName::Circles, 0.6), Colours::default()),
            Preset::Highlight => (LightRig::default(), pattern(PatternName::Stripes, 0.16), Colours::default()),
        };
        Rig { field: Some(self.method()), light, pattern, colours, ..Rig::default() }
    }

    /// Its light for an object, where that is not the one that suits its method.
    pub(super) fn light(self, scout: &Scout, camera: &Camera) -> Option<Light> {
        let [middle, up] = [scout.middle(), camera.up.normalize_or(DVec3::Z)];
        let [along, across] = scout.horizontal(up);
        match self {
            // Longitude runs round the object, from 0 above it.
            Preset::Tunnel => Some(Light::new(middle, along, along.cross(up), 10.0)),
            Preset::Showroom => Some(ceiling(scout, camera, middle, up, across)),
            Preset::Zebra => Some(Light::new(middle, -up, along, 10.0)),
            Preset::Highlight => {
                // Twice as many lines as other methods have: they are thin.
                let light = scout.field(&self.method(), camera).light;
                Some(Light { spacing: 0.5 * light.spacing, ..light })
            }
            Preset::Lattice | Preset::Circles => None,
        }
    }
}

/// Three panels over what the camera sees, which run along `lines`.
fn ceiling(scout: &Scout, camera: &Camera, middle: DVec3, up: DVec3, lines: DVec3) -> Light {
    /// Height of the panels over the middle of the object, in diagonals.
    const HEIGHT: f64 = 1.5;
    /// Half the panels' number and their width, in spacings: the outer ones end where their tubes do.
    const HALF: f64 = 1.0 + 0.31;
    let diagonal = scout.diagonal();
    let mut light = Light::new(middle + up * (HEIGHT * diagonal), -up, lines, diagonal);
    // What most of the surface mirrors, across the panels and along them.
    let turned = Light { axes: [light.axes[1], -light.axes[0]], ..light };
    let seen = |light: Light| scout.quantiles(&Field::reflection(light), camera, [0.15, 0.5, 0.85]);
    let [[low, x, high], [start, y, end]] = [light, turned].map(seen);
    light.center += light.axes[0] * x + light.axes[1] * y;
    let spacing = (high - low) / 3.0;
    if spacing > 0.0 && spacing.is_finite() {
        light.spacing = spacing.max(1e-3 * diagonal);
    }
    light.half = [HALF * light.spacing, (0.5 * (end - start)).max(light.spacing)];
    light
}

impl FromStr for Preset {
    type Err = String;

    fn from_str(text: &str) -> Result<Preset, String> {
        Preset::ALL.into_iter().find(|preset| preset.name() == text).ok_or_else(|| {
            let names = Preset::ALL.map(Preset::name);
            let near = nearest(text, names).map(|name| format!(" (did you mean {name}?)")).unwrap_or_default();
            let names = names.join(", ");
            format!("no light rig has this name{near}; give {names}, or a file that ends in .toml or .json")
        })
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
