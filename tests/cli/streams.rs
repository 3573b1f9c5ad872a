//! `-` is standard output where a file is written: one of them, and nothing else goes there.

use super::{Folder, mesh};

/// Standard output and standard error of a run that must end with this exit code.
fn streams(folder: &Folder, args: &str, code: i32) -> (Vec<u8>, String) {
    let cube = mesh("cube").display().to_string();
    let output = folder.run(args.split_whitespace().map(|word| if word == "MESH" { &cube } else { word }));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{args}: {said}");
    assert_eq!(folder.names(), ["samples.csv"], "{args}");
    assert!(!said.contains("wrote -"), "{args}: {said}");
    (output.stdout, said)
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("samples.csv", "face,u,v\n0,0.5,0.5\n");
    folder
}

#[test]
fn pictures_go_to_standard_output() {
    let folder = folder();
    let (png, _) = streams(&folder, "render MESH -o - --size 40x30", 0);
    let picture = image::load_from_memory_with_format(&png, image::ImageFormat::Png).expect("a PNG and nothing else");
    assert_eq!((picture.width(), picture.height()), (40, 30));
    let (exr, _) = streams(&folder, "render MESH -o - --output-format exr --size 40x30", 0);
    assert_eq!(exr[..4], [0x76, 0x2f, 0x31, 0x01], "OpenEXR's magic number");
    let made_by = catoptric::output::read_exr_made_by(std::io::Cursor::new(&exr)).expect("a whole file");
    assert!(made_by.is_some_and(|text| text.contains("--size=40x30")));
    // Its corners are beyond the limits: exit code 1.
    let (png, list) = streams(&folder, "quality MESH -o - --size 40x30", 1);
    image::load_from_memory_with_format(&png, image::ImageFormat::Png).expect("a PNG and nothing else");
    assert!(list.contains("cube"), "the list goes to standard error instead: {list}");
}

#[test]
fn texts_go_to_standard_output() {
    let folder = folder();
    let json = |args: &str, code: i32| -> serde_json::Value {
        serde_json::from_slice(&streams(&folder, args, code).0).expect("JSON and nothing else")
    };
    assert_eq!(json("verify MESH --size 16x16 --json -", 0)["pass"], true);
    assert_eq!(json("render MESH -o /dev/null --output-format png --size 16x16 --json -", 0)["pictures"], 1);
    assert!(json("quality MESH --json -", 1)["limits"].is_object());
    assert!(json("lines MESH --count 2 -o -", 0)["curves"].is_array());
    let (_, said) = streams(&folder, "verify MESH --size 16x16 --json -", 0);
    assert!(said.contains("pass: 1 mesh against OpenSubdiv"), "the text goes to standard error: {said}");
    let (failed, said) = streams(&folder, "verify MESH --size 16x16 --plant point:1 --json -", 1);
    assert!(serde_json::from_slice::<serde_json::Value>(&failed).is_ok() && said.contains("FAIL: "), "{said}");
    for (args, begin) in [
        ("verify MESH --size 16x16 --junit -", "<?xml"),
        ("verify MESH --size 16x16 --html -", "<!doctype html>"),
        ("verify MESH --samples-out - --samples 1", "face,u,v\n"),
        ("lines MESH --count 2 -o - --output-format svg", "<?xml"),
        ("lines MESH --count 2 -o - --output-format usda", "#usda 1.0"),
        ("eval MESH --samples samples.csv -o -", "face,u,v,x,y,z,"),
        ("glints MESH --light-point=1,4,5 --eye=3.5,-2.5,4 -o -", "light,face,u,v,"),
    ] {
        let (text, _) = streams(&folder, args, 0);
        assert!(text.starts_with(begin.as_bytes()), "{args}: {}", String::from_utf8_lossy(&text));
    }
    let (rig, _) = streams(&folder, "render MESH -o /dev/null --output-format png --size 16x16 --save-rig -", 0);
    let rig = String::from_utf8(rig).expect("a text");
    assert!(toml::from_str::<toml::Table>(&rig).is_ok_and(|rig| rig.contains_key("camera")), "{rig}");
    // As without it.
    let [with, without] = ["-o -", ""].map(|o| streams(&folder, &format!("eval MESH --samples samples.csv {o}"), 0).0);
    assert_eq!(with, without);
}

#[test]
fn two_outputs_do_not_share_it() {
    let folder = folder();
    for (args, part) in [
        ("render MESH -o - --json -", "standard output (-) is named for -o and --json; write one of them to a file"),
        ("verify MESH --json - --junit -", "standard output (-) is named for --json and --junit"),
        ("quality MESH -o - --json -", "standard output (-) is named for -o and --json"),
        ("render MESH -o - --save-rig -", "standard output (-) is named for"),
        ("render MESH -o - --frames 3 --orbit 90", "standard output (-) takes one picture, and this is a series"),
    ] {
        let (text, said) = streams(&folder, args, 2);
        assert!(text.is_empty() && said.contains(part) && said.lines().count() == 1, "{args}: {said}");
    }
}
