//! The `catoptric` program: see [`catoptric::cli`].

fn main() -> std::process::ExitCode {
    catoptric::cli::run()
}
