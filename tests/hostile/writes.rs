//! Writes that fail or are stopped: nothing half-written, nothing left beside it, the old file as it was.

use super::{Folder, mesh, refusal};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const OLD: &[u8] = b"what was there before";

/// The commands that write a file, each with what it takes to be larger than 8 KiB.
fn writers() -> Vec<(&'static str, Vec<String>)> {
    let cube = mesh("cube");
    [
        ("view.png", "render MESH --size=256x256 -o"),
        ("view.exr", "render MESH --size=64x64 -o"),
        ("lines.svg", "lines MESH --count=40 -o"),
        ("lines.dxf", "lines MESH --count=40 -o"),
        ("lines.obj", "lines MESH --count=40 -o"),
        ("lines.usda", "lines MESH --count=40 -o"),
        ("lines.json", "lines MESH --count=40 -o"),
        ("eval.csv", "eval MESH --samples samples.csv -o"),
        ("quality.png", "quality MESH --size=128x128 -o"),
        ("quality.json", "quality MESH --json"),
        ("report.html", "verify MESH --size=16x16 --html"),
        ("report.json", "verify MESH --size=16x16 --json"),
        ("set.csv", "verify MESH --samples-out"),
    ]
    .map(|(name, words)| {
        let words = words.split(' ').map(|word| if word == "MESH" { cube.clone() } else { word.to_owned() });
        (name, words.chain([name.to_owned()]).collect())
    })
    .into()
}

fn folder() -> Folder {
    let folder = Folder::new();
    let rows: String = (0..400).map(|i| format!("{},{},0.5\n", i % 6, f64::from(i) / 400.0)).collect();
    folder.write("samples.csv", format!("face,u,v\n{rows}"));
    folder
}

/// Runs the program by a shell that limits the size of files to a number of blocks of 512 bytes.
fn limited(folder: &Folder, blocks: u32, args: &[String]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -f {blocks} && exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_catoptric")]);
    command.args(args).current_dir(folder.path(".")).env("NODEVICE_SELECT", "1").output().expect("a shell")
}

/// A file cannot grow beyond 4 KiB: as on a full disk, a write fails in the middle, and every format says so.
#[test]
fn disks_that_are_full() {
    let folder = folder();
    for (name, args) in writers() {
        folder.write(name, OLD);
        let before = folder.names();
        let message = refusal(&limited(&folder, 8, &args));
        assert!(message.contains(&format!("{name}: cannot write: ")), "{message}");
        assert!(!message.contains(".part"), "{message}");
        assert_eq!(std::fs::read(folder.path(name)).expect("the old file"), OLD, "{name}");
        assert_eq!(folder.names(), before, "{name} left a file");
        // And without the limit it is written.
        let output = folder.run(&args.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(matches!(output.status.code(), Some(0 | 1)), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(
            std::fs::metadata(folder.path(name)).expect("the new file").len() > 4096,
            "{name} is too small to tell"
        );
    }
}

/// The third frame does not fit: two are there, whole, and one line says which one is not.
#[test]
fn disks_that_fill_up_in_a_series() {
    let folder = folder();
    let small = mesh("cube");
    let first = folder.run(&["render", &small, "--size=64x64", "-o", "v.png", "--frames=3", "--orbit=90"]);
    assert!(first.status.success());
    let args: Vec<String> =
        ["render", &small, "--size=400x400", "-o", "v.png", "--frames=3", "--orbit=90"].map(String::from).into();
    let message = refusal(&limited(&folder, 8, &args));
    assert!(message.contains("v_0001.png: cannot write"), "{message}");
    for i in 1..=3 {
        let frame = image::open(folder.path(&format!("v_000{i}.png"))).expect("the old frame");
        assert_eq!(frame.width(), 64);
    }
    assert_eq!(folder.names(), ["samples.csv", "v_0001.png", "v_0002.png", "v_0003.png"]);
}

/// A device without room is a disk without room.
#[cfg(target_os = "linux")]
#[test]
fn devices_that_are_full() {
    let folder = folder();
    for (name, args) in writers() {
        std::os::unix::fs::symlink("/dev/full", folder.path(name)).expect("a link");
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let message = folder.refused(&args);
        assert!(message.contains(&format!("{name}: cannot write: ")), "{message}");
    }
}

/// Where nothing can be written is known before the work.
#[test]
fn places_that_cannot_be_written() {
    let folder = folder();
    std::fs::create_dir(folder.path("locked")).expect("a folder");
    std::fs::set_permissions(folder.path("locked"), PermissionsExt::from_mode(0o555)).expect("its owner");
    folder.write("file", OLD);
    // Nothing is locked to root.
    let is_root = std::fs::write(folder.path("locked/probe"), "").is_ok();
    let mut places = vec!["no-such-folder/", "file/", "/proc/"];
    if is_root {
        std::fs::remove_file(folder.path("locked/probe")).expect("it was written");
    } else {
        places.push("locked/");
    }
    for (name, args) in writers() {
        for place in &places {
            let target = format!("{place}{name}");
            let args: Vec<&str> = args[..args.len() - 1].iter().map(String::as_str).chain([target.as_str()]).collect();
            let message = folder.refused(&args);
            assert!(message.contains(&target) && message.contains("cannot write"), "{message}");
        }
        std::fs::create_dir(folder.path(name)).expect("a folder");
        let message = folder.refused(&args.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(message.contains("it is a folder"), "{message}");
        std::fs::remove_dir(folder.path(name)).expect("it is empty");
    }
    assert_eq!(std::fs::read(folder.path("file")).expect("a file"), OLD);
}

/// A file that may not be written stands in a folder that may: it is replaced as `mv` would, whole.
#[test]
fn links_and_locked_files_are_replaced() {
    let folder = folder();
    let cube = mesh("cube");
    folder.write("target.png", OLD);
    std::os::unix::fs::symlink("target.png", folder.path("view.png")).expect("a link");
    assert!(folder.run(&["render", &cube, "--size=16x16", "-o", "view.png"]).status.success());
    assert_eq!(std::fs::read(folder.path("target.png")).expect("the old file"), OLD);
    assert_eq!(image::open(folder.path("view.png")).expect("a picture").width(), 16);
    let mode = std::fs::metadata(folder.path("view.png")).expect("a file").permissions().mode();
    let usual = std::fs::metadata(folder.path("target.png")).expect("a file").permissions().mode();
    assert_eq!(mode & 0o777, usual & 0o777, "the rights of any new file");
}

/// The files that are being written: hidden ones of ours.
fn parts(folder: &Folder) -> Vec<String> {
    folder.names().into_iter().filter(|name| name.starts_with(".catoptric-")).collect()
}

/// Stopped while a file is being written, by each signal that can be caught: the old file stays, nothing else does.
#[test]
fn stopped_in_the_middle_of_a_write() {
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        let folder = folder();
        folder.write("big.exr", OLD);
        // 120 MB, which take a second to pack.
        let cube = mesh("cube");
        // Whoever runs the tests may ignore some (`nohup`, `&` in a script), and what is ignored when we start stays ignored.
        let mut child = Command::new("env");
        child.args(["--default-signal=INT,TERM,HUP", env!("CARGO_BIN_EXE_catoptric")]).current_dir(folder.path("."));
        child.args(["render", &cube, "--size=2048x1024", "--samples=1", "-o", "big.exr"]);
        let mut child = child.stderr(Stdio::null()).spawn().expect("the program starts");
        let mut seen = 0;
        while seen < 3 && child.try_wait().expect("a child").is_none() {
            // Not the probe at the start, which is gone at once.
            let size = |name: &String| std::fs::metadata(folder.path(name)).map_or(0, |file| file.len());
            seen = if parts(&folder).iter().any(|name| size(name) > 0) { seen + 1 } else { 0 };
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(
            Command::new("sh")
                .args(["-c", &format!("kill -{signal} {}", child.id())])
                .status()
                .expect("a shell")
                .success()
        );
        let status = child.wait().expect("a child");
        assert_eq!(status.signal(), Some(number), "it dies of the signal, as a shell expects: {status}");
        assert_eq!(folder.names(), ["big.exr", "samples.csv"], "SIG{signal}");
        assert_eq!(std::fs::read(folder.path("big.exr")).expect("the old file"), OLD);
    }
}

/// Killed, which nothing can catch: the old file stays; what is left is hidden, and in nobody's way.
#[test]
fn killed_in_the_middle_of_a_write() {
    let folder = folder();
    folder.write("big.exr", OLD);
    let cube = mesh("cube");
    let mut child = folder.command(&["render", &cube, "--size=2048x1024", "--samples=1", "-o", "big.exr"]);
    let mut child = child.stderr(Stdio::null()).spawn().expect("the program starts");
    while !parts(&folder).iter().any(|name| std::fs::metadata(folder.path(name)).is_ok_and(|file| file.len() > 0)) {
        assert!(child.try_wait().expect("a child").is_none(), "it was faster");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("a child");
    child.wait().expect("a child");
    assert_eq!(std::fs::read(folder.path("big.exr")).expect("the old file"), OLD);
    let others: Vec<String> = folder.names().into_iter().filter(|name| !name.starts_with('.')).collect();
    assert_eq!(others, ["big.exr", "samples.csv"]);
}
