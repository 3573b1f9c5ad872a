//! Rows that make tables, and move them.

use super::{BenchError, Contest, Effort, Row, one_thread};
use crate::gpu::Gpu;
use crate::mesh::SubdivMesh;
use crate::osd::{BfrPeer, EndCap, Far, Isolation, MAX_ISOLATION, OsdPeer};
use crate::stam::{Evaluator, LimitSurface, MovingSurface};
use std::hint::black_box;

const DEEPEST: (u32, u32) = (MAX_ISOLATION, MAX_ISOLATION);

pub(super) fn tables(mesh: &SubdivMesh, effort: Effort, gpu: &Gpu) -> Result<Vec<Row>, BenchError> {
    // Whether anybody refuses the mesh.
    gpu.upload(&LimitSurface::new(mesh)?)?;
    Evaluator::<f32>::new(&LimitSurface::new(mesh)?)?;
    let isolation = Isolation::uniform(MAX_ISOLATION);
    Far::with(mesh, isolation, EndCap::Gregory)?;
    BfrPeer::<f64>::new(mesh, DEEPEST)?;
    let per_face = 1e6 / mesh.face_count() as f64;
    let surface = || LimitSurface::new(mesh).expect("it had a surface");
    let osd = || _ = black_box(Far::with(mesh, isolation, EndCap::Gregory).expect("it had a table"));
    let bfr = || _ = black_box(BfrPeer::<f64>::new(mesh, DEEPEST).expect("it had surfaces"));
    let row = |name, ours: &mut dyn FnMut(), note: &str| {
        let note = format!(
            "{} faces, mesh in memory to {note}, one thread; Osd: refinement, patch table and points at isolation 10; Bfr: surfaces of all faces at \
             levels 10 and 10",
            mesh.face_count()
        );
        let contest = Contest::new(ours).against("osd", osd).against("bfr", bfr);
        contest.row(name, "us/face", per_face, note, effort)
    };
    let pool = one_thread();
    let mut on_adapter = || pool.install(|| _ = black_box(gpu.upload(&surface()).expect("it was uploaded")));
    let mut in_memory = || pool.install(|| _ = black_box(Evaluator::<f32>::new(&surface()).expect("it had room")));
    Ok(vec![
        row("tables", &mut on_adapter, "tables on the adapter"),
        row("tables_cpu", &mut in_memory, "the polynomials of Evaluator<f32>"),
    ])
}

pub(super) fn update(mesh: &SubdivMesh, effort: Effort) -> Result<Vec<Row>, BenchError> {
    let mut moving = MovingSurface::new(mesh)?;
    let mut evaluator = Evaluator::<f32>::new(moving.surface())?;
    let mut peers = [5, MAX_ISOLATION].map(|level| OsdPeer::new(mesh, level));
    let [Ok(osd_5), Ok(osd_10)] = &mut peers else {
        let refusal = peers.into_iter().find_map(Result::err);
        return Err(refusal.expect("one of them refused").into());
    };
    let points: Vec<[f32; 3]> = mesh.points.iter().map(|point| point.as_vec3().to_array()).collect();
    let bytes = evaluator.bytes();
    let mut written = vec![0u8; bytes];
    let pool = one_thread();
    let ours = || evaluator.update(moving.move_to(mesh).expect("the same topology"));
    let mut ours = ours;
    let contest = Contest::new(|| pool.install(&mut ours))
        .against("osd", || osd_10.update(black_box(&points)).expect("it followed before"))
        .against("osd_level_5", || osd_5.update(black_box(&points)).expect("it followed before"))
        .floor(|| black_box(&mut written).fill(1));
    let note = format!(
        "{} control points move: refined points, then the {bytes} bytes of Evaluator<f32>; Osd: EvalStencils at isolation 10 and at 5; floor: writing \
         those bytes; one thread",
        mesh.points.len()
    );
    Ok(vec![contest.row("update", "ms", 1e3, note, effort)])
}
