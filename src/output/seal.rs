//! A digest of a whole file that stands in the file: what proves that no byte of it has changed, for formats that have nothing of the kind.
//!
//! The file is written with a mark and room for sixteen digits after it, which count as `0` in the digest.

use crate::digest::{START, fnv1a};
use std::io::{Error, Read, Result, Seek, SeekFrom, Write};

/// Digits of a digest, and what stands in their place while it is computed.
pub(super) const BLANK: &str = "0000000000000000";
/// Bytes at the start of a file among which the mark is.
const HEAD: usize = 1 << 20;

/// A file with a mark.
struct Sealed {
    /// Where the digits are, and what they are.
    at: u64,
    digits: [u8; BLANK.len()],
    /// The digest of the file.
    digest: u64,
}

/// Reads all of a file; `None` where it has no mark.
fn read(mut file: impl Read, mark: &[u8]) -> Result<Option<Sealed>> {
    let mut head = Vec::new();
    file.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
    let Some(found) = head.windows(mark.len()).position(|window| window == mark) else { return Ok(None) };
    let at = found + mark.len();
    let place = head.get_mut(at..at + BLANK.len()).ok_or_else(|| Error::other("it ends too early"))?;
    let mut digits = [0; BLANK.len()];
    digits.copy_from_slice(place);
    place.copy_from_slice(BLANK.as_bytes());
    let mut digest = fnv1a(START, &head);
    let mut some = vec![0; 1 << 16];
    loop {
        match file.read(&mut some)? {
            0 => return Ok(Some(Sealed { at: at as u64, digits, digest })),
            count => digest = fnv1a(digest, &some[..count]),
        }
    }
}

/// Writes the digest of a file behind its mark.
///
/// # Errors
/// Those of the file; it has no mark.
pub(super) fn write(mut file: impl Read + Write + Seek, mark: &[u8]) -> Result<()> {
    file.rewind()?;
    let sealed = read(&mut file, mark)?.ok_or_else(|| Error::other("it has no room for its digest"))?;
    file.seek(SeekFrom::Start(sealed.at))?;
    file.write_all(format!("{:016x}", sealed.digest).as_bytes())
}

/// Whether a file has a mark, and with it its digest.
///
/// # Errors
/// The digest is not that of the file; those of the file.
pub(super) fn prove(file: impl Read, mark: &[u8]) -> Result<bool> {
    let Some(Sealed { digits, digest, .. }) = read(file, mark)? else { return Ok(false) };
    let is_whole = digits == *format!("{digest:016x}").as_bytes();
    if is_whole { Ok(true) } else { Err(Error::other("its digest says that bytes have changed")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each byte that changes is noticed, and so is an end that is missing.
    #[test]
    fn every_byte_counts() {
        let mut file = tempfile::tempfile().expect("a temporary file");
        file.write_all(b"before mark=0000000000000000 and after").expect("it is written");
        write(&file, b"mark=").expect("it is sealed");
        let mut bytes = Vec::new();
        file.rewind().and_then(|()| file.read_to_end(&mut bytes)).expect("it is read");
        let is_proved = |bytes: &[u8]| prove(bytes, b"mark=").unwrap_or(false);
        assert!(is_proved(&bytes) && !bytes.windows(16).any(|window| window == BLANK.as_bytes()));
        for k in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[k] ^= 1;
            assert!(!is_proved(&changed), "byte {k}");
            assert!(!is_proved(&bytes[..k]), "the first {k} bytes");
        }
    }
}
