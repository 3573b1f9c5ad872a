//! The WGSL limit against the f64 limit at the same samples.

mod gpu_support;

use catoptric::gpu::tables::{BUDGET, bytes, tail_error};
use catoptric::gpu::{AdapterChoice, Gpu, GpuError, Sample, TableLayout};
use catoptric::mesh::{self, SubdivMesh};
use catoptric::stam::{Jet, LimitSurface, weights};
use glam::{DVec3, dvec3};
use gpu_support::{Random, gpu, meshes};

/// Positions are sums of 16 products in f32 of numbers of the size of the patch, which is at most the diagonal: 20
/// roundings of 2^-24 (6e-8) each.
const POSITION: f64 = 2e-6;
/// Two layouts round differently. A compact one combines points with weights whose absolute values sum to 10 at most for
/// these classes, each product rounded twice by 2^-24, of points at most half a diagonal away: 6e-7; and the sum of the 16
/// adds what it adds in every layout.
const BETWEEN_LAYOUTS: f64 = 1e-6;
/// Normals in degrees at the 99.99th percentile: 1/100 pixel of reflection line is 1.4e-3. A derivative is
/// off by 20 x 6e-8 of the patch's size, so the bound holds where that is less than some 15 times the derivative.
const NORMAL_DEGREES: f64 = 1e-3;
/// Derivatives cancel: 20 roundings of the net's size, which is a few times the derivative's, and 2^-24 more for the power.
const DERIVATIVE: f64 = 1e-5;

/// A disc of quads round one vertex of this valence, two rings wide, with uneven heights.
fn pole(valence: usize, seed: u64) -> SubdivMesh {
    let mut random = Random::new(seed);
    let mut mesh = SubdivMesh { name: format!("pole {valence}"), points: vec![DVec3::ZERO], ..SubdivMesh::default() };
    // Sector k holds the grid points (i, j), i from 1 to 2 along its first spoke, j from 0 to 2 towards the next one.
    let index = |sector: usize, i: usize, j: usize| match (i, j) {
        (0, 0) => 0,
        (0, j) => (1 + 6 * ((sector + 1) % valence) + 3 * (j - 1)) as u32,
        (i, j) => (1 + 6 * sector + 3 * (i - 1) + j) as u32,
    };
    for sector in 0..valence {
        let spoke = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / valence as f64;
            dvec3(angle.cos(), angle.sin(), 0.0)
        };
        for (i, j) in (1..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let mut noise = || 0.4 * (random.next() - 0.5);
            let p = spoke(sector) * i as f64 + spoke(sector + 1) * j as f64 + dvec3(noise(), noise(), 2.0 * noise());
            mesh.points.push(p);
        }
        for (i, j) in (0..2).flat_map(|i| (0..2).map(move |j| (i, j))) {
            mesh.face_sizes.push(4);
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            mesh.face_vertices.extend(corners.map(|(i, j)| index(sector, i, j)));
        }
    }
    mesh
}

fn angle_degrees(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// Parameters in every corner, on every edge, in every level that the tables hold, and anywhere.
fn parameters(seed: u64) -> Vec<[f32; 2]> {
    let mut random = Random::new(seed);
    let mut uv = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for n in 0..=23 {
        let x = 0.5f32.powi(n);
        uv.extend([[x, 0.0], [0.0, x], [x, x], [x, x * random.next() as f32], [x * random.next() as f32, x]]);
        uv.extend([[x - x / 16_777_216.0, x * 0.3], [x * 0.3, x - x / 16_777_216.0]]);
    }
    for _ in 0..60 {
        let (a, b) = (random.next() as f32, random.next() as f32);
        uv.extend([[a, b], [a, 0.0], [0.0, b], [a, 1.0], [1.0, b]]);
    }
    uv
}

/// Evaluates all patches of a mesh on both sides, in every layout, and compares.
fn compare(mesh: &SubdivMesh) {
    let surface = LimitSurface::new(mesh).expect("it has a surface");
    assert!(!surface.patches().is_empty(), "{} has nothing to compare", mesh.name);
    let samples: Vec<Sample> = (0..surface.patches().len() as u32)
        .flat_map(|patch| parameters(u64::from(patch)).into_iter().map(move |uv| Sample { patch, uv }))
        .collect();
    let all = TableLayout::ALL.map(|layout| {
        let tables = gpu().upload_as(&surface, layout).expect("it fits");
        assert_eq!(tables.layout(), layout);
        assert_eq!(tables.size(), bytes(&surface, layout), "{}: {layout}", mesh.name);
        let jets = gpu().evaluate(&tables, &samples).expect("the adapter works");
        compare_with_f64(mesh, &surface, layout, &samples, &jets);
        jets
    });
    for jets in &all[1..] {
        compare_layouts(mesh, &surface, &samples, [&all[0], jets]);
    }
}

/// Positions within [`BETWEEN_LAYOUTS`]; regular patches the same to the last bit.
fn compare_layouts(mesh: &SubdivMesh, surface: &LimitSurface, samples: &[Sample], [one, other]: [&[Jet]; 2]) {
    let distance = |(a, b): (&Jet, &Jet)| a.position.distance(b.position);
    let off = one.iter().zip(other).map(distance).fold(0.0, f64::max) / surface.diagonal();
    println!("{:<28} layouts differ by {off:.1e}", mesh.name);
    assert!(off <= BETWEEN_LAYOUTS, "{}: layouts differ by {off:e}", mesh.name);
    for (sample, (a, b)) in samples.iter().zip(one.iter().zip(other)) {
        if surface.class(sample.patch as usize).is_none() {
            assert_eq!(a, b, "{}: {sample:?} of a regular patch", mesh.name);
        }
    }
}

fn compare_with_f64(mesh: &SubdivMesh, surface: &LimitSurface, layout: TableLayout, samples: &[Sample], jets: &[Jet]) {
    let diagonal = surface.diagonal();
    let (mut angles, mut farthest, mut steepest) = (Vec::new(), 0.0f64, 0.0f64);
    for (sample, jet) in samples.iter().zip(jets) {
        let exact: Jet = surface.evaluate(sample.patch as usize, sample.uv.map(f64::from));
        let off = jet.position.distance(exact.position) / diagonal;
        farthest = farthest.max(off);
        assert!(off <= POSITION, "{} ({layout}): {sample:?} is off by {off:e}", mesh.name);
        // At the extraordinary vertex derivatives are zero or infinite; both sides give those of an innermost level.
        if sample.uv != [0.0, 0.0] {
            for (found, expected) in [(jet.du, exact.du), (jet.dv, exact.dv)] {
                let size = exact.du.length().max(exact.dv.length());
                let off = found.distance(expected) / size;
                if size > 0.0 {
                    steepest = steepest.max(off);
                }
                assert!(
                    size == 0.0 || off <= DERIVATIVE,
                    "{} ({layout}): derivative at {sample:?} is off by {off:e}",
                    mesh.name
                );
            }
        }
        // Derivatives are rounded like the larger of the two, which turns the normal by that over the height of the
        // parallelogram: it tends to zero at the tip of a cone (a sharp corner with faces all round).
        let size = exact.du.length().max(exact.dv.length());
        let condition = exact.du.cross(exact.dv).length() / size.powi(2);
        if exact.normal != DVec3::ZERO {
            angles.push(angle_degrees(jet.normal, exact.normal) * condition);
        }
    }
    angles.sort_by(f64::total_cmp);
    let percentile = angles[(angles.len() as f64 * 0.9999) as usize];
    println!(
        "{:<28} {layout:<9} {:>7} samples: position {farthest:.1e}, derivative {steepest:.1e}, normal 99.99% \
         {percentile:.1e}, max {:.1e}",
        mesh.name,
        angles.len(),
        angles[angles.len() - 1]
    );
    assert!(percentile <= NORMAL_DEGREES, "{} ({layout}): normals are off by {percentile:e} degrees", mesh.name);
}

#[test]
fn extraordinary_vertices_of_every_valence() {
    for valence in 3..=12 {
        compare(&pole(valence, valence as u64));
    }
}

#[test]
fn every_test_mesh() {
    for mesh in meshes() {
        compare(&mesh);
    }
}

#[test]
fn far_from_the_origin_nothing_changes() {
    for valence in [3, 5, 8, 12] {
        compare(&pole(valence, 7).translated(dvec3(1000.0, -500.0, 200.0)));
    }
    for mesh in meshes() {
        compare(&mesh.translated(dvec3(1000.0, -500.0, 200.0)));
    }
}

/// Beyond the last stored level the last one serves again. What it leaves out has decayed to (mu/lambda)^23 of the tangents,
/// mu the next eigenvalue: 5e-6 for N = 3, 1e-2 for N = 8; positions are scaled by lambda^24 or less on top.
#[test]
fn deeper_than_the_tables_nothing_breaks() {
    for valence in [3, 5, 8, 12] {
        let surface = LimitSurface::new(&pole(valence, 2)).expect("it has a surface");
        let left_out = surface.class(0).and_then(|class| tail_error(&surface.tables()[class])).expect("a pole");
        println!("valence {valence}: the last level is {left_out:.1e} of itself off the limit");
        let small = |n: i32| [[0.5f32.powi(n), 0.3 * 0.5f32.powi(n)], [0.0, 0.5f32.powi(n)]];
        let samples: Vec<Sample> = (24..150).flat_map(small).map(|uv| Sample { patch: 0, uv }).collect();
        for layout in TableLayout::ALL {
            let tables = gpu().upload_as(&surface, layout).expect("it fits");
            for (sample, jet) in samples.iter().zip(gpu().evaluate(&tables, &samples).expect("the adapter works")) {
                let exact = surface.evaluate(0, sample.uv.map(f64::from));
                let turned = angle_degrees(jet.normal, exact.normal);
                assert!(jet.position.distance(exact.position) <= POSITION * surface.diagonal(), "{sample:?} {jet:?}");
                // The weights of a row times a ring a few times larger than the tangents.
                assert!(turned < 1e-3 + 4.0 * left_out.to_degrees(), "{layout}: {sample:?} {turned} {jet:?} {exact:?}");
                assert!(jet.du.is_finite() && jet.dv.is_finite(), "{sample:?} {jet:?}");
            }
        }
    }
}

/// What `Auto` chooses: the fastest that saves memory, within the budget.
#[test]
fn layouts_take_what_they_say() {
    let surface = LimitSurface::new(&mesh::sample()).expect("it has a surface");
    let [expanded, compact, hybrid] = TableLayout::ALL.map(|layout| bytes(&surface, layout));
    let auto = gpu().upload(&surface).expect("it fits");
    assert!(compact < hybrid && hybrid < expanded && expanded < BUDGET, "{compact} {hybrid} {expanded}");
    assert_eq!(auto.layout(), TableLayout::Expanded, "a megabyte is not worth saving");
    assert_eq!(auto.size(), bytes(&surface, TableLayout::Auto));
    assert_eq!("hybrid".parse(), Ok(TableLayout::Hybrid));
    assert!("dense".parse::<TableLayout>().is_err());
}

#[test]
fn size_does_not_matter() {
    for scale in [1e-9, 1e12] {
        let mut mesh = pole(5, 3);
        mesh.points.iter_mut().for_each(|p| *p *= scale);
        compare(&mesh);
    }
}

/// A net that no mesh is behind: the upload takes patches from any source.
#[test]
fn regular_nets_need_no_mesh() {
    let mut random = Random::new(11);
    let nets: Vec<[DVec3; 16]> = (0..8)
        .map(|_| {
            std::array::from_fn(|k| {
                dvec3((k % 4) as f64, (k / 4) as f64, 0.0) + dvec3(random.next(), random.next(), random.next())
            })
        })
        .collect();
    let tables = gpu().upload_patches(&nets).expect("it fits");
    let uv = parameters(5);
    let samples: Vec<Sample> = (0..8).flat_map(|patch| uv.iter().map(move |&uv| Sample { patch, uv })).collect();
    let jets = gpu().evaluate(&tables, &samples).expect("the adapter works");
    for (sample, jet) in samples.iter().zip(&jets) {
        let terms = weights(sample.uv.map(f64::from)).into_iter().zip(nets[sample.patch as usize]);
        let exact: DVec3 = terms.map(|(w, p)| w[0] * p).sum();
        assert!(jet.position.distance(exact) <= POSITION * 4.0, "{sample:?}");
    }
}

#[test]
fn errors_name_what_is_wrong() {
    let missing = Gpu::with(&AdapterChoice::Named("no such adapter".into())).map(drop);
    let Err(GpuError::UnknownAdapter { wanted, known }) = missing else { panic!("{missing:?}") };
    assert!(wanted == "no such adapter" && known.iter().any(|name| name == gpu().adapter()), "{known:?}");
    let tables = gpu().upload(&LimitSurface::new(&pole(5, 1)).expect("it has a surface")).expect("it fits");
    let patch = tables.patches() as u32;
    let error = gpu().evaluate(&tables, &[Sample { patch, uv: [0.5; 2] }]).map(drop);
    assert!(matches!(error, Err(GpuError::Patch { sample: 0, .. })), "{error:?}");
    assert_eq!(gpu().evaluate(&tables, &[]).expect("nothing to do"), []);
}
