//! How far a picture of other patches is from the exact limit, pixel by pixel: normals in degrees, reflection lines in pixels.
//!
//! # Theory
//! A pixel of the other picture sees some patch at some (u,v), and these are a place of the limit surface too: the two
//! normals there enclose an angle, whichever side of a crease or silhouette the pixel happens to be on. Reflection lines are contours of
//! the field f (Ulmet 2003, Theorem RC). The exact surface has the value f at that place, the gradient g by pixels, and appears e
//! pixels beside the pixel; so where the other picture has the value f', the exact one has f - g.e, and the line of the value f' is
//! |d| / |g| pixels away, d = f' - f + g.e, to first order. Near points where g vanishes that says nothing; to second order, with h
//! the second derivative of f along g, it is the least root s > 0 of |g| s + sign(d) h s^2 / 2 = |d|. Where the field turns back
//! before it has the value, there is no such line: sqrt(2 |d| / |h|), which the root goes over into, says how far it would be from
//! the turn of a field that bends as much.
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
        let difference = value - self.value - self.gradient.dot(aside);
        if difference == 0.0 {
            return 0.0;
        }
        let (slope, bend, height) = (self.gradient.length(), self.bend * difference.signum(), difference.abs());
        let discriminant = slope * slope + 2.0 * bend * height;
        match discriminant >= 0.0 {
            true => 2.0 * height / (slope + discriminant.sqrt()),
            false => (2.0 * height / bend.abs()).sqrt(),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// On s + h s^2 / 2, where a line is is known: nearer where the field steepens, farther where it flattens.
    #[test]
    fn lines_are_where_a_parabola_has_their_value() {
        for bend in [-0.4, 0.0, 0.4] {
            let line = Line { value: 7.0, gradient: DVec2::new(0.6, 0.8), bend };
            for s in [-2.0, -0.5, 1e-9, 0.5, 2.0f64] {
                let found = line.displacement(DVec2::ZERO, 7.0 + s + 0.5 * bend * s * s);
                assert!((found - s.abs()).abs() < 1e-6, "bend {bend}: {s} {found}");
            }
        }
        // It turns back at 2.5, at a height of 1.25; from there on it goes on without a step.
        let line = Line { value: 0.0, gradient: DVec2::X, bend: -0.4 };
        let [before, beyond] = [1.25 - 1e-9, 1.25 + 1e-9].map(|value| line.displacement(DVec2::ZERO, value));
        assert!((before - 2.5).abs() < 1e-3 && (beyond - 2.5).abs() < 1e-3, "{before} {beyond}");
        // Nothing bends and nothing slopes: there is no such line.
        let flat = Line { value: 0.0, gradient: DVec2::ZERO, bend: 0.0 };
        assert_eq!([flat.displacement(DVec2::X, 0.0), flat.displacement(DVec2::X, 1.0)], [0.0, f64::INFINITY]);
    }
}
