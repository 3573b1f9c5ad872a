//! How much memory this process may take, asked before it is taken.
//!
//! A mesh can say in a few lines what takes more than any machine has (a thousand edges of sharpness 9.5, one file of many
//! gigabytes). What is about to be allocated is forecast and compared with the limit, so that there is a message instead of a
//! process that the system kills. Without [`set_limit`] there is none.

use bytesize::ByteSize;
use std::sync::{PoisonError, RwLock};
use sysinfo::{MemoryRefreshKind, ProcessRefreshKind, ProcessesToUpdate, RefreshKind, System};

/// What holds the process to a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Whoever called [`set_limit`]; on the command line, `--memory-limit`.
    Asked,
    /// What the machine has free.
    Machine,
    /// The group of processes (control groups of either version, and those that they are in).
    Group,
    /// The address space that a shell grants: `ulimit -v`.
    AddressSpace,
    /// The data that a shell grants: `ulimit -d`.
    Data,
}

impl Cause {
    /// Whether an allocation beyond the limit fails, in whoever's code it is: others are estimates, which the system may exceed.
    pub fn is_hard(self) -> bool {
        matches!(self, Self::AddressSpace | Self::Data)
    }

    /// What it leaves, and what to do about it.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Asked => ["are to be had", "free memory, raise --memory-limit, or take a smaller part"],
            Self::Machine => ["are to be had", "free memory, raise --memory-limit, or take a smaller part"],
            Self::Group => [
                "are left by the memory limit of its control group",
                "raise that limit or --memory-limit, or take a smaller part",
            ],
            Self::AddressSpace => {
                ["are left by the limit of the address space (ulimit -v)", "raise it, or take a smaller part"]
            }
            Self::Data => ["are left by the limit of the data size (ulimit -d)", "raise it, or take a smaller part"],
        }
    }
}

/// Bytes that the process may take, and why no more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// All that it takes from now on together.
    pub bytes: u64,
    /// What holds it to them.
    pub cause: Cause,
}

impl std::fmt::Display for Limit {
    /// As the end of a sentence: `1.0 GiB are left by ...; raise it, or ...`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [left, remedy] = self.cause.words();
        write!(f, "{} {left}; {remedy}", shown(self.bytes))
    }
}

static LIMIT: RwLock<Limit> = RwLock::new(Limit { bytes: u64::MAX, cause: Cause::Asked });

/// Holds the process to a limit from now on.
pub fn set_limit(limit: Limit) {
    *LIMIT.write().unwrap_or_else(PoisonError::into_inner) = limit;
}

/// What the process is held to.
pub fn limit() -> Limit {
    *LIMIT.read().unwrap_or_else(PoisonError::into_inner)
}

/// The least of what the machine has to give, what this process's group may take (of which caches, that the system takes back, do not
/// count as used), and [`granted`]; `None` where the system does not say.
pub fn free() -> Option<Limit> {
    let memory = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let mut system = System::new_with_specifics(memory).ok()?;
    let machine = Limit { bytes: system.available_memory(), cause: Cause::Machine };
    let group = group(&mut system).map(|bytes| Limit { bytes, cause: Cause::Group });
    [Some(machine).filter(|limit| limit.bytes > 0), group, granted()]
        .into_iter()
        .flatten()
        .min_by_key(|limit| limit.bytes)
}

/// What the limits of the process's group leave.
fn group(system: &mut System) -> Option<u64> {
    let id = sysinfo::get_current_pid().ok()?;
    system.refresh_processes_specifics(ProcessesToUpdate::Some(&[id]), false, ProcessRefreshKind::nothing());
    let limits = system.process(id)?.cgroup_limits()?;
    Some(limits.total_memory.saturating_sub(limits.rss))
}

/// What the shell's limits leave of address space or data (`ulimit -v`, `-d`), which no allocation exceeds; `None` where there are none.
#[cfg(target_os = "linux")]
pub fn granted() -> Option<Limit> {
    use rustix::process::{Resource, getrlimit};
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let used = |name: &str| -> u64 {
        let line = status.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
        line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse().ok()).map_or(0, |kib: u64| kib * 1024)
    };
    let left = |resource: Resource, name: &str, cause: Cause| {
        let granted = getrlimit(resource).current?;
        Some(Limit { bytes: granted.saturating_sub(used(name)), cause })
    };
    let limits = [left(Resource::As, "VmSize", Cause::AddressSpace), left(Resource::Data, "VmData", Cause::Data)];
    limits.into_iter().flatten().min_by_key(|limit| limit.bytes)
}

/// No system but Linux says what is left.
#[cfg(not(target_os = "linux"))]
pub fn granted() -> Option<Limit> {
    None
}

/// More memory is needed than the process may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it takes some {}, and {limit}", shown(*.needs))]
pub struct TooMuch {
    /// Bytes, as forecast.
    pub needs: u64,
    /// What the process may take.
    pub limit: Limit,
}

/// An error if so many bytes in all are more than the process may take.
///
/// # Errors
/// They are.
pub fn check(needs: u64) -> Result<(), TooMuch> {
    let limit = limit();
    if needs > limit.bytes { Err(TooMuch { needs, limit }) } else { Ok(()) }
}

/// An error if so many more bytes are more than the shell's limits leave now ([`granted`]).
///
/// # Errors
/// They are.
pub fn check_granted(needs: u64) -> Result<(), TooMuch> {
    match granted() {
        Some(limit) if needs > limit.bytes => Err(TooMuch { needs, limit }),
        _ => Ok(()),
    }
}

fn shown(bytes: u64) -> impl std::fmt::Display {
    ByteSize(bytes).display().iec()
}
