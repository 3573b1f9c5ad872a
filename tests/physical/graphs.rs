//! On planes and quadratic graphs, which bicubics reproduce: closed forms, and a dense grid on the graph's own equation.

use crate::bodies::{Graph, Rng, in_cube};
use catoptric::physical::{PathEnd, PathPoint, physical_reflections, stationary_points};
use glam::{DMat2, DVec2, DVec3, dvec3};

/// The mirror image of the light in the plane, seen from the eye.
#[test]
fn planes_mirror_images() {
    let plane = Graph { xx: 0.0, xy: 0.0, yy: 0.0, half: 1.0 };
    let surface = plane.surface();
    let mut rng = Rng::new(7);
    let (mut inside, mut through, mut beyond) = (0, 0, 0);
    for _ in 0..300 {
        let [light, eye] = [in_cube(&mut rng), in_cube(&mut rng)].map(|p| p * dvec3(1.5, 1.5, 2.0));
        let points = stationary_points(&surface, PathEnd::Point(light), PathEnd::Point(eye));
        let mirrors = light.z * eye.z > 0.0;
        // Where the line from the light, or its image, to the eye meets the plane.
        let image = if mirrors { light * dvec3(1.0, 1.0, -1.0) } else { light };
        let foot = image + (eye - image) * (image.z / (image.z - eye.z));
        if !plane.holds(foot.x, foot.y) {
            assert!(points.is_empty(), "{light} {eye}: {points:?}");
            beyond += 1;
            continue;
        }
        let [point] = points[..] else { panic!("{light} {eye}: {points:?}") };
        // A rounding of the direction to the nearer end, times its distance, over the sine of the angle of incidence twice.
        let near = light.z.abs().min(eye.z.abs());
        let tolerance = 1e-15 * 4.0 * (1.0 + 4.0 / (near * near));
        assert!(point.position.distance(foot) < tolerance, "{light} {eye}: {} {foot}", point.position);
        assert_eq!(point.mirrors, mirrors);
        assert!(point.residual < 1e-13 / near, "{light} {eye}: {point:?}");
        if mirrors { inside += 1 } else { through += 1 }
    }
    assert!(inside > 50 && through > 50 && beyond > 50, "{inside} {through} {beyond}");
}

/// Ends infinitely far away: the normal halves the angle between the directions.
#[test]
fn directions_are_ends() {
    let bowl = Graph { xx: 0.8, xy: 0.1, yy: 0.5, half: 1.0 };
    let surface = bowl.surface();
    for [light, eye] in [[dvec3(0.1, 0.2, 1.0), dvec3(-0.4, 0.1, 2.0)], [dvec3(0.3, 0.0, 1.0), DVec3::Z]] {
        let half = light.normalize() + eye.normalize();
        // The gradient of the graph is that of the half vector: a linear system.
        let slope = DVec2::new(half.x, half.y) / -half.z;
        let at = DMat2::from_cols_array(&[bowl.xx, bowl.xy, bowl.xy, bowl.yy]).inverse() * slope;
        let points = physical_reflections(&surface, PathEnd::Direction(light), PathEnd::Direction(3.0 * eye));
        let [point] = points[..] else { panic!("{points:?}") };
        assert!(point.position.distance(bowl.position(at.x, at.y)) < 1e-13, "{point:?}");
    }
}

/// Length of the path over the graph, its gradient and Hessian by x and y, written out for z(x,y).
fn length(graph: &Graph, ends: [DVec3; 2], at: DVec2) -> (DVec2, DMat2) {
    let r = graph.position(at.x, at.y);
    let slope = DVec2::new(graph.xx * at.x + graph.xy * at.y, graph.xy * at.x + graph.yy * at.y);
    let second = DMat2::from_cols_array(&[graph.xx, graph.xy, graph.xy, graph.yy]);
    let mut gradient = DVec2::ZERO;
    let mut hessian = DMat2::ZERO;
    for end in ends {
        let d = r - end;
        let distance = d.length();
        // d(distance^2 / 2) by x and y.
        let g = DVec2::new(d.x, d.y) + d.z * slope;
        let outer = |a: DVec2| DMat2::from_cols(a * a.x, a * a.y);
        gradient += g / distance;
        hessian += (DMat2::IDENTITY + outer(slope) + second * d.z) * (1.0 / distance)
            - outer(g) * (1.0 / (distance * distance * distance));
    }
    (gradient, hessian)
}

/// Zeros of the gradient by Newton's method from every cell of a dense grid where both components may change sign.
fn by_grid(graph: &Graph, ends: [DVec3; 2]) -> Vec<DVec2> {
    const CELLS: i32 = 240;
    let step = 2.0 * graph.half / f64::from(CELLS);
    let node = |i: i32, j: i32| DVec2::new(f64::from(i), f64::from(j)) * step - graph.half;
    let mut found: Vec<DVec2> = Vec::new();
    for (i, j) in (-1..=CELLS).flat_map(|i| (-1..=CELLS).map(move |j| (i, j))) {
        let (gradient, hessian) = length(graph, ends, node(i, j) + 0.5 * step);
        let reach = DMat2::from_cols(hessian.x_axis.abs(), hessian.y_axis.abs()) * DVec2::splat(step);
        // Within a cell and a half of a zero, as the Hessian has it; twice that for its change.
        if (gradient.abs() - 2.0 * reach).max_element() > 0.0 {
            continue;
        }
        let mut at = node(i, j) + 0.5 * step;
        for _ in 0..50 {
            let (gradient, hessian) = length(graph, ends, at);
            at -= (hessian.inverse() * gradient).clamp_length_max(step);
        }
        let inside = graph.holds(at.x * (1.0 - 1e-12), at.y * (1.0 - 1e-12));
        if inside && length(graph, ends, at).0.length() < 1e-12 && found.iter().all(|p| p.distance(at) > 1e-8) {
            found.push(at);
        }
    }
    found
}

#[test]
fn graphs_agree_with_a_dense_grid() {
    let graphs = [
        Graph { xx: 1.2, xy: 0.0, yy: 0.0, half: 1.0 },
        Graph { xx: 1.5, xy: 0.0, yy: 1.0, half: 1.0 },
        Graph { xx: -0.7, xy: 0.3, yy: 1.1, half: 1.2 },
        Graph { xx: 2.5, xy: -0.4, yy: 1.9, half: 1.0 },
    ];
    let mut rng = Rng::new(11);
    let mut by_count = [0; 12];
    for graph in graphs {
        let surface = graph.surface();
        for _ in 0..25 {
            let ends = [in_cube(&mut rng), in_cube(&mut rng)].map(|p| p * 1.5 + 0.4 * DVec3::Z);
            let expected = by_grid(&graph, ends);
            let [light, eye] = ends.map(PathEnd::Point);
            let found = stationary_points(&surface, light, eye);
            assert_eq!(found.len(), expected.len(), "{graph:?} {ends:?}: {expected:?} {found:?}");
            by_count[found.len()] += 1;
            for at in &expected {
                let near = |point: &&PathPoint| point.position.distance(graph.position(at.x, at.y)) < 1e-8;
                let point = found.iter().find(near).expect("it is found");
                let sides = ends.map(|end| (end - point.position).dot(graph.normal(at.x, at.y)));
                assert_eq!(point.mirrors, sides[0] * sides[1] > 0.0);
                let saddle = length(&graph, ends, *at).1.determinant() < 0.0;
                let nature =
                    if saddle { catoptric::physical::Nature::Saddle } else { catoptric::physical::Nature::Extremum };
                assert_eq!(point.nature, nature);
            }
        }
    }
    println!("cases by number of points: {by_count:?}");
    assert!(by_count[1] > 5 && by_count[3] > 2, "{by_count:?}");
}
