//! What Blender writes: Suzanne and a cube (beside the project), and a bowl of ours (`fixtures/make_blender.py`).

use std::path::{Path, PathBuf};

use catoptric::mesh::{self, SubdivMesh};
use glam::DVec3;

use crate::fixtures::{
    Stage, assert_attributes, assert_same_surface, distance, expected, folder, read_by_usd_core, read_obj, read_prim,
    samples,
};

/// The prim over all that Blender writes.
const BLENDER_ROOT: &str = "root";

fn file(extension: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes/blender");
    let path = folder.join("suzanne_and_cube").with_extension(extension);
    if !path.exists() {
        println!("skipped: no {}", path.display());
    }
    path.exists().then_some(path)
}

/// To the last bit. The two prims may be the other way round in the binary file, in usd-core's view too.
fn assert_text_is_binary([text, binary]: [&Path; 2]) -> [SubdivMesh; 2] {
    let meshes = [text, binary].map(|path| mesh::read(path).expect("a mesh"));
    let mut faces = meshes.each_ref().map(|mesh| {
        let (parts, samples) = (mesh.ptex_parts(), samples(mesh));
        let each = samples.len() / mesh.ptex_count();
        let mut by_part: Vec<_> = parts
            .iter()
            .map(|(part, ptex)| {
                let points = &samples[ptex.start as usize * each..ptex.end as usize * each];
                let bits: Vec<_> = points.iter().map(|p| p.map(|p| p.to_array().map(f64::to_bits))).collect();
                (part.name.clone(), bits)
            })
            .collect();
        by_part.sort();
        by_part
    });
    let count: usize = faces[0].iter().map(|(_, bits)| bits.len()).sum();
    assert!(count > 100, "only {count} samples");
    let [text, binary] = &mut faces;
    assert!(text == binary, "the surfaces differ");
    meshes
}

#[test]
fn suzanne_is_the_same_from_text_and_binary() {
    let (Some(text), Some(binary)) = (file("usda"), file("usdc")) else { return };
    let meshes = assert_text_is_binary([&text, &binary]);
    assert_eq!(meshes.each_ref().map(|mesh| mesh.up), [Some(DVec3::Z); 2]);
    assert!(!meshes[0].creases.is_empty());
}

#[test]
fn the_bowl_is_the_same_from_text_and_binary() {
    let bowl = folder().join("blender_bowl.usda");
    let [mesh, _] = assert_text_is_binary([&bowl, &bowl.with_extension("usdc")]);
    assert_eq!((mesh.creases.len(), mesh.corners.len(), &mesh.holes[..]), (9, 4, &[11][..]));
}

/// Attributes are usd-core's, and the surface is that of an OBJ with tags made of them.
fn assert_as_usd_core(path: &Path, stage: &Stage, count: usize) {
    assert_eq!(stage.times[0].meshes.len(), count);
    for prim in &stage.times[0].meshes {
        // Expected prims are named below the one that Blender puts over all.
        let ours = read_prim(path, &format!("/{BLENDER_ROOT}{}", prim.prim));
        assert_attributes(&ours, prim, &prim.prim);
        let points = distance(&ours, &prim.world());
        assert!(points <= 1e-14, "{}: {points:e}", prim.prim);
        let surface = assert_same_surface(&ours, &read_obj(&prim.as_obj()));
        println!("{}: points {points:.1e} of their size off, surface {surface:.1e} of its diagonal", prim.prim);
    }
}

#[test]
fn suzanne_is_what_usd_core_reads() {
    for path in [file("usda"), file("usdc")].into_iter().flatten() {
        let Some(stage) = read_by_usd_core(&path) else { return };
        assert_as_usd_core(&path, &stage, 2);
    }
}

#[test]
fn the_bowl_is_what_usd_core_reads() {
    for extension in ["usda", "usdc"] {
        let path = folder().join("blender_bowl").with_extension(extension);
        assert_as_usd_core(&path, &expected("blender_bowl"), 1);
    }
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
