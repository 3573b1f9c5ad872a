//! WGSL sources: which files make up a pass, and the constants that Rust shares with them.

use super::NO_PATCH;
use super::charts::BAND;
use super::records::ChartRecord;
use super::tables::TABLE_LEVELS;
use crate::field::{Method, colours};
use crate::stam::{LEVELS, box_spline};

/// Kind of a patch of 16 points.
pub const KIND_REGULAR: u32 = 0;
/// Kind of a patch with a table of levels.
pub const KIND_IRREGULAR: u32 = 1;
/// Kind of a Gregory patch of 16 points and 4 differences.
pub const KIND_GREGORY: u32 = 2;
/// Pattern numbers.
pub const PATTERN_STRIPES: u32 = 0;
/// Two families of stripes.
pub const PATTERN_LATTICE: u32 = 1;
/// Discs.
pub const PATTERN_CIRCLES: u32 = 2;
/// A picture.
pub const PATTERN_PICTURE: u32 = 3;
/// One stripe.
pub const PATTERN_BAND: u32 = 4;
/// False colours.
pub const PATTERN_HEAT: u32 = 5;
/// Number of them.
pub const PATTERNS: usize = 6;
/// Samples of a column that an invocation of shaders/summary.wgsl sums up.
pub const SUMMED: u32 = 64;
/// Invocations in a workgroup of the compute passes.
pub const WORKGROUP: u32 = 64;
/// Highest level n with 2^-n a normal f32: the number of scales of a class.
pub const SCALE_LEVELS: u32 = 126;
/// Samples a side of a workgroup of the compute stages.
pub const TILE_SIDE: u32 = 8;
/// Texels in a row of a table texture; the tables of the largest meshes then have some 10,000 rows.
pub const TABLE_WIDTH: u32 = 4096;
/// Rows of a block of a table: what every adapter takes (WebGPU's default limit), a power of two so that shaders find a
/// texel with shifts.
pub const BLOCK_ROWS: u32 = 8192;
/// Texels of one level of an irregular patch: 9 rows of 4 points, x, y and z each.
pub const LEVEL_TEXELS: u32 = 27;
/// Texels of one level of an irregular triangle, and of a regular one: 16 points.
pub const TRIANGLE_TEXELS: u32 = 12;
/// Texels of a chart.
pub const CHART_TEXELS: u32 = (size_of::<ChartRecord>() / 16) as u32;
/// How a sample came to its point: not at all.
pub const STATE_NONE: u32 = 0;
/// Solved on the host.
pub const STATE_SOLVED: u32 = 1;
/// By Newton's method on a chart.
pub const STATE_CHART: u32 = 2;
/// Added where the method did not converge on a chart that may lie before what was found.
pub const STATE_DOUBTFUL: u32 = 4;
/// Samples by which Newton's last step may move: its error is the square of that over the size of the chart.
const SETTLED: f32 = 0.005;
/// Newton's steps at most: the error shrinks by a fifth each time at least, in practice it is squared (2 steps in the mean).
const MOST_STEPS: u32 = 24;
/// Distance in pixels by which the borders of proxy patches overlap: large against the rasteriser's grid of 1/256 pixel
/// on which vertices that differ by rounding may land one step apart, small against a pixel. (Measured: in 36 million
/// pixels of a cube at level 7, 6 fall through without it, none with it.)
pub const PUSH: f32 = 0.1;

/// What tables hold: what they do not is not compiled into the shaders, where the software adapter would pay for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Content {
    /// Points of regular patches and levels.
    #[default]
    Points,
    /// Some levels may be given by picked points.
    Tails,
    /// Regular patches, levels and Gregory patches.
    Gregory,
    /// Triangles.
    Triangles,
    /// As `Points`, some patches others in another place.
    Instances,
    /// As `Tails`, likewise.
    InstancesWithTails,
}

impl Content {
    pub const ALL: [Self; 6] =
        [Self::Points, Self::Tails, Self::Gregory, Self::Triangles, Self::Instances, Self::InstancesWithTails];

    /// Whether levels may be given by picked points.
    pub fn has_tail(self) -> bool {
        matches!(self, Self::Tails | Self::InstancesWithTails)
    }

    pub fn variant(self, block_rows: u32) -> Variant {
        Variant {
            block_rows,
            has_tail: self.has_tail(),
            has_gregory: self == Self::Gregory,
            has_instances: matches!(self, Self::Instances | Self::InstancesWithTails),
            triangles: self == Self::Triangles,
        }
    }
}

/// What is compiled into the shaders about the tables that they read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variant {
    /// Rows of a block of a table.
    pub block_rows: u32,
    pub has_tail: bool,
    pub has_gregory: bool,
    pub has_instances: bool,
    pub triangles: bool,
}

/// One shader module: its name, the files that it consists of, and its entry points.
#[derive(Debug, Clone, Copy)]
pub struct Module {
    /// File stem of the pass.
    pub name: &'static str,
    /// WGSL files, concatenated.
    pub files: &'static [&'static str],
}

impl Module {
    /// The whole source, constants first, for a field and for all that tables may hold.
    pub fn source(&self, method: &Method) -> String {
        // Levels that are given by picked points have no second derivatives.
        let has_tail = !method.reads_curvature();
        let variant =
            Variant { block_rows: BLOCK_ROWS, has_tail, has_gregory: true, has_instances: true, triangles: false };
        self.source_for(&variant, &method.wgsl())
    }

    /// The same for tables of triangles.
    pub fn source_for_triangles(&self, method: &Method) -> String {
        self.source_for(&Content::Triangles.variant(BLOCK_ROWS), &method.wgsl())
    }

    /// Whether it depends on the field.
    pub(super) fn reads_field(&self) -> bool {
        self.files.contains(&FIELD)
    }

    /// The same for other tables, and the source of a field.
    pub(super) fn source_for(&self, variant: &Variant, field: &str) -> String {
        let mut source = constants(variant);
        if !self.reads_field() {
            source.push_str("const READS_CURVATURE = false;\n");
        }
        for &file in self.files {
            source.push_str(match file {
                FIELD => field,
                LIMIT_POINT if variant.triangles => TRIANGLE_POINT,
                file => file,
            });
        }
        source
    }
}

const RECORDS: &str = include_str!("../../shaders/shared/records.wgsl");
const TABLES: &str = include_str!("../../shaders/shared/tables.wgsl");
const LIMIT_VALUE: &str = include_str!("../../shaders/shared/limit_value.wgsl");
const TRIANGLE_POINT: &str = include_str!("../../shaders/shared/triangle_point.wgsl");
const LIMIT_POINT: &str = include_str!("../../shaders/shared/limit_point.wgsl");
const BASIS: &str = include_str!("../../shaders/shared/basis.wgsl");
const GREGORY: &str = include_str!("../../shaders/shared/gregory.wgsl");
const CERTIFICATE: &str = include_str!("../../shaders/shared/certificate.wgsl");
const CHART: &str = include_str!("../../shaders/shared/chart.wgsl");
const FULLSCREEN: &str = include_str!("../../shaders/shared/fullscreen.wgsl");
const VISIBILITY_PASS: &str = include_str!("../../shaders/visibility.wgsl");
const SURFACE: &str = include_str!("../../shaders/shared/surface.wgsl");
const OCTAHEDRAL: &str = include_str!("../../shaders/shared/octahedral.wgsl");
const HEAT: &str = include_str!("../../shaders/shared/heat.wgsl");
const PATTERN: &str = include_str!("../../shaders/shared/pattern.wgsl");
const CURVATURE: &str = include_str!("../../shaders/shared/curvature.wgsl");
const LIGHT: &str = include_str!("../../shaders/field/light.wgsl");
/// Stands for the source of a field ([`Method::wgsl`]).
const FIELD: &str = "field";

/// Rasterises the proxy.
pub const VISIBILITY: Module = Module {
    name: "visibility",
    files: &[RECORDS, TABLES, BASIS, GREGORY, CURVATURE, LIMIT_VALUE, LIMIT_POINT, VISIBILITY_PASS],
};
/// What the proxy covers.
pub const RECTANGLE: Module = Module {
    name: "rectangle",
    files: &[
        RECORDS,
        TABLES,
        BASIS,
        GREGORY,
        CURVATURE,
        LIMIT_VALUE,
        LIMIT_POINT,
        VISIBILITY_PASS,
        include_str!("../../shaders/rectangle.wgsl"),
    ],
};
/// Exact positions, drawn as points.
pub const POINTS: Module = Module {
    name: "points",
    files: &[
        RECORDS,
        TABLES,
        BASIS,
        GREGORY,
        CURVATURE,
        LIMIT_VALUE,
        LIMIT_POINT,
        VISIBILITY_PASS,
        FULLSCREEN,
        include_str!("../../shaders/points.wgsl"),
    ],
};
/// Exact surface per pixel.
pub const LIMIT: Module = Module {
    name: "limit",
    files: &[
        RECORDS,
        TABLES,
        BASIS,
        GREGORY,
        CURVATURE,
        LIMIT_VALUE,
        LIMIT_POINT,
        LIGHT,
        FIELD,
        OCTAHEDRAL,
        SURFACE,
        FULLSCREEN,
        include_str!("../../shaders/limit.wgsl"),
    ],
};
/// Interpolated surface per pixel.
pub const POLYGON: Module = Module {
    name: "polygon",
    files: &[RECORDS, LIGHT, FIELD, OCTAHEDRAL, SURFACE, FULLSCREEN, include_str!("../../shaders/polygon.wgsl")],
};
/// Colour.
pub const SHADE: Module = Module {
    name: "shade",
    files: &[LIGHT, OCTAHEDRAL, PATTERN, HEAT, FULLSCREEN, include_str!("../../shaders/shade.wgsl")],
};
/// Linear sum to sRGB.
pub const RESOLVE: Module =
    Module { name: "resolve", files: &[FULLSCREEN, include_str!("../../shaders/resolve.wgsl")] };
/// Limit at samples.
pub const EVALUATE: Module = Module {
    name: "evaluate",
    files: &[
        RECORDS,
        TABLES,
        BASIS,
        GREGORY,
        CURVATURE,
        LIMIT_VALUE,
        LIMIT_POINT,
        include_str!("../../shaders/evaluate.wgsl"),
    ],
};

/// Samples solved on the host.
pub const SPECKS: Module = Module { name: "specks", files: &[CERTIFICATE, include_str!("../../shaders/specks.wgsl")] };
/// What each sample sees first.
pub const CHARTS: Module =
    Module { name: "charts", files: &[CHART, CERTIFICATE, include_str!("../../shaders/charts.wgsl")] };

/// What the certificates of a tile say together.
pub const SUMMARY: Module = Module { name: "summary", files: &[include_str!("../../shaders/summary.wgsl")] };

/// All modules.
pub const MODULES: [Module; 11] =
    [SUMMARY, SPECKS, CHARTS, VISIBILITY, RECTANGLE, LIMIT, POLYGON, SHADE, POINTS, RESOLVE, EVALUATE];

/// WGSL declarations of the constants above.
fn constants(variant: &Variant) -> String {
    let counts = [
        ("KIND_IRREGULAR", KIND_IRREGULAR),
        ("KIND_GREGORY", KIND_GREGORY),
        ("PATTERN_STRIPES", PATTERN_STRIPES),
        ("PATTERN_LATTICE", PATTERN_LATTICE),
        ("PATTERN_CIRCLES", PATTERN_CIRCLES),
        ("PATTERN_PICTURE", PATTERN_PICTURE),
        ("PATTERN_BAND", PATTERN_BAND),
        ("PATTERN_HEAT", PATTERN_HEAT),
        ("WORKGROUP", WORKGROUP),
        ("TILE_SIDE", TILE_SIDE),
        ("TABLE_WIDTH", TABLE_WIDTH),
        ("BLOCK_ROWS", variant.block_rows),
        ("TABLE_LEVELS", TABLE_LEVELS as u32),
        ("LEVEL_TEXELS", if variant.triangles { TRIANGLE_TEXELS } else { LEVEL_TEXELS }),
        ("CENTRE_LEVEL", LEVELS as u32),
        ("NO_PATCH", NO_PATCH),
        ("CHART_TEXELS", CHART_TEXELS),
        ("SUMMED", SUMMED),
        ("STATE_NONE", STATE_NONE),
        ("STATE_SOLVED", STATE_SOLVED),
        ("STATE_CHART", STATE_CHART),
        ("STATE_DOUBTFUL", STATE_DOUBTFUL),
        ("MOST_STEPS", MOST_STEPS),
    ];
    let mut text: String = counts.iter().map(|(name, value)| format!("const {name} = {value}u;\n")).collect();
    text.push_str(&format!("const PUSH = {PUSH:?};\nconst SETTLED = {SETTLED:?};\nconst BAND = {BAND:?};\n"));
    let vector = |[r, g, b]: [u8; 3]| {
        let [r, g, b] = [r, g, b].map(|c| f32::from(c) / 255.0);
        format!("vec3f({r:?}, {g:?}, {b:?})")
    };
    for (name, ramp) in [("HEAT_COLOURS", colours::HEAT), ("DIVERGING_COLOURS", colours::DIVERGING)] {
        text.push_str(&format!("const {name} = array({});\n", ramp.map(vector).join(", ")));
    }
    text.push_str(&format!("const UNDEFINED_COLOUR = {};\n", vector(colours::UNDEFINED)));
    if variant.triangles {
        let columns: Vec<String> = box_spline_columns().iter().map(|c| format!("{c:?}")).collect();
        let matrices = columns.chunks(16).map(|matrix| format!("mat4x4f({})", matrix.join(", ")));
        let matrices: Vec<String> = matrices.collect();
        text.push_str(&format!("const BOX_SPLINE = array({});\n", matrices.join(", ")));
    }
    let has = [("TAIL", variant.has_tail), ("GREGORY", variant.has_gregory), ("INSTANCES", variant.has_instances)];
    text.extend(has.map(|(name, is)| format!("const HAS_{name} = {is};\n")));
    text
}

/// For each group of 4 control points of a triangle and each group of 4 Bezier points, the matrix that gives the weights of the
/// former from those of the latter, column by column.
fn box_spline_columns() -> Vec<f32> {
    let mut columns = Vec::with_capacity(12 * 16);
    for (controls, bezier) in (0..3).flat_map(|g| (0..4).map(move |q| (g, q))) {
        for (column, row) in (0..4).flat_map(|column| (0..4).map(move |row| (column, row))) {
            columns.push(box_spline::bezier_weight(4 * bezier + column, 4 * controls + row) as f32);
        }
    }
    columns
}
