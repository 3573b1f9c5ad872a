//! Digests that are the same on every machine and in every version, unlike the standard library's: FNV-1a, 64 bits (Fowler, Noll & Vo).
//!
//! A single byte that differs always changes it: each step is a bijection of what came before.

/// The digest of nothing.
pub(crate) const START: u64 = 0xcbf2_9ce4_8422_2325;

/// The digest of what `digest` is of, and these bytes after it.
pub(crate) fn fnv1a(digest: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(digest, |digest, byte| (digest ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}
