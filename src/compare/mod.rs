//! How far a picture of other patches is from the exact limit, pixel by pixel: normals in degrees, reflection lines in pixels.
//!
//! # Theory
//! A pixel of the other picture sees some patch at some (u,v), and these are a place of the limit surface too: the two
//! normals there enclose an angle, whichever side of a crease or silhouette the pixel happens to be on. Reflection lines are contours of
//! the field f (Ulmet 2003, Theorem RC). The exact surface has the value f at that place, the gradient g by pixels, and appears e
//! pixels beside the pixel; so where the other picture has the value f', the exact one has f - g.e, and the line of the value f' is
//! |d| / |g| pixels away, d = f' - f + g.e, to first order. Near points where g vanishes that says nothing; to second order, with h
//! the second derivative of f along g, it is the root of |g| s + |h| s^2 / 2 = |d|.
//!
//! # Practice
//! [`Exact`] holds the surface and what the view shows of it; [`Exact::compare`] holds any picture of the same view
//! against it, in f64.

use crate::gpu::{NO_PATCH, PatchSource, SurfaceImage, View};
use crate::stam::LimitSurface;
use crate::statistics::{Spread, angle_deg};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The exact surface in a view.
#[derive(Debug, Clone, Copy)]
pub struct Exact<'a> {
    /// The surface.
    pub surface: &'a LimitSurface,
    /// The view.
    pub view: &'a View,
    /// What the view shows of the surface.
    pub image: &'a SurfaceImage,
}

/// The first coordinate of the field, whose contours are the lines, at a place of the exact surface.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    value: f64,
    /// By pixels.
    gradient: DVec2,
    /// Second derivative along the gradient.
    bend: f64,
}

/// What differs between a picture and the exact limit. Pixels in rows from top to bottom.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Width and height.
    pub size: [u32; 2],
    /// Angle between the normals in degrees; NaN where one of the two has no surface or no normal.
    pub normal_deg: Vec<f32>,
    /// Displacement of the reflection lines in pixels, at most the picture's diagonal; NaN where one of the two has no line.
    pub lines_px: Vec<f32>,
    /// The angles, summed up.
    pub normal: Spread,
    /// The displacements, summed up.
    pub lines: Spread,
    /// Pixels where only the exact surface is seen, and where only the other one is.
    pub only_one: [usize; 2],
}

/// What one pixel shows: angle between the normals, and displacement of the lines; NaN where there is none.
#[derive(Debug, Clone, Copy)]
struct Difference {
    normal_deg: f64,
    lines_px: f64,
}

impl Line {
    /// Of a point of the surface; `None` where the field is undefined or the surface is seen edge on.
    fn new(surface: &LimitSurface, view: &View, patch: usize, uv: DVec2) -> Option<Line> {
        /// Part of the patch over which the gradient is taken; its error is of that order.
        const STEP: f64 = 1e-6;
        /// Pixels over which the second derivative is taken.
        const REACH: f64 = 0.5;
        let camera = &view.camera;
        let value = |uv: DVec2| Some(view.field.at(surface, camera, patch, uv.to_array())?.x);
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
        Some(Line { value: start, gradient, bend })
    }

    /// Pixels from a point `aside` of here, in pixels, to where the field has this value.
    fn displacement(&self, aside: DVec2, value: f64) -> f64 {
        let difference = (value - self.value - self.gradient.dot(aside)).abs();
        let root = (self.gradient.length_squared() + 2.0 * self.bend.abs() * difference).sqrt();
        if difference == 0.0 { 0.0 } else { 2.0 * difference / (self.gradient.length() + root) }
    }
}

impl Exact<'_> {
    /// Holds another picture of the same view against the exact surface. `source`: where its patches came from.
    ///
    /// # Panics
    /// The picture has another size, or its patches are of another mesh.
    pub fn compare(&self, source: &dyn PatchSource, image: &SurfaceImage) -> Comparison {
        assert_eq!(self.image.size, image.size, "a picture of the same view");
        let covers = |image: &SurfaceImage, i: usize| image.patch[i] != NO_PATCH;
        let count = image.patch.len();
        let differences: Vec<Difference> = (0..count)
            .into_par_iter()
            .map(|i| match covers(image, i) && covers(self.image, i) {
                true => self.difference(source, image, i),
                false => Difference { normal_deg: f64::NAN, lines_px: f64::NAN },
            })
            .collect();
        let only = |a: &SurfaceImage, b: &SurfaceImage| (0..count).filter(|&i| covers(a, i) && !covers(b, i)).count();
        Comparison {
            size: image.size,
            normal: Spread::of(differences.iter().map(|d| d.normal_deg)),
            lines: Spread::of(differences.iter().map(|d| d.lines_px)),
            normal_deg: differences.iter().map(|d| d.normal_deg as f32).collect(),
            lines_px: differences.iter().map(|d| d.lines_px as f32).collect(),
            only_one: [only(self.image, image), only(image, self.image)],
        }
    }

    fn difference(&self, source: &dyn PatchSource, image: &SurfaceImage, i: usize) -> Difference {
        let (ptex, uv) = source.to_ptex(image.patch[i] as usize, image.uv[i].map(f64::from));
        let Some((patch, uv)) = self.surface.locate(ptex, uv) else {
            return Difference { normal_deg: f64::NAN, lines_px: f64::NAN };
        };
        let exact = self.surface.evaluate(patch, uv);
        let normal = DVec3::from_array(image.normal[i].map(f64::from));
        let lines = || {
            let line = Line::new(self.surface, self.view, patch, DVec2::from_array(uv))?;
            let width = image.size[0] as usize;
            let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            let aside = centre - DVec2::from_array(self.view.camera.project(exact.position)?);
            // Farther away than the picture is long, there is no such line.
            let farthest = f64::from(image.size[0]).hypot(image.size[1].into());
            Some(line.displacement(aside, image.field[i]?.x).min(farthest))
        };
        Difference { normal_deg: angle_deg(normal, exact.normal), lines_px: lines().unwrap_or(f64::NAN) }
    }
}
