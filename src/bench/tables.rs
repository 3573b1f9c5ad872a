//! Rows that make tables, and move them.

use super::{BenchError, Contest, Unit, one_thread};
use crate::gpu::Gpu;
use crate::mesh::SubdivMesh;
use crate::osd::{BfrPeer, EndCap, Far, Isolation, MAX_ISOLATION, OsdPeer};
use crate::patch::refiner;
use crate::stam::{ClassTable, Evaluator, LimitSurface, MovingSurface};
use std::hint::black_box;

const DEEPEST: (u32, u32) = (MAX_ISOLATION, MAX_ISOLATION);

pub(super) fn tables<'a>(mesh: &'a SubdivMesh, gpu: Option<&'a Gpu>) -> Result<Vec<Contest<'a>>, BenchError> {
    let isolation = Isolation::uniform(MAX_ISOLATION);
    // Whether anybody refuses the mesh.
    let classes = LimitSurface::new(mesh)?.classes().to_vec();
    gpu.map(|gpu| gpu.upload(&LimitSurface::new(mesh)?).map_err(BenchError::from)).transpose()?;
    Evaluator::<f32>::new(&LimitSurface::new(mesh)?)?;
    Far::with(mesh, isolation, EndCap::Gregory)?;
    BfrPeer::<f64>::new(mesh, DEEPEST)?;
    let cold = std::time::Instant::now();
    classes.iter().for_each(|&class| _ = black_box(ClassTable::new(class)));
    let cold = cold.elapsed().as_secs_f64() * 1e6 / mesh.face_count() as f64;
    let surface = || LimitSurface::new(mesh).expect("it had a surface");
    let contest = |name: &str, ours: Box<dyn Fn() + Send + Sync + 'a>, what: &str| {
        let note = format!(
            "{} faces, mesh in memory to {what}, one thread; the matrices of {} classes are those of all meshes of the process, and made before: \
             {cold:.1} us/face more in the first; Osd: refinement, patch table, points and patch map at isolation 10 in f64; Bfr: surfaces of all \
             faces at levels 10 and 10 in f64; floor: OpenSubdiv's part of ours, its refinement as deep as we need it",
            mesh.face_count(),
            classes.len(),
        );
        let pool = one_thread();
        Contest::new(name, Unit::microseconds_a_face(mesh.face_count()), note, move || pool.install(&ours))
            .against("osd", move || _ = black_box(Far::with(mesh, isolation, EndCap::Gregory).expect("it had a table")))
            .against("bfr", || _ = black_box(BfrPeer::<f64>::new(mesh, DEEPEST).expect("it had surfaces")))
            .floor(|| {
                _ = black_box(refiner(mesh).and_then(|refiner| refiner.interpolate(&mesh.points)).expect("it refined"))
            })
    };
    let on_adapter = gpu.map(|gpu| {
        let ours = move || _ = black_box(gpu.upload(&surface()).expect("it was uploaded"));
        contest("tables", Box::new(ours), "tables on the adapter, the copy counted in")
    });
    let ours = move || _ = black_box(Evaluator::<f32>::new(&surface()).expect("it had room"));
    let in_memory = contest("tables_cpu", Box::new(ours), "the polynomials of Evaluator<f32>");
    Ok(on_adapter.into_iter().chain([in_memory]).collect())
}

pub(super) fn update<'a>(mesh: &'a SubdivMesh) -> Result<Vec<Contest<'a>>, BenchError> {
    let points: Vec<[f32; 3]> = mesh.points.iter().map(|point| point.as_vec3().to_array()).collect();
    let contest = |name: &str, what: &str, bytes: usize, mut ours: Box<dyn FnMut() + Send + 'a>| {
        let [mut deep, mut shallow] = [OsdPeer::new(mesh, MAX_ISOLATION)?, OsdPeer::new(mesh, 5)?];
        let ([to_deep, to_shallow], pool) = ([(); 2].map(|()| points.clone()), one_thread());
        let note = format!(
            "{} control points move, one thread: {what}; Osd: EvalStencils in f32 at isolation 10 (osd) and 5; floor: writing the {bytes} bytes \
             of the result",
            points.len()
        );
        let mut written = vec![0u8; bytes];
        Ok::<_, BenchError>(
            Contest::new(name, Unit::MILLISECONDS, note, move || pool.install(&mut ours))
                .against("osd", move || deep.update(black_box(&to_deep)).expect("it followed before"))
                .against("osd_level_5", move || shallow.update(black_box(&to_shallow)).expect("it followed before"))
                .floor(move || black_box(&mut written).fill(1)),
        )
    };
    let [mut moving, mut followed] = [MovingSurface::new(mesh)?, MovingSurface::new(mesh)?];
    let refined = moving.surface().refined_points() * size_of::<glam::DVec3>();
    let move_to = move || _ = black_box(moving.move_to(mesh).expect("the same topology"));
    let mut evaluator = Evaluator::<f32>::new(followed.surface())?;
    let polynomials = evaluator.bytes();
    let follow = move || evaluator.update(followed.move_to(mesh).expect("the same topology"));
    Ok(vec![
        contest("update", "refined points in f64, from which LimitSurface evaluates", refined, Box::new(move_to))?,
        contest("update_evaluator", "these, and the polynomials of Evaluator<f32>", polynomials, Box::new(follow))?,
    ])
}
