//! A pinhole camera in f64.

use glam::{DVec3, dvec3};

/// Vertical field of view of a fitted camera, in degrees: a short telephoto lens, as product photographers use.
pub const DEFAULT_FOV: f64 = 26.0;

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
    /// Vertical field of view in degrees, between 0 and 180.
    pub fov: f64,
    /// Picture size in pixels, width and height.
    pub size: [u32; 2],
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
    /// x_ndc = scale_x * (d . right) / (d . forward), y_ndc likewise, for d = point - eye.
    pub scale: [f64; 2],
}

impl Camera {
    /// A camera that looks against `direction` (from the object to the eye) and is as near as it can be with all
    /// `points` in the picture: they reach `FILL` of its half width or half height on both sides.
    pub fn fit(points: &[DVec3], size: [u32; 2], up: DVec3, direction: DVec3, fov: f64) -> Camera {
        let forward = -direction.try_normalize().unwrap_or(DVec3::X);
        let mut camera = Camera { eye: DVec3::ZERO, target: forward, up, fov, size };
        let axes = camera.axes();
        let range = |value: &dyn Fn(DVec3) -> f64| {
            points
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &p| [low.min(value(p)), high.max(value(p))])
        };
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
        let scale_y = 1.0 / (self.fov.to_radians() * 0.5).tan();
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1]);
        Axes { right, up: right.cross(forward), forward, scale: [scale_y / aspect, scale_y] }
    }

    /// Whether lines of sight meet in the eye.
    pub fn is_perspective(&self) -> bool {
        true
    }

    /// Distance of the near plane for an object inside `bounds`: half the way to the nearest corner, and at least a
    /// ten-millionth of the box where the eye is inside it. The depth buffer is reversed and infinite (near/distance in
    /// f32), so its relative resolution is the same everywhere and no far plane is needed.
    pub fn near(&self, bounds: [DVec3; 2]) -> f64 {
        let forward = self.axes().forward;
        let nearest = corners(bounds).map(|c| (c - self.eye).dot(forward)).into_iter().fold(f64::INFINITY, f64::min);
        let diagonal = (bounds[1] - bounds[0]).length().max(f64::MIN_POSITIVE);
        (nearest * 0.5).max(diagonal * 1e-7)
    }

    /// Depth of the farthest corner of `bounds` along the line of sight.
    pub fn far(&self, bounds: [DVec3; 2]) -> f64 {
        let forward = self.axes().forward;
        corners(bounds).map(|c| (c - self.eye).dot(forward)).into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Unit direction of the ray through pixel coordinates (x right, y down; the first pixel's centre is at 0.5, 0.5).
    pub fn pixel_ray(&self, x: f64, y: f64) -> DVec3 {
        let axes = self.axes();
        let ndc_x = 2.0 * x / f64::from(self.size[0]) - 1.0;
        let ndc_y = 1.0 - 2.0 * y / f64::from(self.size[1]);
        (axes.forward + axes.right * (ndc_x / axes.scale[0]) + axes.up * (ndc_y / axes.scale[1])).normalize()
    }

    /// Pixel coordinates of a world-space point, `None` behind the eye.
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        let axes = self.axes();
        let d = point - self.eye;
        let w = d.dot(axes.forward);
        (w > 0.0).then(|| {
            let ndc = [axes.scale[0] * d.dot(axes.right) / w, axes.scale[1] * d.dot(axes.up) / w];
            [(ndc[0] + 1.0) * 0.5 * f64::from(self.size[0]), (1.0 - ndc[1]) * 0.5 * f64::from(self.size[1])]
        })
    }
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
            let camera = Camera::fit(&points, size, up, Camera::three_quarter(bounds, up), DEFAULT_FOV);
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
            assert!(camera.near(bounds) > 0.0);
        }
    }

    #[test]
    fn degenerate_objects_are_seen_from_outside() {
        for points in [vec![DVec3::ONE], vec![DVec3::ZERO, DVec3::X], vec![DVec3::ONE * 1e6; 3]] {
            let camera = Camera::fit(&points, [64, 64], DVec3::Z, DVec3::X, DEFAULT_FOV);
            assert!(camera.eye.is_finite() && camera.eye != camera.target, "{camera:?}");
        }
    }

    #[test]
    fn pixel_ray_inverts_project() {
        let camera = Camera::fit(&corners([DVec3::ZERO, DVec3::ONE]), [64, 48], DVec3::Y, DVec3::ONE, DEFAULT_FOV);
        let ray = camera.pixel_ray(10.25, 40.5);
        let [x, y] = camera.project(camera.eye + ray * 3.7).unwrap();
        assert!((x - 10.25).abs() < 1e-10 && (y - 40.5).abs() < 1e-10);
    }
}
