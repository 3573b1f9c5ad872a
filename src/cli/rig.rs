//! Where the camera and the light stand: flags, the light rig that they name, and what is fitted where nothing is said.

use super::Failure;
use super::args::vector;
use super::files::Files;
use super::outgoing;
use crate::field::{Camera, Light, Scout, sample_rig};
use crate::rig::{
    Attachment, CameraRig, FittedRig, LightRig, PatternRig, Preset, ProjectionName, Rig, RigError, RigFileError,
    RigFormat, checked_extents, checked_fov, checked_positive,
};
use clap::{Args, ValueEnum};
use glam::DVec3;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct RigArgs {
    /// Light rig: camera, field, light, pattern and colours from a file (docs/RIGS.md), or one by name: tunnel, showroom, zebra,
    /// lattice, circles, highlight. Other flags win over it
    #[arg(long, value_name = "NAME|FILE")]
    rig: Option<PathBuf>,
    /// Write the whole light rig of this picture, fitted values included (.toml or .json)
    #[arg(long, value_name = "FILE")]
    save_rig: Option<PathBuf>,
    /// Eye position [default: fit]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    eye: Option<DVec3>,
    /// Point in the middle of the picture [default: middle of the surface]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// Direction that points up [default: the up axis of a USD file, else 0,0,1]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    up: Option<DVec3>,
    /// Lines of sight that meet in the eye, or parallel ones [default: perspective]
    #[arg(long, value_enum)]
    projection: Option<ProjectionFlag>,
    /// Vertical field of view of a perspective picture, in degrees [default: 26]
    #[arg(long, value_name = "DEG", value_parser = fov, allow_negative_numbers = true)]
    fov: Option<f64>,
    /// World units that the height of an orthographic picture spans [default: fit]
    #[arg(long, value_name = "H", value_parser = positive, allow_negative_numbers = true)]
    height: Option<f64>,
    /// What the light stays with when the eye moves; with the camera, its vectors count from the eye: x to the right, y up,
    /// z towards the viewer [default: object]
    #[arg(long, value_name = "object|camera")]
    light_attached: Option<Attachment>,
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
    /// Width (across the lines) and length of the light plane; on the sphere, degrees of longitude and latitude [default:
    /// infinite]
    #[arg(long, value_name = "W,L", value_parser = extents)]
    light_size: Option<[f64; 2]>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ProjectionFlag {
    Perspective,
    Orthographic,
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    checked_positive(text.parse().unwrap_or(f64::NAN))
}

fn fov(text: &str) -> Result<f64, String> {
    checked_fov(text.parse().unwrap_or(f64::NAN))
}

fn extents(text: &str) -> Result<[f64; 2], String> {
    let sides = text.split_once(',').and_then(|(w, l)| Some([w.parse().ok()?, l.parse().ok()?]));
    checked_extents(sides.unwrap_or([f64::NAN; 2]))
}

impl RigArgs {
    /// Refuses flags that contradict each other, and files that cannot be written.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let bad = |what: &str| Err(Failure::Bad(what.to_owned()));
        match (self.projection, self.fov, self.height) {
            (Some(ProjectionFlag::Orthographic), Some(_), _) => {
                return bad(
                    "--fov does not apply to --projection orthographic; give --height, in world units, instead",
                );
            }
            (None, _, Some(_)) if self.rig.is_none() => {
                return bad("--height applies to --projection orthographic only; add that, or give --fov instead");
            }
            (Some(ProjectionFlag::Perspective), _, Some(_)) => {
                return bad("--height applies to --projection orthographic only; add that, or give --fov instead");
            }
            _ => {}
        }
        match &self.save_rig {
            Some(path) if format_to_write(path).is_none() => {
                Err(outgoing::unknown_ending(path, "a light rig", ".toml or .json"))
            }
            Some(path) => outgoing::check(path, "--save-rig"),
            None => Ok(()),
        }
    }

    /// The files that this run reads.
    pub(super) fn files(&self, mesh: Option<&Path>, rig: &Rig) -> Files {
        Files::read(mesh, self.file(), rig)
    }

    /// Refuses to write the rig over another file of this run.
    pub(super) fn check_apart(&self, files: &mut Files) -> Result<(), Failure> {
        self.save_rig.iter().try_for_each(|path| files.write(path, "--save-rig", "the light rig"))
    }

    /// What is said of the picture: these flags and `more`, and where they say nothing the rig that they name.
    pub(super) fn rig(&self, more: Rig) -> Result<Rig, Failure> {
        let projection = self.projection.map(|projection| match projection {
            ProjectionFlag::Perspective => ProjectionName::Perspective,
            ProjectionFlag::Orthographic => ProjectionName::Orthographic,
        });
        let flags = Rig {
            camera: CameraRig {
                eye: self.eye,
                target: self.target,
                up: self.up,
                projection,
                fov: self.fov,
                height: self.height,
                ..more.camera
            },
            light: LightRig {
                attached: self.light_attached,
                center: self.light_center,
                normal: self.light_normal,
                lines: self.light_lines,
                spacing: self.light_spacing,
                size: self.light_size,
            },
            ..more
        };
        let base = match &self.rig {
            None => Rig::default(),
            Some(path) if RigFormat::of(path).is_some() => {
                Rig::read(path).map_err(|error| Failure::Bad(error.to_string()))?
            }
            Some(path) if path.is_dir() => {
                let what = "it is a folder; name a file in it that ends in .toml or .json";
                return Err(Failure::Bad(format!("--rig {}: {what}", path.display())));
            }
            Some(name) => {
                let name = name.display().to_string();
                let preset: Result<Preset, String> = name.parse();
                let preset = preset.map_err(|what| Failure::Bad(format!("--rig {name}: {what}")))?;
                Rig { preset: Some(preset), ..Rig::default() }
            }
        };
        let rig = flags.over(base).with_preset();
        rig.check().map_err(|error| self.bad(error))?;
        Ok(rig)
    }

    /// A rig fitted to a surface; `is_sample`: to the built-in one, which has a camera and a light of its own.
    pub(super) fn fit(&self, rig: &Rig, scout: &Scout, is_sample: bool) -> Result<FittedRig, Failure> {
        let habit: Option<(DVec3, Light)> = is_sample.then(sample_rig);
        let fitted = rig.fit(scout, habit).map_err(|error| self.bad(error))?;
        self.check_camera(&fitted.camera)?;
        Ok(fitted)
    }

    /// A rig's fault in words of the file that has it, or else of the command line.
    fn bad(&self, error: RigError) -> Failure {
        let given = match error.key {
            "camera.up" => self.up.is_some(),
            "camera.fov" => self.fov.is_some() || self.projection.is_some(),
            "camera.height" => self.height.is_some() || self.projection.is_some(),
            "light.normal" => self.light_normal.is_some(),
            "light.lines" => self.light_lines.is_some(),
            _ => false,
        };
        if let Some(path) = self.file().filter(|_| !given) {
            return Failure::Bad(RigFileError::of(path, &error).to_string());
        }
        let flag = error.key.trim_start_matches("camera.").replace('.', "-");
        Failure::Bad(format!("--{flag} {}", error.problem))
    }

    /// The file that the rig is read from.
    fn file(&self) -> Option<&Path> {
        self.rig.as_deref().filter(|path| RigFormat::of(path).is_some())
    }

    /// Refuses a fitted camera without a picture; the file is named where it alone says what the camera is.
    fn check_camera(&self, camera: &Camera) -> Result<(), Failure> {
        let flags = self.eye.or(self.target).or(self.up).is_some() || self.fov.or(self.height).is_some();
        camera.check(1).map_err(|what| match self.file().filter(|_| !flags) {
            Some(path) => Failure::Bad(format!("{}: {what}", path.display())),
            None => Failure::Bad(what),
        })
    }

    /// Writes the whole rig if a file for it is named.
    pub(super) fn save(&self, rig: &FittedRig, pattern: PatternRig) -> Result<(), Failure> {
        let Some((path, format)) = self.save_rig.as_ref().and_then(|path| Some((path, format_to_write(path)?))) else {
            return Ok(());
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let text = rig.to_rig(pattern).write(format, folder);
        let text = text.map_err(|error| Failure::Bad(format!("{}: cannot write it: {error}", path.display())))?;
        super::write_out(Some(path), text.as_bytes())
    }
}

/// How a rig is written: as its file's name says, on standard output as TOML.
fn format_to_write(path: &Path) -> Option<RigFormat> {
    if outgoing::is_stdout(path) { Some(RigFormat::Toml) } else { RigFormat::of(path) }
}

/// Whether the camera of a rig has parallel lines of sight.
pub(super) fn is_orthographic(rig: &Rig) -> bool {
    rig.camera.projection == Some(ProjectionName::Orthographic)
}

/// A camera turned about its up axis through the target, counter-clockwise seen from above, radians.
pub(super) fn orbited(camera: Camera, angle: f64) -> Camera {
    let turn = glam::DQuat::from_axis_angle(camera.up.normalize(), angle);
    Camera { eye: camera.target + turn * (camera.eye - camera.target), ..camera }
}
