//! Curves as a camera sees them: projected, and cut where the picture ends.

use crate::curves::Curve;
use crate::field::{Camera, Projection};
use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

/// A part of a curve in a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The last point is joined to the first, which is not repeated.
    pub closed: bool,
    /// Pixel coordinates: x to the right, y down, (0,0) the upper left corner of the picture.
    pub points: Vec<DVec2>,
}

/// Part of the distance from eye to target in front of which nothing is drawn: only what would divide by zero.
const NEAR: f64 = 1e-9;

/// A point before the division by its last coordinate: in the picture where |x| and |y| are at most w, and z, the
/// distance from the near plane, is not negative.
struct Lens {
    rows: [DVec4; 4],
    size: DVec2,
}

impl Lens {
    fn new(camera: &Camera) -> Lens {
        let axes = camera.axes();
        let row = |axis: DVec3| axis.extend(-axis.dot(camera.eye));
        let depth = row(axes.forward);
        let w = match camera.projection {
            Projection::Perspective { .. } => depth,
            Projection::Orthographic { .. } => DVec4::W,
        };
        let near = NEAR * camera.eye.distance(camera.target);
        let [sx, sy] = axes.scale;
        let rows = [row(axes.right) * sx, row(axes.up) * sy, depth - near * DVec4::W, w];
        Lens { rows, size: DVec2::from_array(camera.size.map(f64::from)) }
    }

    fn at(&self, point: DVec3) -> DVec4 {
        DVec4::from_array(self.rows.map(|row| row.dot(point.extend(1.0))))
    }

    fn pixel(&self, at: DVec4) -> DVec2 {
        let ndc = at.xy() / at.w * DVec2::new(1.0, -1.0);
        // A cut lies on the border, whatever rounding says.
        ((ndc + 1.0) * 0.5 * self.size).clamp(DVec2::ZERO, self.size)
    }
}

/// The part of a line from `a` to `b` that is in the picture, as parameters from 0 to 1 (Liang & Barsky 1984).
fn inside(a: DVec4, b: DVec4) -> Option<[f64; 2]> {
    let borders = |p: DVec4| [p.w - p.x, p.w + p.x, p.w - p.y, p.w + p.y, p.z];
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (a, b) in borders(a).into_iter().zip(borders(b)) {
        match (a < 0.0, b < 0.0) {
            (true, true) => return None,
            (true, false) => from = from.max(a / (a - b)),
            (false, true) => to = to.min(a / (a - b)),
            (false, false) => {}
        }
    }
    (from < to).then_some([from, to])
}

/// The parts of a curve that are in front of the eye and within the picture, in its order. Straight pieces between its
/// points are cut exactly at the borders. What hides them is not asked: [`crate::curves`] does that in space.
pub fn in_picture(camera: &Camera, curve: &Curve) -> Vec<Drawn> {
    let lens = Lens::new(camera);
    let points: Vec<DVec4> = curve.points.iter().map(|&point| lens.at(point)).collect();
    let count = points.len();
    let pieces = if curve.closed { count } else { count.saturating_sub(1) };
    let mut parts: Vec<Drawn> = Vec::new();
    // Whether the last part ends at the point where the next piece begins.
    let mut goes_on = false;
    let mut starts_whole = false;
    for i in 0..pieces {
        let [a, b] = [points[i], points[(i + 1) % count]];
        let Some([from, to]) = inside(a, b) else {
            goes_on = false;
            continue;
        };
        let at = |t: f64| lens.pixel(if t == 1.0 { b } else { a + (b - a) * t });
        if !(goes_on && from == 0.0) {
            starts_whole |= i == 0 && from == 0.0;
            parts.push(Drawn { closed: false, points: vec![at(from)] });
        }
        if let Some(part) = parts.last_mut() {
            part.points.push(at(to));
        }
        goes_on = to == 1.0;
    }
    if curve.closed && goes_on && starts_whole {
        // It comes back to where it started.
        match &mut parts[..] {
            [whole] => {
                whole.closed = true;
                whole.points.pop();
            }
            [first, .., last] => {
                last.points.extend(first.points.drain(..).skip(1));
                parts.remove(0);
            }
            [] => {}
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(closed: bool, points: &[[f64; 3]]) -> Curve {
        let points = points.iter().map(|&point| DVec3::from_array(point)).collect();
        Curve { value: 0.0, light: 0, closed, points, places: Vec::new() }
    }

    /// Looks along -z from height 10 at a picture 2 wide and 1 high, at the target.
    fn cameras() -> [Camera; 2] {
        let fov = 2.0 * (0.05f64).atan().to_degrees();
        [Projection::Perspective { fov }, Projection::Orthographic { height: 1.0 }].map(|projection| Camera {
            eye: DVec3::Z * 10.0,
            target: DVec3::ZERO,
            up: DVec3::Y,
            projection,
            size: [200, 100],
        })
    }

    fn close(drawn: &Drawn, closed: bool, expected: &[[f64; 2]]) {
        let far = |(a, b): (&DVec2, &[f64; 2])| a.distance(DVec2::from_array(*b)) > 1e-9;
        let same = drawn.points.len() == expected.len() && !drawn.points.iter().zip(expected).any(far);
        assert!(same && drawn.closed == closed, "{drawn:?} {expected:?}");
    }

    #[test]
    fn whole_curves_stay_whole_and_agree_with_the_projection() {
        for camera in cameras() {
            for closed in [false, true] {
                let curve = curve(closed, &[[0.1, 0.2, 1.0], [0.3, -0.2, 0.5], [-0.6, 0.1, -2.0]]);
                let project = |&point: &DVec3| camera.project(point).expect("it is seen");
                let expected: Vec<_> = curve.points.iter().map(project).collect();
                let drawn = in_picture(&camera, &curve);
                assert_eq!(drawn.len(), 1);
                close(&drawn[0], closed, &expected);
            }
        }
    }

    #[test]
    fn borders_cut_and_parts_join_over_the_start() {
        for camera in cameras() {
            // A square of side 1.2 round the middle, in the plane of the target: it leaves the picture above and below.
            let square = [[0.6, 0.0, 0.0], [0.6, 0.6, 0.0], [-0.6, 0.6, 0.0], [-0.6, -0.6, 0.0], [0.6, -0.6, 0.0]];
            let drawn = in_picture(&camera, &curve(true, &square));
            assert_eq!(drawn.len(), 2, "{drawn:?}");
            close(&drawn[0], false, &[[40.0, 0.0], [40.0, 100.0]]);
            close(&drawn[1], false, &[[160.0, 100.0], [160.0, 50.0], [160.0, 0.0]]);
            let drawn = in_picture(&camera, &curve(false, &square));
            assert_eq!(drawn.len(), 2, "{drawn:?}");
            close(&drawn[0], false, &[[160.0, 50.0], [160.0, 0.0]]);
            // Passes a corner of the picture outside, cuts one off, and lies beside the picture.
            let corner = in_picture(&camera, &curve(false, &[[0.95, 0.6, 0.0], [1.15, 0.4, 0.0]]));
            assert_eq!(corner, []);
            let corner = in_picture(&camera, &curve(false, &[[0.8, 0.6, 0.0], [1.1, 0.3, 0.0]]));
            close(&corner[0], false, &[[190.0, 0.0], [200.0, 10.0]]);
            assert_eq!(in_picture(&camera, &curve(false, &[[2.0, 0.0, 0.0], [3.0, 0.0, 0.0]])), []);
            assert_eq!(in_picture(&camera, &curve(false, &[[0.0, 0.0, 0.0]])), []);
            assert_eq!(in_picture(&camera, &curve(true, &[])), []);
        }
    }

    #[test]
    fn nothing_behind_the_eye_is_drawn() {
        let [perspective, orthographic] = cameras();
        // From the target up past the eye, a little aside: it leaves the picture where it leaves the pyramid of sight.
        let line = curve(false, &[[0.02, 0.0, 0.0], [0.02, 0.0, 20.0]]);
        let drawn = in_picture(&perspective, &line);
        assert_eq!(drawn.len(), 1);
        close(&drawn[0], false, &[[102.0, 50.0], [200.0, 50.0]]);
        // Parallel lines of sight: it ends in the plane of the eye, and falls on one point.
        let drawn = in_picture(&orthographic, &line);
        assert_eq!(drawn.len(), 1);
        close(&drawn[0], false, &[[102.0, 50.0], [102.0, 50.0]]);
        for camera in [perspective, orthographic] {
            assert_eq!(in_picture(&camera, &curve(false, &[[0.0, 0.0, 11.0], [0.1, 0.0, 12.0]])), []);
        }
        // Straight into the eye: finite to the last.
        let drawn = in_picture(&perspective, &curve(false, &[[0.0, 0.0, 0.0], [0.0, 0.0, 20.0]]));
        assert!(drawn.iter().flat_map(|part| &part.points).all(|point| point.is_finite()), "{drawn:?}");
    }
}
