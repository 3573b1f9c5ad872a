//! `--memory-limit`, the limits of the shell, and threads.

use super::Failure;
use crate::memory::{self, Cause, Limit};
use bytesize::ByteSize;
use clap::Args;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};

/// Bytes that any command takes beside what its mesh needs: on the sample 15 MiB beyond what is mapped at the start.
const LEAST: u64 = 24 << 20;
/// Threads beside those of the work: one for signals, one that shows progress.
const BESIDE: usize = 2;

#[derive(Debug, Args)]
pub(super) struct MemoryArgs {
    /// Memory that the command may take, such as 6GiB or 500MB: what needs more is refused beforehand [default: what is free, in
    /// the machine, its control group, and the limits of the shell]
    #[arg(long, global = true, value_name = "SIZE", value_parser = size)]
    memory_limit: Option<ByteSize>,
}

fn size(text: &str) -> Result<ByteSize, String> {
    text.parse().map_err(|_| "give a size such as 6GiB or 500MB".to_owned())
}

impl MemoryArgs {
    /// Starts the threads of the work and lets the limit hold from now on.
    pub fn apply(&self) -> Result<(), Failure> {
        if self.memory_limit == Some(ByteSize(0)) {
            return Err(Failure::Bad("--memory-limit 0: nothing fits in there; give a size above 0".to_owned()));
        }
        if memory::granted().is_some() {
            // An arena a thread takes 64 MiB of address space each, and uses next to nothing of it.
            crate::osd::share_one_arena();
        }
        start_threads();
        let granted = memory::granted();
        if let Some(limit) = granted.filter(|limit| limit.bytes < LEAST) {
            return Err(Failure::Bad(memory::TooMuch { needs: LEAST, limit }.to_string()));
        }
        let asked = self.memory_limit.map(|ByteSize(bytes)| Limit { bytes, cause: Cause::Asked });
        let limit = match asked {
            Some(asked) => [Some(asked), granted].into_iter().flatten().min_by_key(|limit| limit.bytes),
            None => memory::free(),
        };
        if let Some(limit) = limit {
            memory::set_limit(limit);
            crate::osd::on_out_of_memory(format!("; at the start {limit}"));
        }
        Ok(())
    }
}

/// Starts rayon's threads: as many as there are processors, or as are to be had (`ulimit -u`, `ulimit -v`); without any, the work is done on
/// this one. Left alone, rayon panics where it gets fewer than it wants.
fn start_threads() {
    let wanted = rayon_threads();
    let threads = granted_threads(wanted + BESIDE).saturating_sub(BESIDE);
    let pool = rayon::ThreadPoolBuilder::new();
    let pool = match threads {
        0 => pool.num_threads(1).use_current_thread(),
        _ => pool.num_threads(threads),
    };
    // Where a program that uses this as a library has started them, they stay.
    let _ = pool.build_global();
}

/// As many as rayon would start.
fn rayon_threads() -> usize {
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok()).filter(|&count| count > 0);
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// How many of so many threads the system gives: started, and ended again.
fn granted_threads(wanted: usize) -> usize {
    let (end, wait) = channel::<()>();
    let wait = Arc::new(Mutex::new(wait));
    let mut threads = Vec::with_capacity(wanted);
    for _ in 0..wanted {
        let wait = Arc::clone(&wait);
        // All are there until the channel is closed.
        let thread = std::thread::Builder::new().spawn(move || drop(wait.lock().map(|wait| wait.recv())));
        match thread {
            Ok(thread) => threads.push(thread),
            Err(_) => break,
        }
    }
    drop(end);
    let count = threads.len();
    threads.into_iter().for_each(|thread| drop(thread.join()));
    count
}
