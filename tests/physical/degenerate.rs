//! Caustics, curves and areas of points, ends on the surface, surfaces of no size.

use crate::bodies::{Graph, ball, quads};
use catoptric::mesh::Boundary;
use catoptric::physical::{Nature, PathEnd, physical_reflections, stationary_points};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};

/// A paraboloid of revolution of focal length 1/2: z = (x^2 + y^2) / 2.
fn bowl() -> Graph {
    Graph { xx: 1.0, xy: 0.0, yy: 1.0, half: 1.0 }
}

/// Light and eye at (0, 0, h) on the axis: their distance from the bowl squared is r^2 + (h - r^2/2)^2, stationary at r = 0 and,
/// for h > 1, on the circle r^2 = 2 (h - 1).
#[test]
fn circles_of_points_are_one_degenerate_point() {
    let surface = bowl().surface();
    let end = PathEnd::Point(dvec3(0.0, 0.0, 1.3));
    let found = physical_reflections(&surface, end, end);
    let radius = 0.6f64.sqrt();
    assert_eq!(found.len(), 2, "{found:?}");
    for point in &found {
        let r = point.position.truncate().length();
        assert!(point.residual < 1e-9, "{point:?}");
        match point.nature {
            Nature::Extremum => assert!(r < 1e-12, "{point:?}"),
            Nature::Degenerate { extent } => {
                assert!((r - radius).abs() < 1e-9, "{point:?}");
                // The diagonal of a square round the circle, to the size of the pieces, 1/16 of a bicubic or less.
                let expected = 8f64.sqrt() * radius;
                assert!(extent >= expected - 1e-9 && extent < expected + 0.1, "{point:?}");
            }
            _ => panic!("{point:?}"),
        }
    }
    // Nearly so: the light beside the axis leaves two points of the circle, and the middle.
    let beside = PathEnd::Point(dvec3(1e-4, 0.0, 1.3));
    let found = physical_reflections(&surface, beside, end);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found.iter().all(|point| !matches!(point.nature, Nature::Degenerate { .. })), "{found:?}");
}

/// The centre of curvature of the apex, h = 1: the gradient of the length grows with the cube of r.
#[test]
fn centres_of_curvature_are_degenerate_points() {
    let surface = bowl().surface();
    let end = PathEnd::Point(dvec3(0.0, 0.0, 1.0));
    let found = physical_reflections(&surface, end, end);
    let [point] = found[..] else { panic!("{found:?}") };
    let Nature::Degenerate { extent } = point.nature else { panic!("{point:?}") };
    // The point itself is as good as r^3 / 2 can be told from rounding, 1e-15 of what is added: r = 1e-5. Pieces are not, as bounds of the
    // Hessian grow with their size and not with r.
    assert!(point.position.length() < 2e-5 && extent < 0.05, "{point:?}");
}

/// From the focus every ray leaves along the axis.
#[test]
fn the_focus_lights_the_whole_bowl() {
    let surface = bowl().surface();
    let found = physical_reflections(&surface, PathEnd::Point(dvec3(0.0, 0.0, 0.5)), PathEnd::Direction(DVec3::Z));
    let [point] = found[..] else { panic!("{found:?}") };
    assert!(
        point.residual < 1e-12 && matches!(point.nature, Nature::Degenerate { extent } if extent > 2.0),
        "{point:?}"
    );
}

/// The eye on the surface sees no reflection in the point where it is; others it does.
#[test]
fn ends_on_the_surface_are_no_points() {
    let surface = bowl().surface();
    let eye = PathEnd::Point(bowl().position(0.31, -0.17));
    let found = stationary_points(&surface, PathEnd::Point(dvec3(0.1, 0.2, 3.0)), eye);
    assert!(found.iter().all(|point| point.residual < 1e-9), "{found:?}");
    let both = stationary_points(&surface, eye, eye);
    assert!(both.iter().all(|point| point.residual < 1e-9), "{both:?}");
}

/// Nothing hangs or breaks where there is no surface to speak of.
#[test]
fn collapsed_surfaces_are_answered() {
    let collapsed = quads("point", vec![DVec3::ONE; 4], &[[0, 1, 2, 3]], Boundary::EdgeAndCorner);
    let line: Vec<DVec3> = (0..4).map(|k| dvec3(f64::from(k), 0.0, 0.0)).collect();
    let line = quads("line", line, &[[0, 1, 2, 3]], Boundary::EdgeAndCorner);
    for mesh in [collapsed, line, ball("tiny", 1, |_| 1e-150), ball("huge", 1, |_| 1e12)] {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        for light in [PathEnd::Point(dvec3(0.3, 0.2, 0.9)), PathEnd::Direction(DVec3::Z), PathEnd::Point(DVec3::ONE)] {
            let found = stationary_points(&surface, light, PathEnd::Direction(dvec3(0.1, 0.3, 1.0)));
            println!("{} {light:?}: {} points", mesh.name, found.len());
            assert!(found.iter().all(|point| point.position.is_finite()));
        }
    }
}
