//! Physical reflection and the contours of Ulmet's theorem are the same points.

use crate::bodies::{Rng, in_cube};
use crate::common::meshes;
use catoptric::field::{Camera, Field, Light, Projection};
use catoptric::physical::{Nature, PathEnd, physical_reflections};
use catoptric::stam::LimitSurface;

/// The reflection field at the points that mirror P is P, in coordinates of a light plane through it: they lie on the contour
/// of the light line through P (Ulmet 2003, sec. 5), on every mesh of the project.
#[test]
fn solutions_lie_on_the_contour() {
    let mut rng = Rng::new(5);
    let (mut points, mut worst) = (0, 0.0f64);
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let [low, high] = surface.bounds().expect("it has patches");
        let (middle, diagonal) = (0.5 * (low + high), surface.diagonal());
        for case in 0..8 {
            let [eye, light] = [1.5, 2.0].map(|reach| middle + in_cube(&mut rng) * (reach * diagonal));
            let projection = match case % 2 {
                0 => Projection::Perspective { fov: 30.0 },
                _ => Projection::Orthographic { height: diagonal },
            };
            let camera = Camera { eye, target: middle, up: glam::DVec3::Z, projection, size: [64, 64] };
            let eye = if case % 2 == 0 { PathEnd::Point(eye) } else { PathEnd::Direction(eye - middle) };
            let plane = Light::new(light + in_cube(&mut rng), middle - light, in_cube(&mut rng), diagonal);
            // Through the light point, and not centred there.
            let plane =
                Light { center: plane.center - plane.normal() * (plane.center - light).dot(plane.normal()), ..plane };
            let field = Field::reflection(plane);
            for point in physical_reflections(&surface, PathEnd::Point(light), eye) {
                assert!(point.residual <= 1e-9, "{}: {point:?}", mesh.name);
                if matches!(point.nature, Nature::Degenerate { .. }) {
                    continue;
                }
                let Some(value) = field.at(&surface, &camera, point.patch, point.uv) else {
                    panic!("{}: the mirrored ray misses the plane: {point:?}", mesh.name)
                };
                let expected = plane.coordinates(light);
                let error = value.distance(expected) / expected.length().max(diagonal);
                // The residual is an angle between rays; the plane is met at a distance, and as flat as it may be.
                assert!(error <= 1e-9, "{}: {error:e} {point:?}", mesh.name);
                worst = worst.max(error);
                points += 1;
            }
        }
    }
    println!("{points} points, at most {worst:.1e} from the contour");
    assert!(points > 200);
}
