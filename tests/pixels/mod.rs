//! What pixels saw, compared with what their rays meet.
#![allow(dead_code, reason = "each test program uses its part")]

mod report;

pub use report::{Limits, Report};

use crate::caster::{Caster, Hit, Ray};
use crate::common::angle_deg;
use catoptric::field::Camera;
use catoptric::gpu::{Certificate, NO_PATCH, State, SurfaceImage};
use glam::DVec3;
use rayon::prelude::*;

/// Pixels within which the edge of a silhouette, boundary or layer may lie on either side of a pixel's centre: the
/// accuracy that is asked of hits, for an edge is a hit too.
pub const BAND: f64 = 0.01;
/// Pixels between two points that are not taken for one: a hundred times what is allowed.
const LAYER: f64 = 1.0;
/// Directions in which the band is looked through.
const DIRECTIONS: u32 = 16;

/// A point that a pixel saw.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    pub patch: usize,
    pub position: DVec3,
    pub normal: DVec3,
}

/// What pixels saw, rows from top to bottom.
#[derive(Debug, Clone)]
pub struct Pixels {
    pub size: [u32; 2],
    pub points: Vec<Option<Point>>,
    /// The pipeline's own certificate in pixels, where it gives one.
    pub residual: Option<Vec<f32>>,
}

impl From<&SurfaceImage> for Pixels {
    fn from(image: &SurfaceImage) -> Pixels {
        let point = |i: usize| {
            let normal = DVec3::from_array(image.normal[i].map(f64::from));
            let patch = image.patch[i];
            (patch != NO_PATCH).then(|| Point { patch: patch as usize, position: image.position[i], normal })
        };
        // A pixel in doubt counts as one without a residual.
        let own = |c: &Certificate| if c.doubtful { f32::NAN } else { c.residual };
        let certified = |c: &Certificate| matches!(c.state, State::Chart | State::Solved);
        let residual = image.certificate.iter().any(certified).then(|| image.certificate.iter().map(own).collect());
        Pixels { size: image.size, points: (0..image.patch.len()).map(point).collect(), residual }
    }
}

/// The judge of one view.
#[derive(Debug)]
pub struct Judge<'a> {
    pub caster: &'a Caster<'a>,
    pub camera: Camera,
    /// Distance of the near plane.
    near: f64,
    forward: DVec3,
    /// Size of a pixel at distance 1 along the line of sight.
    pixel: f64,
}

/// How a pixel compares.
#[derive(Debug, Clone, Copy)]
pub enum Verdict {
    /// Nothing there on either side.
    Background,
    /// One sees the surface, the other does not.
    Coverage { excused: bool },
    /// Both see the surface, but not the same layer of it, or points more than [`LAYER`] apart in the picture.
    Layer { excused: bool },
    /// The same layer.
    Same {
        /// Distance in the picture, in pixels.
        image: f64,
        /// Distance in space over the size of a pixel there: larger where the surface is seen at a slant.
        space: f64,
        /// Angle between the normals in degrees; `None` where a crease lies so near that either side's is right, or the
        /// surface has none.
        angle: Option<f64>,
    },
}

impl<'a> Judge<'a> {
    pub fn new(caster: &'a Caster<'a>, camera: Camera) -> Judge<'a> {
        let axes = camera.axes();
        let bounds = caster.surface().bounds().expect("it has patches");
        let pixel = 2.0 / (axes.scale[1] * f64::from(camera.size[1]));
        Judge { caster, camera, near: camera.depth_range(bounds)[0], forward: axes.forward, pixel }
    }

    /// First hit of the ray through pixel coordinates, beyond the near plane.
    pub fn see(&self, [x, y]: [f64; 2]) -> Option<Hit> {
        let catoptric::field::Ray { origin, direction } = self.camera.pixel_ray(x, y);
        let start = self.near / direction.dot(self.forward);
        self.caster.first_hit(&Ray { origin, direction, start })
    }

    /// What the caster itself would have drawn, looking `shift` pixels aside.
    pub fn ideal(&self, shift: [f64; 2]) -> Pixels {
        let size = self.camera.size;
        let point = |i: u32| {
            let [x, y] = centre(size, i as usize);
            let hit = self.see([x + shift[0], y + shift[1]])?;
            Some(Point { patch: hit.patch, position: hit.position, normal: hit.normal })
        };
        let points = (0..size[0] * size[1]).into_par_iter().map(point).collect();
        Pixels { size, points, residual: None }
    }

    /// Judges all pixels.
    pub fn judge(&self, name: &str, pixels: &Pixels) -> Report {
        assert_eq!(pixels.size, self.camera.size);
        let indices = (0..pixels.points.len()).into_par_iter();
        let verdicts: Vec<Verdict> = indices.map(|i| self.pixel(i, pixels.points[i])).collect();
        Report::new(name, &verdicts, pixels)
    }

    fn pixel(&self, i: usize, seen: Option<Point>) -> Verdict {
        let at = centre(self.camera.size, i);
        match (seen, self.see(at)) {
            (None, None) => Verdict::Background,
            (Some(point), Some(hit)) => self.both(at, point, hit),
            (_, hit) => {
                let around = self.around(at, BAND);
                Verdict::Coverage { excused: around.iter().any(|other| other.is_some() != hit.is_some()) }
            }
        }
    }

    fn both(&self, at: [f64; 2], point: Point, hit: Hit) -> Verdict {
        // The hit projects to the centre of the pixel.
        let place = self.camera.project(point.position);
        let image = place.map_or(f64::INFINITY, |[x, y]| (x - at[0]).hypot(y - at[1]));
        let space = point.position.distance(hit.position) / self.footprint(hit.position);
        // Seen at a slant, points that are one in the picture may be far apart in space: then the one seen must be in
        // sight from the eye.
        if image.is_nan() || image > LAYER || (space > LAYER && !self.in_sight(point.position)) {
            let excused = self.around(at, BAND).iter().any(|other| !self.continues(&hit, at, other.as_ref()));
            return Verdict::Layer { excused };
        }
        let angle = angle_deg(point.normal, hit.normal);
        let unknown = hit.normal == DVec3::ZERO;
        // Creases lie between patches.
        let excused = unknown || (angle > 0.0 && point.patch != hit.patch && self.at_crease(at, angle));
        Verdict::Same { image, space, angle: (!excused).then_some(angle) }
    }

    /// Size of a pixel at a point.
    fn footprint(&self, point: DVec3) -> f64 {
        match self.camera.is_orthographic() {
            true => self.pixel,
            false => (point - self.camera.eye).dot(self.forward) * self.pixel,
        }
    }

    /// Whether nothing hides a point.
    fn in_sight(&self, point: DVec3) -> bool {
        let [x, y] = self.camera.project(point).expect("it is seen");
        let first = self.see([x, y]);
        first.is_some_and(|hit| hit.position.distance(point) <= LAYER * self.footprint(point))
    }

    /// What rays see at a distance in pixels all round a place.
    fn around(&self, [x, y]: [f64; 2], distance: f64) -> Vec<Option<Hit>> {
        let ray = |k: u32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
            self.see([x + distance * cos, y + distance * sin])
        };
        (0..DIRECTIONS).map(ray).collect()
    }

    /// Whether another hit within the band lies on the same layer: where the tangent plane says, give or take half of the
    /// way that it goes, for curvature, and a tenth of a pixel.
    fn continues(&self, hit: &Hit, at: [f64; 2], other: Option<&Hit>) -> bool {
        let Some(other) = other else { return false };
        let sight = self.camera.sight(other.position).normalize();
        let here = (hit.position - self.camera.eye).dot(self.camera.pixel_ray(at[0], at[1]).direction);
        let beyond = (other.position - hit.position).dot(hit.normal) / sight.dot(hit.normal);
        let plane = (other.position - self.camera.eye).dot(sight) - beyond;
        beyond.abs() <= 0.5 * (plane - here).abs() + 0.1 * self.footprint(hit.position)
    }

    /// Whether normals jump within the band, by this angle or more. On a smooth surface the normals of a ring differ in proportion to its size,
    /// from ring to ring; beyond a crease a small ring sees no jump that a large one sees, and across it both see the
    /// same.
    fn at_crease(&self, at: [f64; 2], angle: f64) -> bool {
        let spread = |distance: f64| {
            let hits: Vec<Hit> = self.around(at, distance).into_iter().flatten().collect();
            let pairs = hits.iter().flat_map(|a| hits.iter().map(move |b| angle_deg(a.normal, b.normal)));
            pairs.fold(0.0, f64::max)
        };
        let [large, small] = [BAND, BAND * 0.1].map(spread);
        // 0.9: a crease is no plane.
        large >= 0.9 * angle && !(3.0..30.0).contains(&(large / small))
    }
}

/// Pixel coordinates of a pixel's centre.
fn centre(size: [u32; 2], i: usize) -> [f64; 2] {
    let [x, y] = [i % size[0] as usize, i / size[0] as usize];
    [x as f64 + 0.5, y as f64 + 0.5]
}
