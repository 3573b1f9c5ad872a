//! The fragment pipeline.
