//! `render`: the picture.

use super::account::Account;
use super::args::size;
use super::compare::Pair;
use super::field::{ColourArgs, FieldArgs, PatternArgs};
use super::frames::{Found, FramesArgs};
use super::patches::PatchesArgs;
use super::rig::RigArgs;
use super::scene::{AnimationArgs, Source, say_notes, say_orientation, say_without_area};
use super::series::Series;
use super::settings::{MeshAt, made_by, mesh_digest};
use super::{Failure, Steps, outgoing, percent, progress, refined};
use crate::field::{CurvatureKind, Method, Pattern, PlaneCurve, Scout};
use crate::gpu::{
    Gpu, MAX_ENLARGE, MAX_PROXY_LEVEL, MAX_SAMPLES, Pipeline, Stage, TableLayout, Tables, View, Watched, tables,
};
use crate::mesh::SubdivMesh;
use crate::output::{Heat, Layers, Scale, draw_legend, encode_png, heat, read_exr_made_by, read_png_made_by};
use crate::rig::{CameraRig, FittedRig, PatternRig, Rig};
use crate::stam::{LimitSurface, MoveError, MovingSurface};
use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Control mesh (.obj, .usd, .usda, .usdc or .usdz, also with .gz), or - for standard input
    pub(super) mesh: Option<PathBuf>,
    #[command(flatten)]
    pub(super) scene: AnimationArgs,
    /// Picture to write: .png, or .exr with linear colour, position, normal, ptex parameters, field and residual
    #[arg(short, long, value_name = "FILE", default_value = "view.png")]
    pub(super) output: PathBuf,
    /// Format of the picture, whatever its name; needed for an EXR on standard output
    #[arg(long, value_enum, value_name = "FORMAT")]
    output_format: Option<Format>,
    /// Width and height in pixels [default: 1024x1024]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    #[command(flatten)]
    field: FieldArgs,
    #[command(flatten)]
    pattern: PatternArgs,
    #[command(flatten)]
    colours: ColourArgs,
    /// How position and normal come to a pixel
    #[arg(long, value_enum, default_value = "exact")]
    pub(super) pipeline: PipelineName,
    /// Fragments a sample each way of `--pipeline points`, 1 to 8: against its gaps [default: 1]
    #[arg(long, value_name = "F", value_parser = enlargement)]
    pub(super) enlarge: Option<f64>,
    /// Kind of the passes that evaluate and shade: the picture does not depend on it
    #[arg(long, value_enum, default_value = "auto")]
    stage: StageName,
    #[command(flatten)]
    pub(super) patches: PatchesArgs,
    /// How the tables of irregular patches are stored: auto, expanded, compact or hybrid
    #[arg(long = "tables", value_name = "LAYOUT", default_value_t)]
    pub(super) layout: TableLayout,
    /// Level of the proxy tessellation: 2^LEVEL parts a face each way [default: as fine as the picture asks for, a patch at a
    /// time in the exact pipeline, whose picture does not depend on it]
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_PROXY_LEVEL)))]
    pub(super) proxy_level: Option<u32>,
    /// Samples a pixel each way
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(super) samples: u32,
    #[command(flatten)]
    rig: RigArgs,
    #[command(flatten)]
    frames: FramesArgs,
    /// Colour how exact each pixel is instead: its residual, or its Newton steps (.png, one sample a pixel)
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(super) show: Option<ShowName>,
    /// Write certificates, summed up, and timings
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print how long each step took
    #[arg(long)]
    timings: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum StageName {
    /// Fragment on software adapters, else what took less time over the first tile
    Auto,
    Fragment,
    Compute,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum ShowName {
    /// Distance of each pixel's point from its ray, from 1e-6 pixels (dark blue) to 1 (yellow)
    Residual,
    /// Newton steps, from none (dark blue: solved on the host) to 6 (yellow)
    Steps,
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

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Png,
    Exr,
}

impl Format {
    fn of(path: &Path) -> Result<Format, Failure> {
        let is = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
        match () {
            () if is("png") => Ok(Format::Png),
            () if is("exr") => Ok(Format::Exr),
            () => Err(outgoing::unknown_ending(path, "a picture", ".png or .exr")),
        }
    }

    /// What a file says about how it was made.
    pub(super) fn made_by(self, path: &Path) -> std::io::Result<Option<String>> {
        let file = BufReader::new(File::open(path)?);
        match self {
            Format::Png => read_png_made_by(file),
            Format::Exr => read_exr_made_by(file),
        }
    }
}

pub(super) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let mut account = Account::default();
    let samples = if args.show.is_some() { 1 } else { args.samples };
    let format = args.format()?;
    args.rig.check()?;
    let numbers = args.scene.numbers();
    args.frames.check(numbers.is_some())?;
    args.patches.check()?;
    if args.enlarge.is_some() && !matches!(args.pipeline, PipelineName::Points) {
        return Err(Failure::Bad("--enlarge is for --pipeline points; leave it out, or choose that one".to_owned()));
    }
    if args.show.is_some() && format == Format::Exr {
        return Err(Failure::Bad("--show colours a .png; an .exr has the residual as a channel anyway".to_owned()));
    }
    if args.patches.compare && (args.show.is_some() || format == Format::Exr) {
        let what = if args.show.is_some() { "--show" } else { "an .exr" };
        return Err(Failure::Bad(format!("--compare draws a .png of its own kind; it does not go with {what}")));
    }
    let numbers_given = numbers.is_some();
    let paths = args.frames.paths(&args.output, numbers)?;
    outgoing::check(&paths[0], "-o")?;
    // From here on no other run draws these frames.
    let _series =
        args.frames.pattern(&args.output, numbers_given).map(|name| Series::begin(&args.output, &name)).transpose()?;
    args.json.iter().try_for_each(|path| outgoing::check(path, "--json"))?;
    let rig = args.rig()?;
    args.pattern.check(&rig)?;
    let mut files = args.rig.files(args.mesh.as_deref(), &rig);
    paths.iter().try_for_each(|path| files.write(path, "-o", "the picture"))?;
    args.json.iter().try_for_each(|path| files.write(path, "--json", "the certificates"))?;
    args.rig.check_apart(&mut files)?;
    let pattern = rig.pattern.read(&rig.method()).map_err(Failure::Bad)?;
    let bar = progress("drawing".to_owned());
    let source = args.scene.source(args.mesh.as_deref())?;
    let times = args.scene.times();
    let mut body = account.time("read", || source.at(times[0])).map_err(Failure::Bad).and_then(|mesh| {
        say_notes(args.mesh.as_deref(), &mesh);
        say_orientation(args.mesh.as_deref(), &mesh);
        account.time("patches and classes", || Body::new(mesh, times.len() > 1, &bar))
    })?;
    let scout = account.time("fit", || Scout::new(body.surface())).ok_or_else(|| {
        Failure::Bad(format!(
            "{}: no face has a limit surface (holes, or boundary rule none); nothing to draw",
            body.mesh.name
        ))
    })?;
    args.frames.check_method(&rig.method())?;
    let fitted = args.rig.fit(&rig.or_up(body.mesh.up), &scout, args.mesh.is_none())?;
    let pattern = PatternRig::fitted(pattern, &scout, &fitted);
    let name = rig.pattern.name_for(&fitted.method);
    let save_rig = || args.rig.save(&fitted, PatternRig::of(name.clone(), &pattern));
    let shot = |index: usize, digest: u64| {
        let rig = args.frames.rig(&fitted, &pattern, index as u32, paths.len() as u32);
        let view = args.view(&rig, pattern.clone());
        let time = times[index.min(times.len() - 1)];
        let made_by = made_by(args, MeshAt { digest, time }, &rig, &name, &view);
        Shot { path: &paths[index], view, made_by }
    };
    let missing = missing(args, format, &source, &times, &body.mesh, paths.len(), shot)?;
    let mut pictures = Pictures { paths: &paths, drawn: Vec::new(), size: [0; 2], kept: paths.len() - missing.len() };
    if missing.is_empty() {
        pictures.note();
        save_rig()?;
        return account.write(args.json.as_ref(), None, samples);
    }
    let gpu = account.time("adapter", Gpu::new)?;
    let layout = args.layout(&fitted.method);
    let steps = (missing.len() > 1).then(|| Steps::new(missing.len(), "frames"));
    if steps.is_some() {
        bar.finish_and_clear();
    }
    let mut drawn: Option<Drawn<'_>> = None;
    let mut draw = |index: usize, account: &mut Account| -> Result<[u32; 2], Failure> {
        let time = times[index.min(times.len() - 1)];
        if times.len() > 1 && index > 0 {
            let mesh = account.time("read", || source.at(time)).map_err(Failure::Bad)?;
            account.time("move", || body.move_to(mesh, time))?;
            drawn = None;
        }
        let ready = match drawn.take() {
            Some(ready) => ready,
            None => Drawn::new(args, &body, layout, &gpu, account)?,
        };
        let shot = shot(index, body.digest);
        // Of a series, the frames are counted instead.
        let watch: Box<dyn Fn(f64) + Sync> = if steps.is_none() { Box::new(percent(&bar)) } else { Box::new(|_| ()) };
        let size = match &ready {
            Drawn::Both(pair) => pair.take(shot.path, &shot.view, &shot.made_by, account, &watch)?,
            Drawn::One(tables) => {
                let size = shot.take(format, args.show, gpu.watched(&watch), tables, account)?;
                // The exact pipeline counts what it sees; of the others, points of the surface are asked.
                if shot.view.pipeline != Pipeline::Exact && times.len() == 1 && !scout.is_in_view(&shot.view.camera) {
                    account.picture_is_empty();
                }
                size
            }
        };
        drawn = Some(ready);
        steps.iter().for_each(Steps::done_one);
        Ok(size)
    };
    let result: Result<(), Failure> = missing.into_iter().try_for_each(|index| {
        pictures.size = draw(index, &mut account)?;
        pictures.drawn.push(index);
        Ok(())
    });
    bar.finish_and_clear();
    drop(steps);
    // What a failure leaves is there all the same.
    pictures.note();
    result?;
    save_rig()?;
    if !say_without_area(&body.mesh, &scout, "nothing can be seen") {
        account.say_empty();
    }
    account.say_certificate(samples);
    account.write(args.json.as_ref(), Some(gpu.adapter()), samples)?;
    if args.timings {
        account.say_timings(gpu.adapter());
        drawn.iter().for_each(|drawn| say_tables(args, body.surface(), drawn.tables()));
    }
    Ok(())
}

/// Which pictures of a series, or of one, are there when it ends.
struct Pictures<'a> {
    paths: &'a [PathBuf],
    /// Indices of those that were drawn, in order.
    drawn: Vec<usize>,
    /// Width and height of each.
    size: [u32; 2],
    /// Pictures that `--resume` found.
    kept: usize,
}

impl Pictures<'_> {
    /// Notes it as one line.
    fn note(&self) {
        let Self { paths, drawn, size: [width, height], kept } = self;
        let name = |index: usize| paths[index].display();
        let kept = if *kept > 0 { format!("; {kept} were there already") } else { String::new() };
        match drawn[..] {
            [] if kept.is_empty() => {}
            [] => outgoing::note_line(format!("wrote no picture: all {} were there already", paths.len())),
            [index] if paths.len() == 1 => outgoing::note(&paths[index], &format!("{width}x{height} pixels")),
            [index] => outgoing::note_line(format!("wrote {}, {width}x{height} pixels{kept}", name(index))),
            [first, .., last] => outgoing::note_line(format!(
                "wrote {} to {}, {} pictures of {width}x{height} pixels{kept}",
                name(first),
                name(last),
                drawn.len()
            )),
        }
    }
}

/// Bytes of the tables, by layout.
fn say_tables(args: &RenderArgs, surface: &LimitSurface, uploaded: &Tables) {
    if !args.patches.draws_exact() {
        tell!("{:<20} {:>12} bytes", "tables", uploaded.size());
        return;
    }
    for layout in TableLayout::ALL {
        let chosen = if layout == uploaded.layout() { ", chosen" } else { "" };
        tell!("{:<20} {:>12} bytes{chosen}", format!("tables {layout}"), tables::bytes(surface, layout));
    }
}

/// Indices of the pictures that are to be drawn.
///
/// # Errors
/// `--resume` finds a picture with other settings, or cannot read the mesh of a time.
fn missing<'a>(
    args: &RenderArgs,
    format: Format,
    source: &Source<'_>,
    times: &[Option<f64>],
    first: &SubdivMesh,
    count: usize,
    shot: impl Fn(usize, u64) -> Shot<'a>,
) -> Result<Vec<usize>, Failure> {
    if !args.frames.resumes() {
        return Ok((0..count).collect());
    }
    let mut digest = mesh_digest(first);
    let (mut missing, mut broken) = (Vec::new(), Vec::new());
    for index in 0..count {
        if times.len() > 1 && index > 0 {
            digest = mesh_digest(&source.at(times[index]).map_err(Failure::Bad)?);
        }
        let Shot { path, made_by, .. } = shot(index, digest);
        match args.frames.found(path, format, &made_by)? {
            Found::Whole => continue,
            Found::Nothing => {}
            Found::Broken(error) => broken.push((path, error)),
        }
        missing.push(index);
    }
    if let Some((path, error)) = broken.first() {
        let count = broken.len();
        let what = if count == 1 { "frame is" } else { "frames are" };
        tell!(
            "catoptric: {count} {what} there but not whole, and drawn again; the first: {}: {error}",
            crate::line::printable(&path.display().to_string())
        );
    }
    Ok(missing)
}

/// The mesh of a picture and its surface.
struct Body {
    mesh: SubdivMesh,
    digest: u64,
    surface: Surface,
}

enum Surface {
    Still(LimitSurface),
    Moving(Box<MovingSurface>),
}

impl Body {
    fn new(mesh: SubdivMesh, moves: bool, bar: &ProgressBar) -> Result<Self, Failure> {
        let surface = match moves {
            true => MovingSurface::new(&mesh)
                .map(|surface| Surface::Moving(Box::new(surface)))
                .map_err(|error| Failure::of(&mesh, error))?,
            false => Surface::Still(refined(&mesh, bar)?),
        };
        Ok(Self { digest: mesh_digest(&mesh), mesh, surface })
    }

    fn surface(&self) -> &LimitSurface {
        match &self.surface {
            Surface::Still(surface) => surface,
            Surface::Moving(moving) => moving.surface(),
        }
    }

    fn move_to(&mut self, mesh: SubdivMesh, time: Option<f64>) -> Result<(), Failure> {
        if let Surface::Moving(moving) = &mut self.surface {
            let moved = moving.move_to(&mesh).map(drop);
            match moved {
                // Prims that turn into their mirror images have their faces turned over, and some change their faces.
                Err(MoveError::Topology(_)) if mesh.has_prims_of(&self.mesh) => {
                    **moving = MovingSurface::new(&mesh).map_err(|error| Failure::of(&mesh, error))?;
                }
                moved => {
                    let at = time.map_or_else(String::new, |time| format!("at time {time} "));
                    moved.map_err(|error| Failure::Bad(format!("{}: {at}{error}", mesh.name)))?;
                }
            }
        }
        (self.digest, self.mesh) = (mesh_digest(&mesh), mesh);
        Ok(())
    }
}

/// What pictures of one mesh are drawn from.
enum Drawn<'a> {
    One(Box<Tables>),
    /// `--compare`.
    Both(Box<Pair<'a>>),
}

impl<'a> Drawn<'a> {
    fn new(
        args: &RenderArgs,
        body: &Body,
        layout: TableLayout,
        gpu: &'a Gpu,
        account: &mut Account,
    ) -> Result<Self, Failure> {
        let tables = args.patches.upload(&body.mesh, body.surface(), layout, gpu, account)?;
        Ok(match args.patches.compare {
            true => Self::Both(Box::new(Pair::new(args, &body.mesh, body.surface(), gpu, tables, account)?)),
            false => Self::One(Box::new(tables)),
        })
    }

    /// Those that are drawn alone, or first.
    fn tables(&self) -> &Tables {
        match self {
            Self::One(tables) => tables,
            Self::Both(pair) => pair.exact(),
        }
    }
}

impl RenderArgs {
    /// What is written: as the flag says, or else the name of the file.
    fn format(&self) -> Result<Format, Failure> {
        match self.output_format {
            Some(format) => Ok(format),
            None if outgoing::is_stdout(&self.output) => Ok(Format::Png),
            None => Format::of(&self.output),
        }
    }

    /// The layout of the tables: curvature is read from expanded ones.
    fn layout(&self, method: &Method) -> TableLayout {
        match self.layout {
            TableLayout::Auto if method.reads_curvature() => TableLayout::Expanded,
            layout => layout,
        }
    }

    /// What is said of the picture.
    fn rig(&self) -> Result<Rig, Failure> {
        self.rig.rig(Rig {
            field: self.field.method.clone(),
            camera: CameraRig { size: self.size, ..CameraRig::default() },
            pattern: self.pattern.rig()?,
            colours: self.colours.rig(),
            ..Rig::default()
        })
    }

    fn view(&self, rig: &FittedRig, pattern: Pattern) -> View {
        let field = rig.field();
        let usual = View::new(rig.camera, field.light);
        View {
            field,
            pattern,
            pipeline: match self.pipeline {
                PipelineName::Exact => Pipeline::Exact,
                PipelineName::Limit => Pipeline::Limit,
                PipelineName::Polygon => Pipeline::Polygon,
                PipelineName::Points => Pipeline::Points,
            },
            stage: match self.stage {
                StageName::Auto => Stage::Auto,
                StageName::Fragment => Stage::Fragment,
                StageName::Compute => Stage::Compute,
            },
            proxy_level: self.proxy_level,
            samples: self.samples,
            enlarge: self.enlarge.unwrap_or(usual.enlarge),
            palette: rig.palette,
            ..usual
        }
    }
}

/// A picture to take.
struct Shot<'a> {
    path: &'a Path,
    view: View,
    made_by: String,
}

impl Shot<'_> {
    /// Draws and writes it; returns its size in pixels.
    fn take(
        &self,
        format: Format,
        show: Option<ShowName>,
        gpu: Watched<'_>,
        tables: &Tables,
        account: &mut Account,
    ) -> Result<[u32; 2], Failure> {
        let Shot { path, view, made_by } = self;
        match (format, show) {
            (_, Some(show)) => {
                let seen = gpu.inspect(tables, view)?;
                account.add(&seen.timings);
                account.picture((view.pipeline == Pipeline::Exact).then(|| seen.summary()));
                let what = match show {
                    ShowName::Residual => Heat::Residual,
                    ShowName::Steps => Heat::Steps,
                };
                let pixels = heat(&seen, what);
                account.time("write", || outgoing::write(path, |out| encode_png(out, seen.size, &pixels, made_by)))?;
            }
            (Format::Png, None) => {
                let mut frame = gpu.render(tables, view)?;
                account.add(&frame.timings);
                if let Pattern::Heat { range: [low, high] } = view.pattern {
                    let scale = Scale::linear(low as f32, high as f32);
                    draw_legend(frame.size, &mut frame.rgba8, &scale, &legend(&view.field.method));
                }
                account.picture(frame.summary);
                account.time("write", || {
                    outgoing::write(path, |out| encode_png(out, frame.size, &frame.rgba8, made_by))
                })?;
            }
            (Format::Exr, None) => {
                let (colour, seen) = (gpu.render_linear(tables, view)?, gpu.inspect(tables, view)?);
                account.add(&colour.timings);
                account.add(&seen.timings);
                account.picture(colour.summary);
                let layers =
                    Layers { camera: &view.camera, colour: &colour, seen: &seen, source: tables.source(), made_by };
                account.time("write", || outgoing::write_exr(path, &layers))?;
            }
        }
        Ok(view.camera.size)
    }
}

/// What false colours of a field measure.
pub(super) fn legend(method: &Method) -> String {
    let unit = match method {
        Method::Sphere(_) | Method::Isophote => "degrees",
        Method::Curve(PlaneCurve::Grid(grid)) => {
            let name = grid.path().file_name().unwrap_or_default().display();
            return format!("curve:{name}, 0 to 1; magenta: undefined");
        }
        Method::Curvature(CurvatureKind::Gaussian) => "1 / world unit^2; magenta: undefined",
        Method::Curvature(_) => "1 / world unit; magenta: undefined",
        _ => "world units; magenta: undefined",
    };
    format!("{method}, {unit}")
}
