//! What goes out: files that are written whole or not at all.

mod comparison;
mod exr;
mod heat;
mod lines;
mod marks;
mod png;
mod seal;
mod sheet;
mod whole;

pub use comparison::{LINES_PX, NORMALS_DEG, comparison_panels};
pub use exr::{Layers, NO_FACE, exr_bytes, read_exr_made_by, world_to_camera, world_to_ndc, write_exr};
pub use heat::{Heat, Scale, heat, heat_of};
pub use lines::{Drawn, Lines, LinesFormat, MM_PER_PIXEL, in_picture};
pub use marks::{Canvas, Mark, Pen};
pub use png::{encode_png, png_bytes, read_png_made_by, write_png};
pub use sheet::{Panel, draw_legend, sheet};
pub(crate) use whole::Unfinished;
pub use whole::{OutputError, WriteSeek, check_writable, discard_unfinished, write_whole};

/// Keyword of the PNG text and name of the EXR attribute that say how a picture was made.
pub const MADE_BY: &str = "catoptric";
