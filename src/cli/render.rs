//! `render`: the picture.

use super::args::size;
use super::rig::RigArgs;
use super::settings::made_by;
use super::{Failure, load, progress};
use crate::field::{Pattern, Picture, Scout};
use crate::gpu::{Gpu, MAX_ENLARGE, MAX_PROXY_LEVEL, MAX_SAMPLES, Pipeline, TableLayout, Timings, View, tables};
use crate::output::{Layers, check_writable, write_exr, write_png};
use crate::stam::LimitSurface;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Control mesh (.obj)
    pub(super) mesh: Option<PathBuf>,
    /// Picture to write: .png, or .exr with linear colour, position, normal, ptex parameters, field and residual
    #[arg(short, long, value_name = "FILE", default_value = "view.png")]
    pub(super) output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = size)]
    pub(super) size: [u32; 2],
    /// What is read off the surface
    #[arg(long, value_enum, default_value = "reflection")]
    pub(super) field: FieldName,
    /// Shape of the lights: stripes, lattice, circles, or a picture
    #[arg(long, value_name = "stripes|lattice|circles|FILE.png", default_value = "stripes")]
    pub(super) pattern: String,
    /// How position and normal come to a pixel
    #[arg(long, value_enum, default_value = "exact")]
    pub(super) pipeline: PipelineName,
    /// Fragments a sample each way of `--pipeline points`, 1 to 8: against its gaps [default: 1]
    #[arg(long, value_name = "F", value_parser = enlargement)]
    pub(super) enlarge: Option<f64>,
    /// How the tables of irregular patches are stored: auto, expanded, compact or hybrid
    #[arg(long = "tables", value_name = "LAYOUT", default_value_t)]
    pub(super) layout: TableLayout,
    /// Level of the proxy tessellation: 2^LEVEL parts a face each way [default: as fine as the picture asks for]
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_PROXY_LEVEL)))]
    pub(super) proxy_level: Option<u32>,
    /// Samples a pixel each way
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(super) samples: u32,
    #[command(flatten)]
    rig: RigArgs,
    /// Part of the spacing that shines, 0 to 1 (of circles: their diameter)
    #[arg(long, value_name = "PART", value_parser = part)]
    light_width: Option<f64>,
    /// Print how long each step took
    #[arg(long)]
    timings: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum FieldName {
    /// Point of the light plane that the surface mirrors into the eye
    Reflection,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum PipelineName {
    /// The limit surface where each pixel's ray meets it
    Exact,
    /// The limit surface at the parameters of a rasterised proxy
    Limit,
    /// Interpolated from the proxy's vertices
    Polygon,
    /// Yasui & Kanai's own
    Points,
}

fn enlargement(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|x| (1.0..=MAX_ENLARGE).contains(x));
    factor.ok_or_else(|| format!("give a number from 1 to {MAX_ENLARGE}"))
}

fn part(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x| (0.0..=1.0).contains(x)).ok_or("give a number from 0 to 1".to_owned())
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
}

impl Format {
    fn of(path: &Path) -> Result<Format, Failure> {
        let is = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
        match () {
            () if is("png") => Ok(Format::Png),
            () if is("exr") => Ok(Format::Exr),
            () => Err(Failure::Bad(format!(
                "{}: not a picture that we write; choose a name that ends in .png or .exr",
                path.display()
            ))),
        }
    }
}

/// Names and times of the steps.
#[derive(Default)]
struct Clock(Vec<(&'static str, Duration)>);

impl Clock {
    fn time<R>(&mut self, name: &'static str, step: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = step();
        self.count(name, start.elapsed());
        result
    }

    fn count(&mut self, name: &'static str, time: Duration) {
        match self.0.iter_mut().find(|(known, _)| *known == name) {
            Some((_, total)) => *total += time,
            None => self.0.push((name, time)),
        }
    }

    fn add(&mut self, timings: &Timings) {
        timings.steps.iter().for_each(|&(name, time)| self.count(name, time));
    }
}

pub(super) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let mut clock = Clock::default();
    let format = Format::of(&args.output)?;
    args.rig.check()?;
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
    let made_by = made_by(args, &mesh, &view);
    match format {
        Format::Png => {
            let frame = gpu.render(&uploaded, &view)?;
            clock.add(&frame.timings);
            clock.time("write", || write_png(&args.output, frame.size, &frame.rgba8, &made_by))?;
        }
        Format::Exr => {
            let (colour, seen) = (gpu.render_linear(&uploaded, &view)?, gpu.inspect(&uploaded, &view)?);
            clock.add(&colour.timings);
            clock.add(&seen.timings);
            let (camera, colour, seen, surface) = (&view.camera, &colour, &seen, &surface);
            let layers = Layers { camera, colour, seen, surface, made_by: &made_by };
            clock.time("write", || write_exr(&args.output, &layers))?;
        }
    }
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

fn view(args: &RenderArgs, scout: &Scout, pattern: Pattern) -> Result<View, Failure> {
    let (camera, light) = args.rig.set_up(scout, args.size, args.mesh.is_none())?;
    let mut view = View::new(camera, light);
    view.pattern = pattern;
    view.proxy_level = args.proxy_level;
    view.samples = args.samples;
    view.pipeline = match args.pipeline {
        PipelineName::Exact => Pipeline::Exact,
        PipelineName::Limit => Pipeline::Limit,
        PipelineName::Polygon => Pipeline::Polygon,
        PipelineName::Points => Pipeline::Points,
    };
    view.enlarge = args.enlarge.unwrap_or(view.enlarge);
    match args.field {
        FieldName::Reflection => Ok(view),
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
