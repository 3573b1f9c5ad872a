//! Cameras that give no picture.

use super::{Camera, MAX_FOV, Projection};

impl Camera {
    /// Refuses a camera that nothing can be drawn or traced by, in one line. `samples`: of a pixel, each way.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check(&self, samples: u32) -> Result<(), String> {
        /// Lengths are squared, and f64 ends at some 1e308.
        const FARTHEST: f64 = 1e150;
        let Camera { eye, target, up, projection, size } = *self;
        match projection {
            Projection::Perspective { fov } if !(fov > 0.0 && fov <= MAX_FOV) => {
                return Err(format!("field of view {fov}: must be above 0 and at most {MAX_FOV} degrees"));
            }
            Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                return Err(format!("view height {height}: must be a finite length above 0"));
            }
            _ => {}
        }
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) || eye == target {
            return Err("the camera's eye and target must be two finite points".to_owned());
        }
        // Scaled, so that nothing overflows or is lost.
        let sight = target - eye;
        let scale = sight.abs().max_element();
        let distance = (sight / scale).length() * scale;
        let largest = eye.abs().max_element().max(target.abs().max_element()).max(distance);
        // Positions have 16 digits; below the last one there is nothing to see.
        let height = match projection {
            Projection::Perspective { fov } => 2.0 * distance * (fov.to_radians() * 0.5).tan(),
            Projection::Orthographic { height } => height,
        };
        let pixel = height / (f64::from(size[1]) * f64::from(samples.max(1)));
        // The fitted camera of a single point in the origin is a few of the least numbers away.
        if largest > f64::MIN_POSITIVE.sqrt() && pixel < 1e-15 * largest {
            return Err(format!(
                "a pixel would span {pixel:.0e} world units at the target, too little beside coordinates of {largest:.0e}: show a larger part"
            ));
        }
        if largest > FARTHEST {
            return Err(format!(
                "the camera's eye or target is {largest:.0e} world units away, too far to compute with; bring it nearer"
            ));
        }
        if (sight / scale).normalize().cross(up.normalize_or_zero()).length() < 1e-9 {
            return Err("the camera's up direction must not be zero or parallel to the line of sight".to_owned());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{DEFAULT_FOV, corners};
    use super::*;
    use glam::DVec3;

    #[test]
    fn cameras_without_a_picture_are_refused() {
        let fine = Camera::fit(&corners([DVec3::ZERO, DVec3::ONE]), [64, 48], DVec3::Z, DVec3::ONE, DEFAULT_FOV);
        assert_eq!(fine.check(2), Ok(()));
        let perspective = |fov: f64| Projection::Perspective { fov };
        let away = |distance: f64| Camera { eye: fine.target + DVec3::X * distance, ..fine };
        for (camera, expected) in [
            (Camera { up: DVec3::ZERO, ..fine }, "up direction"),
            (Camera { up: fine.target - fine.eye, ..fine }, "up direction"),
            (Camera { eye: fine.target, ..fine }, "two finite points"),
            (Camera { eye: DVec3::NAN, ..fine }, "two finite points"),
            (away(1e200), "too far"),
            (Camera { projection: perspective(1e-300), ..away(1e300) }, "a pixel would span"),
            (Camera { projection: perspective(180.0), ..fine }, "field of view 180"),
            (Camera { projection: Projection::Orthographic { height: 0.0 }, ..fine }, "view height 0"),
        ] {
            let message = camera.check(1).expect_err(expected);
            assert!(message.contains(expected), "{message}");
        }
    }
}
