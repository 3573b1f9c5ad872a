//! Files that gzip has packed.

use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::error::{MeshError, Place};
use crate::memory;

/// The first bytes of what gzip writes (RFC 1952, section 2.3.1).
const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The bytes as they were before they were packed; as they are, if they are not.
///
/// # Errors
/// Packed bytes that are damaged or end too early, and those that unpacked are too many for [`memory::limit`].
pub(super) fn unpacked(bytes: Vec<u8>, at: impl Fn() -> Place) -> Result<Vec<u8>, MeshError> {
    if !bytes.starts_with(&MAGIC) {
        return Ok(bytes);
    }
    // The text and what it says take about as much.
    let most = memory::limit().bytes / 2;
    let mut text = Vec::new();
    let read = MultiGzDecoder::new(&bytes[..]).take(most.saturating_add(1)).read_to_end(&mut text);
    read.map_err(|error| MeshError::NotPacked { at: at(), error })?;
    if text.len() as u64 > most {
        let needs = memory::TooMuch { needs: 2 * text.len() as u64, limit: memory::limit() };
        return Err(MeshError::Memory { at: at(), needs });
    }
    Ok(text)
}

/// A path without the `.gz` behind it.
pub(super) fn unpacked_path(path: &Path) -> Cow<'_, Path> {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("gz") => Cow::Owned(path.with_extension("")),
        _ => Cow::Borrowed(path),
    }
}
