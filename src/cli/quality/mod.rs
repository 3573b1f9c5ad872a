//! `quality`: where the surface breaks, the worst first.

mod picture;
mod record;
mod table;

use super::account::Account;
use super::args::size;
use super::field::{ColourArgs, FieldArgs, PatternArgs};
use super::rig::RigArgs;
use super::scene::SceneArgs;
use super::settings::{CommandLine, mesh_digest};
use super::{Failure, outgoing, progress, refined, write_out};
use crate::field::{Field, Pattern, Scout};
use crate::gpu::View;
use crate::mesh::{Orientation, PtexParts, SubdivMesh};
use crate::quality::{FeatureKind, Kind, Limits, Quality, Ranked, Reading};
use crate::rig::{CameraRig, FittedRig, PatternName, PatternRig, Rig};
use clap::{Args, ValueEnum};
use picture::Picture;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct QualityArgs {
    /// Control mesh (.obj, .usd, .usda, .usdc or .usdz, also with .gz), or - for standard input
    mesh: Option<PathBuf>,
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Picture to write (.png): the field, creases and vertices coloured by how far they exceed their limits, the worst numbered
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write everything that was measured as JSON (docs/QUALITY.md)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// How many of the worst are listed, and numbered in the picture
    #[arg(long, value_name = "N", default_value_t = 20)]
    count: usize,
    /// Largest gap that is no break (G0), world units; millimetres with --mm-per-unit
    #[arg(long, value_name = "D", default_value_t = 0.001, value_parser = limit, allow_negative_numbers = true)]
    gap: f64,
    /// Largest angle between tangent planes that is no break (G1), degrees
    #[arg(long, value_name = "DEG", default_value_t = 0.5, value_parser = limit, allow_negative_numbers = true)]
    angle: f64,
    /// Largest difference in curvature that is no break (G2): 2 |k1 - k2| / (|k1| + |k2|), percent, 0 to 200
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0, value_parser = limit, allow_negative_numbers = true)]
    curvature: f64,
    /// How far apart two boundaries may be to be judged as a joint, world units; millimetres with --mm-per-unit. 0: none is
    /// [default: 1e-3 of the diagonal]
    #[arg(long, value_name = "D", value_parser = weld, allow_negative_numbers = true)]
    weld: Option<f64>,
    /// Millimetres that a world unit takes: gaps are in millimetres then
    #[arg(long, value_name = "MM", value_parser = unit, allow_negative_numbers = true)]
    mm_per_unit: Option<f64>,
    /// What is measured but neither judged nor listed, for breaks that are meant
    #[arg(long, value_name = "KIND,...", value_enum, value_delimiter = ',')]
    ignore: Vec<Ignored>,
    /// Width and height of the picture in pixels, legend excluded [default: 1024x1024]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    #[command(flatten)]
    field: FieldArgs,
    #[command(flatten)]
    pattern: PatternArgs,
    #[command(flatten)]
    colours: ColourArgs,
    #[command(flatten)]
    rig: RigArgs,
    /// Print how long each step took
    #[arg(long)]
    timings: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum Ignored {
    /// Infinitely sharp edges
    Creases,
    /// Creases of finite sharpness
    SemiSharp,
    /// Lines inside the smooth surface
    Smooth,
    /// Boundaries that lie beside each other
    Seams,
    /// Extraordinary vertices, those on creases too
    Vertices,
}

impl Ignored {
    fn kind(self) -> Kind {
        match self {
            Ignored::Creases => Kind::Feature(FeatureKind::Crease),
            Ignored::SemiSharp => Kind::Feature(FeatureKind::SemiSharp),
            Ignored::Smooth => Kind::Feature(FeatureKind::Smooth),
            Ignored::Seams => Kind::Feature(FeatureKind::Seam),
            Ignored::Vertices => Kind::Vertex,
        }
    }

    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Limits below would be exceeded by rounding.
const LEAST: f64 = 1e-12;

fn limit(text: &str) -> Result<f64, String> {
    let limit = text.parse().ok().filter(|x: &f64| *x >= LEAST && x.is_finite());
    limit.ok_or_else(|| format!("give a number, {LEAST:e} or above: less is rounding"))
}

fn weld(text: &str) -> Result<f64, String> {
    let distance = text.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite());
    distance.ok_or_else(|| "give a distance, 0 or above".to_owned())
}

fn unit(text: &str) -> Result<f64, String> {
    let unit = text.parse().ok().filter(|x: &f64| (1e-30..=1e30).contains(x));
    unit.ok_or_else(|| "give a number of millimetres from 1e-30 to 1e30".to_owned())
}

/// A surface, judged.
struct Verdict<'a> {
    mesh: &'a SubdivMesh,
    parts: PtexParts<'a>,
    field: &'a Field,
    quality: &'a Quality,
    /// The worst first; those that are ignored too.
    ranked: Vec<Ranked<'a>>,
    ignored: Vec<Ignored>,
    orientation: Orientation,
    /// Why the surface has no area, where it has none.
    without_area: Option<String>,
    /// As asked for.
    limits: AskedLimits,
    made_by: String,
}

/// Limits in the units of the command line.
#[derive(Debug, Clone, Copy)]
struct AskedLimits {
    gap: f64,
    angle_deg: f64,
    percent: f64,
    weld: Option<f64>,
    mm_per_unit: Option<f64>,
}

impl AskedLimits {
    /// What a world unit is in the unit of gaps.
    fn gap_unit(&self) -> f64 {
        self.mm_per_unit.unwrap_or(1.0)
    }

    fn unit(&self) -> &'static str {
        if self.mm_per_unit.is_some() { "mm" } else { "units" }
    }

    fn limits(&self) -> Limits {
        Limits {
            gap: self.gap / self.gap_unit(),
            angle_deg: self.angle_deg,
            difference: self.percent / 100.0,
            weld: self.weld.map(|weld| weld / self.gap_unit()),
        }
    }
}

impl Verdict<'_> {
    fn is_ignored(&self, ranked: &Ranked<'_>) -> bool {
        self.ignored.iter().any(|ignored| ignored.kind() == ranked.kind())
    }

    /// Those that are judged, the worst first.
    fn judged(&self) -> impl Iterator<Item = &Ranked<'_>> {
        self.ranked.iter().filter(|ranked| !self.is_ignored(ranked))
    }

    fn over(&self) -> usize {
        self.judged().filter(|ranked| ranked.is_over()).count()
    }

    /// Joints inside the smooth surface that are judged.
    fn smooth_joints(&self) -> usize {
        if self.ignored.contains(&Ignored::Smooth) { 0 } else { self.quality.smooth_joints }
    }

    /// Whether limits are kept; `None` where nothing was judged.
    fn passes(&self) -> Option<bool> {
        let is_judged = self.judged().next().is_some() || self.smooth_joints() > 0;
        is_judged.then(|| self.over() == 0)
    }
}

pub(super) fn run(args: &QualityArgs) -> Result<(), Failure> {
    let mut account = Account::default();
    args.rig.check()?;
    let rig = args.rig()?;
    args.pattern.check(&rig)?;
    args.check_files(&rig)?;
    let pattern = rig.pattern.read(&rig.method()).map_err(Failure::Bad)?;
    let bar = progress("measuring".to_owned());
    let mesh = account.time("read", || args.scene.load_quads(args.mesh.as_deref(), "quality"))?;
    let surface = account.time("patches and classes", || refined(&mesh, &bar))?;
    let scout = account.time("fit", || Scout::new(&surface)).ok_or_else(|| {
        let what = "no face has a limit surface (holes, or boundary rule none); nothing to measure";
        Failure::Bad(format!("{}: {what}", mesh.name))
    })?;
    let fitted = args.rig.fit(&rig.or_up(mesh.up), &scout, args.mesh.is_none())?;
    let (camera, field) = (fitted.camera, fitted.field());
    let pattern = PatternRig::fitted(pattern, &scout, &fitted);
    let name = rig.pattern.name_for(&fitted.method);

    let asked = AskedLimits {
        gap: args.gap,
        angle_deg: args.angle,
        percent: args.curvature,
        weld: args.weld,
        mm_per_unit: args.mm_per_unit,
    };
    let limits = asked.limits();
    let reading = Reading { field: &field, camera: &camera };
    let quality = account.time("measure", || Quality::measure(&mesh, &surface, Some(reading), &limits));
    let mut ignored = args.ignore.clone();
    ignored.sort_unstable();
    ignored.dedup();
    let mut verdict = Verdict {
        mesh: &mesh,
        parts: mesh.ptex_parts(),
        field: &field,
        quality: &quality,
        ranked: quality.ranked(&limits),
        ignored,
        orientation: mesh.orientation(),
        without_area: scout.without_area(),
        limits: asked,
        made_by: String::new(),
    };
    verdict.made_by = args.made_by(&verdict, &fitted, (&pattern, &name));
    if let Some(path) = &args.output {
        let mut view = View::new(camera, field.light);
        view.field = field.clone();
        view.pattern = pattern.clone();
        view.palette = fitted.palette;
        let picture = Picture { surface: &surface, view: &view, count: args.count };
        picture.draw(path, &verdict, &mut account)?;
    }
    if let Some(path) = &args.json {
        let text = account.time("write", || record::json(&verdict)).map_err(std::io::Error::from)?;
        write_out(Some(path), &text)?;
    }
    args.rig.save(&fitted, PatternRig::of(name, &pattern))?;
    bar.finish_and_clear();
    write_out(None, table::text(&verdict, args.count).as_bytes())?;
    if args.timings {
        account.say_steps();
    }
    if verdict.over() > 0 { Err(Failure::Check) } else { Ok(()) }
}

impl QualityArgs {
    /// Refuses files that could not be written, before the work.
    fn check_files(&self, rig: &Rig) -> Result<(), Failure> {
        let is_png = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if let Some(path) = self.output.as_ref().filter(|path| !is_png(path) && !outgoing::is_stdout(path)) {
            return Err(outgoing::unknown_ending(path, "a picture", ".png"));
        }
        let mut files = self.rig.files(self.mesh.as_deref(), rig);
        for (path, flag, what) in [(&self.output, "-o", "the picture"), (&self.json, "--json", "the measurements")] {
            if let Some(path) = path {
                outgoing::check(path, flag)?;
                files.write(path, flag, what)?;
            }
        }
        self.rig.check_apart(&mut files)
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

    /// The command that makes the same files again.
    fn made_by(&self, verdict: &Verdict<'_>, rig: &FittedRig, (pattern, name): (&Pattern, &PatternName)) -> String {
        let mut command = CommandLine::new("quality", self.mesh.as_deref());
        self.scene.record(&mut command);
        command.camera(&rig.camera);
        command.field(rig);
        command.pattern(pattern, name);
        command.colours(rig.palette);
        let limits = &verdict.limits;
        for (flag, value) in [("gap", limits.gap), ("angle", limits.angle_deg), ("curvature", limits.percent)] {
            command.flag(flag, value);
        }
        if let Some(weld) = limits.weld {
            command.flag("weld", weld);
        }
        if let Some(mm) = limits.mm_per_unit {
            command.flag("mm-per-unit", mm);
        }
        if !verdict.ignored.is_empty() {
            command.flag("ignore", verdict.ignored.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(","));
        }
        command.flag("count", self.count);
        command.finish(mesh_digest(verdict.mesh), &rig.method)
    }
}
