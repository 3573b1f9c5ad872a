//! The regression against OpenSubdiv over every mesh at hand: the project's own, and the corpus beside it if it is there.

use catoptric::gpu::Gpu;
use catoptric::mesh::{self, SubdivMesh};
use catoptric::verify::{MeshReport, Settings, verify};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// OBJ files of a folder below the project's; none if it does not exist.
fn meshes(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(&folder).into_iter().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "obj"));
    paths.sort();
    println!("{}: {} meshes", folder.display(), paths.len());
    paths
}

fn check(gpu: &Gpu, mesh: &SubdivMesh) -> MeshReport {
    let report = verify(mesh, gpu, &Settings { size: [96, 96], ..Settings::default() })
        .unwrap_or_else(|error| panic!("{}: {error}", mesh.name));
    assert!(report.pass, "{report}");
    report
}

#[test]
fn own_meshes_pass_at_the_origin_and_far_from_it() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    let mut own: Vec<_> =
        meshes("tests/meshes").iter().map(|path| mesh::read(path).expect("a test mesh is valid")).collect();
    assert!(own.len() >= 20);
    own.push(mesh::sample());
    for mesh in &own {
        let report = check(&gpu, mesh);
        let kinds = report.patches.values().filter(|&&count| count > 0).count();
        let dyadic = report.tiers.iter().filter(|row| row.tier == "dyadic").count();
        assert_eq!(dyadic, 2 * kinds, "every kind of patch is checked, with stencils and patches: {report}");
        // A thousand units away the reference itself loses digits, OpenSubdiv works in world coordinates: the tolerances
        // know how many.
        check(&gpu, &mesh.translated(DVec3::new(1000.0, -500.0, 200.0)));
    }
}

/// A sheet of 6 x 6 quads; `place` makes points of grid positions.
fn sheet(name: &str, place: impl Fn(f64, f64) -> DVec3) -> SubdivMesh {
    let grid = |i: u32| (f64::from(i % 7), f64::from(i / 7));
    let corners = |i: u32| (i % 7 < 6 && i < 42).then_some([i, i + 1, i + 8, i + 7]);
    let face_vertices: Vec<u32> = (0..49).filter_map(corners).flatten().collect();
    SubdivMesh {
        name: name.to_owned(),
        points: (0..49).map(grid).map(|(x, y)| place(x, y)).collect(),
        face_sizes: vec![4; 36],
        face_vertices,
        ..SubdivMesh::default()
    }
}

/// Samples whose normal was not judged.
fn skipped(report: &MeshReport) -> usize {
    report.tiers.iter().map(|row| row.normals_skipped).sum()
}

#[test]
fn shapes_without_normals_pass_and_say_what_was_not_judged() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    let shapes = [
        sheet("all points equal", |_, _| DVec3::new(1.25, 2.5, -3.7)),
        sheet("all points 0", |_, _| DVec3::ZERO),
        sheet("a line", |x, y| DVec3::new(1.1 * x + 0.9 * y, 0.3, 0.7)),
        sheet("a line between the axes", |x, y| DVec3::new(0.1, 0.3, 0.7) * (1.1 * x + 0.9 * y)),
        sheet("scales far apart", |x, y| DVec3::new(x + 0.1 * y, 1e-14 * y, 1e-14 * (x * y).sin())),
    ];
    for mesh in &shapes {
        let report = check(&gpu, mesh);
        assert!(skipped(&report) > 0, "{report}");
        assert!(report.to_string().contains("normals that rounding alone turns too far"), "{report}");
        // No pixel sees them: the shader is checked all the same.
        let all = report.tiers.iter().find(|row| row.reference == "f64 all patches").expect("a row");
        assert_eq!(all.samples, 36 * 8);
    }
    // A pillow: two triangles back to back. Its rim is a fold, where normals have no direction.
    let corner = |angle: f64| DVec3::new(angle.cos(), angle.sin(), -0.1 * angle.sin());
    let pillow = SubdivMesh {
        name: "pillow".to_owned(),
        points: [0.0, 2.1, 4.2].map(corner).to_vec(),
        face_sizes: vec![3, 3],
        face_vertices: vec![0, 1, 2, 2, 1, 0],
        ..SubdivMesh::default()
    };
    let report = check(&gpu, &pillow);
    assert!(skipped(&report) > 0, "{report}");
    assert!(report.reference_not_asked >= 2 * 6 * 32, "both Bfr tiers count: {report}");
}

#[test]
fn well_shaped_meshes_have_every_normal_judged() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    let wave = sheet("wave", |x, y| DVec3::new(x, y, (x + 0.3 * y).sin()));
    assert_eq!(skipped(&check(&gpu, &wave)), 0);
    assert_eq!(skipped(&check(&gpu, &wave.translated(DVec3::splat(100.0)))), 0);
}

#[test]
fn thin_surfaces_are_looked_at_from_near() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    // It runs through the middle of the picture, between the centres of four pixels.
    let thread = sheet("thread", |x, y| DVec3::new(x, 0.0, 4e-3 * y));
    let report = verify(&thread, &gpu, &Settings { size: [2, 2], ..Settings::default() }).expect("it runs");
    let seen = report.tiers.iter().find(|row| row.tier == "fragment" && row.reference == "f64").expect("a row");
    assert!(report.pass && seen.samples == 4 && seen.normal_max_deg.is_some(), "{report}");
}

/// OpenSubdiv's end cap beside an infinitely sharp dart is wrong everywhere, not at the dart alone.
#[test]
fn end_caps_at_darts_are_known_to_be_wrong() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    let mut lens = mesh::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/valence_2_interior.obj"))
        .expect("a test mesh is valid");
    let faces = |vertex: u32| lens.faces().filter(|(_, face)| face.contains(&vertex)).count();
    let tip = (0..lens.points.len() as u32).find(|&v| faces(v) == 2 && interior(&lens, v)).expect("a valence of 2");
    let (_, face) = lens.faces().find(|(_, face)| face.contains(&tip)).expect("a face");
    let at = face.iter().position(|&v| v == tip).expect("it is there");
    let vertices = [tip, face[(at + 1) % face.len()]];
    lens.creases.push(mesh::Crease { vertices, sharpness: 10.0 });
    let report = check(&gpu, &lens);
    let known = |row: &&catoptric::verify::KnownWrong| row.row.tier == "dyadic" && row.row.kind == "dart";
    let row = &report.reference_known_wrong.iter().find(known).expect("it is listed").row;
    assert!(row.samples > 2 && row.tolerance_position == Some(1e-2), "{report}");
}

/// Whether every edge of the vertex has two faces.
fn interior(mesh: &SubdivMesh, vertex: u32) -> bool {
    let mut neighbours = std::collections::BTreeMap::<u32, usize>::new();
    for (_, face) in mesh.faces() {
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            match vertex {
                v if v == a => *neighbours.entry(b).or_default() += 1,
                v if v == b => *neighbours.entry(a).or_default() += 1,
                _ => {}
            }
        }
    }
    neighbours.values().all(|&count| count == 2)
}

#[test]
fn the_corpus_passes_without_the_bad_faces_that_we_know() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    for path in meshes("../shared/meshes/opensubdiv").iter().chain(&meshes("../shared/meshes/blender")) {
        let name = path.file_stem().expect("a file").to_string_lossy().into_owned();
        match mesh::read(path) {
            Ok(mesh) => {
                let known = ["catmark_nonman_edges", "catmark_nonman_quadpole8"];
                assert_eq!(!mesh.bad_faces.is_empty(), known.contains(&name.as_str()), "{:?}", mesh.notes);
                let report = check(&gpu, &mesh);
                println!("{name}: {} patches", report.patches.values().sum::<usize>());
            }
            Err(error) => panic!("{error}"),
        }
    }
}

/// OpenSubdiv's patches at vertices that are not manifold can be off, which the report says by name; its limit masks are right.
#[test]
fn patches_at_vertices_that_are_not_manifold_are_known_to_be_wrong() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/verify/not_manifold.obj");
    let report = check(&gpu, &mesh::read(&path).expect("the mesh is valid"));
    let known: Vec<_> =
        report.reference_known_wrong.iter().filter(|known| known.reason.contains("not manifold")).collect();
    assert!(known.iter().any(|known| known.row.position_max > 1e-6), "they are off");
}
