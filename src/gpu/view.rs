//! What to draw, and its f64-composed records for the shaders.

use super::fields::FieldNumbers;
use super::records::{FrameRecord, LightRecord, ResolveRecord, ShadeRecord};
use super::shader::{PATTERN_BAND, PATTERN_CIRCLES, PATTERN_HEAT, PATTERN_LATTICE, PATTERN_PICTURE, PATTERN_STRIPES};
use super::{GpuError, Tables};
use crate::field::{Camera, Field, Light, Palette, Pattern};
use glam::DVec3;
use rayon::prelude::*;

/// Highest level of the proxy tessellation: 256 parts a face.
pub const MAX_PROXY_LEVEL: u32 = 8;
/// Most samples a pixel each way.
pub const MAX_SAMPLES: u32 = 4;
/// Greatest enlargement of [`Pipeline::Points`].
pub const MAX_ENLARGE: f64 = 8.0;
/// Largest side, in samples, of a picture by [`Pipeline::Points`]: points land anywhere, so it is drawn in one piece,
/// and its intermediate textures take 16 bytes a sample.
pub const MAX_POINTS_SIDE: u32 = 4096;
/// Largest picture side in pixels.
const MAX_SIZE: u32 = 32_768;

/// How position and normal come to a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pipeline {
    /// Evaluated on the limit surface where each sample's ray meets it first; nothing depends on a proxy.
    #[default]
    Exact,
    /// Evaluated on the limit surface at the pixel's (patch, u, v) that the rasterised proxy gives.
    Limit,
    /// Interpolated from the proxy's vertices, which have limit positions and normals (Yasui & Kanai 2004, fig. 7b).
    Polygon,
    /// Yasui & Kanai's own (2004, sec. 4.4): the proxy is rasterised as it is, the limit evaluated at each of its
    /// fragments, and these drawn as points of one sample at the projection of their exact positions. A point may land
    /// beside the sample that it was rasterised at, so there are gaps where the proxy is coarse
    /// ([`View::enlarge`]), and the silhouette is the proxy's.
    Points,
}

/// Which kind of pass evaluates and shades over the visibility buffer. The picture does not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stage {
    /// Fragment passes on software adapters, where they are the faster; on others, whichever takes less time over the first
    /// tile that is drawn.
    #[default]
    Auto,
    /// Fragment passes: the reference.
    Fragment,
    /// Compute passes: some GPUs rasterise on a few of their cores only. Polygons keep their fragment pass.
    Compute,
}

/// A picture to take.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// From where, and how many pixels.
    pub camera: Camera,
    /// What is read off the surface.
    pub field: Field,
    /// How the field becomes light.
    pub pattern: Pattern,
    /// How position and normal come to a pixel.
    pub pipeline: Pipeline,
    /// Kind of the passes that evaluate and shade.
    pub stage: Stage,
    /// Level of the proxy tessellation, in the exact pipeline the least one of its charts, 0 to [`MAX_PROXY_LEVEL`]: 2^level parts a quad
    /// face. `None`: as fine as the picture
    /// asks for ([`View::proxy_level_for`]).
    pub proxy_level: Option<u32>,
    /// Samples a pixel each way, 1 to [`MAX_SAMPLES`].
    pub samples: u32,
    /// Fragments a sample each way of [`Pipeline::Points`], 1 to [`MAX_ENLARGE`]; 1 with other pipelines. Yasui & Kanai
    /// 2004, sec. 5 close the gaps of proxies of level 1 and 2 by viewports 1.7^2 and 1.3^2 times larger: 1.7 and 1.3.
    pub enlarge: f64,
    /// Colours.
    pub palette: Palette,
}

impl View {
    /// Reflection lines of `light` in stripes, with defaults for the rest.
    pub fn new(camera: Camera, light: Light) -> View {
        View {
            camera,
            field: Field::reflection(light),
            pattern: Pattern::Stripes { width: 0.42 },
            pipeline: Pipeline::default(),
            stage: Stage::default(),
            proxy_level: None,
            samples: 2,
            enlarge: 1.0,
            palette: Palette::default(),
        }
    }

    /// The light plane of the field.
    pub fn light(&self) -> &Light {
        &self.field.light
    }

    /// Refuses what cannot be drawn.
    pub(super) fn check(&self, tables: &Tables) -> Result<(), GpuError> {
        let fail = |message: String| Err(GpuError::View(message));
        if self.field.method.reads_curvature() && tables.content().has_tail() {
            return fail("curvature is read from tables in the expanded layout only (--tables expanded)".into());
        }
        if tables.has_triangles() && self.pipeline != Pipeline::Exact {
            return fail("the scheme loop is drawn by the pipeline exact only (--pipeline exact)".into());
        }
        if !tables.is_resident() && self.pipeline != Pipeline::Exact {
            let gib = tables.size() as f64 / f64::from(1 << 30);
            return fail(format!(
                "the tables of {} patches take {gib:.1} GiB; only the exact pipeline draws such surfaces: choose it",
                tables.patches()
            ));
        }
        let Camera { size, .. } = self.camera;
        if size.iter().any(|n| !(1..=MAX_SIZE).contains(n)) {
            return fail(format!("picture size {}x{}: each side must be 1 to {MAX_SIZE} pixels", size[0], size[1]));
        }
        self.camera.check(self.samples).map_err(GpuError::View)?;
        if let Some(level) = self.proxy_level.filter(|&level| level > MAX_PROXY_LEVEL) {
            return fail(format!("proxy level {level}: must be 0 to {MAX_PROXY_LEVEL}"));
        }
        if !(1..=MAX_SAMPLES).contains(&self.samples) {
            return fail(format!("{} samples: must be 1 to {MAX_SAMPLES}", self.samples));
        }
        self.check_enlargement()?;
        let light = self.light();
        let axes_ok = light.center.is_finite() && (light.normal().length() - 1.0).abs() < 1e-6;
        if !(axes_ok && light.spacing > 0.0 && light.spacing.is_finite()) {
            return fail("the light needs a finite centre, perpendicular unit axes and a spacing above 0".into());
        }
        if self.field.method.grid().is_some_and(|grid| grid.net().is_none() || grid.width().is_none()) {
            return fail("the grid of light curves must be read, and have a width".into());
        }
        match &self.pattern {
            Pattern::Picture(p)
                if p.rgba8.len() != 4 * p.size[0] as usize * p.size[1] as usize || p.rgba8.is_empty() =>
            {
                fail("the picture's bytes do not match its size".into())
            }
            _ => Ok(()),
        }
    }

    fn check_enlargement(&self) -> Result<(), GpuError> {
        let side = self.camera.size.map(|n| n * self.samples).into_iter().max().unwrap_or(0);
        let problem = match self.pipeline {
            Pipeline::Points if !(1.0..=MAX_ENLARGE).contains(&self.enlarge) => {
                format!("enlargement {}: must be 1 to {MAX_ENLARGE}", self.enlarge)
            }
            Pipeline::Points if side > MAX_POINTS_SIDE => {
                let [w, h] = self.camera.size;
                format!(
                    "{w}x{h} pixels at {} samples: points are drawn at up to {MAX_POINTS_SIDE} samples a side; choose fewer",
                    self.samples
                )
            }
            pipeline if pipeline != Pipeline::Points && self.enlarge != 1.0 => {
                format!("enlargement {}: only the points pipeline takes one", self.enlarge)
            }
            _ => return Ok(()),
        };
        Err(GpuError::View(problem))
    }

    /// The level of the proxy: as asked, or such that a face of average size has cells of at most 4 pixels. An edge of
    /// that length on a silhouette with a radius of 20 pixels is 4^2 / (8 20) = 0.1 pixel off the curve.
    pub fn proxy_level_for(&self, tables: &Tables) -> u32 {
        const CELL: f64 = 4.0;
        self.proxy_level.unwrap_or_else(|| {
            let pixels: f64 = self.camera.size.map(f64::from).iter().product();
            // Half of the picture, seen half from the front and half from the back.
            let face = (pixels / tables.faces().max(1.0)).sqrt();
            (face / CELL).log2().ceil().clamp(1.0, 7.0) as u32
        })
    }

    /// The linear part of the projection: rows of clip-space x, y and of the third coordinate, by lengths in
    /// [`Tables::unit`]. The third one is w in perspective, where z is the near distance, so that z/w = near/distance; in
    /// an orthographic view it is z, from 1 at the near distance to 0 at the far one, and w is 1.
    fn clip_rows(&self, tables: &Tables) -> [DVec3; 3] {
        let axes = self.camera.axes();
        let rows = [axes.right * axes.scale[0], axes.up * axes.scale[1]];
        if !self.camera.is_orthographic() {
            return [rows[0], rows[1], axes.forward];
        }
        let [near, far] = self.camera.depth_range(tables.bounds());
        [rows[0], rows[1], axes.forward / (near - far)].map(|row| row * tables.unit())
    }

    /// The point that positions are told relative to where light is concerned: the eye, or the point of an orthographic
    /// line of sight beside the middle of the surface, wherever on it the eye may be.
    fn viewpoint(&self, tables: &Tables) -> DVec3 {
        let Camera { eye, .. } = self.camera;
        if !self.camera.is_orthographic() {
            return eye;
        }
        let [low, high] = tables.bounds();
        let forward = self.camera.axes().forward;
        eye + forward * forward.dot((low + high) * 0.5 - eye)
    }

    /// Every patch as this camera sees it, composed in f64, then rounded: the three clip-space coordinates of its origin;
    /// the viewpoint relative to its origin.
    pub(super) fn patch_views(&self, tables: &Tables) -> Vec<[[f32; 4]; 2]> {
        let (rows, unit, viewpoint) = (self.clip_rows(tables), tables.unit(), self.viewpoint(tables));
        let eye = self.camera.eye;
        // The third coordinate counts from where it is 0.
        let zero = match self.camera.is_orthographic() {
            true => eye + self.camera.axes().forward * self.camera.depth_range(tables.bounds())[1],
            false => eye,
        };
        let one = |origin: &DVec3| {
            let [x, y, z] =
                [(0, eye), (1, eye), (2, zero)].map(|(k, start)| rows[k].dot((*origin - start) / unit) as f32);
            let [ex, ey, ez] = ((viewpoint - *origin) / unit).as_vec3().to_array();
            [[x, y, z, 0.0], [ex, ey, ez, 0.0]]
        };
        tables.origins.par_iter().map(one).collect()
    }

    /// The projection of the part of the picture that `tile` draws.
    pub(super) fn frame_record(&self, tables: &Tables, tile: &Tile) -> FrameRecord {
        let [w, h] = self.camera.size.map(|n| f64::from(n * tile.samples) * tile.enlarge);
        let [tw, th] = tile.size.map(f64::from);
        let [x, y] = tile.origin.map(f64::from);
        let rows = self.clip_rows(tables);
        let [clip_x, clip_y, clip_depth] = rows.map(|row| row.as_vec3().to_array());
        FrameRecord {
            clip_x,
            near: (self.camera.depth_range(tables.bounds())[0] / tables.unit()) as f32,
            clip_y,
            focal: (rows[1].length() * h * 0.5) as f32,
            clip_depth,
            proxy_level: self.proxy_level_for(tables),
            scale: [(w / tw) as f32, (h / th) as f32],
            shift: [(w / tw - 2.0 * x / tw - 1.0) as f32, (1.0 - h / th + 2.0 * y / th) as f32],
            size: [tw as f32, th as f32],
            orthographic: u32::from(self.camera.is_orthographic()),
            padding: 0,
        }
    }

    /// The light relative to the viewpoint, and lines of sight.
    pub(super) fn light_record(&self, tables: &Tables) -> LightRecord {
        let light = self.light();
        let unit = tables.unit();
        let FieldNumbers { kind, parameter, spacing, half, lines } = FieldNumbers::new(&self.field, unit);
        let (sight, from_eye) = match self.camera.is_orthographic() {
            true => (self.camera.axes().forward, 0.0),
            false => (DVec3::ZERO, 1.0),
        };
        LightRecord {
            center: ((light.center - self.viewpoint(tables)) / unit).as_vec3().to_array(),
            spacing,
            axis_x: light.axes[0].as_vec3().to_array(),
            half_x: half[0],
            axis_y: light.axes[1].as_vec3().to_array(),
            half_y: half[1],
            sight: sight.as_vec3().to_array(),
            from_eye,
            kind,
            parameter,
            lines,
            unit: unit as f32,
        }
    }

    /// Colours and pattern.
    pub(super) fn shade_record(&self, tables: &Tables) -> ShadeRecord {
        let width = match &self.pattern {
            Pattern::Stripes { width } | Pattern::Lattice { width } => *width,
            Pattern::Circles { radius } => *radius,
            Pattern::Band { radius } => 2.0 * radius,
            Pattern::Heat { .. } | Pattern::Picture(_) => 0.0,
        };
        let scale = self.field.method.scale(tables.unit());
        let range = match self.pattern {
            Pattern::Heat { range } => range.map(|end| (end / scale) as f32),
            _ => [0.0; 2],
        };
        let Palette { paint, tube, top, bottom } = self.palette;
        let axes = self.camera.axes();
        // Over the photographer's left shoulder.
        let key = (axes.up * 0.75 - axes.right * 0.45 - axes.forward * 0.5).normalize();
        ShadeRecord {
            paint,
            width: width as f32,
            tube,
            padding0: 0,
            top,
            samples: (f64::from(self.samples) * self.enlarge) as f32,
            bottom,
            padding1: 0.0,
            up: self.camera.up.normalize_or_zero().as_vec3().to_array(),
            padding2: 0.0,
            key: key.as_vec3().to_array(),
            padding3: 0.0,
            picture_scale: (self.pattern.picture_scale(&self.field) * scale).as_vec2().to_array(),
            range,
        }
    }

    /// Which of the `PATTERN_` constants of [`shader`](super::shader) the pattern is.
    pub(super) fn pattern_kind(&self) -> u32 {
        match &self.pattern {
            Pattern::Stripes { .. } => PATTERN_STRIPES,
            Pattern::Lattice { .. } => PATTERN_LATTICE,
            Pattern::Circles { .. } => PATTERN_CIRCLES,
            Pattern::Band { .. } => PATTERN_BAND,
            Pattern::Heat { .. } => PATTERN_HEAT,
            Pattern::Picture(_) => PATTERN_PICTURE,
        }
    }

    /// Background of a tile.
    pub(super) fn resolve_record(&self, tile: &Tile) -> ResolveRecord {
        ResolveRecord {
            top: self.palette.top,
            padding0: 0,
            bottom: self.palette.bottom,
            row: tile.pixels()[0][1] as f32,
            rows: self.camera.size[1] as f32,
            padding: [0.0; 3],
        }
    }
}

/// A rectangle of the picture, in samples (or in fragments, where these are denser: `enlarge`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tile {
    /// First sample.
    pub origin: [u32; 2],
    /// Samples.
    pub size: [u32; 2],
    /// Samples a pixel each way; divides origin and size.
    pub samples: u32,
    /// Fragments a sample each way: 1 but for the parameters of [`Pipeline::Points`].
    pub enlarge: f64,
}

impl Tile {
    /// Largest side for pictures: with 44 bytes a sample the intermediate textures take 176 MiB, whatever the picture's
    /// size.
    pub const PICTURE_SIDE: u32 = 2048;
    /// Largest side for surface images, which take 68 bytes a sample and as much again while they are read back.
    pub const SURFACE_SIDE: u32 = 1024;

    /// Tiles of a picture of `size` pixels.
    pub fn cover(size: [u32; 2], samples: u32, side: u32) -> Vec<Tile> {
        let side = side / samples * samples;
        let total = size.map(|n| n * samples);
        let starts = |n: u32| (0..n).step_by(side as usize);
        let tile = |x: u32, y: u32| Tile {
            origin: [x, y],
            size: [(total[0] - x).min(side), (total[1] - y).min(side)],
            samples,
            enlarge: 1.0,
        };
        starts(total[1]).flat_map(|y| starts(total[0]).map(move |x| tile(x, y))).collect()
    }

    /// The tile and a pixel round it, as far as a picture of `size` pixels goes: shading looks at neighbours.
    pub fn grown(&self, size: [u32; 2]) -> Tile {
        let low = self.origin.map(|n| n.saturating_sub(self.samples));
        let high = [0, 1].map(|k| (self.origin[k] + self.size[k] + self.samples).min(size[k] * self.samples));
        Tile { origin: low, size: [0, 1].map(|k| high[k] - low[k]), ..*self }
    }

    /// First pixel and size in pixels.
    pub fn pixels(&self) -> [[u32; 2]; 2] {
        [self.origin, self.size].map(|v| v.map(|n| n / self.samples))
    }
}
