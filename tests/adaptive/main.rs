//! OpenSubdiv's own patches: our evaluation of them against `Far`, and the pictures of them.

#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, reason = "each test program uses its part")]
#[path = "../gpu_support/mod.rs"]
mod gpu_support;

mod command;
mod comparison;
mod evaluation;
mod pixels;
