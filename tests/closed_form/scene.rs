//! Surfaces, lights and cameras for all fields, and random places whose position and normal are known.

use crate::bodies::{Graph, Rng, in_cube};
use catoptric::field::{Camera, Field, Light, Method, Projection};
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3};

/// A plane, a parabolic cylinder, paraboloids of revolution and not, and a saddle with axes askew.
pub const GRAPHS: [Graph; 5] = [
    Graph { xx: 0.0, xy: 0.0, yy: 0.0, half: 1.0 },
    Graph { xx: 0.9, xy: 0.0, yy: 0.0, half: 1.0 },
    Graph { xx: 0.5, xy: 0.0, yy: 0.5, half: 1.5 },
    Graph { xx: 1.3, xy: 0.0, yy: 0.4, half: 1.0 },
    Graph { xx: 0.7, xy: 0.3, yy: -0.6, half: 1.2 },
];

/// What papers call it, at one point.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    pub x: f64,
    pub y: f64,
    /// R(u,v) of Ulmet, Q(u,v) of Beier & Chen.
    pub r: DVec3,
    /// The upper unit normal.
    pub n: DVec3,
    /// Unit vector to the eye: a / |a| of Ulmet, eq. 2.3.
    pub to_eye: DVec3,
}

impl Sample {
    /// Direction of the reflected ray, Ulmet 2003, eq. 4.1.
    pub fn s(&self) -> DVec3 {
        2.0 * self.to_eye.dot(self.n) * self.n - self.to_eye
    }
}

/// A method read off all graphs by random lights and cameras, at random places: `check` gets the graph, the light, the place and what
/// the field says there. The number of places with a value is returned.
pub fn everywhere(method: &Method, mut check: impl FnMut(&Graph, &Light, &Sample, Option<DVec2>)) -> usize {
    let mut rng = Rng::new(method.to_string().bytes().map(u64::from).sum());
    let mut values = 0;
    for graph in GRAPHS {
        let surface = graph.surface();
        for case in 0..8 {
            let center = in_cube(&mut rng) * 2.0 + 4.0 * DVec3::Z;
            let light = Light::new(center, in_cube(&mut rng) - 2.0 * DVec3::Z, in_cube(&mut rng), 0.3 + rng.unit());
            let projection = match case % 2 {
                0 => Projection::Perspective { fov: 30.0 },
                _ => Projection::Orthographic { height: 3.0 },
            };
            let eye = in_cube(&mut rng) * 3.0 + 4.0 * DVec3::Z;
            let camera = Camera { eye, target: in_cube(&mut rng), up: DVec3::Y, projection, size: [64; 2] };
            let field = Field { light, method: method.clone() };
            for _ in 0..100 {
                let (sample, value) = read(&graph, &surface, &field, &camera, &mut rng);
                values += usize::from(value.is_some());
                check(&graph, &light, &sample, value);
            }
        }
    }
    values
}

/// A random place of a random face; faces at the rim have no surface.
fn read(
    graph: &Graph,
    surface: &LimitSurface,
    field: &Field,
    camera: &Camera,
    rng: &mut Rng,
) -> (Sample, Option<DVec2>) {
    loop {
        let uv = [rng.unit(), rng.unit()];
        let Some((patch, uv)) = surface.locate(rng.below(surface.ptex_count()) as u32, uv) else { continue };
        let position = surface.evaluate(patch, uv).position;
        let (x, y) = (position.x, position.y);
        let r = graph.position(x, y);
        // The graph is reproduced, up to the rounding of sums of points of size 1.
        assert!(position.distance(r) < 1e-15, "{graph:?} {position} {r}");
        let to_eye = match camera.projection {
            Projection::Perspective { .. } => (camera.eye - r).normalize(),
            Projection::Orthographic { .. } => (camera.eye - camera.target).normalize(),
        };
        let sample = Sample { x, y, r, n: graph.normal(x, y), to_eye };
        return (sample, field.at(surface, camera, patch, uv));
    }
}

/// Rounding of unit normals and of what is computed from them, as an angle: control points, 1e-16, are some 1/3 apart, and differences
/// of them, sums of 16 terms and a normalisation follow.
pub const ANGLE: f64 = 1e-14;

/// A value that is there and right.
#[track_caller]
pub fn close(found: Option<DVec2>, expected: DVec2, tolerance: f64) {
    let found = found.expect("the field has a value");
    let error = (found - expected).abs().max_element();
    assert!(error <= tolerance, "{found} where {expected} is right: {error:e} off, {tolerance:e} allowed");
}
