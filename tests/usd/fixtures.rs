//! Files that usd-core wrote (`fixtures/make.py`), and what usd-core reads from them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use catoptric::mesh::{self, Boundary, Choice, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::DVec3;
use serde::Deserialize;

/// A stage as usd-core reads it, at some times.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Stage {
    pub meters_per_unit: f64,
    pub up_axis: String,
    pub times: Vec<At>,
}

/// The meshes that are shown at a time; `null` is the default time.
#[derive(Debug, Deserialize)]
pub struct At {
    pub time: Option<f64>,
    pub meshes: Vec<Prim>,
}

/// A Mesh prim, its attributes as they are, and its points in world space.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Prim {
    pub prim: String,
    pub points: Vec<[f32; 3]>,
    pub world: Vec<DVec3Json>,
    /// Whether its transform has a negative determinant.
    pub mirrors: bool,
    pub face_vertex_counts: Vec<u32>,
    pub face_vertex_indices: Vec<u32>,
    pub crease_indices: Vec<u32>,
    pub crease_lengths: Vec<usize>,
    pub crease_sharpnesses: Vec<f32>,
    pub corner_indices: Vec<u32>,
    pub corner_sharpnesses: Vec<f32>,
    pub hole_indices: Vec<u32>,
    pub interpolate_boundary: String,
    pub orientation: String,
    pub subdivision_scheme: String,
    #[serde(default)]
    pub triangle_subdivision_rule: String,
}

pub type DVec3Json = [f64; 3];

pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/usd/fixtures")
}

pub fn expected(name: &str) -> Stage {
    let text = fs::read_to_string(folder().join(name).with_extension("json")).expect("a fixture");
    serde_json::from_str(&text).expect("JSON of make.py")
}

/// What usd-core reads from a file now; `None` where python3 has no usd-core.
pub fn read_by_usd_core(path: &Path) -> Option<Stage> {
    let python = |arguments: &[&std::ffi::OsStr]| Command::new("python3").args(arguments).output().ok();
    let has_usd = python(&["-c".as_ref(), "import pxr, numpy".as_ref()]).is_some_and(|run| run.status.success());
    if !has_usd {
        println!("skipped: python3 has no usd-core (pip install usd-core numpy)");
        return None;
    }
    let script = folder().join("make.py");
    let run = python(&[script.as_ref(), "--print".as_ref(), path.as_ref()]).expect("python3 ran before");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    Some(serde_json::from_slice(&run.stdout).expect("JSON of make.py"))
}

impl Prim {
    pub fn world(&self) -> Vec<DVec3> {
        self.world.iter().copied().map(DVec3::from).collect()
    }

    /// The faces, turned over where orientation and transform ask for it: each keeps its first vertex.
    fn faces(&self) -> Vec<Vec<u32>> {
        let mut rest = self.face_vertex_indices.iter().copied();
        let turned = (self.orientation == "leftHanded") != self.mirrors;
        let face = |&size: &u32| {
            let mut face: Vec<u32> = rest.by_ref().take(size as usize).collect();
            if turned {
                face.reverse();
                face.rotate_right(1);
            }
            face
        };
        self.face_vertex_counts.iter().map(face).collect()
    }

    /// Ends and sharpness of each creased edge.
    fn creases(&self) -> Vec<([u32; 2], f32)> {
        let mut edges = Vec::new();
        let mut chain_of = Vec::new();
        let mut start = 0;
        for (chain, &length) in self.crease_lengths.iter().enumerate() {
            for k in start..start + length - 1 {
                edges.push([self.crease_indices[k], self.crease_indices[k + 1]]);
                chain_of.push(chain);
            }
            start += length;
        }
        let an_edge = self.crease_sharpnesses.len() == edges.len();
        let sharpness = |k: usize| self.crease_sharpnesses[if an_edge { k } else { chain_of[k] }];
        edges.iter().enumerate().map(|(k, &edge)| (edge, sharpness(k))).collect()
    }

    fn corners(&self) -> Vec<(u32, f32)> {
        self.corner_indices.iter().copied().zip(self.corner_sharpnesses.iter().copied()).collect()
    }

    fn boundary(&self) -> Boundary {
        match self.interpolate_boundary.as_str() {
            "none" => Boundary::None,
            "edgeOnly" => Boundary::EdgeOnly,
            "edgeAndCorner" => Boundary::EdgeAndCorner,
            other => panic!("{other}"),
        }
    }

    /// The same as an OBJ with tags.
    pub fn as_obj(&self) -> String {
        let rule = match self.boundary() {
            Boundary::None => 0,
            Boundary::EdgeAndCorner => 1,
            Boundary::EdgeOnly => 2,
        };
        let mut lines = vec![format!("t interpolateboundary 1/0/0 {rule}")];
        lines.extend(self.world.iter().map(|[x, y, z]| format!("v {x:?} {y:?} {z:?}")));
        let index = |vertex: &u32| format!(" {}", vertex + 1);
        lines.extend(self.faces().iter().map(|face| format!("f{}", face.iter().map(index).collect::<String>())));
        lines.extend(self.creases().iter().map(|([a, b], s)| format!("t crease 2/1/0 {a} {b} {s:?}")));
        lines.extend(self.corners().iter().map(|(vertex, s)| format!("t corner 1/1/0 {vertex} {s:?}")));
        lines.extend(self.hole_indices.iter().map(|face| format!("t hole 1/0/0 {face}")));
        lines.join("\n") + "\n"
    }
}

/// Reads the mesh of one prim.
pub fn read_prim(path: &Path, prim: &str) -> SubdivMesh {
    let choice = Choice { prims: vec![prim.to_owned()], ..Choice::default() };
    mesh::read_choice(path, &choice).unwrap_or_else(|error| panic!("{error}"))
}

/// Asserts that all but the points is that of the prim, to the last bit.
pub fn assert_attributes(mesh: &SubdivMesh, prim: &Prim, what: &str) {
    assert_eq!(prim.subdivision_scheme, "catmullClark");
    assert_features(mesh, prim, what);
}

/// As [`assert_attributes`], of any scheme.
pub fn assert_features(mesh: &SubdivMesh, prim: &Prim, what: &str) {
    assert_eq!(mesh.scheme.name(), prim.subdivision_scheme, "{what}");
    assert_eq!(mesh.face_sizes, prim.face_vertex_counts, "{what}");
    assert_eq!(mesh.face_vertices, prim.faces().concat(), "{what}");
    assert_eq!(mesh.creases.iter().map(|c| (c.vertices, c.sharpness)).collect::<Vec<_>>(), prim.creases(), "{what}");
    assert_eq!(mesh.corners.iter().map(|c| (c.vertex, c.sharpness)).collect::<Vec<_>>(), prim.corners(), "{what}");
    assert_eq!(mesh.holes, prim.hole_indices, "{what}");
    assert_eq!(mesh.boundary, prim.boundary(), "{what}");
    assert_eq!(mesh.points.len(), prim.points.len(), "{what}");
}

/// Largest distance of points from usd-core's, over their largest coordinate.
pub fn distance(mesh: &SubdivMesh, world: &[DVec3]) -> f64 {
    let size = world.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    mesh.points.iter().zip(world).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max) / size
}

/// Limit positions at many places of every ptex face, and whether there is a surface.
pub fn samples(mesh: &SubdivMesh) -> Vec<Option<DVec3>> {
    let surface = LimitSurface::new(mesh).expect("a surface");
    let uvs = [[0.0, 0.0], [0.5, 0.5], [0.2, 0.7], [1.0, 0.4], [1e-3, 2e-4], [0.9, 1.0], [0.31, 0.05]];
    let at = |ptex| uvs.map(|uv| Some(surface.evaluate_ptex(ptex, uv)?.1.position));
    (0..surface.ptex_count() as u32).flat_map(at).collect()
}

/// Asserts that two surfaces are one within 1e-12 of their size; how far they are apart.
pub fn assert_same_surface(ours: &SubdivMesh, twin: &SubdivMesh) -> f64 {
    let (size, [ours, twin]) = (twin.diagonal(), [ours, twin].map(samples));
    assert_eq!(ours.len(), twin.len());
    let mut worst = 0.0_f64;
    for (a, b) in ours.iter().zip(&twin) {
        assert_eq!(a.is_some(), b.is_some(), "a hole in one alone");
        worst = worst.max(a.zip(*b).map_or(0.0, |(a, b)| a.distance(b) / size));
    }
    assert!(worst <= 1e-12, "{worst:e}");
    worst
}

/// Writes text as an OBJ and reads it.
pub fn read_obj(text: &str) -> SubdivMesh {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("twin.obj");
    fs::write(&path, text).expect("a file");
    mesh::read(&path).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn fifty_random_meshes_are_as_usd_core_reads_them() {
    let (mut compared, mut creases, mut identical, mut worst) = (0, 0, 0, 0.0_f64);
    for index in 0..10 {
        let name = format!("stage_{index}");
        let stage = expected(&name);
        for extension in ["usda", "usdc", "usdz"] {
            let path = folder().join(&name).with_extension(extension);
            for prim in &stage.times[0].meshes {
                let what = format!("{}: {}", path.display(), prim.prim);
                let mesh = read_prim(&path, &prim.prim);
                assert_attributes(&mesh, prim, &what);
                let world = prim.world();
                let off = distance(&mesh, &world);
                // Some twenty products of rotations, each rounded to 1.1e-16, and usd-core's trigonometry beside Rust's.
                assert!(off <= 1e-14, "{what}: {off:e}");
                worst = worst.max(off);
                let local = prim.points.iter().map(|p| p.map(f64::from)).zip(&prim.world).all(|(p, &w)| p == w);
                if local {
                    assert_eq!(mesh.points, world, "{what}");
                    identical += 1;
                }
                assert_eq!(mesh.meters_per_unit, Some(stage.meters_per_unit), "{what}");
                assert_eq!(mesh.up, Some(if stage.up_axis == "Z" { DVec3::Z } else { DVec3::Y }), "{what}");
                assert_eq!(mesh.parts.len(), 1);
                assert_eq!(mesh.parts[0].name, prim.prim);
                compared += 1;
                creases += mesh.creases.len();
            }
        }
    }
    println!(
        "{compared} meshes, {creases} creased edges, {identical} without transform; points at most {worst:.1e} of their size off"
    );
    assert_eq!(compared, 150);
    assert!(creases > 300, "{creases} creased edges");
}

/// A stage as a whole is its meshes one after the other.
#[test]
fn a_stage_is_its_meshes_together() {
    let mut compared = 0;
    for index in 0..10 {
        let path = folder().join(format!("stage_{index}.usda"));
        let stage = expected(&format!("stage_{index}"));
        let Ok(whole) = mesh::read(&path) else { continue };
        assert_eq!(whole.parts.len(), stage.times[0].meshes.len());
        for (part, prim) in whole.parts.iter().zip(&stage.times[0].meshes) {
            assert_eq!(part.name, prim.prim);
            let alone = read_prim(&path, &prim.prim);
            assert_eq!(whole.points[part.points.start as usize..part.points.end as usize], alone.points);
            assert_eq!(whole.face_sizes[part.faces.start as usize..part.faces.end as usize], alone.face_sizes);
        }
        compared += 1;
    }
    assert!(compared >= 2, "only {compared} stages have one boundary rule");
}

/// The limit surface is that of an OBJ with tags made from usd-core's attributes.
#[test]
fn surfaces_are_those_of_usd_cores_attributes_as_obj() {
    let mut worst = 0.0_f64;
    for index in 0..10 {
        let name = format!("stage_{index}");
        for prim in &expected(&name).times[0].meshes {
            let ours = read_prim(&folder().join(&name).with_extension("usdc"), &prim.prim);
            worst = worst.max(assert_same_surface(&ours, &read_obj(&prim.as_obj())));
        }
    }
    println!("at most {worst:.1e} of the diagonal apart");
}

/// `.usd` may be text or binary.
#[test]
fn usd_is_either_encoding() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let fixture = self::folder().join("blender_bowl.usda");
    let meshes = ["usda", "usdc"].map(|extension| {
        let path = folder.path().join("blender_bowl.usd");
        fs::copy(fixture.with_extension(extension), &path).expect("a copy");
        mesh::read(&path).expect("a mesh")
    });
    assert_eq!(meshes[0], meshes[1]);
    assert_eq!(meshes[0], mesh::read(&fixture).expect("a mesh"));
}
