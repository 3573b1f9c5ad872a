//! What the fuzz targets run, and `tests/fuzzed` once more on every input that is kept. Each function takes any bytes, and
//! panics where something is wrong: a crash, a message that is not one line, a number that is none.

mod draft;
mod rig;
mod surface;
mod text;
mod usd;

pub use rig::rig;
pub use surface::surface;
pub use text::{obj, samples, tags};
pub use usd::{usd_attributes, usd_file};

/// A message says in one printable line what is wrong in the file of that name.
fn check_message(message: &str, name: &str) {
    assert!(message.starts_with(name), "no file: {message}");
    assert!(message.len() > name.len() + 10, "says nothing: {message}");
    assert!(message.len() < 1000, "{} bytes: {message}", message.len());
    assert!(!message.chars().any(char::is_control), "not one line: {message:?}");
}
