//! What it costs to move control points, beside making the surface anew: `update [MESH ...]`.
//!
//! Without a mesh: the sample, and a torus of 102,400 faces with a semi-sharp and an infinitely sharp crease round it.

use catoptric::mesh::{self, Boundary, Crease, MeshError, SubdivMesh};
use catoptric::stam::{LimitSurface, MovingSurface};
use glam::DVec3;
use std::f64::consts::TAU;
use std::path::Path;
use std::time::{Duration, Instant};

const RUNS: usize = 7;
const SIDE: u32 = 320;

fn main() -> Result<(), MeshError> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let meshes = match paths.is_empty() {
        true => vec![mesh::sample(), torus()],
        false => paths.iter().map(|path| mesh::read(Path::new(path))).collect::<Result<_, _>>()?,
    };
    println!("medians of {RUNS}, interleaved");
    println!("{:<24} {:>8} {:>8} {:>12} {:>12} {:>7}", "mesh", "faces", "patches", "anew ms", "moved ms", "ratio");
    meshes.iter().for_each(measure);
    Ok(())
}

fn measure(mesh: &SubdivMesh) {
    let mut moving = MovingSurface::new(mesh).expect("a surface");
    let (mut anew, mut moved) = (Vec::new(), Vec::new());
    for run in 0..RUNS {
        let stretch = DVec3::new(1.0, 1.0 + 0.1 * (run + 1) as f64, 1.0);
        let other = SubdivMesh { points: mesh.points.iter().map(|&point| point * stretch).collect(), ..mesh.clone() };
        let (time, surface) = timed(|| LimitSurface::new(&other).expect("a surface"));
        anew.push(time);
        let (time, ()) = timed(|| _ = moving.move_to(&other).expect("the same topology"));
        moved.push(time);
        assert_eq!(surface.bounds(), moving.surface().bounds());
    }
    let median = |times: &mut Vec<Duration>| {
        times.sort_unstable();
        times[RUNS / 2].as_secs_f64() * 1e3
    };
    let [anew, moved] = [&mut anew, &mut moved].map(median);
    let patches = moving.surface().patches().len();
    let ratio = anew / moved;
    println!("{:<24} {:>8} {patches:>8} {anew:>12.2} {moved:>12.2} {ratio:>7.1}", mesh.name, mesh.face_count());
}

fn timed<R>(work: impl FnOnce() -> R) -> (Duration, R) {
    let start = Instant::now();
    let result = work();
    (start.elapsed(), result)
}

fn torus() -> SubdivMesh {
    let index = |i: u32, j: u32| j % SIDE * SIDE + i % SIDE;
    let cells = || (0..SIDE * SIDE).map(|k| (k % SIDE, k / SIDE));
    let angle = |k: u32| TAU * f64::from(k) / f64::from(SIDE);
    let point = |(i, j)| {
        let (reach, height) = (2.0 + angle(j).cos(), angle(j).sin());
        DVec3::new(reach * angle(i).cos(), reach * angle(i).sin(), height)
    };
    let ring =
        |j: u32, sharpness| (0..SIDE).map(move |i| Crease { vertices: [index(i, j), index(i + 1, j)], sharpness });
    SubdivMesh {
        name: "torus".to_owned(),
        points: cells().map(point).collect(),
        face_sizes: vec![4; (SIDE * SIDE) as usize],
        face_vertices: cells()
            .flat_map(|(i, j)| [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)])
            .collect(),
        creases: ring(0, 2.5).chain(ring(SIDE / 2, 10.0)).collect(),
        boundary: Boundary::EdgeAndCorner,
        ..SubdivMesh::default()
    }
}
