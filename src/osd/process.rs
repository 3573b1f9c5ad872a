//! What only C, or `unsafe`, can say of the process or do to it. It has nothing to do with OpenSubdiv but the room that it is in.

use super::raw;
use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the process was started without a standard output (`>&-`). The standard library opens `/dev/null` in its place before `main`, and
/// nothing that is written there is ever an error.
pub fn stdout_was_closed() -> bool {
    // SAFETY: it takes nothing and reads a variable that is written before main.
    unsafe { raw::osd_stdout_was_closed() != 0 }
}

/// Lets all threads allocate from one arena (glibc), before there are any: an arena each reserves 64 MiB of address space, which matters where
/// the shell limits it, and one for all is slower where many threads allocate at once.
pub fn share_one_arena() {
    // SAFETY: it changes a setting of the allocator, which is made for that at any time.
    unsafe { raw::osd_share_one_arena() }
}

/// Lets signals that end the process (SIGSEGV and its like, from a library that reads out of bounds) end it with one line on standard error and
/// exit code 2 from now on: for programs. What is half done is lost all the same.
pub fn name_fatal_signals() {
    // SAFETY: it sets handlers that only write and end the process.
    unsafe { raw::osd_name_fatal_signals() }
}

/// The system's allocator, which ends the process with one line and exit code 2 where there is no memory, in place of an abort: for
/// programs, as their `#[global_allocator]`. What could be tried in another way without the memory is ended too.
#[derive(Debug)]
pub struct Allocator;

/// What to do about missing memory: the end of the line that [`Allocator`] writes.
static REMEDY: OnceLock<String> = OnceLock::new();

/// Says what to do about missing memory, as the end of a sentence.
pub fn on_out_of_memory(remedy: String) {
    // Said twice, the first one holds.
    let _ = REMEDY.set(remedy);
}

/// Ends the process, without memory.
#[cold]
fn out_of_memory(bytes: usize) -> ! {
    static ENDS: AtomicBool = AtomicBool::new(false);
    if ENDS.swap(true, Ordering::Relaxed) {
        // Another thread is about to end us all.
        loop {
            std::thread::sleep(std::time::Duration::from_secs(1));
        }
    }
    let mut line = [0u8; 512];
    let mut rest = &mut line[..];
    let remedy = REMEDY.get().map_or("; free memory, or take a smaller part", String::as_str);
    // What does not fit is cut off.
    let _ = writeln!(rest, "catoptric: out of memory: {bytes} more bytes are not to be had{remedy}");
    let left = rest.len();
    let written = line.len() - left;
    say(&line[..written]);
    // SAFETY: it ends the process, and touches none of its memory.
    unsafe { raw::osd_end_process(2) };
    unreachable!("the process has ended")
}

/// Writes to standard error, past the lock that another thread may hold for ever.
#[cfg(unix)]
fn say(line: &[u8]) {
    let _ = rustix::io::write(std::io::stderr(), line);
}

#[cfg(not(unix))]
fn say(line: &[u8]) {
    let _ = std::io::stderr().write_all(line);
}

fn known(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() { out_of_memory(bytes) } else { pointer }
}

// SAFETY: all of it is the system's allocator; a pointer that is returned is one of its own, and not null.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of the same function.
        known(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        known(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above; the pointer came from the system's allocator.
        known(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}
