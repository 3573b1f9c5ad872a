//! The length of the path from the light over a point to the eye: its derivatives by the point, and how they vary in a ball.

use glam::{DMat3, DVec3};

/// An end of a path of light, which may be infinitely far away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathEnd {
    /// A point, world space.
    Point(DVec3),
    /// Infinitely far away in this direction, of any length but 0: the sun, or the eye of an orthographic camera.
    Direction(DVec3),
}

impl PathEnd {
    /// Unit vector from a point to the end; zero at the end itself.
    pub fn from(&self, point: DVec3) -> DVec3 {
        match *self {
            PathEnd::Point(end) => (end - point).normalize_or_zero(),
            PathEnd::Direction(direction) => direction.normalize_or_zero(),
        }
    }

    /// One over the distance.
    fn nearness(&self, point: DVec3) -> f64 {
        match *self {
            PathEnd::Point(end) => 1.0 / end.distance(point),
            PathEnd::Direction(_) => 0.0,
        }
    }

    /// In coordinates that start at `origin`.
    pub(super) fn relative_to(&self, origin: DVec3) -> PathEnd {
        match *self {
            PathEnd::Point(end) => PathEnd::Point(end - origin),
            direction => direction,
        }
    }
}

/// The two ends of a path: light and eye, in either order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends(pub [PathEnd; 2]);

/// Derivatives of the path's length over a ball.
#[derive(Debug, Clone, Copy)]
pub(super) struct InBall {
    /// [`Ends::pull`] in the middle.
    pub pull: DVec3,
    /// Most that it differs by from there.
    pub pull_change: f64,
    /// [`Ends::bend`] in the middle.
    pub bend: DMat3,
    /// Largest norm of that.
    pub bend_most: f64,
    /// Most that it differs by from the middle.
    pub bend_change: f64,
}

impl Ends {
    pub fn relative_to(&self, origin: DVec3) -> Ends {
        Ends(self.0.map(|end| end.relative_to(origin)))
    }

    /// Sum of the unit vectors to the two ends: against the gradient of the path's length by the point.
    pub fn pull(&self, point: DVec3) -> DVec3 {
        self.0[0].from(point) + self.0[1].from(point)
    }

    /// Second derivative of the path's length by the point: the sum of (I - d d^T) / distance over the ends, d = unit vector.
    pub fn bend(&self, point: DVec3) -> DMat3 {
        let of_end = |end: &PathEnd| {
            let d = end.from(point);
            (DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z)) * end.nearness(point)
        };
        of_end(&self.0[0]) + of_end(&self.0[1])
    }

    /// Bounds over a ball; `None` where it holds an end.
    ///
    /// Seen from the ball the end keeps within an angle of sine s = radius / distance, so its unit vector within the chord
    /// (2 - 2 (1 - s^2)^(1/2))^(1/2). The third derivative of a distance r has the norm of at most 2^(1/2) / r^2: in direction w it is
    /// -((d.w)(I - d d^T) + sym(d, w across d)) / r^2, whose blocks have the norms |d.w| and |w across d|.
    pub fn over(&self, middle: DVec3, radius: f64) -> Option<InBall> {
        let mut out = InBall {
            pull: self.pull(middle),
            pull_change: 0.0,
            bend: self.bend(middle),
            bend_most: 0.0,
            bend_change: 0.0,
        };
        for end in &self.0 {
            let nearness = end.nearness(middle);
            let sine = radius * nearness;
            // At the end itself it is not a number.
            if sine >= 1.0 || sine.is_nan() {
                return None;
            }
            // 2 - 2 c = 2 s^2 / (1 + c), without cancellation.
            out.pull_change += sine * (2.0 / (1.0 + (1.0 - sine * sine).sqrt())).sqrt();
            let most = nearness / (1.0 - sine);
            out.bend_most += most;
            out.bend_change += std::f64::consts::SQRT_2 * most * most * radius;
        }
        Some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    fn ends() -> Ends {
        Ends([PathEnd::Point(dvec3(1.0, 2.0, 3.0)), PathEnd::Direction(dvec3(0.3, -0.4, 2.0))])
    }

    /// Central differences of pull: -bend.
    #[test]
    fn bend_is_the_derivative() {
        let (ends, at, step) = (ends(), dvec3(0.2, -0.1, 0.4), 1e-5);
        for axis in DVec3::AXES {
            let difference = (ends.pull(at + step * axis) - ends.pull(at - step * axis)) / (2.0 * step);
            // A third derivative times the step squared, and rounding over the step.
            assert!((difference + ends.bend(at) * axis).length() < 1e-9);
        }
    }

    /// No point of the ball exceeds the bounds, and they are no more than some times what occurs.
    #[test]
    fn balls_hold() {
        let (ends, middle) = (ends(), dvec3(0.2, -0.1, 0.4));
        for radius in [1e-3, 0.3, 2.5] {
            let ball = ends.over(middle, radius).expect("no end inside");
            let (mut pull, mut bend) = (0.0f64, 0.0f64);
            for k in 0..400 {
                let angle = f64::from(k) * 2.4;
                let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 400.0;
                let direction = dvec3(angle.cos(), angle.sin(), 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
                let point = middle + radius * direction;
                pull = pull.max(ends.pull(point).distance(ball.pull));
                let difference = ends.bend(point) - ball.bend;
                for axis in DVec3::AXES {
                    bend = bend.max((difference * axis).length());
                }
            }
            assert!(pull <= ball.pull_change && ball.pull_change < 1.1 * pull, "{radius}: {pull} {ball:?}");
            assert!(bend <= ball.bend_change, "{radius}: {bend} {ball:?}");
        }
        assert!(ends.over(dvec3(1.0, 2.0, 2.0), 1.0).is_none());
        assert!(ends.over(dvec3(1.0, 2.0, 3.0), 0.0).is_none());
    }
}
