//! How much memory this process may take, asked before it is taken.
//!
//! A mesh can say in a few lines what takes more than any machine has (a thousand edges of sharpness 9.5, one file of many
//! gigabytes). What is about to be allocated is forecast and compared with the limit, so that there is a message instead of a
//! process that the system kills. Without [`set_limit`] there is none.

use bytesize::ByteSize;
use std::sync::atomic::{AtomicU64, Ordering};
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

static LIMIT: AtomicU64 = AtomicU64::new(u64::MAX);

/// Bytes that the process may take from now on, all of it together.
pub fn set_limit(bytes: u64) {
    LIMIT.store(bytes, Ordering::Relaxed);
}

/// Bytes that the process may take.
pub fn limit() -> u64 {
    LIMIT.load(Ordering::Relaxed)
}

/// What the system has to give, or all that it gives to this process's group (of which caches, that it takes back, count as
/// used); `None` where it does not say.
pub fn free() -> Option<u64> {
    let memory = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let system = System::new_with_specifics(memory).ok()?;
    let group = system.cgroup_limits().map_or(u64::MAX, |limits| limits.total_memory);
    Some(system.available_memory().min(group)).filter(|&bytes| bytes > 0)
}

/// More memory is needed than the process may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it takes some {}, and {} are to be had; free memory, raise --memory-limit, or take a smaller part", shown(*.needs), shown(*.limit))]
pub struct TooMuch {
    /// Bytes, as forecast.
    pub needs: u64,
    /// Bytes that the process may take.
    pub limit: u64,
}

/// An error if so many bytes in all are more than the process may take.
///
/// # Errors
/// They are.
pub fn check(needs: u64) -> Result<(), TooMuch> {
    let limit = limit();
    if needs > limit { Err(TooMuch { needs, limit }) } else { Ok(()) }
}

fn shown(bytes: u64) -> impl std::fmt::Display {
    ByteSize(bytes).display().iec()
}
