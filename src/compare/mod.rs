//! How far a picture of other patches is from the exact limit, pixel by pixel: normals in degrees, reflection lines in pixels.
//!
//! # Theory
//! Both pictures are taken on the same rays, so at every pixel the two normals enclose an angle, and the two values f of the
//! field differ by some d. Reflection lines are contours of f (Ulmet 2003, Theorem RC), so where the exact f has the gradient g on
//! the screen, the line of the same value lies |d| / |g| pixels away, to first order. Near points where g vanishes that
//! says nothing; to second order, with h the second derivative of f along g, it is the root of |g| s + |h| s^2 / 2 = |d|.
//!
//! # Practice
//! [`Reference::new`] evaluates gradient and second derivative once, in f64; [`Reference::compare`] holds any picture of the same view
//! against them.

use crate::gpu::{NO_PATCH, SurfaceImage, View};
use crate::stam::LimitSurface;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The exact surface at every pixel of a view.
#[derive(Debug, Clone)]
pub struct Reference {
    size: [u32; 2],
    pixels: Vec<Option<Pixel>>,
}

#[derive(Debug, Clone, Copy)]
struct Pixel {
    normal: DVec3,
    line: Option<Line>,
}

/// The first coordinate of the field, whose contours are the lines, at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    value: f64,
    /// Length of its gradient, by pixels.
    gradient: f64,
    /// Its second derivative along the gradient.
    bend: f64,
}

/// What differs between a picture and the exact limit. Pixels in rows from top to bottom.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Width and height.
    pub size: [u32; 2],
    /// Angle between the normals in degrees; NaN where one of the two has no surface or no normal.
    pub normal_deg: Vec<f32>,
    /// Displacement of the reflection lines in pixels; NaN where one of the two has no line.
    pub lines_px: Vec<f32>,
    /// The angles, summed up.
    pub normal: Spread,
    /// The displacements, summed up.
    pub lines: Spread,
    /// Pixels where only the exact surface is seen, and where only the other one is.
    pub only_one: [usize; 2],
}

/// Mean, 99th percentile (nearest rank) and maximum.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Spread {
    /// How many values there are.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest value.
    pub max: f64,
}

impl Spread {
    /// Of all values but NaN.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Spread {
        let mut values: Vec<f64> = values.into_iter().filter(|x| !x.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let Some(&max) = values.last() else { return Spread::default() };
        let count = values.len();
        let mean = values.iter().sum::<f64>() / count as f64;
        Spread { count, mean, p99: values[(count * 99).div_ceil(100) - 1], max }
    }
}

impl Line {
    /// Of a point of the surface; `None` where the field is undefined or the surface is seen edge on.
    fn new(surface: &LimitSurface, view: &View, patch: usize, uv: DVec2) -> Option<Line> {
        /// Part of the patch over which the gradient is taken; its error is of that order.
        const STEP: f64 = 1e-6;
        /// Pixels over which the second derivative is taken.
        const REACH: f64 = 0.5;
        let camera = &view.camera;
        let value = |uv: DVec2| {
            let jet = surface.evaluate(patch, uv.to_array());
            Some(view.field.value(jet.position, jet.normal, camera.sight(jet.position))?.x)
        };
        let here = surface.evaluate(patch, uv.to_array());
        let screen = camera.screen(here.position, [here.du, here.dv])?;
        let start = value(uv)?;
        // Inwards, where the patch goes on.
        let inwards = DVec2::select(uv.cmplt(DVec2::splat(0.5)), DVec2::splat(STEP), DVec2::splat(-STEP));
        let along = |step: DVec2| Some((value(uv + step)? - start) / (step.x + step.y));
        let by_uv = DVec2::new(along(DVec2::new(inwards.x, 0.0))?, along(DVec2::new(0.0, inwards.y))?);
        let to_uv = screen.inverse();
        let gradient = to_uv.transpose() * by_uv;
        if !gradient.is_finite() {
            return None;
        }
        let mut step = to_uv * gradient.normalize_or(DVec2::X) * REACH;
        // To the side on which there is more of the patch; a shorter way where two steps would leave it.
        let room = |step: DVec2| {
            let one = |at: f64, by: f64| if by > 0.0 { (1.0 - at) / by } else { -at / by };
            one(uv.x, step.x).min(one(uv.y, step.y))
        };
        if room(-step) > room(step) {
            step = -step;
        }
        let part = (0.5 * room(step)).min(1.0);
        let (near, far) = (value(uv + part * step)?, value(uv + 2.0 * part * step)?);
        let bend = (far - 2.0 * near + start) / (REACH * part).powi(2);
        let bend = if bend.is_finite() { bend } else { 0.0 };
        Some(Line { value: start, gradient: gradient.length(), bend })
    }

    /// Pixels from here to where the field has another value.
    fn displacement(&self, value: f64) -> f64 {
        let difference = (value - self.value).abs();
        let root = (self.gradient.powi(2) + 2.0 * self.bend.abs() * difference).sqrt();
        if difference == 0.0 { 0.0 } else { 2.0 * difference / (self.gradient + root) }
    }
}

impl Reference {
    /// From the picture that [`Gpu::inspect`](crate::gpu::Gpu::inspect) takes of the limit surface in the exact pipeline: it says
    /// where each ray meets the surface; what is there is evaluated in f64.
    pub fn new(surface: &LimitSurface, view: &View, image: &SurfaceImage) -> Reference {
        let pixel = |i: usize| {
            let patch = image.patch[i];
            (patch != NO_PATCH).then(|| {
                let (patch, uv) = (patch as usize, image.uv[i].map(f64::from));
                let normal = surface.evaluate(patch, uv).normal;
                Pixel { normal, line: Line::new(surface, view, patch, DVec2::from_array(uv)) }
            })
        };
        Reference { size: image.size, pixels: (0..image.patch.len()).into_par_iter().map(pixel).collect() }
    }

    /// Holds another picture of the same view against the exact surface.
    ///
    /// # Panics
    /// The picture has another size.
    pub fn compare(&self, image: &SurfaceImage) -> Comparison {
        assert_eq!(self.size, image.size, "a picture of the same view");
        let one = |(i, exact): (usize, &Option<Pixel>)| {
            let Some(exact) = exact.as_ref().filter(|_| image.patch[i] != NO_PATCH) else {
                return (f64::NAN, f64::NAN);
            };
            let normal = DVec3::from_array(image.normal[i].map(f64::from));
            let line = exact.line.zip(image.field[i]).map(|(line, value)| line.displacement(value.x));
            (angle_deg(normal, exact.normal), line.unwrap_or(f64::NAN))
        };
        let (normals, lines): (Vec<f64>, Vec<f64>) = self.pixels.par_iter().enumerate().map(one).unzip();
        let mut only_one = [0; 2];
        for (exact, &patch) in self.pixels.iter().zip(&image.patch) {
            match (exact.is_some(), patch != NO_PATCH) {
                (true, false) => only_one[0] += 1,
                (false, true) => only_one[1] += 1,
                _ => {}
            }
        }
        Comparison {
            size: self.size,
            normal: Spread::of(normals.iter().copied()),
            lines: Spread::of(lines.iter().copied()),
            normal_deg: normals.into_iter().map(|x| x as f32).collect(),
            lines_px: lines.into_iter().map(|x| x as f32).collect(),
            only_one,
        }
    }
}

/// Angle between two normals; NaN where one is none.
fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    match a.length_squared() > 0.0 && b.length_squared() > 0.0 {
        true => a.cross(b).length().atan2(a.dot(b)).to_degrees(),
        false => f64::NAN,
    }
}
