//! Figures 7 and 8 of Yasui & Kanai 2004, redone with the built-in sample: what docs/PIPELINES.md explains.
//!
//! `cargo run --release --example paper_figures -- docs/images/paper_figures.png`
//!
//! Rows: (a) interpolated polygons (their fig. 7b), (b) exact points (their fig. 7c), (c) the limit on every pixel's ray; columns:
//! polygons of level 1, 2, 3. Last row: their fig. 8, a close-up at level 3, (a) to (c) from left to right.

mod paper;

use catoptric::gpu::{Frame, Pipeline, View};
use catoptric::output::write_whole;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use paper::{EXACT, Failure, Stage, close_up, drawn_by, enlargement, exit};
use std::path::PathBuf;
use std::process::ExitCode;

/// Side of a panel and width of the gutters in pixels.
const PANEL: u32 = 320;
const GUTTER: u32 = 8;
/// What the figures show of the picture of `catoptric render`: a point in parts of its sides, and how much larger.
type Part = ([f64; 2], f64);
/// The end of the wheel arch.
const FIGURE_7: Part = ([0.75, 0.70], 2.2);
/// The saddle and the pole beside it.
const FIGURE_8: Part = ([0.80, 0.645], 6.0);

fn main() -> ExitCode {
    exit("paper_figures", run())
}

fn run() -> Result<(), Failure> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(path), None) = (arguments.next().map(PathBuf::from), arguments.next()) else {
        return Err("give the PNG file to write, and nothing else".into());
    };
    let stage = Stage::load(None)?;
    let whole = View { samples: 2, ..stage.view([PANEL; 2])? };
    let part = |(center, zoom): Part| View { camera: close_up(&whole.camera, center, zoom), ..whole.clone() };
    let [view, close] = [FIGURE_7, FIGURE_8].map(part);
    let mut panels = Vec::new();
    for pipeline in [Pipeline::Polygon, Pipeline::Points, EXACT] {
        for level in [1, 2, 3] {
            panels.push(drawn_by(&view, pipeline, level, enlargement(level)));
        }
    }
    panels.extend([Pipeline::Polygon, Pipeline::Points, EXACT].map(|pipeline| drawn_by(&close, pipeline, 3, 1.0)));
    let frames: Result<Vec<Frame>, _> = panels.iter().map(|view| stage.gpu.render(&stage.tables, view)).collect();
    let (size, rgba8) = compose(&frames?, 3);
    // Small rather than fast: the picture is part of the documentation.
    write_whole(&path, |out| {
        PngEncoder::new_with_quality(out, CompressionType::Best, FilterType::Adaptive)
            .write_image(&rgba8, size[0], size[1], ExtendedColorType::Rgba8)
            .map_err(std::io::Error::other)
    })?;
    Ok(())
}

/// Panels in rows, white between them.
fn compose(frames: &[Frame], columns: u32) -> ([u32; 2], Vec<u8>) {
    let rows = (frames.len() as u32).div_ceil(columns);
    let side = |n: u32| n * (PANEL + GUTTER) - GUTTER;
    let [width, height] = [side(columns), side(rows)];
    let mut rgba8 = vec![255; 4 * (width * height) as usize];
    for (k, frame) in (0..).zip(frames) {
        let [x, y] = [k % columns, k / columns].map(|n| n * (PANEL + GUTTER));
        for (row, source) in (0..).zip(frame.rgba8.chunks_exact(4 * PANEL as usize)) {
            let start = 4 * ((y + row) * width + x) as usize;
            rgba8[start..start + source.len()].copy_from_slice(source);
        }
    }
    ([width, height], rgba8)
}
