//! Yasui & Kanai's own pipeline, in their order (2004, sec. 4.4, fig. 5).
//!
//! # Theory
//! The subdivided polygon is rasterised over the smallest rectangle that encloses it, with face id and parameters at each
//! fragment; one fragment program computes the exact positions, another the colours; the fragments are drawn as points of
//! one pixel. Sec. 5: where the polygon is coarse, a point lands beside the pixel that it was rasterised at; the gaps that
//! this leaves are closed by a viewport 1.7^2 (once subdivided) or 1.3^2 times (twice) larger than the picture.
//!
//! # Changes
//! Normalised tables and patch-local coordinates as in all our pipelines; colours filtered to the fragment, so that
//! pictures differ from the other pipelines' in geometry alone; with several samples a pixel the points land on the samples.
//!
//! # Practice
//! The rectangle is drawn in tiles; their points land on one picture with one depth buffer, in the same order every time.

use super::device::Device;
use super::frame::{Drawn, SurfaceImage, Timings, choose_stage, read_tile};
use super::passes::points::{Cloud, Landing};
use super::passes::{self, Colour, Passes, PictureTargets, Scene, SurfaceTargets, Visible};
use super::pool::Pool;
use super::view::{Tile, View};
use super::{GpuError, Tables};
use std::array::from_fn;

pub(super) fn draw<T: bytemuck::Pod>(
    device: &Device,
    passes: &Passes,
    tables: &Tables,
    view: &View,
    colour: Colour,
) -> Result<Drawn<T>, GpuError> {
    let mut timings = Timings::default();
    timings.time("compile", || {
        passes.prepare(device, view, colour);
        passes::rectangle::pipeline(passes, device);
        passes::points::position_pipeline(passes, device);
        passes::points::pipeline(passes, device);
    });
    let scene = timings.time("scene", || Scene::new(device, tables, view))?;
    let whole = whole(view, view.samples);
    let landing = Landing::new(device, &whole, colour);
    let rectangle = timings.time("rectangle", || passes::rectangle::run(device, passes, &scene, &whole))?;
    for tile in parts(rectangle, view.enlarge, view.samples, Tile::PICTURE_SIDE) {
        let visible = Visible::new(device, &device.pool, &tile, view.pipeline);
        let texels = PictureTargets::new(device, &device.pool, &tile, colour);
        timings.time("visibility", || passes::visibility::run(device, passes, &scene, &visible, &tile))?;
        let position = timings.time("position", || passes::points::run_position(device, passes, &scene, &visible))?;
        let stage = choose_stage(device, passes, &scene, &visible, &texels)?;
        timings.time("colour", || {
            passes::limit::run(device, passes, &scene, &visible, &texels.surface, stage)?;
            passes::shade::run(device, passes, &scene, &visible, &texels, stage)
        })?;
        let cloud = Cloud { visible: &visible, position: &position };
        timings.time("points", || passes::points::run(device, passes, &scene, &cloud, &texels, &landing, &whole))?;
    }
    timings.time("resolve", || passes::resolve::run(device, passes, &scene, &landing.picture, &whole, colour))?;
    let pixels = timings.time("read back", || device.read_texture(&landing.picture.colour))?;
    Ok(Drawn { pixels, summary: None, timings })
}

/// What landed on every pixel: its position need not be on the pixel's ray.
pub(super) fn inspect(
    device: &Device,
    passes: &Passes,
    tables: &Tables,
    view: &View,
) -> Result<SurfaceImage, GpuError> {
    let mut timings = Timings::default();
    let scene = timings.time("scene", || Scene::new(device, tables, view))?;
    let whole = whole(view, 1);
    // Nothing has landed yet: new textures are zero.
    let landed = Visible::new(device, &Pool::default(), &whole, view.pipeline);
    let rectangle = timings.time("rectangle", || passes::rectangle::run(device, passes, &scene, &whole))?;
    for tile in parts(rectangle, view.enlarge, 1, Tile::SURFACE_SIDE) {
        let visible = Visible::new(device, &device.pool, &tile, view.pipeline);
        timings.time("visibility", || passes::visibility::run(device, passes, &scene, &visible, &tile))?;
        let position = timings.time("position", || passes::points::run_position(device, passes, &scene, &visible))?;
        let cloud = Cloud { visible: &visible, position: &position };
        timings.time("points", || passes::points::run_full(device, passes, &scene, &cloud, &landed, &whole))?;
    }
    let surface = SurfaceTargets::new(device, &whole);
    timings.time("limit", || passes::limit::run_full(device, passes, &scene, &landed, &surface))?;
    let mut image = SurfaceImage::empty(view.camera.size);
    timings.time("read back", || read_tile(device, &scene, &landed, &surface, &whole, &mut image))?;
    image.timings = timings;
    Ok(image)
}

/// The picture in one piece; `View::check` keeps it small enough.
fn whole(view: &View, samples: u32) -> Tile {
    Tile { origin: [0, 0], size: view.camera.size.map(|n| n * samples), samples, enlarge: 1.0 }
}

/// Tiles of fragments, `enlarge` a sample each way, over a rectangle in samples. To the passes each is a picture of one
/// sample a pixel whose pixels are the fragments.
fn parts([low, high]: [[f32; 2]; 2], enlarge: f64, samples: u32, side: u32) -> Vec<Tile> {
    /// Rasterisers round vertices to a grid of 1/256; a fragment that this moves in still has its centre inside.
    const SNAP: f64 = 1.0 / 256.0;
    let first: [u32; 2] = from_fn(|k| (f64::from(low[k]) * enlarge - SNAP).floor().max(0.0) as u32);
    let end: [u32; 2] = from_fn(|k| (f64::from(high[k]) * enlarge + SNAP).ceil() as u32);
    if (0..2).any(|k| high[k] <= low[k]) {
        return Vec::new();
    }
    let enlarge = enlarge * f64::from(samples);
    let place = |tile: Tile| Tile { origin: from_fn(|k| tile.origin[k] + first[k]), enlarge, ..tile };
    Tile::cover(from_fn(|k| end[k] - first[k]), 1, side).into_iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_the_rectangle_and_no_more() {
        let tiles = parts([[10.2, 0.0], [19.9, 8.0]], 1.7, 2, 4);
        let area: u32 = tiles.iter().map(|tile| tile.size[0] * tile.size[1]).sum();
        // Fragments 17 to 33 across, 0 to 13 down.
        assert_eq!(area, 17 * 14);
        assert_eq!(tiles[0], Tile { origin: [17, 0], size: [4, 4], samples: 1, enlarge: 3.4 });
        assert_eq!(parts([[f32::MAX; 2], [0.0; 2]], 1.0, 1, 4), []);
        assert_eq!(parts([[64.0, 3.0], [64.0, 5.0]], 1.0, 1, 64), []);
    }
}
