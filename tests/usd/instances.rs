//! Instances: the same mesh in several places is stored once, and is what it would be by itself.

use std::fs;
use std::path::Path;
use std::process::Command;

use catoptric::field::{CurvatureKind, Field, Method, Scout};
use catoptric::gpu::{Gpu, NO_PATCH, Sample, TableLayout, View, tables};
use catoptric::mesh::{self, Choice, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::DVec3;

use crate::fixtures::{expected, folder};
use crate::{HEADER, HOUSE, SQUARE, accepted, prim};

fn flattened(mesh: &SubdivMesh) -> SubdivMesh {
    SubdivMesh { parts: Vec::new(), ..mesh.clone() }
}

fn repeats(mesh: &SubdivMesh) -> Vec<Option<u32>> {
    mesh.parts.iter().map(|part| part.repeats.map(|repeat| repeat.part)).collect()
}

/// Asserts that both are one surface within 1e-12 of the size, patch by patch, place by place, neighbour by neighbour.
fn assert_same(mesh: &SubdivMesh) {
    let (shared, flat) =
        (LimitSurface::new(mesh).expect("a surface"), LimitSurface::new(&flattened(mesh)).expect("a surface"));
    assert_eq!(shared.patches(), flat.patches());
    assert!(shared.stored_patches() < flat.stored_patches());
    assert_eq!((shared.ptex_count(), shared.diagonal()), (flat.ptex_count(), flat.diagonal()));
    let near = |a: DVec3, b: DVec3, size: f64| a.distance(b) <= 1e-12 * size.max(flat.diagonal());
    let bounds = [&shared, &flat].map(|surface| surface.bounds().expect("patches"));
    assert!((0..2).all(|k| near(bounds[0][k], bounds[1][k], 0.0)));
    let neighbours = [shared.adjacency(), flat.adjacency()];
    let mut worst = 0.0_f64;
    for patch in 0..flat.patches().len() {
        let classes = [&shared, &flat].map(|surface| surface.class(patch).map(|class| surface.classes()[class]));
        assert_eq!(classes[0], classes[1]);
        for edge in 0..4 {
            assert_eq!(neighbours[0].across(patch, edge), neighbours[1].across(patch, edge));
        }
        for uv in [[0.0, 0.0], [1.0, 1.0], [0.5, 0.25], [1e-5, 3e-6]] {
            let [a, b] = [&shared, &flat].map(|surface| surface.evaluate(patch, uv));
            assert!(near(a.position, b.position, 0.0) && near(a.du, b.du, b.du.length()), "{patch} {uv:?}");
            assert!(near(a.dv, b.dv, b.dv.length()), "{patch} {uv:?}");
            // A corner of three faces and more may have no tangent plane: what is given there is rounding.
            if uv != [0.0, 0.0] || classes[1].is_none_or(|class| class.has_tangent_plane()) {
                assert!(a.normal.distance(b.normal) < 1e-9, "{patch} {uv:?}: {} {}", a.normal, b.normal);
            }
            worst = worst.max(a.position.distance(b.position) / flat.diagonal());
        }
    }
    println!(
        "{}: {} of {} patches stored, at most {worst:.1e} of the diagonal apart",
        mesh.name,
        shared.stored_patches(),
        flat.stored_patches()
    );
    for ptex in 0..flat.ptex_count() as u32 {
        for uv in [[0.0, 0.0], [0.3, 0.9], [1.0, 1.0]] {
            assert_eq!(shared.locate(ptex, uv), flat.locate(ptex, uv));
        }
    }
}

/// Six places by instances and references, and seven of a PointInstancer, in which usd-core has the same points.
#[test]
fn instances_are_what_they_are_by_themselves() {
    let files = ["instances", "scattered"].into_iter().flat_map(|name| ["usda", "usdc", "usdz"].map(|e| (name, e)));
    for (name, extension) in files {
        let mesh = mesh::read(&folder().join(name).with_extension(extension)).expect("a scene");
        let stage = expected(name);
        assert_eq!(mesh.parts.len(), stage.times[0].meshes.len());
        let mut originals = 0;
        for (part, prim) in mesh.parts.iter().zip(&stage.times[0].meshes) {
            assert_eq!(part.name, prim.prim);
            let points = &mesh.points[part.points.start as usize..part.points.end as usize];
            let world = prim.world();
            let size = world.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
            let worst = points.iter().zip(&world).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max) / size;
            assert!(worst <= 1e-14, "{}: {worst:e}", prim.prim);
            assert_eq!(points.len(), world.len());
            originals += usize::from(part.repeats.is_none());
        }
        let prototypes = if name == "scattered" { 2 } else { 1 };
        assert_eq!(originals, prototypes, "{:?}", repeats(&mesh));
        assert_same(&mesh);
    }
}

#[test]
fn copies_are_instances_too_and_others_are_not() {
    let moved = |name: &str, mesh: &str, by: f64| {
        let place =
            format!("double3 xformOp:translate = ({by}, 0, 0)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]");
        prim(name, &format!("{mesh}{place}"))
    };
    let crease = "int[] creaseIndices = [1, 2]\nint[] creaseLengths = [2]\nfloat[] creaseSharpnesses = [3]\n";
    let creased = format!("{HOUSE}{crease}");
    let holed = format!("{HOUSE}int[] holeIndices = [1]\n");
    let scene = prim("a", HOUSE) + &moved("b", SQUARE, 1.0) + &moved("c", HOUSE, 3.0) + &moved("d", &creased, 6.0);
    let scene = scene
        + &moved("e", &creased, 9.0)
        + &moved("f", SQUARE, 12.0)
        + &moved("g", &holed, 15.0)
        + &moved("h", &holed, 20.0);
    let mesh = accepted(&scene);
    assert_eq!(repeats(&mesh), [None, None, Some(0), None, Some(3), Some(1), None, Some(6)]);
    assert_same(&mesh);
    // One that mirrors has its faces the other way round.
    let scaled = |name: &str, x: f64| {
        let scale = format!("double3 xformOp:scale = ({x}, 1, 2)\nuniform token[] xformOpOrder = [\"xformOp:scale\"]");
        prim(name, &format!("{creased}{scale}"))
    };
    let mesh = accepted(&(scaled("a", -1.0) + &scaled("b", 3.0) + &scaled("c", -2.0) + &scaled("d", 0.5)));
    assert_eq!(repeats(&mesh), [None, None, Some(0), Some(1)]);
    assert_same(&mesh);
    // A scale of 0 cannot be undone.
    let flat = "double3 xformOp:scale = (1, 1, 0)\nuniform token[] xformOpOrder = [\"xformOp:scale\"]";
    let mesh = accepted(&(prim("a", &format!("{HOUSE}{flat}")) + &prim("b", HOUSE)));
    assert_eq!(repeats(&mesh), [None, None]);
    // Parts that say they are what they are not are taken as they are.
    let mut wrong = accepted(&scene);
    wrong.parts[3].repeats = wrong.parts[2].repeats;
    let surface = LimitSurface::new(&wrong).expect("a surface");
    assert_eq!(surface.stored_patches(), surface.patches().len());
}

/// Tables hold the points of originals alone, and give what f64 gives, in every layout.
#[test]
fn tables_are_shared() {
    let mesh = mesh::read(&folder().join("instances.usdc")).expect("a scene");
    let gpu = Gpu::new().expect("an adapter");
    let [shared, flat] = [mesh.clone(), flattened(&mesh)].map(|mesh| LimitSurface::new(&mesh).expect("a surface"));
    let uvs = [[0.0, 0.0], [0.5, 0.5], [1.0, 0.25], [0.001, 0.0007], [0.01, 0.3]];
    let patches = 0..shared.patches().len() as u32;
    let samples: Vec<Sample> = patches.flat_map(|patch| uvs.map(|uv| Sample { patch, uv })).collect();
    for layout in TableLayout::ALL {
        let [small, large] = [&shared, &flat].map(|surface| gpu.upload_as(surface, layout).expect("it fits"));
        assert_eq!(small.size(), tables::bytes(&shared, layout));
        assert!(small.size() < large.size(), "{layout}: {} of {} bytes", small.size(), large.size());
        let (mut position, mut angle, mut flat_angle) = (0.0_f64, 0.0_f64, 0.0_f64);
        let [small_jets, large_jets] =
            [&small, &large].map(|tables| gpu.evaluate(tables, &samples).expect("the adapter works"));
        for ((sample, jet), twin) in samples.iter().zip(small_jets).zip(large_jets) {
            let exact = flat.evaluate(sample.patch as usize, sample.uv.map(f64::from));
            position = position.max(jet.position.distance(exact.position) / flat.diagonal());
            angle = angle.max(jet.normal.angle_between(exact.normal).to_degrees());
            flat_angle = flat_angle.max(twin.normal.angle_between(exact.normal).to_degrees());
            // Derivatives of 24 bits, moved by matrices of 24 bits.
            let long = twin.du.length().max(twin.dv.length());
            assert!(jet.du.distance(twin.du).max(jet.dv.distance(twin.dv)) <= 1e-5 * long, "{sample:?}");
        }
        println!(
            "{layout}: {} of {} bytes; {position:.1e} of the diagonal, {angle:.1e} degrees, {flat_angle:.1e} flattened",
            small.size(),
            large.size()
        );
        // What the fragment tier allows, and no more than twice what the flattened tables do.
        assert!(position <= 2e-6 && angle <= 1e-3_f64.max(2.0 * flat_angle), "{layout}: {position:e} {angle:e}");
    }
}

/// Pictures of both show the same points, within what each certifies.
#[test]
fn pictures_are_those_of_the_flattened_scene() {
    let mesh = mesh::read(&folder().join("instances.usdc")).expect("a scene");
    let gpu = Gpu::new().expect("an adapter");
    let surfaces = [LimitSurface::new(&mesh), LimitSurface::new(&flattened(&mesh))].map(|s| s.expect("a surface"));
    let scout = Scout::new(&surfaces[1]).expect("it has faces");
    let camera = scout.camera([240, 180], DVec3::Y);
    let view = View::new(camera, scout.light(&camera));
    let curvature = Method::Curvature(CurvatureKind::Mean);
    let curved = View { field: Field { method: curvature, ..view.field.clone() }, ..view.clone() };
    let tables = surfaces.each_ref().map(|surface| gpu.upload_as(surface, TableLayout::Expanded).expect("it fits"));
    let [a, b] = tables.each_ref().map(|tables| gpu.inspect(tables, &curved).expect("a picture"));
    let mut compared = 0;
    for k in (0..a.patch.len()).filter(|&k| a.patch[k] == b.patch[k]) {
        if let (Some(p), Some(q)) = (a.field[k], b.field[k]) {
            // Second derivatives lose more of the 24 bits.
            assert!((p.x - q.x).abs() <= 1e-3 * (p.x.abs() + 1.0), "{p} {q}");
            compared += 1;
        }
    }
    assert!(compared > 3000, "only {compared} curvatures");
    let tables = surfaces.each_ref().map(|surface| gpu.upload(surface).expect("it fits"));
    println!("{} and {} bytes", tables[0].size(), tables[1].size());
    let [a, b] = tables.each_ref().map(|tables| gpu.inspect(tables, &view).expect("a picture"));
    let (mut both, mut either, mut apart, mut turned) = (0, 0, 0.0_f64, 0.0_f32);
    for k in 0..a.patch.len() {
        either += usize::from(a.patch[k] != NO_PATCH || b.patch[k] != NO_PATCH);
        if a.patch[k] == NO_PATCH || b.patch[k] == NO_PATCH {
            continue;
        }
        both += 1;
        let [p, q] = [a.position[k], b.position[k]].map(|p| camera.project(p).expect("in front of the eye"));
        let certified = f64::from(a.certificate[k].residual + b.certificate[k].residual);
        apart = apart.max((p[0] - q[0]).hypot(p[1] - q[1]) - certified);
        if a.patch[k] == b.patch[k] {
            let difference: f32 = (0..3).map(|i| (a.normal[k][i] - b.normal[k][i]).powi(2)).sum();
            turned = turned.max(difference.sqrt());
        }
    }
    println!("{both} pixels; at most {apart:.1e} pixels apart beyond what is certified, normals {turned:.1e}");
    // Silhouettes may fall either way in 32 bits.
    assert!(both > 3000 && either - both <= 2, "{both} of {either}");
    // Certificates hold (u,v) in 32 bits, and positions have 24 bits of the object: 0.001 pixels of 240.
    assert!(apart <= 1e-3, "{apart:e}");
    assert!(turned < 2e-4, "{turned:e}");
}

/// Every place is judged against OpenSubdiv.
#[test]
fn verify_passes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = prim("a", HOUSE)
        + &prim(
            "b",
            &format!(
                "{HOUSE}double3 xformOp:translate = (1, 3, 2)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]"
            ),
        );
    fs::write(folder.path().join("two.usda"), HEADER.to_owned() + &scene).expect("a file");
    let run = |file: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
        let told = command.args(["verify", "--size", "96x96"]).arg(file).output().expect("the program starts");
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stdout));
    };
    run(&folder.path().join("two.usda"));
    run(&crate::fixtures::folder().join("scattered.usda"));
}

#[test]
fn instances_are_chosen_by_number() {
    let path = folder().join("scattered.usda");
    let names = |prim: &str| {
        let choice = Choice { prims: vec![prim.to_owned()], ..Choice::default() };
        let mesh = mesh::read_choice(&path, &choice).map_err(|error| error.to_string())?;
        Ok::<_, String>(mesh.parts.into_iter().map(|part| part.name).collect::<Vec<_>>().join(" "))
    };
    assert_eq!(names("/world/scatter[5]").as_deref(), Ok("/world/scatter[5]/crown"));
    assert_eq!(names("/world/scatter[2]").as_deref(), Ok("/world/scatter[2]"));
    assert_eq!(names("/world").map(|names| names.split(' ').count()), Ok(7));
    // Instance 3 is invisible, and prototypes are not shown by themselves.
    assert!(names("/world/scatter[3]").is_err() && names("/world/scatter/stone").is_err());
}

/// `inactiveIds` of all layers together, in stages of text and of crates, and through instances.
#[test]
fn inactive_ids_are_composed() {
    let to = tempfile::tempdir().expect("a temporary folder");
    let ids = "int64[] ids = [5, 7, 9, 11]\nint64[] invisibleIds = [11]\nint[] protoIndices = [0, 0, 0, 0]\n\
               point3f[] positions = [(0, 0, 0), (4, 0, 0), (8, 0, 0), (12, 0, 0)]\nrel prototypes = </W/I/P>\n";
    let lists = "prepend inactiveIds = [7]\nappend inactiveIds = [9.]";
    let instancer = format!("def PointInstancer \"I\" (\n{lists}\n)\n{{\n{ids}{}}}\n", prim("P", SQUARE));
    let layer = to.path().join("layer.usda");
    let text = format!("{HEADER}(\n    defaultPrim = \"W\"\n)\ndef Xform \"W\"\n{{\n{instancer}}}\n");
    fs::write(&layer, text).expect("a file");
    let over = "over \"I\" (\n    delete inactiveIds = [9]\n)\n{\n}\n";
    let stage = format!(
        "{HEADER}def \"A\" (\n    instanceable = 1\n    references = @./layer.usda@\n)\n{{\n}}\n\
         def \"B\" (\n    references = @./layer.usda@\n)\n{{\n{over}}}\n\
         def \"C\" (\n    references = @./layer.usda@\n)\n{{\n{}}}\n",
        over.replace("delete inactiveIds = [9]", "inactiveIds = [5]")
    );
    let path = to.path().join("stage.usda");
    fs::write(&path, stage).expect("a file");
    let mesh = mesh::read(&path).expect("a scene");
    let names: Vec<&str> = mesh.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["/A/I[0]", "/B/I[0]", "/B/I[2]", "/C/I[1]", "/C/I[2]"]);
}
