//! Curves as files, read back by what we did not write: serde_json, roxmltree, resvg, dxf, tobj and openusd.

mod command;
mod dxf_file;
mod hand_made;
mod json;
mod obj;
mod svg;
mod usda;
