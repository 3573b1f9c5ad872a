//! Where the camera and the light stand: flags, and what is fitted where none is given.

use super::Failure;
use super::args::vector;
use super::field::FieldArgs;
use crate::field::{Camera, DEFAULT_FOV, Field, Light, Method, Projection, Scout, sample_rig};
use crate::gpu::MAX_FOV;
use clap::{Args, ValueEnum};
use glam::DVec3;

#[derive(Debug, Args)]
pub(super) struct RigArgs {
    /// Eye position [default: fit]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    eye: Option<DVec3>,
    /// Point in the middle of the picture [default: middle of the surface]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// Direction that points up [default: 0,0,1]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    up: Option<DVec3>,
    /// Lines of sight that meet in the eye, or parallel ones
    #[arg(long, value_enum, default_value = "perspective")]
    projection: ProjectionName,
    /// Vertical field of view of a perspective picture, in degrees [default: 26]
    #[arg(long, value_name = "DEG", value_parser = fov, allow_negative_numbers = true)]
    fov: Option<f64>,
    /// World units that the height of an orthographic picture spans [default: fit]
    #[arg(long, value_name = "H", value_parser = positive, allow_negative_numbers = true)]
    height: Option<f64>,
    /// A point of the light plane, where its coordinates are 0 [default: fit]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    light_center: Option<DVec3>,
    /// Normal of the light plane [default: fit]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    light_normal: Option<DVec3>,
    /// Direction of the light lines; its part in the plane counts [default: fit]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    light_lines: Option<DVec3>,
    /// Distance from one light line to the next [default: fit]
    #[arg(long, value_name = "D", value_parser = positive, allow_negative_numbers = true)]
    light_spacing: Option<f64>,
    /// Width (across the lines) and length of the light plane [default: infinite]
    #[arg(long, value_name = "W,L", value_parser = extents)]
    light_size: Option<[f64; 2]>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ProjectionName {
    Perspective,
    Orthographic,
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite()).ok_or("give a number above 0".to_owned())
}

fn fov(text: &str) -> Result<f64, String> {
    let fov = text.parse().ok().filter(|x| *x > 0.0 && *x <= MAX_FOV);
    fov.ok_or_else(|| format!("give a field of view above 0 and at most {MAX_FOV} degrees"))
}

fn extents(text: &str) -> Result<[f64; 2], String> {
    let sides = text.split_once(',').and_then(|(w, l)| Some([positive(w).ok()?, positive(l).ok()?]));
    sides.ok_or("give two numbers above 0, W,L".to_owned())
}

impl RigArgs {
    /// Refuses flags that contradict each other.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let bad = |what: &str| Err(Failure::Bad(what.to_owned()));
        match (self.projection, self.fov, self.height) {
            (ProjectionName::Orthographic, Some(_), _) => {
                bad("--fov does not apply to --projection orthographic; give --height, in world units, instead")
            }
            (ProjectionName::Perspective, _, Some(_)) => {
                bad("--height applies to --projection orthographic only; add that, or give --fov instead")
            }
            _ => Ok(()),
        }
    }

    /// Whether lines of sight are parallel.
    pub(super) fn is_orthographic(&self) -> bool {
        self.projection == ProjectionName::Orthographic
    }

    /// Normal and line direction that say which light this is: those given, and its own.
    pub(super) fn directions(&self, light: &Light) -> [DVec3; 2] {
        [self.light_normal.unwrap_or(light.normal()), self.light_lines.unwrap_or(light.axes[1])]
    }

    /// Camera and field, fitted to a surface where flags do not say; `is_sample`: to the built-in one.
    pub(super) fn set_up(
        &self,
        scout: &Scout,
        size: [u32; 2],
        is_sample: bool,
        field: &FieldArgs,
    ) -> Result<(Camera, Field), Failure> {
        let sample = (is_sample && self.up.is_none()).then(sample_rig);
        let camera = self.camera(scout, size, sample.map(|(direction, _)| direction));
        let light = sample.map(|(_, light)| light).filter(|_| field.method == Method::Reflection);
        let mut field = field.field(scout, &camera, light);
        let light = &mut field.light;

        let given = [self.light_center, self.light_normal, self.light_lines];
        if given.iter().any(Option::is_some) {
            let fitted = [light.center, light.normal(), light.axes[1]];
            let [center, normal, lines] = std::array::from_fn(|i| given[i].unwrap_or(fitted[i]));
            self.check_light(normal, lines)?;
            *light = Light { half: light.half, ..Light::new(center, normal, lines, light.spacing) };
        }
        light.spacing = self.light_spacing.unwrap_or(light.spacing);
        if let Some(size) = self.light_size {
            light.half = size.map(|side| side / 2.0);
        }
        Ok((camera, field))
    }

    /// The camera, which looks against `direction` where flags do not say, by default in three-quarter view.
    fn camera(&self, scout: &Scout, size: [u32; 2], direction: Option<DVec3>) -> Camera {
        let up = self.up.unwrap_or(DVec3::Z);
        let direction = direction.unwrap_or_else(|| {
            let default = scout.camera(size, up);
            default.eye - default.target
        });
        let orthographic = self.projection == ProjectionName::Orthographic;
        let mut camera = match orthographic {
            true => scout.orthographic_from(size, up, direction),
            false => scout.camera_from(size, up, direction, self.fov.unwrap_or(DEFAULT_FOV)),
        };
        if let Some(target) = self.target {
            camera.eye += target - camera.target;
            camera.target = target;
        }
        camera.eye = self.eye.unwrap_or(camera.eye);
        if orthographic {
            camera.projection =
                Projection::Orthographic { height: self.height.unwrap_or_else(|| scout.height_for(&camera)) };
        }
        camera
    }

    /// Refuses directions that say nothing: `Light::new` would take any instead.
    fn check_light(&self, normal: DVec3, lines: DVec3) -> Result<(), Failure> {
        /// Sine of the smallest angle between lines and normal: below it, their part in the plane is mostly rounding.
        const PARALLEL: f64 = 1e-9;
        let bad = |what: &str| Err(Failure::Bad(what.to_owned()));
        let Some(normal) = normal.try_normalize() else {
            return bad("--light-normal has no direction; give one that is not 0,0,0");
        };
        match lines.try_normalize() {
            None => bad("--light-lines has no direction; give one that is not 0,0,0"),
            Some(lines) if self.light_lines.is_some() && lines.cross(normal).length() < PARALLEL => bad(
                "--light-lines is parallel to the normal of the light plane; give a direction with a part in the plane",
            ),
            Some(_) => Ok(()),
        }
    }
}
