//! The `catoptric` program: see [`catoptric::cli`].

use std::process::ExitCode;

/// Missing memory is a message, not an abort.
#[global_allocator]
static ALLOCATOR: catoptric::osd::Allocator = catoptric::osd::Allocator;

fn main() -> ExitCode {
    // Here, and not in the library, so that a commit alone compiles these lines again and nothing else. Without git, there is none.
    const COMMIT: &str =
        git_version::git_version!(args = ["--always", "--match=", "--abbrev=12", "--dirty=, changed"], fallback = "");
    catoptric::cli::run(COMMIT)
}
