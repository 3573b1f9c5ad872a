//! Joints of limit surfaces.

use crate::common::{angle_deg, corpus, meshes, on_edge};
use catoptric::field::{Method, Scout};
use catoptric::mesh::{Boundary, Crease, SubdivMesh};
use catoptric::quality::{Continuity, FeatureKind, Limits, Line, Quality, Reading, Unjudged};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};

/// A grid of faces over the points (i, j), `size` points each way.
pub fn grid(size: [u32; 2], point: impl Fn(f64, f64) -> DVec3) -> SubdivMesh {
    let [width, height] = size;
    let points = (0..width * height).map(|k| point(f64::from(k % width), f64::from(k / width))).collect();
    let faces = (0..(width - 1) * (height - 1)).map(|k| (k % (width - 1)) + width * (k / (width - 1)));
    let face_vertices: Vec<u32> = faces.flat_map(|a| [a, a + 1, a + 1 + width, a + width]).collect();
    SubdivMesh {
        name: "grid".into(),
        points,
        face_sizes: vec![4; face_vertices.len() / 4],
        face_vertices,
        boundary: Boundary::EdgeAndCorner,
        ..SubdivMesh::default()
    }
}

/// Two half-planes that meet in the line x = 2 at an angle, 0 to 180 degrees, with an infinitely sharp crease there.
pub fn roof(angle_deg: f64) -> SubdivMesh {
    let angle = angle_deg.to_radians();
    let mut mesh = grid([5, 4], |i, j| match i {
        i if i <= 2.0 => dvec3(i, j, 0.0),
        i => dvec3(2.0 + (i - 2.0) * angle.cos(), j, (i - 2.0) * angle.sin()),
    });
    let edges = (0..3).map(|j| Crease { vertices: [2 + 5 * j, 2 + 5 * (j + 1)], sharpness: 10.0 });
    mesh.creases = edges.collect();
    mesh
}

fn measure(mesh: &SubdivMesh) -> (LimitSurface, Quality) {
    let surface = LimitSurface::new(mesh).expect("it has a surface");
    let quality = Quality::measure(mesh, &surface, None, &Limits::default());
    (surface, quality)
}

#[test]
fn a_folded_plane_has_its_angle_and_nothing_else() {
    for angle in [0.0, 0.25, 10.0, 37.5, 90.0, 150.0, 179.0] {
        let (_, quality) = measure(&roof(angle));
        let [crease] = &quality.features[..] else { panic!("one crease: {:?}", quality.features) };
        assert_eq!(crease.kind, FeatureKind::Crease);
        assert_eq!(crease.sharpness, [10.0; 2]);
        let chain = crease.chain.as_ref().expect("a chain");
        assert!((&chain.vertices[..], chain.closed) == (&[2, 7, 12, 17], false), "{chain:?}");
        // Unit vectors from coordinates below 10, and their product: some 20 roundings.
        let found = crease.extremes.angle_deg.expect("normals");
        assert!((found - angle).abs() < 20.0 * f64::EPSILON.to_degrees() * 10.0, "{found} for {angle}");
        // Coordinates below 5.
        assert!(crease.extremes.gap < 4.0 * 5.0 * f64::EPSILON);
        // Flat on both sides: rounding is no difference in curvature.
        assert_eq!((crease.extremes.difference, crease.extremes.concave), (Some(0.0), false));
        assert_eq!((quality.smooth.difference, quality.smooth.undefined), (Some(0.0), 0));
        let (severity, worst) = crease.extremes.worst.expect("points");
        assert!((severity - found / 0.5).abs() < 1e-12);
        assert!(
            (worst.position.x - 2.0).abs() < 1e-14 && matches!(crease.line, Line::Edge([2, 7] | [7, 12] | [12, 17]))
        );
        // The place is where the point is.
        let surface = LimitSurface::new(&roof(angle)).expect("it has a surface");
        let place = worst.place;
        let (_, there) = surface.evaluate_ptex(place.face, [place.u, place.v]).expect("no hole");
        assert!(there.position.distance(worst.position) < 1e-14);
        assert!(quality.vertices.is_empty() && quality.unjudged == Unjudged::default());
    }
}

/// z = k x^2, as a B-spline: i^2 becomes i^2 - 1/3 (the mean of its neighbours, weighted 1/6, 2/3, 1/6, is i^2 + 1/3).
#[test]
fn a_parabolic_cylinder_is_c2_with_its_own_curvature() {
    let k = 0.15;
    let mesh = grid([9, 6], |i, j| dvec3(i, j, k * (i * i - 1.0 / 3.0)));
    let (surface, quality) = measure(&mesh);
    assert!(quality.features.is_empty() && quality.smooth.difference == Some(0.0));
    assert_eq!(quality.smooth_joints, 8 * 4 + 7 * 5);
    let adjacency = surface.adjacency();
    let mut joints = 0;
    // Faces away from the boundary, whose nets have no phantom points.
    let inner = |patch: usize| (1..7).contains(&(patch % 8)) && (1..4).contains(&(patch / 8));
    for patch in (0..surface.patches().len()).filter(|&patch| inner(patch)) {
        for n in adjacency.across(patch, 1).iter().filter(|n| inner(n.patch as usize)) {
            for t in [0.0, 0.3, 1.0] {
                let own = surface.evaluate_second(patch, on_edge(1, t));
                let other = surface.evaluate_second(n.patch as usize, n.carry(1, on_edge(1, t)));
                let joint = Continuity::new([&own, &other], own.first.dv, [0.0; 2]);
                let x = own.first.position.x;
                let expected = 2.0 * k / (1.0 + (2.0 * k * x).powi(2)).powf(1.5);
                // Second differences of points below 10 over a width of 1: 4 x 16 roundings of 10.
                let rounding = 64.0 * 10.0 * f64::EPSILON;
                let [a, b] = joint.curvature.expect("tangent planes");
                assert!((a - expected).abs() < rounding && (b - expected).abs() < rounding, "{joint:?} {expected}");
                assert!(joint.difference.expect("tangent planes") < 2.0 * rounding / expected);
                joints += 1;
            }
        }
    }
    assert_eq!(joints, 5 * 3 * 3);
}

/// A fold of finite sharpness: no break, and a radius that halves, about, with every step of sharpness.
#[test]
fn semi_sharp_creases_are_smooth_but_tightly_curved() {
    let mut before = f64::INFINITY;
    for sharpness in [1.0, 2.0, 3.0, 4.0] {
        let mut mesh = roof(60.0);
        mesh.creases.iter_mut().for_each(|crease| crease.sharpness = sharpness);
        let (_, quality) = measure(&mesh);
        let [crease] = &quality.features[..] else { panic!("one crease: {:?}", quality.features) };
        assert_eq!((crease.kind, crease.sharpness), (FeatureKind::SemiSharp, [sharpness; 2]));
        assert!(crease.extremes.severity() < 1e-6, "{:?}", crease.extremes);
        // After s levels of the sharp rule, the profile is a uniform cubic B-spline of a polygon with one corner and edges of length
        // 2^-s: at the corner r' = (p1 - p-1) / 2 and r'' = p1 - 2 p0 + p-1, both of the two unit edges.
        let edge = 0.5f64.powi(sharpness as i32);
        let half = 30f64.to_radians();
        let curvature = 2.0 * edge * half.sin() / (edge * half.cos()).powi(2);
        let radius = crease.radius.expect("a radius");
        assert!((radius * curvature - 1.0).abs() < 1e-10, "{radius} {}", 1.0 / curvature);
        assert!(radius < before);
        before = radius;
    }
}

/// Joints inside the smooth surface of every mesh are C2 but for rounding, and no figure is NaN.
#[test]
fn every_mesh_is_as_smooth_as_it_must_be() {
    let (mut joints, mut judged) = (0, 0);
    for mesh in meshes().into_iter().chain(corpus()) {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let Some(scout) = Scout::new(&surface) else { continue };
        let camera = scout.camera([640, 480], DVec3::Z);
        let field = scout.field(&Method::Reflection, &camera);
        let reading = Some(Reading { field: &field, camera: &camera });
        let limits = Limits { gap: 1e-12 * mesh.diagonal(), ..Limits::default() };
        let quality = Quality::measure(&mesh, &surface, reading, &limits);
        let smooth = &quality.smooth;
        let name = &mesh.name;
        assert!(smooth.gap <= 1e-14 * surface.diagonal(), "{name}: {smooth:?}");
        // As in tests/adjacency.rs.
        assert!(smooth.angle_deg.unwrap_or(0.0) < 1e-7 && smooth.undefined == 0, "{name}: {smooth:?}");
        assert!(smooth.difference.unwrap_or(0.0) == 0.0 && !smooth.concave, "{name}: {smooth:?}");
        if let Some(line) = smooth.line {
            // Slopes are known to a thousandth of a radian each.
            assert!(line.turn_deg.unwrap_or(0.0) < 0.12, "{name}: {line:?}");
            assert!(line.along.unwrap_or(0.0) < 1e-8 * surface.diagonal(), "{name}: {line:?}");
        }
        let line =
            |line: &catoptric::quality::LineBreak| [Some(line.jump), Some(line.lines), line.along, line.turn_deg];
        for feature in &quality.features {
            assert_ne!(feature.kind, FeatureKind::Smooth, "{name}: {feature:?}");
            let extremes = &feature.extremes;
            let figures = [Some(extremes.gap), extremes.angle_deg, extremes.difference];
            let lines = extremes.line.as_ref().map(line).unwrap_or_default();
            assert!(figures.into_iter().chain(lines).flatten().all(f64::is_finite), "{name}: {feature:?}");
            if feature.kind == FeatureKind::SemiSharp {
                assert!(extremes.severity() <= 1.0 && feature.radius.is_some_and(|r| r > 0.0), "{name}: {feature:?}");
            }
            judged += 1;
        }
        for vertex in &quality.vertices {
            let figures = [Some(vertex.gap), vertex.angle_deg, vertex.growth];
            assert!(figures.into_iter().flatten().all(f64::is_finite), "{name}: {vertex:?}");
            assert!(vertex.gap <= 1e-14 * surface.diagonal(), "{name}: {vertex:?}");
            for ring in &vertex.rings {
                let figures = [ring.distance, ring.principal[0], ring.principal[1], ring.curvature, ring.spread];
                let figures = figures.into_iter().chain(ring.turn_deg);
                assert!(figures.into_iter().all(f64::is_finite) && ring.spread <= 2.0, "{name}: {vertex:?}");
            }
            judged += 1;
        }
        joints += quality.smooth_joints;
    }
    println!("{joints} smooth joints; {judged} creases and vertices");
    assert!(joints > 5_000 && judged > 200, "{joints} {judged}");
}

/// What counts as rounding hides nothing: without the allowance, curvatures of both sides agree to a millionth as well, of themselves or
/// of the curvature of a sphere as large as the mesh.
#[test]
fn rounding_hides_no_difference() {
    let mut worst = 0.0f64;
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let adjacency = surface.adjacency();
        for (patch, edge) in (0..surface.patches().len()).flat_map(|patch| (0..4).map(move |edge| (patch, edge))) {
            for n in adjacency.across(patch, edge).iter().filter(|n| !n.sharp) {
                for part in [0.05, 0.6] {
                    let at = on_edge(edge, n.own[0] + part * (n.own[1] - n.own[0]));
                    let own = surface.evaluate_second(patch, at);
                    let other = surface.evaluate_second(n.patch as usize, n.carry(edge, at));
                    let along = if edge % 2 == 0 { own.first.du } else { own.first.dv };
                    let joint = Continuity::new([&own, &other], along, [0.0; 2]);
                    let [a, b] = joint.curvature.expect("tangent planes");
                    worst = worst.max((a - b).abs() / a.abs().max(b.abs()).max(1.0 / surface.diagonal()));
                    assert!(angle_deg(own.first.normal, other.first.normal) < 1e-7);
                }
            }
        }
    }
    println!("largest relative difference {worst:e}");
    // Second differences of the narrowest strips, 2^-10 of a face: 64 roundings times 2^20.
    assert!(worst < 64.0 * f64::EPSILON * f64::from(1 << 20) * 100.0, "{worst:e}");
}
