//! Stages that were refused or read wrongly once, and damaged copies of each.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use catoptric::mesh::{self, Choice, SubdivMesh};
use catoptric::stam::LimitSurface;
use glam::DVec3;

use crate::rng::Rng;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/usd/trials")
}

fn read(name: &str) -> SubdivMesh {
    mesh::read(&folder().join(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn names(mesh: &SubdivMesh) -> Vec<&str> {
    mesh.parts.iter().map(|part| part.name.as_str()).collect()
}

/// The first point of each prim.
fn places(mesh: &SubdivMesh) -> Vec<[f64; 3]> {
    mesh.parts.iter().map(|part| mesh.points[part.points.start as usize].to_array()).collect()
}

#[test]
fn trials_are_what_usd_core_reads() {
    assert_eq!(read("lead_dot.usda").points[0], DVec3::new(-0.5, -1.0, -1.0));
    let mesh = read("mpu_dot.usda");
    assert_eq!((mesh.meters_per_unit, mesh.up), (Some(0.01), Some(DVec3::Z)));
    assert_eq!(read("string_asset.usda").face_count(), 6);
    assert_eq!(read("noval_op.usda").points[0], DVec3::new(0.0, -1.0, -1.0));
    assert_eq!(places(&read("notype_ids.usda")), [[-1.0, -1.0, -1.0], [2.0, -1.0, -1.0]]);
    for name in ["mtlx_ref.usda", "mtlx_missing.usda"] {
        let mesh = read(name);
        assert_eq!((mesh.face_count(), mesh.notes.len()), (6, 1), "{name}");
        assert!(mesh.notes[0].starts_with("passed over: /Looks refers to /"), "{:?}", mesh.notes);
    }
    assert_eq!(names(&read("mixed_scheme.usda")), ["/A", "/B"]);
    let nested = read("nested_instancer.usda");
    assert_eq!(names(&nested), ["/O[0][0]", "/O[0][1]", "/O[1][0]", "/O[1][1]"]);
    assert_eq!(places(&nested), [[0.0, 0.0, 0.0], [0.0, 3.0, 0.0], [5.0, 0.0, 0.0], [5.0, 3.0, 0.0]]);
    assert_eq!(read("concave_none.usda").notes.len(), 1);
    let inactive = read("inactive_ids.usda");
    assert_eq!((names(&inactive), places(&inactive)), (vec!["/I[0]", "/I[2]"], vec![[0.0; 3], [8.0, 0.0, 0.0]]));
    let message = mesh::read(&folder().join("nurbs_patch.usda")).expect_err("it has no mesh").to_string();
    assert!(message.contains("(passed over: 1 NurbsPatch (/N))"), "{message}");
}

/// Velocities count where their samples are those of the positions: 24 a second from frame 1, not half of the way to 8.
#[test]
fn instances_follow_their_velocities() {
    let at = |time| {
        let choice = Choice { time: Some(time), ..Choice::default() };
        mesh::read_choice(&folder().join("velocities.usda"), &choice).expect("a mesh").points[0].x
    };
    assert_eq!([0.0, 1.0, 3.0, 5.0, 6.0].map(at), [-1.0, 0.0, 2.0, 8.0, 9.0]);
}

/// A copy with some bytes flipped, cut off, or with two pieces of it changed over.
fn damaged(text: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = text.to_vec();
    let mut below = |limit: usize| rng.below(limit.max(1));
    match below(4) {
        0 => {
            for _ in 0..=below(4) {
                let at = below(bytes.len());
                bytes[at] ^= 1 << below(8);
            }
        }
        1 => bytes.truncate(below(bytes.len())),
        2 => {
            // Words and marks in each other's place.
            let text = String::from_utf8_lossy(text).into_owned();
            let mut words: Vec<&str> = text.split_inclusive([' ', ',', '(', ')', '[', ']', '\n']).collect();
            for _ in 0..=below(3) {
                let (i, j) = (below(words.len()), below(words.len()));
                words.swap(i, j);
            }
            bytes = words.concat().into_bytes();
        }
        _ => {
            let (from, length) = (below(bytes.len()), below(20));
            let piece = bytes[from..(from + length).min(bytes.len())].to_vec();
            let at = below(bytes.len());
            bytes.splice(at..at, piece);
        }
    }
    bytes
}

/// Read or refused in one line, and over soon.
#[test]
fn damaged_copies_end() {
    let to = tempfile::tempdir().expect("a temporary folder");
    let path = to.path().join("damaged.usda");
    let mut rng = Rng::new(17);
    let (mut read, mut refused) = (0, 0);
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder()).expect("trials").map(|file| file.expect("a file").path()).collect();
    files.sort();
    for file in files.iter().filter(|file| file.extension().is_some_and(|extension| extension == "usda")) {
        let text = fs::read(file).expect("a file");
        for _ in 0..100 {
            let bytes = damaged(&text, &mut rng);
            fs::write(&path, &bytes).expect("a file");
            let start = Instant::now();
            match mesh::read(&path) {
                Ok(mesh) => {
                    read += 1;
                    LimitSurface::new(&mesh)
                        .map(drop)
                        .unwrap_or_else(|error| assert!(!error.to_string().contains('\n')));
                }
                Err(error) => {
                    refused += 1;
                    assert_eq!(error.to_string().lines().count(), 1, "{error}");
                }
            }
            let took = start.elapsed();
            assert!(took < Duration::from_secs(5), "{took:?}: {}", String::from_utf8_lossy(&bytes));
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > 50 && refused > 500, "{read} read, {refused} refused");
}
