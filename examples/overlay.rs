//! Draws the lines of an SVG over a picture, for the gallery: with resvg, which knows nothing of us.
//!
//! ```text
//! cargo run --release --example overlay -- lines.svg [view.png] out.png
//! ```
//! Without a picture the ground is white. The picture must be of the SVG's size.

use resvg::tiny_skia::{Color, Pixmap, PixmapPaint, Transform};
use resvg::usvg::{Options, Tree};
use std::error::Error;

/// Of the lines over a picture.
const RED: &str = "stroke=\"#e0102a\"";
/// As the program writes them.
const BLACK: &str = "stroke=\"#000\"";
/// How much of the picture is left under the lines.
const GROUND: f32 = 0.55;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let (svg, view, out) = match &args[..] {
        [svg, out] => (svg, None, out),
        [svg, view, out] => (svg, Some(view), out),
        _ => return Err("give lines.svg [view.png] out.png".into()),
    };
    let text = std::fs::read_to_string(svg)?;
    let text = if view.is_some() { text.replace(BLACK, RED) } else { text };
    let tree = Tree::from_str(&text, &Options::default())?;
    let size = tree.size().to_int_size();
    let mut picture = Pixmap::new(size.width(), size.height()).ok_or("the SVG has no size")?;
    picture.fill(Color::WHITE);
    if let Some(view) = view {
        let view = Pixmap::load_png(view)?;
        if (view.width(), view.height()) != (size.width(), size.height()) {
            return Err("the picture is not of the SVG's size".into());
        }
        let paint = PixmapPaint { opacity: GROUND, ..PixmapPaint::default() };
        picture.draw_pixmap(0, 0, view.as_ref(), &paint, Transform::identity(), None);
    }
    resvg::render(&tree, Transform::identity(), &mut picture.as_mut());
    picture.save_png(out)?;
    Ok(())
}
