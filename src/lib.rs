//! catoptric shows what the limit surface of a subdivision mesh really reflects.
//!
//! A tour in data-flow order.

pub mod field;
pub mod gpu;
pub mod mesh;
pub mod osd;
pub mod patch;
pub mod stam;
