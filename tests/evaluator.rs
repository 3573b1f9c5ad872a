//! The fast evaluator against the reference: every patch kind, both number types, any vectors.

mod common;

use catoptric::mesh::{SubdivMesh, sample};
use catoptric::stam::{Evaluator, Jet2, LimitSurface, MovingSurface, Real, Results, Samples, Wanted};
use common::meshes;
use glam::DVec3;

const ALL: Wanted = Wanted { first: true, second: true, normal: true };

/// Samples all over a mesh: a grid with corners and edges, places that are no dyadic fractions, and close to a corner.
fn places(surface: &LimitSurface) -> Vec<(u32, f64, f64)> {
    let inside = (0..40).map(|k| [0.618_034 * f64::from(k), 0.414_214 * f64::from(k)].map(f64::fract));
    let grid = (0..25).map(|k| [f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0]);
    let corner = (1..12).map(|k| [0.7, 0.3].map(|t| t * 0.25f64.powi(k)));
    let uv: Vec<[f64; 2]> = inside.chain(grid).chain(corner).collect();
    let faces = 0..surface.ptex_count() as u32;
    faces.flat_map(|face| uv.iter().map(move |&[u, v]| (face, u, v))).collect()
}

fn vector<T: Real>(x: [T; 3]) -> DVec3 {
    DVec3::from_array(x.map(T::to_f64))
}

/// Largest differences from the reference, of position, first and second derivatives (times 2^-depth and 4^-depth, for they are by the
/// parameters of the ptex face) and of normals in radians. Positions and derivatives are parts of the mesh's diagonal, or of
/// themselves where they are longer: at corners of three faces and more they grow without bound.
fn compare<T: Real>(
    surface: &LimitSurface,
    samples: &Samples<T>,
    all: &[(u32, T, T)],
    results: &Results<T>,
) -> [f64; 4] {
    let unit = surface.diagonal();
    let mut worst = [0.0f64; 4];
    for (row, &index) in samples.order().iter().enumerate() {
        let (face, u, v) = all[index as usize];
        let Some((patch, jet)) = surface.evaluate_second_ptex(face, [u.to_f64(), v.to_f64()]) else {
            assert_eq!(vector(results.position(row)), DVec3::ZERO, "zero in holes");
            continue;
        };
        let Jet2 { first, duu, duv, dvv } = jet;
        let uv = surface.patches()[patch].to_local([u.to_f64(), v.to_f64()]);
        // Near an extraordinary vertex second derivatives grow without bound: compare them where they are of the patch's size.
        let cell = surface.patches()[patch].scale();
        let near = if uv[0].max(uv[1]) < 0.125 { 0.0 } else { 1.0 };
        let [du, dv] = results.first(row).expect("asked for").map(vector);
        let second = results.second(row).expect("asked for").map(vector);
        let off = |ours: DVec3, exact: DVec3, rate: f64| ours.distance(exact) / (unit * rate).max(exact.length());
        let differences = [
            [vector(results.position(row)).distance(first.position) / unit, 0.0, 0.0],
            [off(du, first.du, cell[0]), off(dv, first.dv, cell[1]), 0.0],
            [
                near * off(second[0], duu, cell[0].powi(2)),
                near * off(second[1], duv, cell[0] * cell[1]),
                near * off(second[2], dvv, cell[1].powi(2)),
            ],
        ];
        for (worst, differences) in worst.iter_mut().zip(differences) {
            *worst = differences.into_iter().fold(*worst, f64::max);
        }
        let normal = vector(results.normal(row).expect("asked for"));
        assert!((normal.length() - first.normal.length()).abs() < 1e-6, "{normal} {}", first.normal);
        worst[3] = worst[3].max(normal.cross(first.normal).length().atan2(normal.dot(first.normal)));
    }
    worst
}

fn check<T: Real>(mesh: &SubdivMesh, surface: &LimitSurface, tolerances: [f64; 4]) {
    let all: Vec<(u32, T, T)> = places(surface).into_iter().map(|(face, u, v)| (face, T::of(u), T::of(v))).collect();
    let evaluator = Evaluator::<T>::new(surface).expect("memory is there");
    let samples = evaluator.place(&all);
    let mut results = Results::new(ALL, samples.len());
    evaluator.evaluate(&samples, results.columns());
    let worst = compare(surface, &samples, &all, &results);
    for (what, (worst, tolerance)) in
        ["positions", "first", "second", "normals"].iter().zip(worst.iter().zip(tolerances))
    {
        assert!(*worst <= tolerance, "{}, {} bits: {what} {worst:e} off", mesh.name, 8 * size_of::<T>());
    }
    // The same bits from all threads.
    let mut parallel = Results::new(ALL, samples.len());
    evaluator.evaluate_in_parallel(&samples, parallel.columns());
    let mut each = vec![[[T::default(); 3]; 3]; all.len()];
    evaluator.each(&all, &mut each);
    for (row, &index) in samples.order().iter().enumerate() {
        assert_eq!(results.position(row), parallel.position(row));
        assert_eq!(results.normal(row), parallel.normal(row));
        let [position, du, dv] = each[index as usize];
        // But for what one rounds and the other does not.
        let first = results.first(row).expect("asked for");
        for (batched, single) in [results.position(row), first[0], first[1]].into_iter().zip([position, du, dv]) {
            let [batched, single] = [batched, single].map(vector);
            let size = single.length().max(surface.diagonal());
            assert!(batched.distance(single) <= 4.0 * tolerances[0] * size, "{}: {batched} {single}", mesh.name);
        }
    }
}

/// Roundings: a polynomial of 16 terms, and control points (some 18 terms, weights up to 10 on the levels that are stored) in f64. Normals
/// as `normal.rs` derives.
#[test]
fn every_mesh_is_that_of_the_reference() {
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        check::<f64>(&mesh, &surface, [1e-14, 1e-13, 1e-12, 1e-8]);
        check::<f32>(&mesh, &surface, [2e-7, 1e-6, 4e-6, 1e-5]);
    }
}

/// Far from the origin derivatives and normals in f32 are those near it; only positions take the rounding of where they are.
#[test]
fn normals_do_not_depend_on_the_place() {
    let near = LimitSurface::new(&sample()).expect("a surface");
    let mut mesh = sample();
    mesh.points.iter_mut().for_each(|point| *point += DVec3::new(1000.0, -2000.0, 512.0) * near.diagonal());
    check_normals(&LimitSurface::new(&mesh).expect("a surface"));
}

fn check_normals(surface: &LimitSurface) {
    let all: Vec<(u32, f32, f32)> = places(surface).into_iter().map(|(f, u, v)| (f, u as f32, v as f32)).collect();
    let evaluator = Evaluator::<f32>::new(surface).expect("memory is there");
    let samples = evaluator.place(&all);
    let mut results = Results::new(ALL, samples.len());
    evaluator.evaluate(&samples, results.columns());
    let worst = compare(surface, &samples, &all, &results);
    assert!(worst[1] < 1e-6 && worst[3] < 1e-5, "{worst:?}");
}

/// Columns that are not asked for are not needed by others, and cost nothing to leave out.
#[test]
fn any_columns_may_be_left_out() {
    let surface = LimitSurface::new(&sample()).expect("a surface");
    let evaluator = Evaluator::<f32>::new(&surface).expect("memory is there");
    let all: Vec<_> = places(&surface).into_iter().map(|(f, u, v)| (f, u as f32, v as f32)).collect();
    let samples = evaluator.place(&all);
    let mut whole = Results::new(ALL, samples.len());
    evaluator.evaluate(&samples, whole.columns());
    for choice in 0..8 {
        let wanted = Wanted { first: choice & 1 != 0, second: choice & 2 != 0, normal: choice & 4 != 0 };
        let mut part = Results::new(wanted, samples.len());
        evaluator.evaluate(&samples, part.columns());
        for row in 0..samples.len() {
            assert_eq!(part.position(row), whole.position(row), "{wanted:?}");
            assert_eq!(part.first(row), whole.first(row).filter(|_| wanted.first), "{wanted:?}");
            assert_eq!(part.second(row), whole.second(row).filter(|_| wanted.second), "{wanted:?}");
            assert_eq!(part.normal(row), whole.normal(row).filter(|_| wanted.normal), "{wanted:?}");
        }
    }
}

/// After a move it is the evaluator of the moved surface, to the last bit, at the same places.
#[test]
fn it_follows_control_points() {
    let mesh = sample();
    let mut moving = MovingSurface::new(&mesh).expect("a surface");
    let mut evaluator = Evaluator::<f64>::new(moving.surface()).expect("memory is there");
    let all = places(moving.surface());
    let samples = evaluator.place(&all);
    let bent = |p: &DVec3| DVec3::new(p.x, p.y + 0.1 * p.x * p.x, 1.2 * p.z);
    let bent = SubdivMesh { points: mesh.points.iter().map(bent).collect(), ..mesh };
    evaluator.update(moving.move_to(&bent).expect("the same topology"));
    let anew = Evaluator::<f64>::new(&LimitSurface::new(&bent).expect("a surface")).expect("memory is there");
    let mut results = [(); 2].map(|()| Results::new(ALL, samples.len()));
    for (evaluator, results) in [&evaluator, &anew].into_iter().zip(&mut results) {
        evaluator.evaluate(&samples, results.columns());
    }
    for row in 0..samples.len() {
        assert_eq!(results[0].position(row), results[1].position(row));
        assert_eq!(results[0].normal(row), results[1].normal(row));
    }
}

#[test]
#[should_panic(expected = "columns as long as there are samples")]
fn short_columns_are_refused() {
    let surface = LimitSurface::new(&sample()).expect("a surface");
    let evaluator = Evaluator::<f32>::new(&surface).expect("memory is there");
    let samples = evaluator.place(&[(0, 0.5, 0.5)]);
    evaluator.evaluate(&samples, Results::new(ALL, 0).columns());
}
