//! Stages in random syntax, with all that a mesh and its place can have: the same as usd-core reads.

use std::fs;
use std::path::Path;
use std::process::Command;

use catoptric::mesh::{Choice, MeshFile};

use crate::fixtures::{At, Prim, Stage, assert_features, distance, folder};

const STAGES: usize = 300;

/// Writes the stages and what usd-core reads from them.
fn write_stages(to: &Path) {
    let script = folder().join("random_stages.py");
    let mut python = Command::new("python3");
    let run = python.arg(script).arg(to).args([STAGES.to_string(), "20261201".to_owned()]).output();
    let run = run.expect("python3, with usd-core: pip install usd-core numpy");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// Sums of what was compared.
#[derive(Debug, Default)]
struct Compared {
    meshes: usize,
    instances: usize,
    converted: usize,
    held: f64,
    moving: f64,
}

#[test]
#[ignore = "needs python3 with usd-core, which script/test installs"]
fn stages_in_random_syntax_are_as_usd_core_reads_them() {
    let to = tempfile::tempdir().expect("a temporary folder");
    write_stages(to.path());
    let mut compared = Compared::default();
    for index in 0..STAGES {
        let base = to.path().join(format!("stage_{index}"));
        let text = fs::read_to_string(base.with_extension("json")).expect("JSON of usd-core");
        let stage: Stage = serde_json::from_str(&text).expect("JSON of random_stages.py");
        for extension in ["usda", "usdc"] {
            let path = base.with_extension(extension);
            if path.exists() {
                compare(&path, &stage, &mut compared);
            }
        }
    }
    println!("{compared:?}");
    assert!(compared.meshes > 2500 && compared.instances > 700 && compared.converted > 400, "{compared:?}");
    // Rounding of some twenty products; trigonometry of 32 bits between samples.
    assert!(compared.held <= 1e-13, "{:e}", compared.held);
    assert!(compared.moving <= 1e-6, "{:e}", compared.moving);
}

fn compare(path: &Path, stage: &Stage, compared: &mut Compared) {
    let file = MeshFile::open(path).unwrap_or_else(|error| panic!("{error}"));
    for moment in &stage.times {
        let read = |prims: Vec<String>| {
            let choice = Choice { prims, time: moment.time, ..Choice::default() };
            file.read(&choice).unwrap_or_else(|error| panic!("{} at {:?}: {error}", path.display(), moment.time))
        };
        let whole = read(Vec::new());
        assert_eq!(whole.meters_per_unit, Some(stage.meters_per_unit), "{}", path.display());
        let rules = shown_rules(moment);
        for prim in &moment.meshes {
            let what = format!("{} of {} at {:?}", prim.prim, path.display(), moment.time);
            let alone = read(vec![prim.prim.clone()]);
            let world = prim.world();
            if alone.parts.len() > 1 {
                // A mesh above others is among them.
                assert!(alone.parts.iter().any(|part| part.name == prim.prim), "{what}");
                continue;
            }
            assert_eq!(alone.parts[0].name, prim.prim, "{what}");
            // Faces that are cut are others.
            if alone.notes.is_empty() {
                assert_features(&alone, prim, &what);
            }
            let off = distance(&alone, &world);
            let worst = if moment.time.is_some() { &mut compared.moving } else { &mut compared.held };
            *worst = worst.max(off);
            assert!(off <= 1e-6, "{what}: {off:e}");
            // In the whole, it is the same one in the form of all.
            let part = whole.parts.iter().find(|part| part.name == prim.prim);
            let Some(part) = part else {
                assert!(rules.may_be_left_out(prim), "{what} is not in the whole");
                continue;
            };
            let points = &whole.points[part.points.start as usize..];
            assert_eq!(points[..world.len()], alone.points, "{what}");
            compared.converted += usize::from(part.points.len() > world.len());
            compared.meshes += 1;
            compared.instances += usize::from(prim.prim.contains('['));
        }
        let expected = moment.meshes.len() - whole.parts.len();
        assert!(expected == 0 || whole.notes.iter().any(|note| note.contains("left out")), "{:?}", whole.notes);
    }
}

/// Which rules for triangles a moment has.
struct Rules {
    are_mixed: bool,
}

fn shown_rules(moment: &At) -> Rules {
    let with_triangles = || moment.meshes.iter().filter(|prim| matters(prim));
    let smooth = with_triangles().filter(|prim| prim.triangle_subdivision_rule == "smooth").count();
    Rules { are_mixed: smooth > 0 && smooth < with_triangles().count() }
}

/// Whether the rule for triangles changes a mesh.
fn matters(prim: &Prim) -> bool {
    prim.subdivision_scheme == "catmullClark" && prim.face_vertex_counts.contains(&3)
}

impl Rules {
    fn may_be_left_out(&self, prim: &Prim) -> bool {
        self.are_mixed && matters(prim)
    }
}
