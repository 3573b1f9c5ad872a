//! Camera and light that suit a surface, found by looking at it.

use super::camera::horizontal_axes;
use super::{Camera, DEFAULT_FOV, Field, Grid, HighlightKind, Light, Method, PlaneCurve, Point, reflection_direction};
use crate::stam::{Curvature, LimitSurface};
use glam::DVec3;

/// A surface as the automatic fit sees it: scattered limit points with normals.
#[derive(Debug, Clone)]
pub struct Scout {
    /// Corners and points of the ptex faces.
    outline: Vec<DVec3>,
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
    curvatures: Vec<Option<Curvature>>,
    /// Area that each point stands for.
    areas: Vec<f64>,
    bounds: [DVec3; 2],
}

/// Direction of sight, from the object to the eye, and light that show the built-in sample best: the fender in three-quarter
/// view, mirroring a wall of tubes behind and beside the car, whose lines run over shoulder, feature line and wheel arch.
pub fn sample_rig() -> (DVec3, Light) {
    let [center, facing, lines] = [[3.6, 2.7, 1.5], [-0.72, -0.63, -0.28], [0.38, -0.55, 0.60]].map(DVec3::from_array);
    (DVec3::new(-1.90, 2.10, 0.81), Light::new(center, facing, lines, 1.0))
}

/// Points looked at, about.
const BUDGET: usize = 40_000;
/// Points a ptex face, each way; inside it, because derivatives may be infinite at its corners.
const GRID: usize = 3;

impl Scout {
    /// Looks at a surface; `None` if it has no patch.
    pub fn new(surface: &LimitSurface) -> Option<Scout> {
        let bounds = surface.bounds()?;
        let stride = (surface.ptex_count() * GRID * GRID).div_ceil(BUDGET).max(1);
        let (mut outline, mut points, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        let (mut curvatures, mut areas) = (Vec::new(), Vec::new());
        for ptex in (0..surface.ptex_count() as u32).step_by(stride) {
            let at = |u: f64, v: f64| surface.evaluate_second_ptex(ptex, [u, v]).map(|(_, jet)| jet);
            for k in 0..GRID * GRID {
                let [u, v] = surface.folded([k % GRID, k / GRID].map(|i| (i as f64 + 0.5) / GRID as f64));
                if let Some(second) = at(u, v) {
                    let jet = second.first;
                    curvatures.push(second.curvature());
                    points.push(jet.position);
                    normals.push(jet.normal);
                    areas.push(jet.du.cross(jet.dv).length());
                }
            }
            let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let corners = corners.iter().filter(|&&(u, v)| !surface.has_triangles() || u + v <= 1.0);
            outline.extend(corners.filter_map(|&(u, v)| at(u, v)).map(|jet| jet.first.position));
        }
        outline.extend(&points);
        Some(Scout { outline, points, normals, curvatures, areas, bounds })
    }

    /// Why the surface has no area, if it has none that its coordinates can tell from rounding: the rest of a sentence, and what to do.
    pub fn without_area(&self) -> Option<String> {
        /// Length below which areas underflow, as squares of squares do.
        const TINY: f64 = 1e-75;
        let extent = (self.bounds[1] - self.bounds[0]).max_element();
        let coordinate = self.bounds.iter().fold(0.0f64, |most, corner| most.max(corner.abs().max_element()));
        // Each point carries some roundings of the largest coordinate.
        let rounding = 64.0 * f64::EPSILON * coordinate;
        let area: f64 = self.areas.iter().sum::<f64>() / (GRID * GRID) as f64;
        if extent == 0.0 {
            Some("all of it lies at one point; check the points of the file".to_owned())
        } else if extent <= rounding {
            let what = "where its coordinates are rounded; move it to the origin";
            Some(format!("it spans {extent:.0e} units at coordinates of {coordinate:.0e}, {what}"))
        } else if extent < TINY {
            Some(format!("it spans {extent:.0e} units, where areas underflow; scale it to {TINY:.0e} or more"))
        } else if area <= rounding * extent {
            Some("all its faces are folded to lines or points; check the points of the file".to_owned())
        } else {
            None
        }
    }

    /// Whether one of the points looked at falls into the picture and is not seen edge-on. Others may hide it.
    pub fn is_in_view(&self, camera: &Camera) -> bool {
        /// Sine of the angle to the line of sight below which a surface is edge-on.
        const EDGE_ON: f64 = 1e-9;
        let size = camera.size.map(f64::from);
        (0..self.points.len()).any(|i| {
            let sight = camera.sight(self.points[i]).normalize_or_zero();
            let is_inside = |[x, y]: [f64; 2]| x >= 0.0 && y >= 0.0 && x <= size[0] && y <= size[1];
            self.normals[i].dot(sight).abs() > EDGE_ON && camera.project(self.points[i]).is_some_and(is_inside)
        })
    }

    /// A camera that sees all of the surface from `direction` (from the object to the eye), vertical field of view `fov`
    /// in degrees.
    pub fn camera_from(&self, size: [u32; 2], up: DVec3, direction: DVec3, fov: f64) -> Camera {
        Camera::fit(&self.outline, size, up, direction, fov)
    }

    /// An orthographic camera that sees all of the surface from `direction` (from the object to the eye).
    pub fn orthographic_from(&self, size: [u32; 2], up: DVec3, direction: DVec3) -> Camera {
        Camera::fit_orthographic(&self.outline, size, up, direction)
    }

    /// Height of an orthographic picture of all of the surface, from this camera's eye towards its target.
    pub fn height_for(&self, camera: &Camera) -> f64 {
        camera.height_for(&self.outline)
    }

    /// The three-quarter view.
    pub fn camera(&self, size: [u32; 2], up: DVec3) -> Camera {
        self.camera_from(size, up, Camera::three_quarter(self.bounds, up), DEFAULT_FOV)
    }

    /// A field by a method, with a light that suits it and the view.
    ///
    /// What reads normals takes them from where most of the visible surface faces; sections run across the longest side. Angles are
    /// ten degrees apart, other values such that the middle half of the visible surface has five lines or so.
    pub fn field(&self, method: &Method, camera: &Camera) -> Field {
        /// Distance of lights above the surface in diagonals.
        const DISTANCE: f64 = 4.0;
        let middle = (self.bounds[0] + self.bounds[1]) * 0.5;
        let extent = self.bounds[1] - self.bounds[0];
        let diagonal = extent.length().max(f64::MIN_POSITIVE);
        let longest = self.longest();
        let seen = self.visible(camera);
        let facing: DVec3 = seen.iter().map(|&(i, w)| self.normals[i] * w).sum();
        let facing = facing.try_normalize().unwrap_or(DVec3::Z);
        let mut method = method.clone();
        let light = match &mut method {
            Method::Curve(PlaneCurve::Grid(grid)) => self.under(grid, camera),
            Method::Reflection | Method::Curve(_) | Method::RayDistance => self.light(camera),
            Method::Highlight(_) => Light::new(middle + facing * (DISTANCE * diagonal), -facing, longest, diagonal),
            Method::Isophote | Method::Curvature(_) => Light::new(middle, -facing, longest, 10.0),
            Method::Sphere(_) => Light::new(middle, -camera.up.normalize_or(DVec3::Z), longest, 10.0),
            Method::Section => {
                // Lines x = k lie across the longest side, in planes that hold the direction up.
                let up = camera.up.normalize_or(DVec3::Z);
                let across = up.cross(longest).try_normalize().unwrap_or_else(|| longest.any_orthonormal_vector());
                Light::new(middle, longest.cross(across), across, diagonal)
            }
        };
        let mut field = Field { light, method };
        let is_fitted = matches!(field.method, Method::Sphere(_) | Method::Isophote | Method::Reflection);
        if !is_fitted {
            // Distances to the nearest line depend on where the lines are.
            let plain = match field.method {
                Method::RayDistance => Field { method: Method::Reflection, ..field.clone() },
                Method::Highlight(HighlightKind::Nearest) => {
                    Field { method: Method::Highlight(HighlightKind::Array), ..field.clone() }
                }
                _ => field.clone(),
            };
            let [low, high] = self.quantiles(&plain, camera, [0.25, 0.75]);
            let spacing = (high - low) / 5.0;
            if spacing > 0.0 && spacing.is_finite() {
                field.light.spacing = spacing;
            }
        }
        field
    }

    /// A light plane whose origin, and so the middle of a grid picture, is mirrored in the middle of what is seen. A grid without
    /// a width gets one with which most of that mirrors it.
    fn under(&self, grid: &mut Grid, camera: &Camera) -> Light {
        /// Part of the mirrored points, each way, that a fitted grid holds.
        const PARTS: [f64; 3] = [0.1, 0.5, 0.9];
        let mut light = self.light(camera);
        let turned = Light { axes: [light.axes[1], -light.axes[0]], ..light };
        let seen = |light: Light| self.quantiles(&Field::reflection(light), camera, PARTS);
        let spans = [light, turned].map(seen);
        light.center += light.axes[0] * spans[0][1] + light.axes[1] * spans[1][1];
        if grid.width().is_none() {
            let [columns, rows] = grid.net().map_or([4, 4], |(size, _)| size).map(f64::from);
            // From the middle to the farther end, without the margin where it is undefined.
            let half = spans.map(|[low, middle, high]| (high - middle).max(middle - low));
            let pitch = (2.0 * half[0] / (columns - 3.0)).max(2.0 * half[1] / (rows - 3.0));
            *grid = grid.clone().wide(if pitch > 0.0 { pitch * columns } else { light.spacing });
        }
        light
    }

    /// The ends of a scale for false colours: what all but a fiftieth of the visible surface has on each side; as far from 0 on
    /// both sides where there are both signs.
    pub fn range(&self, field: &Field, camera: &Camera) -> [f64; 2] {
        let [low, high] = self.quantiles(field, camera, [0.02, 0.98]);
        if low < 0.0 && high > 0.0 {
            let most = high.max(-low);
            return [-most, most];
        }
        if low < high { [low, high] } else { [low - 0.5, low + 0.5] }
    }

    /// The first coordinate of a field at a point.
    fn value(&self, field: &Field, camera: &Camera, i: usize) -> Option<f64> {
        let position = self.points[i];
        let point =
            Point { position, normal: self.normals[i], sight: camera.sight(position), curvature: self.curvatures[i] };
        field.value(&point).map(|value| value.x)
    }

    /// Least and greatest value of a field's first coordinate at the points looked at, visible or not; `None` where it
    /// has no values.
    pub fn extremes(&self, field: &Field, camera: &Camera) -> Option<[f64; 2]> {
        let values = (0..self.points.len()).filter_map(|i| self.value(field, camera, i));
        values.map(|x| [x, x]).reduce(|[low, high], [x, _]| [low.min(x), high.max(x)])
    }

    /// Quantiles of a field's first coordinate over the visible surface; zeros where it has no values.
    pub fn quantiles<const N: usize>(&self, field: &Field, camera: &Camera, parts: [f64; N]) -> [f64; N] {
        let value = |&(i, w): &(usize, f64)| Some((self.value(field, camera, i)?, w));
        let mut values: Vec<(f64, f64)> = self.visible(camera).iter().filter_map(value).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = values.iter().map(|(_, w)| w).sum();
        parts.map(|part| {
            let mut sum = 0.0;
            let reached = values.iter().find(|(_, w)| {
                sum += w;
                sum >= part * total
            });
            reached.map_or(0.0, |(x, _)| *x)
        })
    }

    /// Middle of the object's box.
    pub fn middle(&self) -> DVec3 {
        (self.bounds[0] + self.bounds[1]) * 0.5
    }

    /// Diagonal of the object's box, greater than 0.
    pub fn diagonal(&self) -> f64 {
        (self.bounds[1] - self.bounds[0]).length().max(f64::MIN_POSITIVE)
    }

    /// Unit vectors across `up`: the one along which the object is longest, and the other one.
    pub fn horizontal(&self, up: DVec3) -> [DVec3; 2] {
        horizontal_axes(self.bounds, up)
    }

    /// The axis along which the object is longest.
    fn longest(&self) -> DVec3 {
        match self.bounds[1] - self.bounds[0] {
            e if e.x >= e.y && e.x >= e.z => DVec3::X,
            e if e.y >= e.z => DVec3::Y,
            _ => DVec3::Z,
        }
    }

    /// An infinite plane of tubes, placed so that as much as possible of what `camera` sees mirrors it, in doubt behind the
    /// eye and above it; its tubes run along the longest side of the object (on a car they flow from bonnet to boot). The
    /// spacing follows from the mirrored points themselves, so that flat and round objects show as many lines. The
    /// constants are empirical: chosen by looking at bodies of many shapes.
    pub fn light(&self, camera: &Camera) -> Light {
        /// Distance of the plane in diagonals: so far that the lines show the normals rather than the positions.
        const DISTANCE: f64 = 4.0;
        /// Tubes that the middle half of the visible surface mirrors.
        const TUBES: f64 = 5.0;
        let middle = (self.bounds[0] + self.bounds[1]) * 0.5;
        let extent = self.bounds[1] - self.bounds[0];
        let diagonal = extent.length().max(f64::MIN_POSITIVE);
        let seen = self.visible(camera);
        let direction = self.lightest(&seen, camera);
        let longest = self.longest();
        let mut light = Light::new(middle + direction * (DISTANCE * diagonal), -direction, longest, diagonal);
        let [low, high] = self.quantiles(&Field::reflection(light), camera, [0.25, 0.75]);
        let spread = high - low;
        if spread > 0.0 && spread.is_finite() {
            // A plane object mirrors less than a tube: then the spacing is not allowed to vanish.
            light.spacing = (spread / TUBES).max(1e-3 * diagonal);
        }
        light
    }

    /// The direction from which a plane light reaches most of the visible surface.
    fn lightest(&self, seen: &[(usize, f64)], camera: &Camera) -> DVec3 {
        /// Candidates, evenly over the sphere.
        const DIRECTIONS: usize = 400;
        /// Sine of the elevation over the plane below which its lines crowd at the horizon.
        const HORIZON: f64 = 0.2;
        let stride = seen.len().div_ceil(4000).max(1);
        let mirrored: Vec<(DVec3, f64)> = seen
            .iter()
            .step_by(stride)
            .map(|&(i, w)| {
                let ray = reflection_direction(self.normals[i], camera.sight(self.points[i]));
                (ray.normalize_or_zero(), w)
            })
            .collect();
        let total: f64 = mirrored.iter().map(|(_, w)| w).sum();
        let middle = (self.bounds[0] + self.bounds[1]) * 0.5;
        let up = camera.up.normalize_or_zero();
        let habit = -0.3 * camera.sight(middle).normalize_or_zero() + 0.1 * up;
        let score = |d: DVec3| {
            let lit: f64 = mirrored.iter().filter(|(r, _)| r.dot(d) > HORIZON).map(|(_, w)| w).sum();
            lit / total.max(f64::MIN_POSITIVE) + habit.dot(d)
        };
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let candidate = |k: usize| {
            let z = 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64;
            let (sin, cos) = (golden * k as f64).sin_cos();
            DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
        };
        (0..DIRECTIONS)
            .map(candidate)
            // Light from below looks wrong, whatever it reaches.
            .filter(|d| d.dot(up) > 0.1)
            .map(|d| (d, score(d)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(camera.up, |(d, _)| d)
    }

    /// Points that face the eye, with their share of the picture; all of them where most turn away (a sheet seen from
    /// behind).
    fn visible(&self, camera: &Camera) -> Vec<(usize, f64)> {
        let facing = |i: usize| {
            let sight = -camera.sight(self.points[i]);
            self.areas[i] * self.normals[i].dot(sight) / sight.length().max(f64::MIN_POSITIVE).powi(3)
        };
        let all: Vec<_> = (0..self.points.len()).map(|i| (i, facing(i))).collect();
        let sum: f64 = all.iter().map(|(_, w)| w).sum();
        let side = if sum < 0.0 { -1.0 } else { 1.0 };
        all.into_iter().map(|(i, w)| (i, side * w)).filter(|(_, w)| *w > 0.0).collect()
    }
}
