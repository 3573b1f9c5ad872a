//! Curves pass through the physical reflections of the points of their light line.

use crate::bodies::{Rng, in_cube};
use crate::common::meshes;
use crate::distance;
use catoptric::curves::trace;
use catoptric::field::{Camera, Field, Light, Projection};
use catoptric::physical::{Nature, PathEnd, physical_reflections};
use catoptric::stam::LimitSurface;
use glam::DVec3;

#[test]
fn curves_pass_through_physical_reflections() {
    let mut rng = Rng::new(3);
    let (mut points, mut worst) = (0, 0.0f64);
    for mesh in meshes().into_iter().step_by(3) {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let [low, high] = surface.bounds().expect("it has patches");
        let (middle, diagonal) = (0.5 * (low + high), surface.diagonal());
        let tolerance = 1e-4 * diagonal;
        for _ in 0..3 {
            let above = middle + 0.5 * diagonal * DVec3::Z;
            let [eye, at] = [1.0, 1.2].map(|reach| above + in_cube(&mut rng) * (reach * diagonal));
            let camera = Camera {
                eye,
                target: middle,
                up: DVec3::Y,
                projection: Projection::Perspective { fov: 30.0 },
                size: [64; 2],
            };
            let light = Light::new(at, middle - at, in_cube(&mut rng), diagonal);
            // The light's point is one of the line x = c.
            let c = 0.3 * diagonal;
            let light = Light { center: light.center - c * light.axes[0] + 0.2 * diagonal * light.axes[1], ..light };
            let found = physical_reflections(&surface, PathEnd::Point(at), PathEnd::Point(eye));
            let curves = trace(&surface, &Field::reflection(light), &camera, &[(1, c)], tolerance);
            for point in found.iter().filter(|point| !matches!(point.nature, Nature::Degenerate { .. })) {
                // Round a vertex without a tangent plane there may be points at any distance, on curves shorter than the tolerance.
                let vertex = surface.class(point.patch).map(|_| surface.evaluate(point.patch, [0.0; 2]).position);
                if vertex.is_some_and(|vertex| vertex.distance(point.position) < tolerance) {
                    continue;
                }
                let off = distance(&curves, point.position);
                assert!(off <= 1.01 * tolerance, "{}: {point:?} is {off:e} from the curve", mesh.name);
                worst = worst.max(off / tolerance);
                points += 1;
            }
        }
    }
    println!("{points} points, at most {worst:.2} tolerances from the curves");
    assert!(points > 20);
}
