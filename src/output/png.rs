//! PNG pictures.

use super::{MADE_BY, OutputError, WriteSeek, write_whole};
use std::io::{BufRead, Seek, SeekFrom};
use std::path::Path;

/// Writes an 8-bit sRGB picture, rows from top to bottom, 4 bytes a pixel, with a text (keyword [`MADE_BY`]) that says how
/// it was made.
///
/// # Errors
/// As [`write_whole`]; a picture whose bytes do not match its size is an error too.
pub fn write_png(path: &Path, size: [u32; 2], rgba8: &[u8], made_by: &str) -> Result<(), OutputError> {
    write_whole(path, |out| encode_png(out, size, rgba8, made_by))
}

/// Writes the bytes of the file that [`write_png`] makes.
///
/// # Errors
/// Those of `out`; a picture whose bytes do not match its size.
pub fn encode_png(out: &mut dyn WriteSeek, size: [u32; 2], rgba8: &[u8], made_by: &str) -> std::io::Result<()> {
    let mut encoder = png::Encoder::new(out, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    // Adaptive filters pay on smooth shading; the fast level costs a tenth of the size and a third of the time.
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let write = || {
        encoder.add_itxt_chunk(MADE_BY.to_owned(), made_by.to_owned())?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(rgba8)?;
        writer.finish()
    };
    write().map_err(plain)
}

/// What the system said, where it is the system's fault.
fn plain(error: png::EncodingError) -> std::io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => other.into(),
    }
}

/// The text of a PNG file that says how it was made; `None` where it has none. All of the file is read: its checksums must be right, and
/// nothing may come after its end.
///
/// # Errors
/// The file cannot be read, is no PNG, ends too early, or bytes of it have changed.
pub fn read_png_made_by(mut file: impl BufRead + Seek) -> std::io::Result<Option<String>> {
    let mut options = png::DecodeOptions::default();
    // Otherwise texts are left out whose checksums are wrong.
    options.set_skip_ancillary_crc_failures(false);
    options.set_ignore_checksums(false);
    let mut reader = png::Decoder::new_with_options(&mut file, options).read_info()?;
    let size = reader.output_buffer_size().ok_or_else(|| std::io::Error::other("it is too large"))?;
    reader.next_frame(&mut vec![0; size])?;
    reader.finish()?;
    let texts = &reader.info().utf8_text;
    let made_by = texts.iter().find(|text| text.keyword == MADE_BY).and_then(|text| text.get_text().ok());
    drop(reader);
    prove_png(file)?;
    Ok(made_by)
}

/// An error if the checksum of a chunk is wrong, or the file goes on after the last one: what a decoder passes over in the end chunk, and in
/// chunks that it does not know.
fn prove_png(mut file: impl BufRead + Seek) -> std::io::Result<()> {
    let changed = || std::io::Error::other("a checksum says that bytes have changed");
    file.seek(SeekFrom::Start(8))?;
    loop {
        let mut head = [0; 8];
        file.read_exact(&mut head)?;
        let [a, b, c, d, kind @ ..] = head;
        let (size, mut sum) = (u64::from(u32::from_be_bytes([a, b, c, d])), crc32fast::Hasher::new());
        sum.update(&kind);
        let mut left = size;
        while left > 0 {
            let some = file.fill_buf()?;
            let count = some.len().min(usize::try_from(left).unwrap_or(usize::MAX));
            if count == 0 {
                return Err(std::io::ErrorKind::UnexpectedEof.into());
            }
            sum.update(&some[..count]);
            file.consume(count);
            left -= count as u64;
        }
        let mut expected = [0; 4];
        file.read_exact(&mut expected)?;
        if sum.finalize() != u32::from_be_bytes(expected) {
            return Err(changed());
        }
        if kind == *b"IEND" {
            let is_end = size == 0 && file.fill_buf()?.is_empty();
            return if is_end { Ok(()) } else { Err(changed()) };
        }
    }
}

/// An opaque picture as the bytes of a PNG file: as small as they come, with a palette where 256 colours are enough.
///
/// # Panics
/// The bytes do not match the size.
pub fn png_bytes(size: [u32; 2], rgba8: &[u8]) -> Vec<u8> {
    let pixels = rgba8.as_chunks::<4>().0;
    let mut palette: Vec<[u8; 3]> = pixels.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    palette.sort_unstable();
    palette.dedup();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let data: Vec<u8> = if palette.len() <= 256 {
        encoder.set_color(png::ColorType::Indexed);
        // Neighbouring numbers are no neighbouring colours: filters would only get in the way.
        encoder.set_filter(png::Filter::NoFilter);
        encoder.set_palette(palette.as_flattened().to_vec());
        let index = |&[r, g, b, _]: &[u8; 4]| palette.partition_point(|colour| *colour < [r, g, b]) as u8;
        pixels.iter().map(index).collect()
    } else {
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_filter(png::Filter::Adaptive);
        pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
    };
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&data)?;
        writer.finish()
    });
    written.expect("memory takes a picture of the right size");
    bytes
}
