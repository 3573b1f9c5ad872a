//! A camera in f64: a pinhole, or one with parallel lines of sight.

mod check;

use glam::{DMat2, DVec2, DVec3, dvec3};

/// Vertical field of view of a fitted camera, in degrees: a short telephoto lens, as product photographers use.
pub const DEFAULT_FOV: f64 = 26.0;

/// Largest vertical field of view in degrees.
pub const MAX_FOV: f64 = 179.0;

/// Part of the picture's half width and half height that a fitted object fills.
const FILL: f64 = 0.92;

/// Where the picture is taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Eye position, world space.
    pub eye: DVec3,
    /// Point that appears in the middle of the picture.
    pub target: DVec3,
    /// Direction that points up in the picture; not parallel to the line of sight.
    pub up: DVec3,
    /// How space falls on the picture.
    pub projection: Projection,
    /// Picture size in pixels, width and height.
    pub size: [u32; 2],
}

/// How space falls on the picture. Neither shows what is behind the plane through the eye across the line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Lines of sight meet in the eye.
    Perspective {
        /// Vertical field of view in degrees, between 0 and 180.
        fov: f64,
    },
    /// Lines of sight are parallel to the one from eye to target.
    Orthographic {
        /// World units that the picture's height spans, greater than 0.
        height: f64,
    },
}

/// A half-line in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes, of unit length.
    pub direction: DVec3,
}

/// Orthonormal frame of a camera, with the scales that turn camera space into normalised device coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes {
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to the top of the picture.
    pub up: DVec3,
    /// Unit vector along the line of sight.
    pub forward: DVec3,
    /// x_ndc = scale_x (d . right) / w, y_ndc likewise, for d = point - eye; w is d . forward in perspective and 1 in an
    /// orthographic view.
    pub scale: [f64; 2],
}

impl Camera {
    /// A camera that looks against `direction` (from the object to the eye) and is as near as it can be with all
    /// `points` in the picture: they reach `FILL` of its half width or half height on both sides. `fov`: vertical field of
    /// view in degrees.
    pub fn fit(points: &[DVec3], size: [u32; 2], up: DVec3, direction: DVec3, fov: f64) -> Camera {
        let forward = -direction.try_normalize().unwrap_or(DVec3::X);
        let mut camera =
            Camera { eye: DVec3::ZERO, target: forward, up, projection: Projection::Perspective { fov }, size };
        let axes = camera.axes();
        let range = |value: &dyn Fn(DVec3) -> f64| range(points, value);
        // Along each picture axis a: |(p - eye) . a| <= k (p - eye) . forward, k = FILL / scale, bounds eye . a from both
        // sides; the two meet at the nearest possible eye.
        let sides = [axes.right, axes.up].map(|axis| (axis, FILL / axes.scale[usize::from(axis == axes.up)]));
        let limits = sides.map(|(axis, k)| {
            let low = range(&|p| p.dot(axis) - k * p.dot(forward))[1];
            let high = range(&|p| p.dot(axis) + k * p.dot(forward))[0];
            (low, high, (high - low) / (2.0 * k))
        });
        let [front, back] = range(&|p| p.dot(forward));
        // A point, or points on the line of sight, would put the eye on the object.
        let clearance = (back - front).max(front.abs() * 1e-9).max(f64::MIN_POSITIVE);
        let depth = limits[0].2.min(limits[1].2).min(front - 0.05 * clearance);
        let across = sides.iter().zip(&limits).map(|((axis, _), (low, high, _))| *axis * (0.5 * (low + high)));
        camera.eye = forward * depth + across.sum::<DVec3>();
        camera.target = camera.eye + forward * (0.5 * (front + back) - depth);
        camera
    }

    /// An orthographic camera that looks against `direction` (from the object to the eye) at all `points`: they reach
    /// `FILL` of the picture's half width or half height on both sides. The eye is a diagonal of their box away, so that
    /// they stay in front of it from whatever side it looks.
    pub fn fit_orthographic(points: &[DVec3], size: [u32; 2], up: DVec3, direction: DVec3) -> Camera {
        let forward = -direction.try_normalize().unwrap_or(DVec3::X);
        let projection = Projection::Orthographic { height: 1.0 };
        let mut camera = Camera { eye: DVec3::ZERO, target: forward, up, projection, size };
        let axes = camera.axes();
        let middle = |axis: DVec3| {
            let [low, high] = range(points, &|p| p.dot(axis));
            axis * (0.5 * (low + high))
        };
        camera.target = [axes.right, axes.up, forward].map(middle).into_iter().sum();
        let extent = DVec3::AXES.map(|axis| range(points, &|p| p.dot(axis))).map(|[low, high]| high - low);
        // A single point: far enough away that eye and target differ in f64.
        let distance = DVec3::from_array(extent).length().max(camera.target.abs().max_element() * 1e-9);
        camera.eye = camera.target - forward * if distance > 0.0 { distance } else { 1.0 };
        camera.projection = Projection::Orthographic { height: camera.height_for(points) };
        camera
    }

    /// Height of an orthographic picture with all `points` in it, from this camera's eye towards its target: they reach
    /// `FILL` of its half width or half height on one side at least.
    pub fn height_for(&self, points: &[DVec3]) -> f64 {
        let axes = self.axes();
        let half = |axis: DVec3| range(points, &|p| (p - self.target).dot(axis).abs())[1];
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1]);
        let height = 2.0 / FILL * half(axes.up).max(half(axes.right) / aspect);
        // Points on the line of sight ask for nothing.
        height.max((self.target - self.eye).length() * 1e-3)
    }

    /// Direction of the three-quarter view, from the object to the eye: mostly at the long side of the box `bounds`,
    /// turned towards its front and from above, as bodywork is judged.
    pub fn three_quarter(bounds: [DVec3; 2], up: DVec3) -> DVec3 {
        let up = up.try_normalize().unwrap_or(DVec3::Z);
        let [first, second] = horizontal_axes(bounds, up);
        let horizontal = (first * 0.62 + second * 0.78).normalize();
        let elevation = 20f64.to_radians();
        horizontal * elevation.cos() + up * elevation.sin()
    }

    /// The camera's frame; a degenerate `up` or `target` is replaced by a usable one.
    pub fn axes(&self) -> Axes {
        let forward = (self.target - self.eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let right = forward.cross(self.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        let scale_y = match self.projection {
            Projection::Perspective { fov } => 1.0 / (fov.to_radians() * 0.5).tan(),
            Projection::Orthographic { height } => 2.0 / height,
        };
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1]);
        Axes { right, up: right.cross(forward), forward, scale: [scale_y / aspect, scale_y] }
    }

    /// Whether lines of sight are parallel.
    pub fn is_orthographic(&self) -> bool {
        matches!(self.projection, Projection::Orthographic { .. })
    }

    /// Vector along the line of sight to a point, world space: from the eye to it in perspective, of unit length in an
    /// orthographic view.
    pub fn sight(&self, point: DVec3) -> DVec3 {
        match self.projection {
            Projection::Perspective { .. } => point - self.eye,
            Projection::Orthographic { .. } => self.axes().forward,
        }
    }

    /// Distances from the eye, along the line of sight, between which `bounds` is seen. Near: half the way to the nearest
    /// corner in perspective, and at least a ten-millionth of the box where the eye is inside it. There the depth buffer
    /// is reversed and infinite (near/distance in f32), so its relative resolution is the same everywhere and the far
    /// distance, beyond the farthest corner, does not matter. In an orthographic view depth is linear between the two,
    /// which leave a hundredth of the box free on both sides; near is not less than 0.
    pub fn depth_range(&self, bounds: [DVec3; 2]) -> [f64; 2] {
        let forward = self.axes().forward;
        let [nearest, farthest] = range(&corners(bounds), &|c| (c - self.eye).dot(forward));
        let diagonal = (bounds[1] - bounds[0]).length().max(f64::MIN_POSITIVE);
        let margin = 0.01 * diagonal.max(1e-9 * farthest.abs());
        let near = match self.projection {
            Projection::Perspective { .. } => (nearest * 0.5).max(diagonal * 1e-7),
            Projection::Orthographic { .. } => (nearest - margin).max(0.0),
        };
        [near, (farthest + margin).max(near + margin)]
    }

    /// Line of sight through pixel coordinates (x right, y down; the first pixel's centre is at 0.5, 0.5). It starts at the
    /// eye, in an orthographic view in the plane through the eye across the line of sight.
    pub fn pixel_ray(&self, x: f64, y: f64) -> Ray {
        let axes = self.axes();
        let ndc_x = 2.0 * x / f64::from(self.size[0]) - 1.0;
        let ndc_y = 1.0 - 2.0 * y / f64::from(self.size[1]);
        let aside = axes.right * (ndc_x / axes.scale[0]) + axes.up * (ndc_y / axes.scale[1]);
        match self.projection {
            Projection::Perspective { .. } => Ray { origin: self.eye, direction: (axes.forward + aside).normalize() },
            Projection::Orthographic { .. } => Ray { origin: self.eye + aside, direction: axes.forward },
        }
    }

    /// Pixel coordinates of a world-space point, `None` behind the eye.
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        let axes = self.axes();
        let d = point - self.eye;
        let depth = d.dot(axes.forward);
        let w = if self.is_orthographic() { 1.0 } else { depth };
        (depth > 0.0).then(|| {
            let ndc = [axes.scale[0] * d.dot(axes.right) / w, axes.scale[1] * d.dot(axes.up) / w];
            [(ndc[0] + 1.0) * 0.5 * f64::from(self.size[0]), (1.0 - ndc[1]) * 0.5 * f64::from(self.size[1])]
        })
    }

    /// Derivatives of pixel coordinates by u and v, as columns, at a point with these tangents; `None` behind the eye.
    pub fn screen(&self, point: DVec3, tangents: [DVec3; 2]) -> Option<DMat2> {
        let axes = self.axes();
        let d = point - self.eye;
        let depth = d.dot(axes.forward);
        let (weight, slope) = if self.is_orthographic() { (1.0, 0.0) } else { (depth, 1.0) };
        let scale =
            DVec2::new(axes.scale[0], -axes.scale[1]) * 0.5 * DVec2::new(self.size[0].into(), self.size[1].into());
        let flat = |v: DVec3| DVec2::new(v.dot(axes.right), v.dot(axes.up));
        let [u, v] =
            tangents.map(|t| scale * (flat(t) * weight - flat(d) * (slope * t.dot(axes.forward))) / (weight * weight));
        (depth > 0.0).then(|| DMat2::from_cols(u, v))
    }
}

/// Least and greatest value over points.
fn range(points: &[DVec3], value: &dyn Fn(DVec3) -> f64) -> [f64; 2] {
    let wider = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
    points.iter().map(|&p| value(p)).fold([f64::INFINITY, f64::NEG_INFINITY], wider)
}

/// The two horizontal directions of a box standing on the plane across `up`: first the one along which it is longest.
pub(super) fn horizontal_axes(bounds: [DVec3; 2], up: DVec3) -> [DVec3; 2] {
    let size = bounds[1] - bounds[0];
    let longest = [(size.x, DVec3::X), (size.y, DVec3::Y), (size.z, DVec3::Z)]
        .into_iter()
        .filter(|(_, axis)| axis.dot(up).abs() < 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(DVec3::X, |(_, axis)| axis);
    let first = (longest - up * longest.dot(up)).normalize();
    [first, first.cross(up).normalize() * handed(first, up)]
}

/// Sign that makes the second horizontal axis point to negative coordinates: fronts of models face -y or +z by habit.
fn handed(first: DVec3, up: DVec3) -> f64 {
    let second = first.cross(up);
    let front = if up.z.abs() > 0.8 { DVec3::NEG_Y } else { DVec3::Z };
    if second.dot(front) < 0.0 { -1.0 } else { 1.0 }
}

/// The eight corners of a box.
pub(super) fn corners([low, high]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
        dvec3(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fitted_points_fill_the_picture_and_stay_inside() {
        for (size, up) in [([640, 480], DVec3::Z), ([300, 900], DVec3::Y)] {
            let bounds = [dvec3(1000.0, -502.0, 200.0), dvec3(1004.0, -500.0, 201.0)];
            let points = corners(bounds);
            let direction = Camera::three_quarter(bounds, up);
            let perspective = Camera::fit(&points, size, up, direction, DEFAULT_FOV);
            for camera in [perspective, Camera::fit_orthographic(&points, size, up, direction)] {
                let mut reach = [[0.0f64; 2]; 2];
                for point in points {
                    let pixel = camera.project(point).unwrap();
                    for k in 0..2 {
                        let ndc = 2.0 * pixel[k] / f64::from(size[k]) - 1.0;
                        reach[k] = [reach[k][0].min(ndc), reach[k][1].max(ndc)];
                    }
                }
                // As large as it can be: it reaches both sides of the tighter way, and none is passed.
                assert!(reach.as_flattened().iter().all(|x| x.abs() < FILL + 1e-9), "{reach:?}");
                assert!(reach.iter().any(|[low, high]| low + FILL < 1e-9 && FILL - high < 1e-9), "{reach:?}");
                let [near, far] = camera.depth_range(bounds);
                let depths = points.map(|p| (p - camera.eye).dot(camera.axes().forward));
                assert!(depths.into_iter().all(|depth| 0.0 < near && near < depth && depth < far), "{near} {far}");
            }
        }
    }

    #[test]
    fn degenerate_objects_are_seen_from_outside() {
        for points in [vec![DVec3::ONE], vec![DVec3::ZERO, DVec3::X], vec![DVec3::ONE * 1e6; 3], vec![DVec3::ZERO]] {
            let cameras = [
                Camera::fit(&points, [64, 64], DVec3::Z, DVec3::X, DEFAULT_FOV),
                Camera::fit_orthographic(&points, [64, 64], DVec3::Z, DVec3::X),
            ];
            for camera in cameras {
                assert!(camera.eye.is_finite() && camera.eye != camera.target, "{camera:?}");
                assert!(camera.axes().scale.iter().all(|s| s.is_finite() && *s > 0.0), "{camera:?}");
            }
        }
    }

    #[test]
    fn nothing_behind_the_eye_is_in_the_depth_range() {
        let bounds = [DVec3::ZERO, DVec3::ONE];
        let mut camera = Camera::fit_orthographic(&corners(bounds), [64, 48], DVec3::Y, DVec3::Z);
        (camera.eye.z, camera.target.z) = (0.5, 0.0);
        assert_eq!(camera.depth_range(bounds)[0], 0.0);
        assert_eq!(camera.project(dvec3(0.5, 0.5, 0.6)), None);
        (camera.eye.z, camera.target.z) = (-5.0, -6.0);
        let [near, far] = camera.depth_range(bounds);
        assert!(near == 0.0 && far > 0.0, "{near} {far}");
    }

    #[test]
    fn screen_is_the_derivative_of_project() {
        let points = corners([DVec3::ZERO, DVec3::ONE]);
        let (point, tangents) = (dvec3(0.3, 0.9, 0.2), [dvec3(0.5, 0.1, -0.7), dvec3(-0.2, 0.8, 0.3)]);
        for camera in [
            Camera::fit(&points, [64, 48], DVec3::Y, DVec3::ONE, DEFAULT_FOV),
            Camera::fit_orthographic(&points, [64, 48], DVec3::Y, DVec3::ONE),
        ] {
            let screen = camera.screen(point, tangents).unwrap();
            for (k, t) in tangents.into_iter().enumerate() {
                let [a, b] = [1e-6, -1e-6].map(|s| DVec2::from_array(camera.project(point + s * t).unwrap()));
                assert!(((a - b) / 2e-6).distance(screen.col(k)) < 1e-7, "{screen}");
            }
            assert_eq!(camera.screen(camera.eye - camera.axes().forward, tangents), None);
        }
    }

    #[test]
    fn pixel_ray_inverts_project() {
        let points = corners([DVec3::ZERO, DVec3::ONE]);
        for camera in [
            Camera::fit(&points, [64, 48], DVec3::Y, DVec3::ONE, DEFAULT_FOV),
            Camera::fit_orthographic(&points, [64, 48], DVec3::Y, DVec3::ONE),
        ] {
            let ray = camera.pixel_ray(10.25, 40.5);
            let point = ray.origin + ray.direction * 3.7;
            let [x, y] = camera.project(point).unwrap();
            assert!((x - 10.25).abs() < 1e-10 && (y - 40.5).abs() < 1e-10);
            assert!(camera.sight(point).normalize().distance(ray.direction) < 1e-14);
            assert!((ray.origin - camera.eye).dot(camera.axes().forward).abs() < 1e-14);
        }
    }
}
