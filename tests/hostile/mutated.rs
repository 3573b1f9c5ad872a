//! OBJ files with errors that hands and programs make: whatever the text says, there is an answer or one line, and no
//! panic.

use super::{Folder, mesh};
use catoptric::curves;
use catoptric::field::{Method, Scout};
use catoptric::gpu::{Gpu, View};
use catoptric::mesh::{SubdivMesh, parse_obj};
use catoptric::quality::{Limits, Quality, Reading};
use catoptric::stam::LimitSurface;
use glam::DVec3;

/// SplitMix64 (Steele, Lea & Flood 2014).
struct Rng(u64);

impl Rng {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % end.max(1) as u64) as usize
    }

    fn of<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }
}

/// What stands in a file in place of something else.
const TOKENS: [&str; 18] = [
    "0",
    "1",
    "-1",
    "2",
    "5",
    "99",
    "1/1/1",
    "-9",
    "1e30",
    "1e-30",
    "nan",
    "-1.#IND",
    "x",
    "#",
    "\\",
    "",
    "4294967297",
    "0.5",
];

/// One error: a line that is gone, there twice, or elsewhere; a token that is another; a character that is wrong.
fn mutate(text: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut lines: Vec<Vec<u8>> = text.split(|&b| b == b'\n').map(<[u8]>::to_vec).collect();
    let at = rng.below(lines.len());
    match rng.below(7) {
        0 => drop(lines.remove(at)),
        1 => lines.insert(at, lines[at].clone()),
        2 => {
            let other = rng.below(lines.len());
            lines.swap(at, other);
        }
        3 if !lines[at].is_empty() => {
            let byte = rng.below(lines[at].len());
            lines[at][byte] = *rng.of(b"0123456789 -./\\#vftx\t\xff");
        }
        4 => {
            let length = rng.below(lines[at].len() + 1);
            lines[at].truncate(length);
        }
        _ => {
            let mut tokens: Vec<Vec<u8>> = lines[at].split(|&b| b == b' ').map(<[u8]>::to_vec).collect();
            let token = rng.below(tokens.len());
            // Mostly vertices of a face or tag: another number of the same file.
            tokens[token] = if rng.below(2) == 0 {
                (1 + rng.below(30)).to_string().into_bytes()
            } else {
                rng.of(&TOKENS).as_bytes().to_vec()
            };
            lines[at] = tokens.join(&b' ');
        }
    }
    lines.join(&b'\n')
}

/// A pole of triangles, and an n-gon beside a quad: many faces at a vertex, many vertices in a face.
fn pole_and_n_gon(valence: usize) -> Vec<u8> {
    let mut text = "v 0 0 1\n".to_owned();
    for k in 0..valence {
        let (sin, cos) = (k as f64 * std::f64::consts::TAU / valence as f64).sin_cos();
        text += &format!("v {cos} {sin} 0\n");
    }
    for k in 0..valence {
        text += &format!("f 1 {} {}\n", k + 2, (k + 1) % valence + 2);
    }
    text += "f";
    for k in (0..valence).rev() {
        text += &format!(" {}", k + 2);
    }
    (text + "\n").into_bytes()
}

fn sources() -> Vec<(String, Vec<u8>)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/trials");
    let entries = std::fs::read_dir(folder).expect("the trials are there");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "obj"));
    paths.sort();
    assert!(paths.len() >= 8, "{paths:?}");
    let read = |path: &std::path::PathBuf| (path.display().to_string(), std::fs::read(path).expect("a file"));
    let mut sources: Vec<_> = paths.iter().map(read).collect();
    sources.push(("pole and n-gon".to_owned(), pole_and_n_gon(12)));
    for name in ["semi_sharp_crease", "hole"] {
        sources.push((name.to_owned(), std::fs::read(mesh(name)).expect("a file")));
    }
    sources
}

/// Surface, quality, lines and a picture, as the commands make them.
fn use_mesh(mesh: &SubdivMesh, gpu: &Gpu) -> Result<(), String> {
    let surface = LimitSurface::new(mesh).map_err(|error| error.to_string())?;
    let Some(scout) = Scout::new(&surface) else { return Err("no surface".to_owned()) };
    let camera = scout.camera([64, 64], DVec3::Z);
    let field = scout.field(&Method::Reflection, &camera);
    Quality::measure(mesh, &surface, Some(Reading { field: &field, camera: &camera }), &Limits::default());
    let values = [-1, 0, 1].map(|k| (k, f64::from(k) * field.light.spacing));
    curves::trace(&surface, &field, &camera, &values, 1e-3 * surface.diagonal());
    let tables = gpu.upload(&surface).map_err(|error| error.to_string())?;
    let view = View { samples: 1, ..View::new(camera, field.light) };
    gpu.render(&tables, &view).map(drop).map_err(|error| error.to_string())
}

/// A hundred copies of each, read and used in this process: a panic or a signal would end it.
#[test]
fn a_hundred_copies_of_each() {
    let gpu = Gpu::new().expect("these tests need a Vulkan adapter: script/setup installs one");
    for (name, text) in sources() {
        let mut rng = Rng(name.len() as u64 + text.len() as u64);
        let (mut used, mut unusable, mut refused, mut left_out) = (0, 0, 0, 0);
        for _ in 0..100 {
            let errors = 1 + rng.below(3);
            let copy = (0..errors).fold(text.clone(), |text, _| mutate(&text, &mut rng));
            match parse_obj(&copy, "copy.obj") {
                Ok(mesh) => {
                    mesh.validate().unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&copy)));
                    left_out += usize::from(!mesh.bad_faces.is_empty());
                    match use_mesh(&mesh, &gpu) {
                        Ok(()) => used += 1,
                        Err(line) => {
                            assert_eq!(line.lines().count(), 1, "{line}");
                            unusable += 1;
                        }
                    }
                }
                Err(error) => {
                    let line = error.to_string();
                    assert!(line.starts_with("copy.obj") && !line.chars().any(char::is_control), "{line:?}");
                    refused += 1;
                }
            }
        }
        println!(
            "{name}: {used} used, bad faces left out of {left_out}, {unusable} without a surface, {refused} refused"
        );
        assert_eq!(used + unusable + refused, 100);
    }
}

/// Some of them by the program: an exit code that is documented, and one line for what is refused.
#[test]
fn some_copies_by_the_program() {
    let folder = Folder::new();
    for (name, text) in sources() {
        let mut rng = Rng(7 + text.len() as u64);
        for command in
            [&["info"][..], &["render", "--size=64x64", "-o", "v.png"], &["quality"], &["lines", "-o", "l.json"]]
        {
            let copy = mutate(&mutate(&text, &mut rng), &mut rng);
            folder.write("copy.obj", &copy);
            let args = [command, &["copy.obj"]].concat();
            let output = folder.run(&args);
            let told = String::from_utf8_lossy(&output.stderr);
            let place = || format!("{name} {args:?}: {told}\n{}", String::from_utf8_lossy(&copy));
            assert!(matches!(output.status.code(), Some(0..=2)), "{:?} {}", output.status, place());
            assert!(!told.contains("panicked"), "{}", place());
            if output.status.code() == Some(2) {
                let lines = told.lines().filter(|line| !line.contains("passed over") && !line.contains("left out"));
                assert!(lines.count() <= 3, "{}", place());
            }
        }
    }
}
