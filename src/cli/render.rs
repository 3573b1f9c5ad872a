//! `render`: the picture.

use super::args::{size, vector};
use super::{Failure, load, progress};
use crate::field::{DEFAULT_FOV, Light, Pattern, Picture, Scout};
use crate::gpu::{Gpu, MAX_ENLARGE, MAX_PROXY_LEVEL, MAX_SAMPLES, Pipeline, TableLayout, View, tables};
use crate::output::{check_writable, write_png};
use crate::stam::LimitSurface;
use clap::{Args, ValueEnum};
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Control mesh (.obj)
    mesh: Option<PathBuf>,
    /// Picture to write (.png)
    #[arg(short, long, value_name = "FILE", default_value = "view.png")]
    output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = size)]
    size: [u32; 2],
    /// What is read off the surface
    #[arg(long, value_enum, default_value = "reflection")]
    field: FieldName,
    /// Shape of the lights: stripes, lattice, circles, or a picture
    #[arg(long, value_name = "stripes|lattice|circles|FILE.png", default_value = "stripes")]
    pattern: String,
    /// Exact limit at every pixel; interpolated from the proxy's vertices; or points at exact positions
    #[arg(long, value_enum, default_value = "limit")]
    pipeline: PipelineName,
    /// Fragments a sample each way of `--pipeline points`, 1 to 8: against its gaps [default: 1]
    #[arg(long, value_name = "F", value_parser = enlargement)]
    enlarge: Option<f64>,
    /// How the tables of irregular patches are stored: auto, expanded, compact or hybrid
    #[arg(long = "tables", value_name = "LAYOUT", default_value_t)]
    layout: TableLayout,
    /// Level of the proxy tessellation: 2^LEVEL parts a face each way [default: as fine as the picture asks for]
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_PROXY_LEVEL)))]
    proxy_level: Option<u32>,
    /// Samples a pixel each way
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    samples: u32,
    /// Eye position [default: fit]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    eye: Option<DVec3>,
    /// Point in the middle of the picture [default: middle of the surface]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    target: Option<DVec3>,
    /// Direction that points up [default: 0,0,1]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    up: Option<DVec3>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG", default_value_t = DEFAULT_FOV, value_parser = fov)]
    fov: f64,
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
    #[arg(long, value_name = "D", value_parser = positive)]
    light_spacing: Option<f64>,
    /// Width (across the lines) and length of the light plane [default: infinite]
    #[arg(long, value_name = "W,L", value_parser = extents)]
    light_size: Option<[f64; 2]>,
    /// Part of the spacing that shines, 0 to 1 (of circles: their diameter)
    #[arg(long, value_name = "PART", value_parser = part)]
    light_width: Option<f64>,
    /// Print how long each step took
    #[arg(long)]
    timings: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FieldName {
    /// Point of the light plane that the surface mirrors into the eye
    Reflection,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum PipelineName {
    Limit,
    Polygon,
    /// Yasui & Kanai's own
    Points,
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite()).ok_or("give a number above 0".to_owned())
}

fn enlargement(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|x| (1.0..=MAX_ENLARGE).contains(x));
    factor.ok_or_else(|| format!("give a number from 1 to {MAX_ENLARGE}"))
}

fn fov(text: &str) -> Result<f64, String> {
    let fov = text.parse().ok().filter(|x| *x > 0.0 && *x < 180.0);
    fov.ok_or("give a field of view above 0 and below 180 degrees".to_owned())
}

fn part(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x| (0.0..=1.0).contains(x)).ok_or("give a number from 0 to 1".to_owned())
}

fn extents(text: &str) -> Result<[f64; 2], String> {
    let sides = text.split_once(',').and_then(|(w, l)| Some([positive(w).ok()?, positive(l).ok()?]));
    sides.ok_or("give two numbers above 0, W,L".to_owned())
}

/// Names and times of the steps.
#[derive(Default)]
struct Clock(Vec<(&'static str, Duration)>);

impl Clock {
    fn time<R>(&mut self, name: &'static str, step: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = step();
        self.0.push((name, start.elapsed()));
        result
    }
}

pub(super) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let mut clock = Clock::default();
    if !args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Err(Failure::Bad(format!(
            "{}: only .png is written so far; choose such a name",
            args.output.display()
        )));
    }
    check_writable(&args.output)?;
    if args.enlarge.is_some() && !matches!(args.pipeline, PipelineName::Points) {
        return Err(Failure::Bad("--enlarge is for --pipeline points; leave it out, or choose that one".to_owned()));
    }
    let pattern = pattern(args)?;
    let bar = progress("drawing".to_owned());
    let mesh = clock.time("read", || load(args.mesh.as_deref()))?;
    let surface = clock.time("patches and classes", || LimitSurface::new(&mesh)).map_err(|e| Failure::of(&mesh, e))?;
    let scout = clock.time("fit", || Scout::new(&surface)).ok_or_else(|| {
        Failure::Bad(format!(
            "{}: no face has a limit surface (holes, or boundary rule none); nothing to draw",
            mesh.name
        ))
    })?;
    let view = view(args, &scout, pattern)?;
    let gpu = clock.time("adapter", Gpu::new)?;
    let uploaded = clock.time("tables", || gpu.upload_as(&surface, args.layout))?;
    let frame = gpu.render(&uploaded, &view)?;
    clock.0.extend(&frame.timings.steps);
    clock.time("write", || write_png(&args.output, frame.size, &frame.rgba8))?;
    bar.finish_and_clear();
    if args.timings {
        eprintln!("{:<20} {}", "adapter", gpu.adapter());
        for (name, time) in &clock.0 {
            eprintln!("{name:<20} {:>8.1} ms", time.as_secs_f64() * 1e3);
        }
        for layout in TableLayout::ALL {
            let chosen = if layout == uploaded.layout() { ", chosen" } else { "" };
            eprintln!("{:<20} {:>12} bytes{chosen}", format!("tables {layout}"), tables::bytes(&surface, layout));
        }
    }
    Ok(())
}

/// Direction of sight and light that show the built-in sample best: the fender in three-quarter view, mirroring a wall of
/// tubes behind and beside the car, whose lines run over shoulder, feature line and wheel arch.
fn sample_rig() -> (DVec3, Light) {
    let [center, facing, lines] = [[3.6, 2.7, 1.5], [-0.72, -0.63, -0.28], [0.38, -0.55, 0.60]].map(DVec3::from_array);
    (DVec3::new(-1.90, 2.10, 0.81), Light::new(center, facing, lines, 1.0))
}

fn view(args: &RenderArgs, scout: &Scout, pattern: Pattern) -> Result<View, Failure> {
    let up = args.up.unwrap_or(DVec3::Z);
    let sample = (args.mesh.is_none() && args.up.is_none()).then(sample_rig);
    let mut camera = match sample {
        Some((direction, _)) => scout.camera_from(args.size, up, direction, args.fov),
        None => {
            let default = scout.camera(args.size, up);
            scout.camera_from(args.size, up, default.eye - default.target, args.fov)
        }
    };
    if let Some(target) = args.target {
        camera.eye += target - camera.target;
        camera.target = target;
    }
    camera.eye = args.eye.unwrap_or(camera.eye);
    let mut light = sample.map_or_else(|| scout.light(camera.eye, up), |(_, light)| light);

    let given = [args.light_center, args.light_normal, args.light_lines];
    if given.iter().any(Option::is_some) {
        let fitted = [light.center, light.normal(), light.axes[1]];
        let [center, normal, lines] = std::array::from_fn(|i| given[i].unwrap_or(fitted[i]));
        check_light(args, normal, lines)?;
        light = Light::new(center, normal, lines, light.spacing);
    }
    light.spacing = args.light_spacing.unwrap_or(light.spacing);
    if let Some(size) = args.light_size {
        light.half = size.map(|side| side / 2.0);
    }
    let mut view = View::new(camera, light);
    view.pattern = pattern;
    view.proxy_level = args.proxy_level;
    view.samples = args.samples;
    view.pipeline = match args.pipeline {
        PipelineName::Limit => Pipeline::Limit,
        PipelineName::Polygon => Pipeline::Polygon,
        PipelineName::Points => Pipeline::Points,
    };
    view.enlarge = args.enlarge.unwrap_or(view.enlarge);
    match args.field {
        FieldName::Reflection => Ok(view),
    }
}

/// Refuses directions that say nothing: `Light::new` would take any instead.
fn check_light(args: &RenderArgs, normal: DVec3, lines: DVec3) -> Result<(), Failure> {
    /// Sine of the smallest angle between lines and normal: below it, their part in the plane is mostly rounding.
    const PARALLEL: f64 = 1e-9;
    let bad = |what: &str| Err(Failure::Bad(what.to_owned()));
    let Some(normal) = normal.try_normalize() else {
        return bad("--light-normal has no direction; give one that is not 0,0,0");
    };
    match lines.try_normalize() {
        None => bad("--light-lines has no direction; give one that is not 0,0,0"),
        Some(lines) if args.light_lines.is_some() && lines.cross(normal).length() < PARALLEL => {
            bad("--light-lines is parallel to the normal of the light plane; give a direction with a part in the plane")
        }
        Some(_) => Ok(()),
    }
}

fn pattern(args: &RenderArgs) -> Result<Pattern, Failure> {
    let width = |default: f64| args.light_width.unwrap_or(default);
    match args.pattern.as_str() {
        "stripes" => Ok(Pattern::Stripes { width: width(0.42) }),
        "lattice" => Ok(Pattern::Lattice { width: width(0.2) }),
        "circles" => Ok(Pattern::Circles { radius: width(0.6) / 2.0 }),
        path => picture(Path::new(path)),
    }
}

fn picture(path: &Path) -> Result<Pattern, Failure> {
    let bad = |what: String| {
        Failure::Bad(format!("{}: {what}; give stripes, lattice, circles or a PNG file", path.display()))
    };
    let reader = image::ImageReader::open(path).map_err(|e| bad(format!("cannot read the pattern ({e})")))?;
    let reader = reader.with_guessed_format().map_err(|e| bad(format!("cannot read the pattern ({e})")))?;
    let picture = reader.decode().map_err(|e| bad(format!("not a picture we read ({e})")))?.to_rgba8();
    Ok(Pattern::Picture(Picture { size: [picture.width(), picture.height()], rgba8: picture.into_raw() }))
}
