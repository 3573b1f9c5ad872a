//! Files that are cut off or damaged: a line each, never a panic.

use std::fs;
use std::path::Path;

use catoptric::mesh;

use crate::{HEADER, HOUSE, converted, prim};

const NUMBERS: &str = "int[] creaseIndices = [0, 1, 2]\nint[] creaseLengths = [3]\nfloat[] creaseSharpnesses = [2.5]";

/// A scene in all three formats.
fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let usda = folder.join("mesh.usda");
    let moved = "double3 xformOp:translate = (1, 2, 3)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
    let text = format!("{HEADER}def Xform \"x\"\n{{\n{moved}\n{}\n}}\n", prim("m", &format!("{HOUSE}{NUMBERS}")));
    fs::write(&usda, text).expect("a file");
    let mut files = converted(&usda).to_vec();
    files.push(usda);
    files
}

/// Reads bytes as a file, and gives the message if they are refused.
fn refused(path: &Path, bytes: &[u8]) -> Option<String> {
    fs::write(path, bytes).expect("a file");
    let message = mesh::read(path).err()?.to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with(&path.display().to_string()), "{message}");
    Some(message)
}

#[test]
fn files_cut_off_at_every_hundredth() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for file in files(folder.path()) {
        let whole = fs::read(&file).expect("a file");
        let path = folder.path().join("cut").with_extension(file.extension().expect("an extension"));
        assert_eq!(refused(&path, &whole), None);
        for percent in 0..100 {
            let cut = &whole[..whole.len() * percent / 100];
            assert!(refused(&path, cut).is_some(), "{percent} % of {}", file.display());
        }
    }
}

/// Every byte in turn replaced: refused or read, and over soon.
#[test]
fn files_with_a_damaged_byte() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for file in files(folder.path()) {
        let whole = fs::read(&file).expect("a file");
        let path = folder.path().join("hurt").with_extension(file.extension().expect("an extension"));
        let mut found = 0;
        for at in 0..whole.len() {
            for value in [0, 0xff, whole[at] ^ 0x10] {
                let mut bytes = whole.clone();
                bytes[at] = value;
                found += usize::from(refused(&path, &bytes).is_some());
            }
        }
        assert!(found > 100, "{found} of {} bytes", whole.len());
    }
}

#[test]
fn files_that_are_not_usd() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for extension in ["usd", "usda", "usdc", "usdz"] {
        let path = folder.path().join("mesh").with_extension(extension);
        let name = path.display();
        let missing = mesh::read(&path).expect_err("no file").to_string();
        assert_eq!(missing, format!("{name}: no such file; check the path"));
        assert_eq!(refused(&path, b""), Some(format!("{name}: the file is empty; export the mesh again")));
        let message = refused(&path, b"v 0 0 0\nv 1 0 0\n").expect("not USD");
        assert!(message.contains(": not readable as USD ("), "{message}");
        assert!(message.ends_with("); export the file again"), "{message}");
    }
}
