//! What goes out: files that are written whole or not at all.

mod png;
mod whole;

pub use png::write_png;
pub use whole::{OutputError, check_writable, write_whole};
