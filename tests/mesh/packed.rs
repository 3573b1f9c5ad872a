//! Files that gzip packed, and contents without a file.

use std::fs;
use std::io::Write;
use std::path::Path;

use catoptric::mesh::{self, Choice, MeshFile, MeshFormat};
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::{QUAD, manifest_path};

fn packed(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content).unwrap();
    encoder.finish().unwrap()
}

const USDA: &str = "#usda 1.0\ndef Mesh \"m\"\n{\n    point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n    \
    int[] faceVertexCounts = [4]\n    int[] faceVertexIndices = [0, 1, 2, 3]\n}\n";

#[test]
fn packed_files_are_read_as_what_they_hold() {
    let folder = tempfile::tempdir().unwrap();
    let plain = fs::read(manifest_path("tests/meshes/hole.obj")).unwrap();
    let mut expected = mesh::read(&manifest_path("tests/meshes/hole.obj")).unwrap();
    for name in ["part.obj.gz", "part.OBJ.GZ", "part.obj"] {
        let path = folder.path().join(name);
        // Members may follow one another.
        let (one, other) = plain.split_at(plain.len() / 2);
        fs::write(&path, [packed(one), packed(other)].concat()).unwrap();
        expected.name = "part".to_owned();
        assert_eq!(mesh::read(&path).unwrap(), expected, "{name}");
    }
    let path = folder.path().join("stage.usda.gz");
    fs::write(&path, packed(USDA.as_bytes())).unwrap();
    let stage = mesh::read(&path).unwrap();
    assert_eq!((stage.name.as_str(), stage.parts[0].name.as_str(), stage.face_count()), ("stage", "/m", 1));
    fs::write(&path, packed(USDA.replace("[4]", "[5]").as_bytes())).unwrap();
    let message = mesh::read(&path).unwrap_err().to_string();
    assert!(message.contains("stage.usda.gz: /m: the face sizes add up to 5"), "{message}");
}

#[test]
fn damaged_packages_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let whole = packed(format!("{QUAD}f 1 2 3 4\n").as_bytes());
    let mut wrong = whole.clone();
    let middle = wrong.len() / 2;
    wrong[middle] ^= 0x55;
    for name in ["mesh.obj.gz", "mesh.usda.gz"] {
        let path = folder.path().join(name);
        for bytes in [&whole[..whole.len() - 3], &whole[..2], &wrong[..]] {
            fs::write(&path, bytes).unwrap();
            let message = mesh::read(&path).unwrap_err().to_string();
            assert!(message.contains(&format!("{name}: not a file that gzip wrote (")), "{message}");
            assert!(message.ends_with("; pack it again, or give it unpacked") && message.lines().count() == 1);
        }
    }
    let message = mesh::read(Path::new("no-such.obj.gz")).unwrap_err().to_string();
    assert_eq!(message, "no-such.obj.gz: no such file; check the path");
    let other = folder.path().join("car.fbx.gz");
    fs::write(&other, &whole).unwrap();
    let message = mesh::read(&other).unwrap_err().to_string();
    assert!(message.contains("car.fbx.gz: only .obj, "), "{message}");
}

#[test]
fn contents_without_a_file() {
    let obj = format!("{QUAD}f 1 2 3 4\nf 1 2 2\n");
    for content in [obj.clone().into_bytes(), packed(obj.as_bytes())] {
        let file = MeshFile::of_bytes(content, MeshFormat::Obj, "standard input", "stdin").unwrap();
        let mesh = file.read(&Choice::default()).unwrap();
        assert_eq!((mesh.name.as_str(), mesh.face_count()), ("stdin", 2));
        let strict = Choice { strict: true, ..Choice::default() };
        let message = file.read(&strict).unwrap_err().to_string();
        assert!(message.starts_with("standard input:6: a face with vertex 2 twice"), "{message}");
        let timed = Choice { time: Some(1.0), ..Choice::default() };
        assert!(file.read(&timed).unwrap_err().to_string().starts_with("standard input: an OBJ has no time"));
    }
    for format in [MeshFormat::Usd, MeshFormat::Usda] {
        let file = MeshFile::of_bytes(USDA.into(), format, "standard input", "stdin").unwrap();
        assert_eq!(file.read(&Choice::default()).unwrap().name, "stdin");
        let message = MeshFile::of_bytes(b"#usda 1.0\ndef (".to_vec(), format, "standard input", "stdin").unwrap_err();
        assert!(message.to_string().starts_with("standard input: not readable as USD ("), "{message}");
        let message = MeshFile::of_bytes(Vec::new(), format, "standard input", "stdin").unwrap_err();
        assert_eq!(message.to_string(), "standard input: the file is empty; export the mesh again");
    }
}

#[test]
fn formats_are_known_by_name_and_content() {
    let of = |name: &str| MeshFormat::of_path(Path::new(name));
    assert_eq!(
        [of("a.obj"), of("a.b.USDZ"), of("a.usd.gz")],
        [Some(MeshFormat::Obj), Some(MeshFormat::Usdz), Some(MeshFormat::Usd)]
    );
    assert_eq!([of("a.gz"), of("obj"), of("a.obj.gz.gz"), of("a.gz.obj.x")], [None; 4]);
    assert_eq!(MeshFormat::ALL.map(MeshFormat::extension), mesh::EXTENSIONS);
    let content = |content: &[u8]| MeshFormat::of_content(content);
    assert_eq!(content(USDA.as_bytes()), MeshFormat::Usda);
    assert_eq!(content(b"PXR-USDC\0"), MeshFormat::Usdc);
    assert_eq!(content(b"PK\x03\x04"), MeshFormat::Usdz);
    assert_eq!([content(b""), content(b"v 0 0 0\n")], [MeshFormat::Obj; 2]);
}
