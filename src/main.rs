//! The `catoptric` program: see [`catoptric::cli`].

use std::process::ExitCode;

/// Missing memory is a message, not an abort.
#[global_allocator]
static ALLOCATOR: catoptric::osd::Allocator = catoptric::osd::Allocator;

fn main() -> ExitCode {
    silence_device_select();
    catoptric::cli::run()
}

/// Mesa's implicit Vulkan layer `device_select` asks Wayland for the preferred GPU and, where there is no session (a
/// container, CI), prints an error each time. We choose the adapter ourselves, so it has nothing to say: start again
/// with the layer off. A process cannot change its own environment without `unsafe`.
#[cfg(unix)]
fn silence_device_select() {
    use std::os::unix::process::CommandExt;
    const SWITCH: &str = "NODEVICE_SELECT";
    if std::env::var_os("XDG_RUNTIME_DIR").is_some() || std::env::var_os(SWITCH).is_some() {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        // A standard output that was closed is closed again, so that the program started anew sees it.
        if catoptric::osd::stdout_was_closed() {
            let _ = rustix::io::fcntl_setfd(std::io::stdout(), rustix::io::FdFlags::CLOEXEC);
        }
        // Returns only if it fails; then the noise is the lesser evil.
        let _ = std::process::Command::new(program).args(std::env::args_os().skip(1)).env(SWITCH, "1").exec();
    }
}

#[cfg(not(unix))]
fn silence_device_select() {}
