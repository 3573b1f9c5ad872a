//! The declarations of `ffi/osd.h`, as bindgen wrote them.
#![allow(non_camel_case_types, missing_docs, dead_code)] // C names, documented in the header
#![allow(missing_debug_implementations, clippy::undocumented_unsafe_blocks)] // generated: bit-field accessors nobody calls

include!(concat!(env!("OUT_DIR"), "/osd.rs"));
