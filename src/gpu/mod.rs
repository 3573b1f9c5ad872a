//! The fragment pipeline: limit surface in, picture out, on a headless Vulkan adapter.
//!
//! # Theory
//! Yasui & Kanai 2004, sec. 4: rasterise an approximation of the surface to find which patch, at which (u,v), each pixel
//! sees; evaluate the exact limit there; shade with the light that the exact normal mirrors.
//!
//! # Changes
//! Normalised tables ([`tables`], docs/LIMIT.md, section 4) instead of plain points, patch-local f32 coordinates with matrices
//! composed in f64, the first point on every sample's ray instead of the proxy's (`charts`), and patterns filtered to the pixel.
//!
//! # Practice
//! [`Gpu::new`] opens the adapter, [`Gpu::upload`] makes [`Tables`] of a surface; then [`Gpu::render`] makes pictures,
//! [`Gpu::inspect`] reads back what every pixel saw, [`Gpu::evaluate`] evaluates samples. All three run the same
//! `limit_point` in WGSL.

mod adapter;
mod blocks;
mod certificate;
mod charts;
mod device;
mod fields;
mod frame;
mod hush;
mod paper;
mod passes;
mod pool;
mod proxy;
pub mod records;
mod scenes;
pub mod shader;
pub mod tables;
mod tessellated;
mod view;
mod watch;

pub use crate::field::{MAX_FOV, Palette};
pub use adapter::{Adapter, AdapterChoice, adapters};
pub use certificate::{Certificate, State, Summary};
pub use frame::{Frame, LinearFrame, NO_PATCH, SurfaceImage, Timings};
pub use tables::{PatchSource, TableLayout, Tables};
pub use tessellated::{Corner, Tessellated};
pub use view::{MAX_ENLARGE, MAX_POINTS_SIDE, MAX_PROXY_LEVEL, MAX_SAMPLES, Pipeline, Stage, View};
pub use watch::Watched;

use crate::stam::{Jet, LimitSurface};
use device::Device;
use passes::Passes;
use shader::{BLOCK_ROWS, Content};
use std::time::{Duration, Instant};
use watch::Watch;

/// Why the GPU could not do its work.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// There is no Vulkan adapter, not even a software one.
    #[error("no usable GPU adapter: install mesa-vulkan-drivers")]
    NoAdapter,
    /// The shell's limits leave too little for the adapter's driver, which would end the process, or hide the adapter.
    #[error("to open a GPU adapter {0}")]
    Memory(#[from] crate::memory::TooMuch),
    /// There are adapters, but not the one that is wanted.
    #[error("no GPU adapter matches {wanted:?}; this machine has {}; give part of a name, software or auto", known.join(", "))]
    UnknownAdapter {
        /// The choice, as it is written.
        wanted: String,
        /// Names of those that there are.
        known: Vec<String>,
    },
    /// The adapter failed.
    #[error("GPU adapter {adapter}: {message}")]
    Device {
        /// Adapter name.
        adapter: String,
        /// What wgpu said.
        message: String,
    },
    /// A table exceeds what the adapter can hold or bind.
    #[error("{what} take {size} bytes, but this adapter takes at most {limit} bytes: use a smaller mesh")]
    TooLarge {
        /// Which buffer.
        what: &'static str,
        /// Its size in bytes.
        size: u64,
        /// The adapter's limit in bytes.
        limit: u64,
    },
    /// A view that cannot be drawn.
    #[error("{0}")]
    View(String),
    /// A sample names a patch that does not exist.
    #[error("sample {sample}: patch {patch} does not exist, the surface has {patches}")]
    Patch {
        /// Index of the sample.
        sample: usize,
        /// Its patch.
        patch: u32,
        /// Number of patches.
        patches: usize,
    },
}

impl GpuError {
    /// Whether there is no adapter at all, rather than one that failed or another one than is wanted.
    pub fn is_no_adapter(&self) -> bool {
        matches!(self, GpuError::NoAdapter)
    }
}

/// A point of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Patch index, as in [`LimitSurface::patches`].
    pub patch: u32,
    /// Patch-local parameters, each from 0 to 1; clamped.
    pub uv: [f32; 2],
}

/// An open adapter with its compiled passes.
#[derive(Debug)]
pub struct Gpu {
    device: Device,
    /// For each content of tables.
    passes: [Passes; Content::ALL.len()],
    startup: Duration,
}

impl Gpu {
    /// Opens the adapter that the environment asks for ([`AdapterChoice::from_env`]).
    ///
    /// Prints nothing, whatever the driver thinks. On Unix, what the process writes to standard error in the meantime goes to the crate `log`
    /// (level debug), that of other threads included; with `VK_LOADER_DEBUG` set, everything is printed.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] where none is installed, [`GpuError::UnknownAdapter`] where another one is wanted,
    /// [`GpuError::Device`] where it does not open.
    pub fn new() -> Result<Gpu, GpuError> {
        Gpu::with(&AdapterChoice::from_env())
    }

    /// Opens an adapter.
    ///
    /// # Errors
    /// As [`Gpu::new`].
    pub fn with(choice: &AdapterChoice) -> Result<Gpu, GpuError> {
        Gpu::with_blocks(choice, BLOCK_ROWS)
    }

    /// Opens an adapter with tables in blocks of so many rows, a power of two.
    fn with_blocks(choice: &AdapterChoice, rows: u32) -> Result<Gpu, GpuError> {
        let start = Instant::now();
        let device = Device::open(choice, rows)?;
        Ok(Gpu { device, passes: Content::ALL.map(Passes::new), startup: start.elapsed() })
    }

    /// The passes that read these tables.
    fn passes(&self, tables: &Tables) -> &Passes {
        &self.passes[tables.content() as usize]
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> &str {
        &self.device.info.name
    }

    /// Whether the adapter is a CPU.
    pub fn is_software(&self) -> bool {
        self.device.info.device_type == wgpu::DeviceType::Cpu
    }

    /// How long it took to open the adapter.
    pub fn startup(&self) -> Duration {
        self.startup
    }

    /// Builds the tables of a surface, in the layout that suits it, and puts them on the adapter.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] where a table exceeds the adapter, [`GpuError::Device`] where its memory does not suffice.
    pub fn upload(&self, surface: &LimitSurface) -> Result<Tables, GpuError> {
        self.upload_as(surface, TableLayout::Auto)
    }

    /// The same in a layout of choice.
    ///
    /// # Errors
    /// As [`Gpu::upload`].
    pub fn upload_as(&self, surface: &LimitSurface, layout: TableLayout) -> Result<Tables, GpuError> {
        tables::upload(&self.device, surface, layout)
    }

    /// Tables of patches from any source, in the layout that suits them.
    ///
    /// # Errors
    /// As [`Gpu::upload`].
    pub fn upload_patches(&self, source: &impl PatchSource) -> Result<Tables, GpuError> {
        tables::upload(&self.device, source, TableLayout::Auto)
    }

    /// Evaluates the limit at samples, in f32 relative to each patch's origin. Positions come back in world space,
    /// derivatives by the patch-local parameters.
    ///
    /// # Errors
    /// [`GpuError::Patch`] for a patch that does not exist.
    pub fn evaluate(&self, tables: &Tables, samples: &[Sample]) -> Result<Vec<Jet>, GpuError> {
        passes::evaluate::run(&self.device, self.passes(tables), tables, samples)
    }

    /// Draws a picture.
    ///
    /// # Errors
    /// [`GpuError::View`] for a view that cannot be drawn.
    pub fn render(&self, tables: &Tables, view: &View) -> Result<Frame, GpuError> {
        frame::render(&self.device, self.passes(tables), tables, view, Watch::NOBODY)
    }

    /// Draws a picture to work with: linear f32, premultiplied, without a background.
    ///
    /// # Errors
    /// As [`Gpu::render`].
    pub fn render_linear(&self, tables: &Tables, view: &View) -> Result<LinearFrame, GpuError> {
        frame::render_linear(&self.device, self.passes(tables), tables, view, Watch::NOBODY)
    }

    /// What every pixel's centre sees: patch, (u,v), position, normal and field.
    ///
    /// # Errors
    /// As [`Gpu::render`].
    pub fn inspect(&self, tables: &Tables, view: &View) -> Result<SurfaceImage, GpuError> {
        frame::inspect(&self.device, self.passes(tables), tables, view, Watch::NOBODY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Scout;
    use crate::mesh;

    /// The same tables in many blocks: the same bits in every sample and every pixel.
    #[test]
    fn blocks_change_nothing() {
        let surface = LimitSurface::new(&mesh::sample()).expect("the sample has a surface");
        let scout = Scout::new(&surface).expect("it has faces");
        let camera = scout.camera([200, 150], glam::DVec3::Z);
        let view = View::new(camera, scout.light(&camera));
        let samples: Vec<Sample> = (0..surface.patches().len() as u32)
            .flat_map(|patch| [0.0, 0.001, 0.03, 0.7].map(|x| Sample { patch, uv: [x, 0.6 * x] }))
            .collect();
        let choice = AdapterChoice::from_env();
        let [whole, parts] = [BLOCK_ROWS, 2].map(|rows| Gpu::with_blocks(&choice, rows).expect("an adapter"));
        for layout in TableLayout::ALL {
            let results = [&whole, &parts].map(|gpu| {
                let tables = gpu.upload_as(&surface, layout).expect("it fits");
                let jets = gpu.evaluate(&tables, &samples).expect("the adapter works");
                (tables.blocks(), jets, gpu.render(&tables, &view).expect("the adapter works").rgba8)
            });
            let [(one, jets, picture), (several, block_jets, block_picture)] = results;
            assert_eq!(one, 1);
            assert!(several > 2, "{layout}: {several} blocks");
            assert!(jets == block_jets && picture == block_picture, "{layout}: {several} blocks differ from one");
        }
    }

    /// Tables beyond the adapter: what pictures and samples get of them are the same bits, and other pipelines are refused.
    #[test]
    fn tables_beyond_the_adapter_are_made_in_parts() {
        let surface = LimitSurface::new(&mesh::sample()).expect("the sample has a surface");
        let scout = Scout::new(&surface).expect("it has faces");
        let camera = scout.camera([60, 45], glam::DVec3::Z);
        let mut view = View::new(camera, scout.light(&camera));
        let patches = surface.patches().len() as u32;
        let samples: Vec<Sample> = (0..3 * patches)
            .map(|i| Sample { patch: (i * 7919) % patches, uv: [0.3 / (1 + i % 40) as f32, 0.2] })
            .collect();
        let mut gpu = Gpu::with_blocks(&AdapterChoice::from_env(), 1).expect("an adapter");
        for layout in TableLayout::ALL {
            // A layer fewer than they take.
            let most = gpu.device.limits.max_texture_array_layers;
            let layers = gpu.upload_as(&surface, layout).expect("it fits").blocks() - 1;
            let results = [most, layers].map(|layers| {
                gpu.device.limits.max_texture_array_layers = layers;
                let tables = gpu.upload_as(&surface, layout).expect("none is too large");
                let jets = gpu.evaluate(&tables, &samples).expect("the adapter works");
                let mut seen = gpu.inspect(&tables, &view).expect("the adapter works");
                seen.timings = Default::default();
                (tables.is_resident(), jets, gpu.render(&tables, &view).expect("the adapter works").rgba8, seen)
            });
            let [(whole, jets, picture, seen), (parts, part_jets, part_picture, part_seen)] = results;
            assert!(whole && !parts, "{layout}");
            assert!(jets == part_jets, "{layout}: samples differ");
            // Charts are cut for each tile, and tiles are smaller: points differ by what (u,v) in f32 are rounded.
            let channels = picture.iter().zip(&part_picture).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(channels <= Some(2), "{layout}: pictures differ by {channels:?}");
            let size = surface.diagonal();
            for (pixel, (a, b)) in seen.position.iter().zip(&part_seen.position).enumerate() {
                let normals = glam::Vec3::from(seen.normal[pixel]).dot(part_seen.normal[pixel].into());
                let covered = seen.patch[pixel] != NO_PATCH;
                assert_eq!(covered, part_seen.patch[pixel] != NO_PATCH, "{layout}, pixel {pixel}");
                assert!(a.distance(*b) < 1e-6 * size && (!covered || normals > 0.99999), "{layout}, pixel {pixel}");
                if covered {
                    let (ptex, uv) =
                        surface.to_ptex(part_seen.patch[pixel] as usize, part_seen.uv[pixel].map(f64::from));
                    let (patch, uv) = surface.locate(ptex, uv).expect("a pixel that sees it");
                    let point = surface.evaluate(patch, uv).position;
                    assert!(point.distance(*a) < 1e-6 * size, "{layout}, pixel {pixel}: patch of the whole");
                }
            }
            gpu.device.limits.max_texture_array_layers = layers;
            let tables = gpu.upload_as(&surface, layout).expect("none is too large");
            view.pipeline = Pipeline::Limit;
            let error = gpu.render(&tables, &view).map(drop).expect_err("nothing to draw from").to_string();
            assert!(error.contains("only the exact pipeline"), "{error}");
            view.pipeline = Pipeline::Exact;
            gpu.device.limits.max_texture_array_layers = most;
        }
    }
}
