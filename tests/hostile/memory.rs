//! Limits of the shell on memory and threads: a command does its work, or says in one line which limit is in its way.

use super::{Folder, mesh};
use std::process::{Command, Output};

/// Runs the program by a shell after `ulimit` with these flags.
fn limited(folder: &Folder, limit: &str, args: &[&str]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit {limit} && exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_catoptric")]);
    command.args(args).current_dir(folder.path(".")).env("NODEVICE_SELECT", "1").env_remove("RUST_BACKTRACE");
    command.output().expect("a shell")
}

/// A sheet of so many quads each way, some of them creased, as an OBJ.
fn sheet(side: usize) -> String {
    let mut text = String::new();
    for k in 0..(side + 1) * (side + 1) {
        let (i, j) = (k % (side + 1), k / (side + 1));
        text += &format!("v {i} {j} {}\n", (i * j) % 7);
    }
    for k in 0..side * side {
        let first = k / side * (side + 1) + k % side + 1;
        text += &format!("f {first} {} {} {}\n", first + 1, first + side + 2, first + side + 1);
    }
    text
}

/// From far too little address space to enough, in steps: exit code 0, or 2 and one line that names the limit.
#[cfg(target_os = "linux")]
#[test]
fn address_space_in_steps() {
    let folder = Folder::new();
    folder.write("sheet.obj", sheet(60));
    folder.write("samples.csv", "face,u,v\n0,0.5,0.5\n");
    let small = mesh("cube");
    let commands: [(&[&str], u64); 8] = [
        (&["info", &small], 400),
        (&["info", "sheet.obj"], 1000),
        (&["eval", "sheet.obj", "--samples", "samples.csv"], 1000),
        (&["lines", "sheet.obj", "--count=5", "-o", "lines.svg"], 1000),
        (&["quality", "sheet.obj"], 1500),
        (&["render", &small, "--size=64x64", "-o", "small.png"], 1500),
        (&["render", "sheet.obj", "--size=64x64", "-o", "view.png"], 2500),
        (&["verify", &small, "--size=16x16"], 2500),
    ];
    let mut refused = 0;
    for (args, enough) in commands {
        for mebibytes in [70, 90, 120, 170, 250, 340, 400, 450, 550, 700, 1000, 1500, 2500, 8000] {
            let output = limited(&folder, &format!("-v {}", mebibytes << 10), args);
            let message = String::from_utf8_lossy(&output.stderr);
            match output.status.code() {
                Some(0) => {}
                // What is wrong with the sheet.
                Some(1) if args[0] == "quality" => {}
                Some(2) => {
                    assert!(
                        message.lines().count() == 1 && message.contains("ulimit -v"),
                        "{args:?} {mebibytes}: {message}"
                    );
                    assert!(mebibytes < enough, "{args:?} {mebibytes}: {message}");
                    refused += 1;
                }
                _ => panic!("{args:?} in {mebibytes} MiB: {}: {message}", output.status),
            }
        }
    }
    assert!(refused > 20, "{refused}");
}

/// The limit of the data size is told from that of the address space.
#[cfg(target_os = "linux")]
#[test]
fn data_sizes_are_limits_too() {
    let folder = Folder::new();
    let output =
        limited(&folder, &format!("-d {}", 200 << 10), &["render", &mesh("cube"), "--size=64x64", "-o", "v.png"]);
    let message = String::from_utf8_lossy(&output.stderr);
    let is_told = message.contains("ulimit -d") && message.lines().count() == 1;
    assert!(output.status.success() || output.status.code() == Some(2) && is_told, "{}: {message}", output.status);
}
