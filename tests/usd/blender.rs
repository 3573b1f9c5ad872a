//! Suzanne and a cube as Blender writes them: usda, usdc, and OBJ, which has neither transforms nor creases.

use std::collections::HashMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use catoptric::mesh::{self, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::{DMat3, DVec3};

fn file(extension: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes/blender");
    let path = folder.join("suzanne_and_cube").with_extension(extension);
    if !path.exists() {
        println!("skipped: no {}", path.display());
    }
    path.exists().then_some(path)
}

/// The arrays of numbers of each Mesh prim, found in the text without a reader of USD.
fn arrays(text: &str) -> Vec<HashMap<String, Vec<f64>>> {
    let prims = text.split("def Mesh").skip(1);
    let array = |line: &str| {
        let (head, values) = line.split_once(" = [")?;
        let numbers = values.split(['(', ')', ',', ']', ' ']).filter_map(|word| word.trim().parse().ok());
        Some((head.split_whitespace().last()?.to_owned(), numbers.collect()))
    };
    prims.map(|prim| prim.lines().filter_map(array).collect()).collect()
}

/// The transforms of the two, as the text says them: translate, rotate about x, y and z, scale.
fn world(prim: usize, p: DVec3) -> DVec3 {
    if prim == 1 {
        return p + DVec3::new(-4.0, 0.0, 0.0);
    }
    let [x, y, z] = [17.188736_f32, 11.459158, 28.647894].map(|degrees| f64::from(degrees).to_radians());
    let turn = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
    DVec3::new(1.0, 2.0, 3.0) + turn * (p * DVec3::new(1.0, 1.5, 1.0))
}

/// An OBJ with tags that says the same as the text.
fn as_obj(prims: &[HashMap<String, Vec<f64>>]) -> String {
    let mut obj = String::from("t interpolateboundary 1/0/0 1\n");
    let mut first = 0;
    for (index, prim) in prims.iter().enumerate() {
        let points = prim["points"].chunks(3).map(|p| DVec3::new(p[0], p[1], p[2]));
        // The numbers of the text are shortest decimals of 32 bits.
        let points: Vec<DVec3> = points.map(|p| world(index, p.as_vec3().as_dvec3())).collect();
        points.iter().for_each(|p| writeln!(obj, "v {:?} {:?} {:?}", p.x, p.y, p.z).expect("it fits"));
        let mut rest = prim["faceVertexIndices"].as_slice();
        for &size in &prim["faceVertexCounts"] {
            let (face, more) = rest.split_at(size as usize);
            let face: Vec<String> = face.iter().map(|v| (*v as usize + 1 + first).to_string()).collect();
            writeln!(obj, "f {}", face.join(" ")).expect("it fits");
            rest = more;
        }
        let pairs = prim.get("creaseIndices").map_or(&[][..], Vec::as_slice);
        let sharpness = prim.get("creaseSharpnesses").map_or(&[][..], Vec::as_slice);
        for (pair, sharpness) in pairs.chunks(2).zip(sharpness) {
            let [a, b] = [pair[0], pair[1]].map(|v| v as usize + first);
            writeln!(obj, "t crease 2/1/0 {a} {b} {sharpness}").expect("it fits");
        }
        let corners = prim.get("cornerIndices").map_or(&[][..], Vec::as_slice);
        for (corner, sharpness) in corners.iter().zip(prim.get("cornerSharpnesses").map_or(&[][..], Vec::as_slice)) {
            writeln!(obj, "t corner 1/1/0 {} {sharpness}", *corner as usize + first).expect("it fits");
        }
        first += points.len();
    }
    obj
}

fn samples(mesh: &SubdivMesh) -> Vec<DVec3> {
    let surface = LimitSurface::new(mesh).expect("a surface");
    let uvs = [[0.0, 0.0], [0.5, 0.5], [0.2, 0.7], [1.0, 0.4]];
    let at = |ptex| uvs.map(|uv| surface.evaluate_ptex(ptex, uv).expect("a point").1.position);
    (0..surface.ptex_count() as u32).flat_map(at).collect()
}

/// To the last bit. The two prims are the other way round in the binary file, in usd-core's view too.
#[test]
fn text_and_binary_give_the_same_surface() {
    let (Some(text), Some(binary)) = (file("usda"), file("usdc")) else { return };
    let [text, binary] = [text, binary].map(|path| mesh::read(&path).expect("a mesh"));
    assert_eq!([text.up, binary.up], [Some(DVec3::Z); 2]);
    assert!(!text.creases.is_empty());
    let [text, binary] = [text, binary].map(|mesh| {
        let mut bits: Vec<_> = samples(&mesh).iter().map(|p| p.to_array().map(f64::to_bits)).collect();
        bits.sort_unstable();
        bits
    });
    assert!(text == binary, "the surfaces differ");
}

/// Within 1e-12 of an OBJ with tags that was written from the text by other means.
#[test]
fn the_surface_is_that_of_an_obj_with_tags() {
    let Some(path) = file("usda") else { return };
    let prims = arrays(&fs::read_to_string(&path).expect("a text"));
    assert_eq!(prims.len(), 2);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let obj = folder.path().join("suzanne_and_cube.obj");
    fs::write(&obj, as_obj(&prims)).expect("a file");
    let [ours, twin] = [&path, &obj].map(|path| samples(&mesh::read(path).expect("a mesh")));
    assert_eq!(ours.len(), twin.len());
    let worst = ours.iter().zip(&twin).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    println!("{} samples, at most {worst:.1e} apart", ours.len());
    assert!(worst <= 1e-12, "{worst:e}");
}

/// Blender's own OBJ has the same points, in world space, to its six decimals, in Y up.
#[test]
fn points_are_those_of_blenders_obj() {
    let (Some(text), Some(obj)) = (file("usda"), file("obj")) else { return };
    let [ours, theirs] = [text, obj].map(|path| mesh::read(&path).expect("a mesh"));
    assert_eq!((&ours.face_sizes, &ours.face_vertices), (&theirs.face_sizes, &theirs.face_vertices));
    for (a, b) in ours.points.iter().zip(&theirs.points) {
        let theirs = DVec3::new(b.x, -b.z, b.y);
        // Half of the last decimal in each coordinate, and 32 bits on the way.
        assert!((*a - theirs).abs().max_element() < 2e-6, "{a} {theirs}");
    }
}
