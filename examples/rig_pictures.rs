//! Draws the pictures of docs/rigs: a sky as an equirectangular environment, and a gray picture whose contours are light curves.
//!
//! `cargo run --release --example rig_pictures -- docs/rigs`

use image::{ImageBuffer, Luma, Rgb, RgbImage};
use std::path::Path;

/// Longitude and latitude of the sun, and its radius, degrees.
const SUN: [f64; 2] = [60.0, 40.0];
const SUN_RADIUS: f64 = 9.0;

/// Colour at longitude and latitude, degrees: meridians and parallels every 30, the middle one red, a sun.
fn sky(longitude: f64, latitude: f64) -> [u8; 3] {
    let mix = |low: [f64; 3], high: [f64; 3], t: f64| {
        let mixed = |k: usize| (low[k] + (high[k] - low[k]) * t) as u8;
        [mixed(0), mixed(1), mixed(2)]
    };
    let is_line = [longitude, latitude].iter().any(|x| (x - (x / 30.0).round() * 30.0).abs() < 0.6);
    let aside = (longitude - SUN[0]) * latitude.to_radians().cos();
    match () {
        () if aside.hypot(latitude - SUN[1]) < SUN_RADIUS => [255, 240, 180],
        () if longitude.abs() < 1.2 => [220, 30, 30],
        () if is_line && latitude > 0.0 => [255; 3],
        () if is_line => [20; 3],
        () if latitude > 0.0 => mix([200.0, 220.0, 245.0], [50.0, 130.0, 220.0], latitude / 90.0),
        () => mix([90.0, 80.0, 70.0], [40.0, 35.0, 30.0], -latitude / 90.0),
    }
}

/// Gray at x and y, -1 to 1: rings that bulge five times.
fn rings(x: f64, y: f64) -> u16 {
    let gray = 0.5 * x.hypot(y) * (1.0 + 0.25 * (5.0 * y.atan2(x)).cos());
    (gray.clamp(0.0, 1.0) * f64::from(u16::MAX)) as u16
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("give the folder to write to")?;
    let middle = |k: u32, count: u32| (f64::from(k) + 0.5) / f64::from(count) - 0.5;
    let [width, height] = [1024, 512];
    let pixel = |x, y| Rgb(sky(360.0 * middle(x, width), -180.0 * middle(y, height)));
    RgbImage::from_fn(width, height, pixel).save(Path::new(&folder).join("sky.png"))?;
    const SIDE: u32 = 96;
    let texel = |x, y| Luma([rings(2.0 * middle(x, SIDE), -2.0 * middle(y, SIDE))]);
    ImageBuffer::<Luma<u16>, Vec<u16>>::from_fn(SIDE, SIDE, texel).save(Path::new(&folder).join("contours.png"))?;
    Ok(())
}
