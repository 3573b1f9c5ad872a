//! Keeps drivers off standard error while an adapter is looked for and opened.
//!
//! Mesa, its layers and the Vulkan loader print there what they think: that there is no desktop session (a line a device), that a folder for
//! shaders cannot be made, that a variable is deprecated. Each message has a variable of its own that turns it off, but a process with
//! several threads cannot change its environment safely. So standard error leads into a file without a name meanwhile, and what was
//! written there goes to the crate `log`, at level debug: nothing is lost for a program that listens.
//!
//! Standard error belongs to the whole process, so what other threads write there in these milliseconds goes the same way, and a process
//! that they start then inherits it. Standard output is never touched. With `VK_LOADER_DEBUG` somebody asks for the messages, and gets them.

use std::sync::{Mutex, PoisonError};

/// One at a time: a second one would take the first one's file for standard error.
static TURN: Mutex<()> = Mutex::new(());

/// Does what drivers print about.
pub(super) fn hushed<R>(open: impl FnOnce() -> R) -> R {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let _aside = Aside::put();
    open()
}

/// Standard error while something else stands in its place.
#[cfg(unix)]
struct Aside {
    stderr: std::os::fd::OwnedFd,
    written: std::fs::File,
}

#[cfg(unix)]
impl Aside {
    /// `None`: it is wanted, or cannot be put aside.
    fn put() -> Option<Aside> {
        /// First number of the copy: those below are the standard streams'.
        const ABOVE: i32 = 3;
        if std::env::var_os("VK_LOADER_DEBUG").is_some() {
            return None;
        }
        let written = tempfile::tempfile().or_else(|_| std::fs::File::options().write(true).open("/dev/null")).ok()?;
        let stderr = rustix::io::fcntl_dupfd_cloexec(std::io::stderr(), ABOVE).ok()?;
        rustix::stdio::dup2_stderr(&written).ok()?;
        Some(Aside { stderr, written })
    }
}

#[cfg(unix)]
impl Drop for Aside {
    fn drop(&mut self) {
        use std::io::{Read, Seek, Write};
        // A copy of an open file takes its number's place, which does not fail.
        let _ = rustix::stdio::dup2_stderr(&self.stderr);
        let mut text = Vec::new();
        if self.written.rewind().and_then(|()| self.written.read_to_end(&mut text)).is_err() {
            return;
        }
        // What a panic said must not be lost.
        if std::thread::panicking() {
            let _ = std::io::stderr().write_all(&text);
        }
        for line in String::from_utf8_lossy(&text).lines() {
            log::debug!("standard error while an adapter was opened: {line}");
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Write;

    static HEARD: Mutex<Vec<String>> = Mutex::new(Vec::new());

    struct Listener;

    impl log::Log for Listener {
        fn enabled(&self, data: &log::Metadata<'_>) -> bool {
            data.target() == "catoptric::gpu::hush"
        }

        fn log(&self, record: &log::Record<'_>) {
            if self.enabled(record.metadata()) {
                HEARD.lock().expect("nobody panics").push(record.args().to_string());
            }
        }

        fn flush(&self) {}
    }

    /// That standard error is itself again afterwards, tests/gpu_manners.rs sees from outside.
    #[test]
    fn what_is_said_is_logged() {
        log::set_logger(&Listener).expect("the only logger");
        log::set_max_level(log::LevelFilter::Debug);
        hushed(|| std::io::stderr().write_all(b"a driver thinks\nof two things\n").expect("a file takes it"));
        let heard = HEARD.lock().expect("nobody panics");
        for line in ["a driver thinks", "of two things"] {
            assert!(heard.iter().any(|heard| heard.ends_with(line)), "{heard:?}");
        }
    }
}

#[cfg(not(unix))]
struct Aside;

#[cfg(not(unix))]
impl Aside {
    fn put() -> Option<Aside> {
        None
    }
}
