//! A headless Vulkan device.

use super::GpuError;
use super::adapter::AdapterChoice;
use super::hush::hushed;
use super::pool::Pool;
use std::sync::{Arc, Mutex, PoisonError};

/// Address space that Mesa's software adapter takes to open and to draw a first picture, and what each of its threads adds, in bytes:
/// 290 MiB and 17 MiB as measured, of one arena of memory.
const ADAPTER: u64 = 340 << 20;
const ADAPTER_THREAD: u64 = 18 << 20;

/// Device, queue and what went wrong on them.
#[derive(Debug)]
pub(super) struct Device {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: wgpu::AdapterInfo,
    pub limits: wgpu::Limits,
    /// Rows of a block of a table, a power of two.
    pub block_rows: u32,
    /// What passes write.
    pub pool: Pool,
    staging: Mutex<Option<wgpu::Buffer>>,
    /// First error that wgpu reported outside a call that returns one.
    error: Arc<Mutex<Option<String>>>,
}

impl Device {
    pub fn open(choice: &AdapterChoice, block_rows: u32) -> Result<Device, GpuError> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
        crate::memory::check_granted(ADAPTER + ADAPTER_THREAD * threads)?;
        hushed(|| Device::open_aloud(choice, block_rows))
    }

    /// Opens an adapter, whatever its driver prints meanwhile.
    fn open_aloud(choice: &AdapterChoice, block_rows: u32) -> Result<Device, GpuError> {
        let adapter = choice.find()?;
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("catoptric"),
            required_limits: limits.clone(),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::Device { adapter: adapter.get_info().name, message: error.to_string() })?;
        let error = Arc::new(Mutex::new(None));
        let slot = Arc::clone(&error);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            slot.lock().unwrap_or_else(|e| e.into_inner()).get_or_insert(error.to_string());
        }));
        Ok(Device {
            device,
            queue,
            info: adapter.get_info(),
            limits,
            block_rows,
            pool: Pool::default(),
            staging: Mutex::default(),
            error,
        })
    }

    /// Submits and waits; reports what wgpu reported meanwhile.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<(), GpuError> {
        self.queue.submit([encoder.finish()]);
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled.map(drop).map_err(|e| self.failed(e.to_string()))
    }

    /// The first error since the last check.
    pub fn check(&self) -> Result<(), GpuError> {
        match self.error.lock().unwrap_or_else(|e| e.into_inner()).take() {
            Some(message) => Err(self.failed(message)),
            None => Ok(()),
        }
    }

    fn failed(&self, message: String) -> GpuError {
        GpuError::Device { adapter: self.info.name.clone(), message }
    }

    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// A buffer with these contents; refuses storage that the adapter cannot bind. Never empty: an empty one cannot be
    /// bound, so it holds one zeroed element.
    pub fn buffer<T: bytemuck::Pod>(
        &self,
        what: &'static str,
        data: &[T],
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        use wgpu::util::DeviceExt;
        let one = [T::zeroed()];
        let contents: &[u8] = bytemuck::cast_slice(if data.is_empty() { &one } else { data });
        self.fits(what, contents.len() as u64)?;
        Ok(self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(what), contents, usage }))
    }

    /// An error if a storage buffer of this size cannot be bound.
    pub fn fits(&self, what: &'static str, size: u64) -> Result<(), GpuError> {
        let limit = self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size);
        if size > limit {
            return Err(GpuError::TooLarge { what, size, limit });
        }
        Ok(())
    }

    /// Reads a buffer back that was made with `COPY_SRC`.
    pub fn read<T: bytemuck::Pod>(&self, source: &wgpu::Buffer) -> Result<Vec<T>, GpuError> {
        let staging = self.staging(source.size());
        let mut encoder = self.encoder();
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
        self.submit(encoder)?;
        self.read_staging(&staging, |bytes| Ok(bytemuck::pod_collect_to_vec(bytes)))
    }

    /// Reads a whole texture back, rows from top to bottom without padding. `T` is one texel.
    pub fn read_texture<T: bytemuck::Pod>(&self, texture: &wgpu::Texture) -> Result<Vec<T>, GpuError> {
        let (width, height) = (texture.width() as usize, texture.height() as usize);
        let mut out = vec![T::zeroed(); width * height];
        self.read_rows(texture, size_of::<T>(), |rows| {
            for (target, source) in out.chunks_exact_mut(width).zip(rows) {
                bytemuck::cast_slice_mut(target).copy_from_slice(source);
            }
        })?;
        Ok(out)
    }

    /// Hands the rows of a texture, from top to bottom, to `read`; `texel` bytes a texel.
    pub fn read_rows(
        &self,
        texture: &wgpu::Texture,
        texel: usize,
        read: impl FnOnce(&mut dyn Iterator<Item = &[u8]>),
    ) -> Result<(), GpuError> {
        let row = texture.width() as usize * texel;
        let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let size = (padded * texture.height() as usize) as u64;
        // What the last picture was read through serves the next one.
        let mut kept = self.staging.lock().unwrap_or_else(PoisonError::into_inner);
        let staging = kept.take().filter(|staging| staging.size() == size).unwrap_or_else(|| self.staging(size));
        let mut encoder = self.encoder();
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded as u32),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        self.submit(encoder)?;
        self.read_staging(&staging, |bytes| {
            read(&mut bytes.chunks_exact(padded).map(|padded| &padded[..row]));
            Ok(())
        })?;
        staging.unmap();
        *kept = Some(staging);
        Ok(())
    }

    fn staging(&self, size: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    fn read_staging<R>(
        &self,
        staging: &wgpu::Buffer,
        read: impl FnOnce(&[u8]) -> Result<R, GpuError>,
    ) -> Result<R, GpuError> {
        staging.map_async(wgpu::MapMode::Read, .., |_| ());
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| self.failed(e.to_string()))?;
        self.check()?;
        let view = staging.get_mapped_range(..).map_err(|e| self.failed(e.to_string()))?;
        read(&view)
    }
}
