//! Tables as textures: rows of [`TABLE_WIDTH`] texels, in blocks where one texture has too few rows.
//!
//! Yasui & Kanai 2004, fig. 4 divide their table into texture columns for the same reason. Here a block is a layer of an
//! array texture; `point_texel` in shaders/shared/tables.wgsl finds a texel by its index.

use super::GpuError;
use super::device::Device;
use super::shader::TABLE_WIDTH;

/// Bytes after which what was handed over goes to the adapter, so that staging copies do not pile up.
const PIECE: usize = 16 << 20;

/// A table that is written from its first texel to its last; `T` is one texel.
pub(super) struct TableWriter<'a, T> {
    device: &'a Device,
    texture: wgpu::Texture,
    /// Texels that do not fill a row yet, and those of [`room`](Self::room).
    pending: Vec<T>,
    /// Rows a block.
    height: usize,
    /// Next row.
    row: usize,
    /// Bytes that have not gone to the adapter.
    unsent: usize,
}

impl Device {
    /// A table in one block.
    pub fn table<T: bytemuck::Pod>(
        &self,
        what: &'static str,
        texels: &[T],
        format: wgpu::TextureFormat,
    ) -> Result<wgpu::Texture, GpuError> {
        let rows = self.limits.max_texture_dimension_2d;
        let mut writer = TableWriter::new(self, what, texels.len() as u64, format, [rows, 1])?;
        writer.write(texels);
        writer.finish()
    }

    /// A table in as many blocks of [`Device::block_rows`] rows as it needs.
    pub fn block_table<T: bytemuck::Pod>(
        &self,
        what: &'static str,
        texels: u64,
        format: wgpu::TextureFormat,
    ) -> Result<TableWriter<'_, T>, GpuError> {
        TableWriter::new(self, what, texels, format, [self.block_rows, self.limits.max_texture_array_layers])
    }

    /// Texels that fit in a table in blocks; their index has 32 bits.
    pub fn block_table_limit(&self) -> u64 {
        capacity([self.block_rows, self.limits.max_texture_array_layers])
    }
}

fn capacity([rows, layers]: [u32; 2]) -> u64 {
    (u64::from(TABLE_WIDTH) * u64::from(rows) * u64::from(layers)).min(u64::from(u32::MAX))
}

impl<'a, T: bytemuck::Pod> TableWriter<'a, T> {
    fn new(
        device: &'a Device,
        what: &'static str,
        texels: u64,
        format: wgpu::TextureFormat,
        most: [u32; 2],
    ) -> Result<Self, GpuError> {
        let size = size_of::<T>() as u64;
        if texels > capacity(most) {
            return Err(GpuError::TooLarge { what, size: texels * size, limit: capacity(most) * size });
        }
        let rows = texels.div_ceil(u64::from(TABLE_WIDTH)).max(1) as u32;
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(what),
            size: wgpu::Extent3d {
                width: TABLE_WIDTH,
                height: rows.min(most[0]),
                depth_or_array_layers: rows.div_ceil(most[0]),
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        // Memory that is not there is noticed here, not after everything has been computed.
        device.check()?;
        Ok(TableWriter { device, texture, pending: Vec::new(), height: most[0] as usize, row: 0, unsent: 0 })
    }

    /// The next `count` texels, zeroed, to be filled in.
    pub fn room(&mut self, count: usize) -> &mut [T] {
        let start = self.pending.len();
        self.pending.resize(start + count, T::zeroed());
        &mut self.pending[start..]
    }

    /// Hands all whole rows to the adapter.
    pub fn flush(&mut self) {
        let width = TABLE_WIDTH as usize;
        let mut pending = std::mem::take(&mut self.pending);
        let whole = pending.len() / width * width;
        self.write(&pending[..whole]);
        pending.drain(..whole);
        self.pending = pending;
    }

    /// The rest, and the table: the next submission takes what has not gone to the adapter.
    pub fn finish(mut self) -> Result<wgpu::Texture, GpuError> {
        let pending = std::mem::take(&mut self.pending);
        self.write(&pending);
        self.device.check()?;
        Ok(self.texture)
    }

    /// Whole rows; the last one may be shorter. In pieces that end with their block.
    fn write(&mut self, mut texels: &[T]) {
        let width = TABLE_WIDTH as usize;
        while !texels.is_empty() {
            let left_in_block = self.height - self.row % self.height;
            let rows = (texels.len() / width).min(left_in_block).min(PIECE / (width * size_of::<T>()));
            let extent = match rows {
                0 => [texels.len(), 1],
                _ => [width, rows],
            };
            let (piece, rest) = texels.split_at(extent[0] * extent[1]);
            self.write_piece(piece, extent);
            self.row += extent[1];
            texels = rest;
        }
    }

    fn write_piece(&mut self, texels: &[T], [width, rows]: [usize; 2]) {
        let mut target = self.texture.as_image_copy();
        let (layer, y) = (self.row / self.height, self.row % self.height);
        target.origin = wgpu::Origin3d { x: 0, y: y as u32, z: layer as u32 };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((width * size_of::<T>()) as u32),
            rows_per_image: None,
        };
        let extent = wgpu::Extent3d { width: width as u32, height: rows as u32, depth_or_array_layers: 1 };
        self.device.queue.write_texture(target, bytemuck::cast_slice(texels), layout, extent);
        self.unsent += size_of_val(texels);
        if self.unsent >= PIECE {
            self.device.queue.submit([]);
            self.unsent = 0;
        }
    }
}
