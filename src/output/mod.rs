//! What goes out: files that are written whole or not at all.

mod whole;

pub use whole::{OutputError, write_whole};
