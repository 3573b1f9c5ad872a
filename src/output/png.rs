//! PNG pictures.

use super::{OutputError, write_whole};
use std::path::Path;

/// Writes an 8-bit sRGB picture, rows from top to bottom, 4 bytes a pixel.
///
/// # Errors
/// As [`write_whole`]; a picture whose bytes do not match its size is an error too.
pub fn write_png(path: &Path, size: [u32; 2], rgba8: &[u8]) -> Result<(), OutputError> {
    use image::codecs::png::{CompressionType, FilterType, PngEncoder};
    use image::{ExtendedColorType, ImageEncoder};
    write_whole(path, |out| {
        // Adaptive filters pay on smooth shading; the fast level costs a tenth of the size and a third of the time.
        PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Adaptive)
            .write_image(rgba8, size[0], size[1], ExtendedColorType::Rgba8)
            .map_err(std::io::Error::other)
    })
}
