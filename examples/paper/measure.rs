//! How far a picture is off the limit surface on each pixel's ray, in f64.

use super::paper::{EXACT, Failure, Stage, drawn_by};
use catoptric::field::Camera;
use catoptric::gpu::{MAX_PROXY_LEVEL, NO_PATCH, SurfaceImage, View};
use catoptric::patch::Adjacency;
use catoptric::stam::Jet;
use catoptric::statistics::Spread;
use glam::{DMat2, DVec2, DVec3};
use rayon::prelude::*;

/// Distance in pixels to the ray below which a point counts as on it.
const ON_RAY: f64 = 1e-3;
/// Pixels of surface that have background within this many pixels are at the silhouette.
const RIM: isize = 3;

/// The limit surface on the ray of a pixel.
struct Point {
    normal: DVec3,
    /// Value of the field, and the gradient of its first coordinate, whose contours are the reflection lines, by pixel
    /// coordinates.
    field: Option<(DVec2, DVec2)>,
}

/// What is true at every pixel of a view.
pub struct Reference {
    size: [u32; 2],
    covered: Vec<bool>,
    /// `None` where there is no surface, or Newton's method found none.
    points: Vec<Option<Point>>,
}

/// Errors of a picture.
pub struct Errors {
    /// Pixels that lack surface: inside, and at the silhouette.
    pub missed: [usize; 2],
    /// Pixels that show surface beyond the silhouette.
    pub beyond: usize,
    /// Angle between the normals, degrees.
    pub normal: Spread,
    /// Displacement of the reflection lines, pixels: difference of the field over its gradient.
    pub lines: Spread,
}

impl Reference {
    /// Coverage, patch and first (u,v) from the exact pipeline; the point on the ray by Newton's method in f64.
    pub fn new(stage: &Stage, view: &View) -> Result<Reference, Failure> {
        // Cells of half a pixel, for as long as the exact pipeline takes its coverage from the proxy.
        let level = (view.proxy_level_for(&stage.tables) + 3).min(MAX_PROXY_LEVEL);
        let image = stage.gpu.inspect(&stage.tables, &drawn_by(view, EXACT, level, 1.0))?;
        let search = Search { stage, view, image: &image, adjacency: &stage.surface.adjacency() };
        let found = (0..image.patch.len()).into_par_iter().map(|i| match image.patch[i] {
            NO_PATCH => (false, None),
            _ => search.pixel(i),
        });
        let (covered, points) = found.unzip();
        Ok(Reference { size: image.size, covered, points })
    }

    /// Pixels of surface, and how many of them have no reference; these are not judged.
    pub fn counts(&self) -> [usize; 2] {
        let covered = self.covered.iter().filter(|&&covered| covered).count();
        [covered, covered - self.points.iter().flatten().count()]
    }

    /// What is wrong with a picture of the same view.
    pub fn errors(&self, image: &SurfaceImage) -> Errors {
        let (mut missed, mut beyond) = ([0; 2], 0);
        let (mut angles, mut shifts) = (Vec::new(), Vec::new());
        for i in 0..self.covered.len() {
            if self.covered[i] && self.points[i].is_none() {
                continue;
            }
            match (self.covered[i], image.patch[i] != NO_PATCH) {
                (true, false) => missed[usize::from(self.at_rim(i))] += 1,
                (false, true) => beyond += 1,
                (true, true) => {
                    let Some(point) = &self.points[i] else { continue };
                    let normal = DVec3::from_array(image.normal[i].map(f64::from));
                    angles.push(normal.cross(point.normal).length().atan2(normal.dot(point.normal)).to_degrees());
                    if let (Some((value, gradient)), Some(found)) = (point.field, image.field[i]) {
                        shifts.push((found.x - value.x).abs() / gradient.length());
                    }
                }
                (false, false) => (),
            }
        }
        shifts.retain(|shift| shift.is_finite());
        Errors { missed, beyond, normal: Spread::of(angles), lines: Spread::of(shifts) }
    }

    fn at_rim(&self, i: usize) -> bool {
        let [w, h] = self.size.map(|n| n as isize);
        let (x, y) = (i as isize % w, i as isize / w);
        let background =
            |x: isize, y: isize| (0..w).contains(&x) && (0..h).contains(&y) && !self.covered[(y * w + x) as usize];
        (-RIM..=RIM).any(|dy| (-RIM..=RIM).any(|dx| background(x + dx, y + dy)))
    }
}

/// Looks for the surface on rays.
struct Search<'a> {
    stage: &'a Stage,
    view: &'a View,
    image: &'a SurfaceImage,
    adjacency: &'a Adjacency,
}

impl Search<'_> {
    /// Whether a pixel that the image covers sees surface, and which.
    fn pixel(&self, i: usize) -> (bool, Option<Point>) {
        const STEPS: usize = 20;
        let camera = &self.view.camera;
        let width = self.image.size[0] as usize;
        let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let mut at = Place { patch: self.image.patch[i] as usize, uv: self.image.uv[i].map(f64::from), outside: false };
        for _ in 0..STEPS {
            let jet = self.jet(&at);
            let Some(pixel) = camera.project(jet.position) else { break };
            let step = screen(camera, &jet).inverse() * (centre - DVec2::from_array(pixel));
            if !step.is_finite() {
                break;
            }
            at = self.walk(at.patch, DVec2::from_array(at.uv) + step);
        }
        let pixel = camera.project(self.jet(&at).position).map(DVec2::from_array);
        match pixel.is_some_and(|pixel| pixel.distance(centre) < ON_RAY) {
            true => (true, Some(self.point(&at))),
            // Beyond a boundary there is none: borders of proxies are a fraction of a pixel wider than the surface.
            false => (!at.outside, None),
        }
    }

    fn jet(&self, at: &Place) -> Jet {
        self.stage.surface.evaluate(at.patch, at.uv)
    }

    /// The place at parameters that may lie beyond the patch's edges: across them, or on the boundary.
    fn walk(&self, mut patch: usize, mut uv: DVec2) -> Place {
        /// Patches crossed in a step.
        const HOPS: usize = 4;
        for _ in 0..HOPS {
            let [u, v] = uv.to_array();
            let over = [(-v, u), (u - 1.0, v), (v - 1.0, 1.0 - u), (-u, 1.0 - v)];
            let (edge, &(beyond, t)) = (0u8..).zip(&over).max_by(|a, b| a.1.0.total_cmp(&b.1.0)).expect("four edges");
            if beyond <= 0.0 {
                return Place { patch, uv: [u, v], outside: false };
            }
            let Some(neighbour) = self.adjacency.at(patch, edge, t.clamp(0.0, 1.0)) else { break };
            uv = DVec2::from_array(neighbour.carry(edge, [u, v]));
            patch = neighbour.patch as usize;
        }
        let clamped = uv.clamp(DVec2::ZERO, DVec2::ONE);
        Place { patch, uv: clamped.to_array(), outside: clamped != uv }
    }

    fn point(&self, at: &Place) -> Point {
        let camera = &self.view.camera;
        let (uv, here) = (DVec2::from_array(at.uv), self.jet(at));
        let value = |uv: DVec2| self.view.field.at(&self.stage.surface, camera, at.patch, uv.to_array());
        // One-sided differences, inwards: their error is of the order of the step.
        const STEP: f64 = 1e-6;
        let inwards = DVec2::select(uv.cmplt(DVec2::splat(0.5)), DVec2::splat(STEP), DVec2::splat(-STEP));
        let field = value(uv).and_then(|centre| {
            let by = |step: DVec2| Some((value(uv + step)?.x - centre.x) / (step.x + step.y));
            let by_uv = DVec2::new(by(DVec2::new(inwards.x, 0.0))?, by(DVec2::new(0.0, inwards.y))?);
            Some((centre, screen(camera, &here).transpose().inverse() * by_uv))
        });
        Point { normal: here.normal, field }
    }
}

/// A point of the surface.
struct Place {
    patch: usize,
    uv: [f64; 2],
    /// Put back onto a boundary.
    outside: bool,
}

/// Derivatives of pixel coordinates by u and v; NaN behind the eye.
fn screen(camera: &Camera, jet: &Jet) -> DMat2 {
    camera.screen(jet.position, [jet.du, jet.dv]).unwrap_or(DMat2::NAN)
}

/// Mean, 99th percentile and maximum as cells of a Markdown table.
pub fn cells(spread: &Spread) -> String {
    let cell = |x: f64| match x {
        0.0 => "0".to_owned(),
        x if x < 0.001 => format!("{x:.0e}"),
        x if x < 1.0 => format!("{x:.3}"),
        x if x < 100.0 => format!("{x:.1}"),
        x => format!("{x:.0}"),
    };
    [spread.mean, spread.p99, spread.max].map(cell).join(" | ")
}
