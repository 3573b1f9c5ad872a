//! OpenSubdiv's own patches: our evaluation of them, on CPU and GPU, against `Far`.

#[path = "../common/mod.rs"]
mod common;
#[path = "../gpu_support/mod.rs"]
mod gpu_support;

mod evaluation;
