//! Light rigs: all of a picture but its object and how it is computed, in a small file.
//!
//! Theory: a picture is a camera, a field with its light, a pattern and colours. A [`Rig`] says some of that; a [`Preset`] and a fit
//! to the object ([`Rig::fit`]) say the rest.
//! Practice: flags are a rig laid [over](Rig::over) that of a file, and a [`FittedRig`] has nothing open, so that the picture it
//! makes is the same whoever draws it. docs/RIGS.md has the format.

mod colour;
mod file;
mod fit;
mod pattern;
mod preset;
mod values;

pub use colour::Colour;
pub use file::{RigFileError, RigFormat};
pub use fit::{FittedRig, PlacedLight};
pub use pattern::{PatternName, PatternRig};
pub use preset::Preset;
pub use values::{LARGEST_SIZE, checked_extents, checked_fov, checked_part, checked_positive, checked_size};

use crate::field::{Method, Palette};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What a file, or a command's flags, say of a picture. All of it may be left open.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Rig {
    /// Says what is not said here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// What is read off the surface; as `--field` takes it.
    #[serde(skip_serializing_if = "Option::is_none", with = "values::text")]
    pub field: Option<Method>,
    /// From where the picture is taken.
    #[serde(skip_serializing_if = "is_open")]
    pub camera: CameraRig,
    /// The light plane.
    #[serde(skip_serializing_if = "is_open")]
    pub light: LightRig,
    /// Shape of the lights.
    #[serde(skip_serializing_if = "is_open")]
    pub pattern: PatternRig,
    /// Colours of the picture.
    #[serde(skip_serializing_if = "is_open")]
    pub colours: Colours,
}

fn is_open<T: Default + PartialEq>(part: &T) -> bool {
    *part == T::default()
}

/// What is said of a camera. Positions and directions in world space.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraRig {
    /// Where the eye is.
    #[serde(skip_serializing_if = "Option::is_none", with = "values::vector")]
    pub eye: Option<DVec3>,
    /// Point in the middle of the picture.
    #[serde(skip_serializing_if = "Option::is_none", with = "values::vector")]
    pub target: Option<DVec3>,
    /// Direction that points up in the picture.
    #[serde(skip_serializing_if = "Option::is_none", with = "values::vector")]
    pub up: Option<DVec3>,
    /// Whether lines of sight meet in the eye.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub projection: Option<ProjectionName>,
    /// Vertical field of view of a perspective picture, degrees, above 0 and at most [`MAX_FOV`](crate::field::MAX_FOV).
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "values::fov")]
    pub fov: Option<f64>,
    /// World units that the height of an orthographic picture spans, above 0.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "values::positive")]
    pub height: Option<f64>,
    /// Width and height of the picture in pixels, 1 to [`LARGEST_SIZE`].
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "values::size")]
    pub size: Option<[u32; 2]>,
}

/// Kind of a projection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ProjectionName {
    /// Lines of sight meet in the eye.
    Perspective,
    /// Lines of sight are parallel.
    Orthographic,
}

/// What is said of the light plane ([`Light`](crate::field::Light)), in the coordinates of what it is attached to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightRig {
    /// What moves the light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attached: Option<Attachment>,
    /// Point with coordinates (0, 0).
    #[serde(skip_serializing_if = "Option::is_none", with = "values::vector")]
    pub center: Option<DVec3>,
    /// Normal of the plane; not zero.
    #[serde(skip_serializing_if = "Option::is_none", with = "values::vector")]
    pub normal: Option<DVec3>,
    /// Direction of the lines, of which the part in the plane counts; not parallel to the normal.
    #[serde(skip_serializing_if = "Option::is_none", with = "values::vector")]
    pub lines: Option<DVec3>,
    /// Distance from one line to the next in units of the field, above 0.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "values::positive")]
    pub spacing: Option<f64>,
    /// Width across the lines and length along them, above 0; infinite where nothing is said. On the sphere, degrees of longitude and
    /// latitude.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "values::extents")]
    pub size: Option<[f64; 2]>,
}

/// What a light goes with when the camera moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Attachment {
    /// The object: world space.
    #[default]
    Object,
    /// The camera: the eye is the origin, x points to the right of the picture, y to its top, z from the object to the eye.
    Camera,
}

impl Attachment {
    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Attachment::Object => "object",
            Attachment::Camera => "camera",
        }
    }
}

impl std::str::FromStr for Attachment {
    type Err = String;

    fn from_str(text: &str) -> Result<Attachment, String> {
        let all = [Attachment::Object, Attachment::Camera];
        all.into_iter().find(|one| one.name() == text).ok_or_else(|| "give object or camera".to_owned())
    }
}

/// Colours that are not the usual ones.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Colours {
    /// The object where it mirrors no light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paint: Option<Colour>,
    /// The lights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<Colour>,
    /// Background at the top of the picture; surfaces that face up reflect it faintly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top: Option<Colour>,
    /// Background at the bottom.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom: Option<Colour>,
}

impl Colours {
    fn over(self, base: Colours) -> Colours {
        Colours {
            paint: self.paint.or(base.paint),
            light: self.light.or(base.light),
            top: self.top.or(base.top),
            bottom: self.bottom.or(base.bottom),
        }
    }

    /// With the usual colours for the others.
    pub fn palette(self) -> Palette {
        let usual = Palette::default();
        let of = |colour: Option<Colour>, usual: [f32; 3]| colour.map_or(usual, |colour| colour.0);
        Palette {
            paint: of(self.paint, usual.paint),
            tube: of(self.light, usual.tube),
            top: of(self.top, usual.top),
            bottom: of(self.bottom, usual.bottom),
        }
    }

    /// All colours of a palette.
    pub fn of(palette: Palette) -> Colours {
        let [paint, light, top, bottom] =
            [palette.paint, palette.tube, palette.top, palette.bottom].map(|colour| Some(Colour(colour)));
        Colours { paint, light, top, bottom }
    }
}

/// A rig that contradicts itself.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{key} {problem}")]
pub struct RigError {
    /// What is wrong, as it is called in a file: `light.normal`.
    pub key: &'static str,
    /// Why, and what to do.
    pub problem: &'static str,
}

impl Rig {
    /// This rig, and another one's word where it says nothing. A projection brings its own field of view or height with it, and
    /// a pattern its own width and range; a light that is attached to something else its own vectors: the other rig's are in other
    /// coordinates.
    pub fn over(self, base: Rig) -> Rig {
        Rig {
            preset: self.preset.or(base.preset),
            field: self.field.or(base.field),
            camera: self.camera.over(base.camera),
            light: self.light.over(base.light),
            pattern: self.pattern.over(base.pattern),
            colours: self.colours.over(base.colours),
        }
    }

    /// Refuses what contradicts itself.
    ///
    /// # Errors
    /// The first contradiction.
    pub fn check(&self) -> Result<(), RigError> {
        let bad = |key, problem| Err(RigError { key, problem });
        let CameraRig { projection, fov, height, .. } = self.camera;
        match (projection.unwrap_or(ProjectionName::Perspective), fov, height) {
            (ProjectionName::Orthographic, Some(_), _) => {
                return bad("camera.fov", "does not apply to an orthographic projection; give a height instead");
            }
            (ProjectionName::Perspective, _, Some(_)) => {
                return bad(
                    "camera.height",
                    "applies to the projection \"orthographic\" only; say that, or give a fov instead",
                );
            }
            _ => {}
        }
        if self.pattern.range.is_some() && self.pattern.name.as_ref().is_some_and(|name| *name != PatternName::Heat) {
            return bad("pattern.range", "is for the pattern \"heat\"; leave it out, or choose that one");
        }
        let LightRig { normal, lines, .. } = self.light;
        for (key, direction) in [("camera.up", self.camera.up), ("light.normal", normal), ("light.lines", lines)] {
            match direction {
                Some(DVec3::ZERO) => return bad(key, "has no direction; give one that is not 0,0,0"),
                // Its square under- or overflows.
                Some(long) if !long.length_squared().is_normal() => {
                    return bad(key, "is too short or too long to have a direction; give one of length 1");
                }
                _ => {}
            }
        }
        match (normal, lines) {
            (Some(normal), Some(lines)) => check_lines(normal, lines),
            _ => Ok(()),
        }
    }
}

/// Refuses line directions that say nothing: [`Light::new`](crate::field::Light::new) would take any instead.
fn check_lines(normal: DVec3, lines: DVec3) -> Result<(), RigError> {
    /// Sine of the smallest angle between lines and normal: below it, their part in the plane is mostly rounding.
    const PARALLEL: f64 = 1e-9;
    match normal.normalize_or_zero().cross(lines.normalize_or_zero()).length() < PARALLEL {
        true => Err(RigError {
            key: "light.lines",
            problem: "is parallel to the normal of the light plane; give a direction with a part in the plane",
        }),
        false => Ok(()),
    }
}

impl LightRig {
    fn over(self, base: LightRig) -> LightRig {
        let moves = self.attached.is_some_and(|own| own != base.attached.unwrap_or_default());
        let vector = |own: Option<DVec3>, base: Option<DVec3>| own.or(base.filter(|_| !moves));
        LightRig {
            attached: self.attached.or(base.attached),
            center: vector(self.center, base.center),
            normal: vector(self.normal, base.normal),
            lines: vector(self.lines, base.lines),
            spacing: self.spacing.or(base.spacing),
            size: self.size.or(base.size),
        }
    }
}

impl CameraRig {
    fn over(self, base: CameraRig) -> CameraRig {
        let keeps = |kind| self.projection.is_none_or(|own| own == kind);
        CameraRig {
            eye: self.eye.or(base.eye),
            target: self.target.or(base.target),
            up: self.up.or(base.up),
            projection: self.projection.or(base.projection),
            fov: self.fov.or(base.fov.filter(|_| keeps(ProjectionName::Perspective))),
            height: self.height.or(base.height.filter(|_| keeps(ProjectionName::Orthographic))),
            size: self.size.or(base.size),
        }
    }
}
