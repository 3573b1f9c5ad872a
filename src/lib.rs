//! catoptric shows what the limit surface of a subdivision mesh really reflects.
//!
//! A tour in data-flow order:
//!
//! * [`mesh`]: a Catmull-Clark control mesh comes in and is validated ([`mesh::read`], [`mesh::sample`]);
//! * [`osd`]: OpenSubdiv refines its topology, and answers as the reference of the regression;
//! * [`patch`]: the refined faces whose limit has a closed form become patches;
//! * [`stam`]: class tables give the exact limit anywhere, in f64 ([`stam::LimitSurface`]);
//! * [`adaptive`]: OpenSubdiv's own patches, end caps included, as other programs show them;
//! * [`statistics`]: what errors are summed up in;
//! * [`field`]: cameras, lights and what a surface mirrors;
//! * [`curves`]: contours of a field as exact curves on the surface;
//! * [`quality`]: how its patches meet, and what that does to a field's lines;
//! * [`physical`]: the points that mirror a light point into an eye;
//! * [`rig`]: light rigs: camera, light, pattern and colours as files and presets;
//! * [`gpu`]: the same limit for every pixel, in a fragment pipeline;
//! * [`compare`]: how far a picture of other patches is from the exact one;
//! * [`verify`]: all of it compared with OpenSubdiv;
//! * [`output`]: files, written whole or not at all;
//! * [`page`]: the report of a verification as one HTML page;
//! * [`mod@bench`]: side by side with what a user could pick instead;
//! * [`cli`]: the command line.
//!
//! ```
//! use catoptric::{mesh, stam::LimitSurface};
//!
//! let surface = LimitSurface::new(&mesh::sample())?;
//! let (patch, jet) = surface.evaluate_ptex(0, [0.25, 0.75]).expect("ptex face 0 is not a hole");
//! assert!((jet.normal.length() - 1.0).abs() < 1e-12);
//! println!("{} at {} on a {} patch", jet.normal, jet.position, surface.kind(patch).name());
//! # Ok::<(), catoptric::patch::PatchError>(())
//! ```

mod absent;
pub mod adaptive;
pub mod bench;
pub mod cli;
pub mod compare;
pub mod curves;
mod digest;
pub mod field;
pub mod gpu;
mod kept;
mod line;
pub mod memory;
pub mod mesh;
mod nearest;
pub mod osd;
pub mod output;
pub mod page;
pub mod patch;
pub mod physical;
pub mod quality;
pub mod rig;
pub mod stam;
pub mod statistics;
pub mod verify;

#[cfg(test)]
mod test_meshes;
