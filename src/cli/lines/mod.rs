//! `lines`: the curves.

mod extent;
mod family;

use super::account::Account;
use super::args::size;
use super::field::FieldArgs;
use super::outgoing::STDOUT;
use super::rig::{RigArgs, is_orthographic, positive};
use super::scene::{SceneArgs, say_orientation, say_without_area};
use super::settings::{CommandLine, mesh_digest, method_name};
use super::{Failure, outgoing, progress, refined};
use crate::curves::{self, Curve};
use crate::field::{Camera, Projection, Scout};
use crate::line::count;
use crate::output::{Lines, LinesFormat, MM_PER_PIXEL};
use crate::rig::{CameraRig, Rig};
use clap::{Args, ValueEnum};
use family::FamilyArgs;
use std::path::{Path, PathBuf};

/// Chord error where none is asked for, in diagonals of the surface's box.
const TOLERANCE: f64 = 1e-4;
/// Least chord error, in diagonals: below, positions are rounding.
const LEAST_TOLERANCE: f64 = 1e-12;

#[derive(Debug, Args)]
pub(super) struct LinesArgs {
    /// Control mesh (.obj, .usd, .usda, .usdc or .usdz, also with .gz), or - for standard input
    mesh: Option<PathBuf>,
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// File to write: .svg (the picture), .dxf, .obj, .usda or .json (in space) [default: JSON on standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Format of the file, whatever its name; needed for another one than JSON on standard output
    #[arg(long, value_enum, value_name = "FORMAT")]
    output_format: Option<Extension>,
    /// Width and height of the picture in pixels [default: 1024x1024]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    #[command(flatten)]
    field: FieldArgs,
    #[command(flatten)]
    family: FamilyArgs,
    /// How far chords may be from the curve, world units [default: 1e-4 of the diagonal]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Keep what the surface hides in an .svg too
    #[arg(long, conflicts_with = "visible")]
    hidden: bool,
    /// Keep only what the camera sees in files of curves in space too
    #[arg(long)]
    visible: bool,
    #[command(flatten)]
    paper: PaperArgs,
    #[command(flatten)]
    rig: RigArgs,
    /// Print how long each step took
    #[arg(long)]
    timings: bool,
}

#[derive(Debug, Args)]
struct PaperArgs {
    /// Unit of an .svg [default: px; mm with --mm-per-unit]
    #[arg(long, value_enum)]
    unit: Option<Unit>,
    /// Millimetres that a world unit takes: on paper in an .svg of an orthographic view, in space in an .usda (where it
    /// is 1000 otherwise)
    #[arg(long, value_name = "MM", value_parser = positive, allow_negative_numbers = true)]
    mm_per_unit: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Unit {
    /// Pixels
    Px,
    /// Millimetres
    Mm,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Extension {
    Json,
    Svg,
    Dxf,
    Obj,
    Usda,
}

impl Extension {
    fn of(path: &Path) -> Result<Extension, Failure> {
        let names = [
            ("json", Extension::Json),
            ("svg", Extension::Svg),
            ("dxf", Extension::Dxf),
            ("obj", Extension::Obj),
            ("usda", Extension::Usda),
        ];
        let is = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
        let found = names.into_iter().find(|(name, _)| is(name)).map(|(_, extension)| extension);
        found.ok_or_else(|| outgoing::unknown_ending(path, "a file of curves", ".svg, .dxf, .obj, .usda or .json"))
    }
}

impl PaperArgs {
    /// Refuses flags that contradict one another or the file.
    fn check(&self, extension: Extension, orthographic: bool) -> Result<(), Failure> {
        let bad = |what: &str| Err(Failure::Bad(what.to_owned()));
        match (extension, self.unit, self.mm_per_unit) {
            (Extension::Svg, Some(Unit::Px), Some(_)) => {
                bad("--mm-per-unit makes an .svg in millimetres; leave --unit px out, or --mm-per-unit")
            }
            (Extension::Svg, _, Some(_)) if !orthographic => bad(
                "--mm-per-unit is a scale, which a perspective .svg has not; add --projection orthographic, or give --unit mm",
            ),
            (Extension::Json | Extension::Dxf | Extension::Obj, _, Some(_)) => {
                bad("--mm-per-unit is for .svg and .usda; coordinates of other files are world units")
            }
            (Extension::Svg, ..) | (_, None, _) => Ok(()),
            (_, Some(_), _) => bad("--unit is for .svg; coordinates of other files are world units"),
        }
    }

    fn format(&self, extension: Extension, camera: &Camera) -> LinesFormat {
        match extension {
            Extension::Json => LinesFormat::Json,
            Extension::Dxf => LinesFormat::Dxf,
            Extension::Obj => LinesFormat::Obj,
            Extension::Usda => LinesFormat::Usda { meters_per_unit: self.mm_per_unit.unwrap_or(1000.0) / 1000.0 },
            Extension::Svg => LinesFormat::Svg {
                mm_per_pixel: match (self.mm_per_unit, camera.projection) {
                    (Some(mm), Projection::Orthographic { height }) => Some(mm * height / f64::from(camera.size[1])),
                    _ => (self.unit == Some(Unit::Mm)).then_some(MM_PER_PIXEL),
                },
            },
        }
    }
}

pub(super) fn run(args: &LinesArgs) -> Result<(), Failure> {
    let mut account = Account::default();
    let extension = args.extension()?;
    args.rig.check()?;
    let rig = args.rig()?;
    args.paper.check(extension, is_orthographic(&rig))?;
    args.family.check(&rig.method())?;
    if let Some(path) = &args.output {
        outgoing::check(path, "-o")?;
    }
    let mut files = args.rig.files(args.mesh.as_deref(), &rig);
    args.output.iter().try_for_each(|path| files.write(path, "-o", "the curves"))?;
    args.rig.check_apart(&mut files)?;
    let bar = progress("tracing".to_owned());
    let mesh = account.time("read", || args.scene.load_quads(args.mesh.as_deref(), "lines"))?;
    let surface = account.time("patches and classes", || refined(&mesh, &bar))?;
    let scout = account.time("fit", || Scout::new(&surface)).ok_or_else(|| {
        let what = "no face has a limit surface (holes, or boundary rule none); no line to trace";
        Failure::Bad(format!("{}: {what}", mesh.name))
    })?;
    say_orientation(args.mesh.as_deref(), &mesh);
    say_without_area(&mesh, &scout, "its lines say nothing");
    // A surface at one point has no diagonal.
    let tolerance = args.tolerance.unwrap_or(TOLERANCE * surface.diagonal()).max(f64::MIN_POSITIVE);
    let least = LEAST_TOLERANCE * surface.diagonal();
    if tolerance < least {
        return Err(Failure::Bad(format!(
            "--tolerance {tolerance:e} is below rounding here; give {least:.0e} or more"
        )));
    }
    let mut fitted = args.rig.fit(&rig.or_up(mesh.up), &scout, args.mesh.is_none())?;
    let camera = fitted.camera;
    let mut field = fitted.field();
    let family = account.time("lights", || args.family.family(&scout, &camera, &mut field));
    fitted.light.spacing = field.light.spacing;
    let mut command = CommandLine::new("lines", args.mesh.as_deref());
    args.scene.record(&mut command);
    command.camera(&camera);
    command.field(&fitted);
    family.record(&mut command);
    args.record(tolerance, &mut command);
    let made_by = command.finish(mesh_digest(&mesh), &field.method);

    let mut curves = account.time("trace", || match surface.diagonal() > 0.0 {
        false => Vec::new(),
        true => curves::trace(&surface, &field, &camera, &family.values, tolerance),
    });
    if field.method.is_bounded() && field.light.half[1].is_finite() {
        curves = account.time("extents", || extent::within(&surface, &field, &camera, curves));
    }
    if args.visible || (extension == Extension::Svg && !args.hidden) {
        curves = account.time("hidden lines", || curves::visible(&surface, &camera, &curves));
    }
    let name = method_name(&field.method);
    let parts = mesh.ptex_parts();
    let lines = Lines { curves: &curves, field: &name, camera: &camera, made_by: &made_by, parts: Some(&parts) };
    let format = args.paper.format(extension, &camera);
    account.time("write", || -> Result<(), Failure> {
        let path = args.output.as_deref().unwrap_or(Path::new(STDOUT));
        outgoing::write(path, |mut out| lines.write(format, &mut out))?;
        outgoing::note(path, &format!("{} curves", curves.len()));
        Ok(())
    })?;
    args.rig.save(&fitted, rig.pattern)?;
    bar.finish_and_clear();
    family.say();
    say(&curves, tolerance);
    if args.timings {
        account.say_steps();
    }
    Ok(())
}

/// What there is, on standard error.
fn say(curves: &[Curve], tolerance: f64) {
    let points: usize = curves.iter().map(|curve| curve.points.len()).sum();
    let closed = curves.iter().filter(|curve| curve.closed).count();
    let mut lights: Vec<i32> = curves.iter().map(|curve| curve.light).collect();
    lights.sort_unstable();
    lights.dedup();
    // The sum of nothing is -0, which would be written so.
    let length = curves.iter().map(Curve::length).sum::<f64>() + 0.0;
    tell!(
        "lines: {} of {}, {closed} of them closed, {}, {length:.6} world units long; chords within {tolerance:.1e}",
        count(curves.len(), "curve"),
        count(lights.len(), "light"),
        count(points, "point")
    );
}

impl LinesArgs {
    /// What is written: as the flag says, or else the name of the file.
    fn extension(&self) -> Result<Extension, Failure> {
        match (self.output_format, &self.output) {
            (Some(format), _) => Ok(format),
            (None, Some(path)) if !outgoing::is_stdout(path) => Extension::of(path),
            (None, _) => Ok(Extension::Json),
        }
    }

    /// What is said of field, camera and light.
    fn rig(&self) -> Result<Rig, Failure> {
        let camera = CameraRig { size: self.size, ..CameraRig::default() };
        self.rig.rig(Rig { field: self.field.method.clone(), camera, ..Rig::default() })
    }

    /// The flags of this command alone.
    fn record(&self, tolerance: f64, command: &mut CommandLine) {
        command.flag("tolerance", tolerance);
        if self.hidden {
            command.switch("hidden");
        }
        if self.visible {
            command.switch("visible");
        }
        if let Some(unit) = self.paper.unit {
            command.flag("unit", if unit == Unit::Mm { "mm" } else { "px" });
        }
        if let Some(mm) = self.paper.mm_per_unit {
            command.flag("mm-per-unit", mm);
        }
    }
}
