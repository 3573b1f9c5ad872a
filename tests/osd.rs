//! The contract of the shim over OpenSubdiv: what fails, and how.

use catoptric::mesh::{self, SubdivMesh};
use catoptric::osd::{Answer, Bfr, Error, Far, LimitStencils, Location, Reference, Refiner, Version};
use glam::DVec3;
use std::path::Path;

mod common;

fn mesh(name: &str) -> SubdivMesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj");
    mesh::read(&path).expect("a test mesh is valid")
}

/// The message of a call that must be refused by the shim or by the wrapper above it.
fn refusal<T>(result: Result<T, Error>) -> String {
    match result {
        Ok(_) => panic!("accepted"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn the_headers_are_those_of_the_version_we_checked() {
    let range = Version::new(3, 5, 0)..Version::new(4, 0, 0);
    assert!(range.contains(&catoptric::osd::version()), "{}", catoptric::osd::version());
}

#[test]
fn a_level_that_32_bits_do_not_hold_is_out_of_range_too() {
    let refiner = Refiner::uniform(&mesh("cube"), 1).expect("it refines");
    // Cut to 32 bits it would be level 0.
    assert!(refusal(refiner.level(1 << 32)).contains("level out of range"));
}

#[test]
fn far_tables_are_measured() {
    let far = Far::new(&mesh("cube"), 3).expect("a table");
    // Every corner of a cube is extraordinary: at isolation 3, each face has 4 end caps and 12 regular patches a level.
    assert_eq!(far.patch_count(), 6 * (4 + 12 + 12));
    // Indices and parameters alone: 16 points a regular patch, 20 an end cap.
    let least = 6 * (24 * 16 + 4 * 20) * 4 + 6 * 28 * 8;
    assert!(far.bytes() > least && far.bytes() < 10 * least, "{}", far.bytes());
}

#[test]
fn answers_say_how_large_their_cell_is() {
    let far = Far::new(&mesh("cube"), 10).expect("a table");
    let answers = far.evaluate(&[(0, 0.4, 0.4), (0, 0.2, 0.2), (0, 0.0, 0.0)]).expect("it evaluates");
    assert_eq!(answers.iter().map(|a| a.cell).collect::<Vec<_>>(), [0.25, 0.125, 2f64.powi(-10)]);
    // The quadrants of an n-gon are ptex faces of their own.
    let far = Far::new(&mesh("n_gons"), 10).expect("a table");
    assert!(far.evaluate(&[(0, 0.75, 0.25)]).expect("it evaluates")[0].cell <= 1.0);
}

#[test]
fn the_smallest_parameters_have_finite_answers() {
    let cube = mesh("cube");
    let least = f64::from_bits(1);
    let samples = [(0, least, least), (0, least, 0.0), (0, 0.0, least), (0, f64::MIN_POSITIVE, least)];
    let far = Far::new(&cube, 10).and_then(|far| far.evaluate(&samples)).expect("it evaluates");
    let bfr = Bfr::new(&cube, (2, 6)).and_then(|mut bfr| bfr.evaluate(&samples)).expect("it evaluates");
    for answer in far.iter().chain(&bfr) {
        assert!(answer.position.is_finite() && answer.du.is_finite() && answer.dv.is_finite(), "{answer:?}");
    }
}

#[test]
fn levels_list_edges_and_restless_vertices() {
    let level = Refiner::uniform(&mesh("semi_sharp_crease"), 1).and_then(|r| r.level(0)).expect("it refines");
    let sharp = |edge: usize| level.edge_sharpness[edge] > 0.0 && level.edge_sharpness[edge] < 10.0;
    let mut restless = vec![false; level.vertex_count()];
    for face in 0..level.face_count() {
        let edges: Vec<_> = level.edges_of_face(face).collect();
        assert_eq!(edges.len(), level.corners(face).len());
        for (i, [vertex, next, edge]) in edges.iter().copied().enumerate() {
            assert_eq!(next, edges[(i + 1) % edges.len()][0]);
            assert!(level.edge_faces[edge].contains(&(face as i32)));
            restless[vertex] |= sharp(edge);
            restless[next] |= sharp(edge);
        }
    }
    assert!(restless.contains(&true));
    assert_eq!(level.restless(), restless);
}

#[test]
fn levels_beyond_ten_are_refused_before_they_corrupt_memory() {
    let cube = mesh("cube");
    for level in [0, 11, 12, 16, u32::MAX] {
        assert!(refusal(Refiner::adaptive(&cube, level, 2, false)).contains("level"), "{level}");
        assert!(refusal(Refiner::uniform(&cube, level)).contains("level"), "{level}");
        assert!(refusal(Far::new(&cube, level)).contains("isolation must be 1 to 10"), "{level}");
        assert!(refusal(LimitStencils::new(&cube, level)).contains("isolation must be 1 to 10"), "{level}");
        assert!(refusal(Bfr::new(&cube, (level, 6))).contains("levels must be 1 to 10"), "{level}");
        assert!(refusal(Bfr::new(&cube, (2, level))).contains("levels must be 1 to 10"), "{level}");
    }
    assert!(refusal(Refiner::adaptive(&cube, 4, 11, false)).contains("level"));
}

#[test]
fn invalid_meshes_never_reach_opensubdiv() {
    let mut broken = mesh("cube");
    broken.face_vertices[3] = 99;
    for message in [
        refusal(Refiner::adaptive(&broken, 2, 2, true)),
        refusal(Refiner::uniform(&broken, 1)),
        refusal(Far::new(&broken, 4)),
        refusal(LimitStencils::new(&broken, 4)),
        refusal(Bfr::new(&broken, Bfr::DEFAULT_LEVELS)),
    ] {
        assert!(message.contains("vertex 99"), "{message}");
    }
}

#[test]
fn limit_masks_need_uniform_refinement() {
    let refiner = Refiner::adaptive(&mesh("cube"), 3, 3, false).expect("it refines");
    let points = refiner.interpolate(&mesh("cube").points).expect("it interpolates");
    let last = refiner.vertex_counts()[refiner.level_count() - 1];
    let message = refusal(refiner.limit(&points[points.len() - last..]));
    assert!(message.starts_with("OpenSubdiv: "), "{message}");
}

#[test]
fn a_level_out_of_range_is_an_error_and_the_refiner_survives_it() {
    let refiner = Refiner::uniform(&mesh("cube"), 2).expect("it refines");
    assert!(refusal(refiner.level(3)).contains("level out of range"));
    let level = refiner.level(2).expect("level 2 exists");
    // A level is a copy: it outlives the refiner.
    drop(refiner);
    assert_eq!(level.face_count(), 96);
    assert_eq!(level.vertex_count(), 98);
}

#[test]
fn faces_out_of_range_are_refused_by_bfr_and_unanswered_by_far() {
    let cube = mesh("cube");
    let mut bfr = Bfr::new(&cube, Bfr::DEFAULT_LEVELS).expect("a factory");
    assert!(refusal(bfr.evaluate(&[(6, 0.5, 0.5)])).contains("out of range"));
    let far = Far::new(&cube, 4).expect("a table");
    let answers = far.evaluate(&[(6, 0.5, 0.5), (u32::MAX, 0.5, 0.5), (0, 0.5, 0.5)]).expect("it evaluates");
    assert_eq!(answers.iter().map(|a| a.answer == Answer::None).collect::<Vec<_>>(), [true, true, false]);
}

#[test]
fn messages_belong_to_the_thread_that_failed() {
    let cube = mesh("cube");
    std::thread::scope(|scope| {
        for level in 11..15 {
            let cube = &cube;
            scope.spawn(move || {
                for _ in 0..50 {
                    assert!(refusal(Far::new(cube, level)).contains("isolation"));
                    assert!(Far::new(cube, 2).is_ok());
                }
            });
        }
    });
}

#[test]
fn holes_have_no_answer() {
    let hole = mesh("hole");
    let samples = [(5, 0.5, 0.5), (0, 0.5, 0.5)];
    let far = Far::new(&hole, 4).and_then(|far| far.evaluate(&samples)).expect("it evaluates");
    let bfr = Bfr::new(&hole, (2, 6)).and_then(|mut bfr| bfr.evaluate(&samples)).expect("it evaluates");
    for answers in [far, bfr] {
        assert_eq!(answers[0].answer, Answer::None);
        assert_eq!(answers[1].answer, Answer::Regular);
    }
}

#[test]
fn references_agree_on_derivatives_of_n_gons() {
    // Their parameters differ by a factor of two on the quadrants of an n-gon; the shim hides it.
    let n_gons = mesh("n_gons");
    let samples: Vec<_> = (0..20).map(|i| (i, 0.75, 0.25)).collect();
    let far = Far::new(&n_gons, 10).and_then(|far| far.evaluate(&samples)).expect("it evaluates");
    let bfr = Bfr::new(&n_gons, (10, 10)).and_then(|mut bfr| bfr.evaluate(&samples)).expect("it evaluates");
    for (far, bfr) in far.iter().zip(&bfr) {
        // Inside regular patches of both, level 10 or not: rounding only.
        assert!(far.position.distance(bfr.position) < 1e-13);
        assert!(far.du.distance(bfr.du) < 1e-12, "{far:?} {bfr:?}");
        assert!(far.dv.distance(bfr.dv) < 1e-12);
    }
}

/// Limit stencils say what the patches say, end caps included, although each call refines a part of the mesh alone: the
/// same patches in other arithmetic.
#[test]
fn limit_stencils_are_the_patches_as_sums_of_control_points() {
    for mesh in common::meshes() {
        let name = &mesh.name;
        let faces = mesh.face_sizes.iter().map(|&n| if n == 4 { 1 } else { n }).sum::<u32>();
        let at = [[0.31, 0.72], [0.0, 0.0], [1.0, 0.5], [1e-4, 2e-4], [0.999, 0.2]];
        // One at a time is what takes long.
        let stride = faces.div_ceil(20) as usize;
        let samples: Vec<Location> =
            (0..faces).step_by(stride).flat_map(|face| at.map(|[u, v]| (face, u, v))).collect();
        let far = Far::new(&mesh, 10).and_then(|far| far.evaluate(&samples)).expect("it evaluates");
        let stencils = LimitStencils::new(&mesh, 10).expect("it is made");
        let unit = mesh.diagonal();
        for ((sample, far), ours) in samples.iter().zip(&far).zip(stencils.evaluate(&samples).expect("it evaluates")) {
            assert_eq!((far.answer, far.cell), (ours.answer, ours.cell), "{name} {sample:?}");
            assert!(far.position.distance(ours.position) < 1e-14 * unit, "{name} {sample:?}: {far:?} {ours:?}");
            // 50 roundings of a cell's points.
            let allowed = 50.0 * f64::EPSILON * unit / far.cell;
            assert!(far.du.distance(ours.du) < allowed && far.dv.distance(ours.dv) < allowed, "{name} {sample:?}");
            let stencil = stencils.stencil(*sample).expect("it is made");
            assert_eq!((stencil.answer, stencil.vertices.len()), (ours.answer, ours.terms as usize));
            if ours.answer == Answer::None {
                continue;
            }
            let sum = |k: usize| -> DVec3 {
                stencil.vertices.iter().zip(&stencil.weights).map(|(&v, w)| w[k] * mesh.points[v as usize]).sum()
            };
            let off = [sum(0).distance(ours.position) / unit, sum(1).distance(ours.du) / allowed];
            assert!(off[0] < 1e-14 && off[1] < 1.0, "{name} {sample:?}: {off:?}");
            assert!((stencil.weights.iter().map(|w| w[0]).sum::<f64>() - 1.0).abs() < 1e-14);
        }
    }
}

/// Threads share a table: its answers are, bit for bit, those to one sample after the other.
#[test]
fn far_answers_many_threads_as_it_answers_one() {
    let mesh = mesh("n_gons");
    let far = Far::new(&mesh, 10).expect("a table");
    let at = |i: u32| (f64::from(i % 97) / 97.0, f64::from(i % 89) / 89.0);
    let samples: Vec<Location> = (0..20_000).map(|i| (i % 20, at(i).0, at(i).1)).collect();
    let together = far.evaluate(&samples).expect("it evaluates");
    std::thread::scope(|scope| {
        for part in 0..4 {
            let (far, samples, together) = (&far, &samples, &together);
            scope.spawn(move || {
                for i in (part..samples.len()).step_by(40) {
                    assert_eq!(far.evaluate(&samples[i..=i]).expect("it evaluates"), together[i..=i]);
                }
            });
        }
    });
}

/// Calls overlap, and what they are asked together is what they are asked alone.
#[test]
fn limit_stencils_do_not_depend_on_what_else_is_asked() {
    let mesh = mesh("n_gons");
    let stencils = LimitStencils::new(&mesh, 10).expect("it is made");
    let samples: Vec<Location> = (0..12).map(|face| (face, 0.3, 0.8)).collect();
    let together = stencils.evaluate(&samples).expect("it evaluates");
    std::thread::scope(|scope| {
        for (sample, expected) in samples.iter().zip(&together) {
            let stencils = &stencils;
            scope.spawn(move || {
                let alone = stencils.evaluate(&[*sample]).expect("it evaluates");
                assert!(alone[0].position.distance(expected.position) < 1e-15 * 10.0, "{sample:?}");
                assert_eq!(alone[0].answer, expected.answer);
            });
        }
    });
    assert!(stencils.evaluate(&[]).expect("nothing is no error").is_empty());
    assert!(refusal(stencils.evaluate(&[(1000, 0.5, 0.5)])).contains("out of range"));
    assert!(refusal(stencils.stencil((u32::MAX, 0.5, 0.5))).contains("out of range"));
}
