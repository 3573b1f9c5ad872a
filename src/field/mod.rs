//! One function of (position, normal, line of sight) a file, in f64: the twins of `shaders/field/*.wgsl`.
//!
//! Theory: every method of the sources is a field on the surface. Stripes, bands and pictures are one reading of it
//! (a [`Pattern`], per pixel); curves are the other (contours, Ulmet 2003, Theorem RC).
//! Practice: a new method is one file here, one variant of [`Field`], and one file in `shaders/field/`.

mod camera;
mod light;
mod pattern;
mod reflection;
mod rig;

pub use camera::{Axes, Camera, DEFAULT_FOV, Projection, Ray};
pub use light::Light;
pub use pattern::{Pattern, Picture};
pub use reflection::{reflection, reflection_direction};
pub use rig::{Scout, sample_rig};

use glam::{DVec2, DVec3};

/// What is read off the surface at each point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Field {
    /// The point of a plane light source that the surface mirrors into the eye (Yasui & Kanai 2004, eq. 1).
    Reflection(Light),
}

impl Field {
    /// Value at a surface point, `None` where the field is undefined there (the mirrored ray misses the light plane).
    /// `position` in world space, `normal` of unit length, `sight` along the line of sight to the point, of any length
    /// ([`Camera::sight`]); the value is in world units of the light plane.
    pub fn value(&self, position: DVec3, normal: DVec3, sight: DVec3) -> Option<DVec2> {
        match self {
            Field::Reflection(light) => reflection(light, position, normal, sight),
        }
    }

    /// Name, as in `--field NAME` and `shaders/field/NAME.wgsl`.
    pub fn name(&self) -> &'static str {
        match self {
            Field::Reflection(_) => "reflection",
        }
    }
}
