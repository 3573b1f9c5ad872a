//! Figures 7 and 8 of Yasui & Kanai 2004, redone with the built-in sample: what docs/PIPELINES.md explains.
//!
//! `cargo run --release --example paper_figures -- docs/images/paper_figures.png`
//!
//! Rows: (a) interpolated polygons (their fig. 7b), (b) exact points (their fig. 7c), (c) the limit on every pixel's ray; columns:
//! polygons of level 1, 2, 3. Last row: their fig. 8, a close-up at level 3, (a) to (c) from left to right.

mod paper;
#[path = "paper/scene.rs"]
mod scene;

use catoptric::field::{Camera, Projection};
use catoptric::gpu::{Frame, Pipeline, View};
use catoptric::output::write_whole;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use paper::{EXACT, Failure, drawn_by, exit};
use std::path::PathBuf;
use std::process::ExitCode;

/// Side of a panel and width of the gutters in pixels.
const PANEL: u32 = 320;
const GUTTER: u32 = 8;
/// Levels of the polygon, and by how much the paper enlarges the viewport each way (sec. 5: 1.7^2, 1.3^2 and 1 times).
const ENLARGE: [(u32, f64); 3] = [(1, 1.7), (2, 1.3), (3, 1.0)];
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
    let (stage, view) = scene::load(None, [PANEL; 2])?;
    let whole = View { samples: 2, ..view };
    let part = |part| View { camera: close_up(&whole.camera, part), ..whole.clone() };
    let [view, close] = [FIGURE_7, FIGURE_8].map(part);
    let mut panels = Vec::new();
    for pipeline in [Pipeline::Polygon, Pipeline::Points, EXACT] {
        panels.extend(ENLARGE.map(|(level, enlarge)| drawn_by(&view, pipeline, level, enlarge)));
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

/// The part of a picture round a point of it, from the same eye.
fn close_up(camera: &Camera, (center, zoom): Part) -> Camera {
    let [w, h] = camera.size.map(f64::from);
    let ray = camera.pixel_ray(center[0] * w, center[1] * h);
    let projection = match camera.projection {
        Projection::Perspective { fov } => {
            Projection::Perspective { fov: 2.0 * ((fov.to_radians() / 2.0).tan() / zoom).atan().to_degrees() }
        }
        Projection::Orthographic { height } => Projection::Orthographic { height: height / zoom },
    };
    Camera { target: camera.eye + ray.direction * camera.eye.distance(camera.target), projection, ..*camera }
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
