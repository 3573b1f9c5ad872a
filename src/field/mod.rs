//! What is read off a surface: a function of a point, its normal, the line of sight and, for some, its curvature. One method a
//! file, in f64: the twins of `shaders/field/*.wgsl`.
//!
//! Theory: every method of the sources is a field on the surface. Stripes, bands and pictures are one reading of it
//! (a [`Pattern`], per pixel); curves are the other (contours, Ulmet 2003, Theorem RC).
//! Practice: a new method is one file here, one variant of [`Method`], and one file in `shaders/field/`.

mod camera;
pub mod colours;
mod contour;
mod curvature;
mod curve;
mod distance;
mod highlight;
mod isophote;
mod light;
mod names;
mod pattern;
mod reflection;
mod rig;
mod sphere;

pub use camera::{Axes, Camera, DEFAULT_FOV, MAX_FOV, Projection, Ray};
pub use colours::Palette;
pub(crate) use contour::weighted;
pub use contour::{Contour, Functions};
pub use curvature::CurvatureKind;
pub use curve::{Expression, ExpressionError, PlaneCurve};
pub use highlight::HighlightKind;
pub use light::Light;
pub use pattern::{Pattern, Picture};
pub use reflection::{reflection, reflection_direction};
pub use rig::{Scout, sample_rig};
pub use sphere::Mirrored;

use crate::stam::{Curvature, LimitSurface};
use glam::{DVec2, DVec3};

/// A point of a surface, as fields see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// World space.
    pub position: DVec3,
    /// Of unit length; its sign does not matter but to isophotes and curvature.
    pub normal: DVec3,
    /// Along the line of sight to the point, of any length ([`Camera::sight`]).
    pub sight: DVec3,
    /// For fields that read it ([`Method::reads_curvature`]); `None` where there is none.
    pub curvature: Option<Curvature>,
}

/// What is read off the surface at each point: a method, and the light that it is read by.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// What the method does with the light is said there.
    pub light: Light,
    /// How it is read.
    pub method: Method,
}

/// How a field is read off the surface. Values have two coordinates, of which the first makes the lines.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// The point of the light plane that the surface mirrors into the eye, world units (Yasui & Kanai 2004, eq. 1).
    Reflection,
    /// g(x, y) of that point (Ulmet 2003, Theorem RC), and zero.
    Curve(PlaneCurve),
    /// Distance of the mirrored ray, as a line, from the nearest of the light lines x = k spacing, world units, with a sign
    /// (Ulmet 2003, eq. 4.2); and which line that is.
    RayDistance,
    /// Of the surface normal, as a line, from the light lines (Beier & Chen 1994).
    Highlight(HighlightKind),
    /// Longitude and latitude, degrees, of a direction on a sphere round the scene (Ulmet 2003, sec. 6): the light's normal points to
    /// the south pole, its first axis to longitude 0.
    Sphere(Mirrored),
    /// Angle between the normal and the direction to a light infinitely far away (against the light's normal), degrees; and
    /// zero (Poeschl 1984).
    Isophote,
    /// A curvature, in one over world units; and zero.
    Curvature(CurvatureKind),
    /// The point itself in coordinates of the light plane: its lines are plane sections.
    Section,
}

impl Method {
    /// Whether values depend on second derivatives.
    pub fn reads_curvature(&self) -> bool {
        matches!(self, Method::Curvature(_))
    }

    /// Whether values change with the camera.
    pub fn reads_sight(&self) -> bool {
        matches!(
            self,
            Method::Reflection | Method::Curve(_) | Method::RayDistance | Method::Sphere(Mirrored::Reflection)
        )
    }

    /// Whether the light's extents bound the pattern: where values are coordinates of the light plane, or longitude and latitude,
    /// of which the extents are degrees then.
    pub fn is_bounded(&self) -> bool {
        matches!(
            self,
            Method::Reflection | Method::Section | Method::Highlight(HighlightKind::Array) | Method::Sphere(_)
        )
    }

    /// Name, as in `shaders/field/NAME.wgsl`.
    pub fn name(&self) -> &'static str {
        match self {
            Method::Reflection => "reflection",
            Method::Curve(_) => "curve",
            Method::RayDistance => "distance",
            Method::Highlight(_) => "highlight",
            Method::Sphere(_) => "sphere",
            Method::Isophote => "isophote",
            Method::Curvature(_) => "curvature",
            Method::Section => "section",
        }
    }
}

impl Field {
    /// Reflection lines of a light plane.
    pub fn reflection(light: Light) -> Field {
        Field { light, method: Method::Reflection }
    }

    /// Value at a surface point; `None` where it is undefined there (a mirrored ray that misses the light plane, say).
    pub fn value(&self, point: &Point) -> Option<DVec2> {
        let Field { light, method } = self;
        let Point { position, normal, sight, curvature } = *point;
        let value = match method {
            Method::Reflection => reflection(light, position, normal, sight),
            Method::Curve(curve) => reflection(light, position, normal, sight).and_then(|at| curve.value(at)),
            Method::RayDistance => distance::ray_distance(light, position, reflection_direction(normal, sight)),
            Method::Highlight(kind) => highlight::highlight(light, *kind, position, normal),
            Method::Sphere(mirrored) => sphere::longitude_latitude(light, mirrored.direction(normal, sight)),
            Method::Isophote => isophote::angle(light, normal),
            Method::Curvature(kind) => curvature.map(|curvature| kind.of(&curvature)),
            Method::Section => Some(light.coordinates(position)),
        };
        value.filter(|value| value.is_finite())
    }

    /// Value at a patch's (u,v), as `camera` sees it.
    pub fn at(&self, surface: &LimitSurface, camera: &Camera, patch: usize, uv: [f64; 2]) -> Option<DVec2> {
        let (jet, curvature) = match self.method.reads_curvature() {
            true => {
                let jet = surface.evaluate_second(patch, uv);
                (jet.first, jet.curvature())
            }
            false => (surface.evaluate(patch, uv), None),
        };
        let sight = camera.sight(jet.position);
        self.value(&Point { position: jet.position, normal: jet.normal, sight, curvature })
    }
}
