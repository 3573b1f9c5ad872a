//! Standard streams that are full, closed, or read by nobody.

use super::{Folder, mesh, refusal};
use std::fs::File;
use std::process::{Command, Output, Stdio};

/// Commands that write to standard output.
fn talkers() -> Vec<Vec<String>> {
    let cube = mesh("cube");
    let commands = [
        "info MESH",
        "info MESH --json",
        "lines MESH --count=3",
        "eval MESH --samples samples.csv",
        "quality MESH",
        "verify MESH --size=16x16",
        "glints MESH --light-point=1,4,5 --eye=3.5,-2.5,4",
        "--help",
        "--version",
        "render --help",
    ];
    let words = |line: &str| line.split(' ').map(|word| word.replace("MESH", &cube)).collect();
    commands.map(words).into()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("samples.csv", "face,u,v\n0,0.5,0.5\n");
    folder
}

fn command(folder: &Folder, args: &[String]) -> Command {
    folder.command(&args.iter().map(String::as_str).collect::<Vec<_>>())
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_is_full() {
    let folder = folder();
    for args in talkers() {
        let full = File::options().write(true).open("/dev/full").expect("a device");
        let output = command(&folder, &args).stdout(full).output().expect("the program starts");
        let message = refusal(&output);
        assert!(message.contains("cannot write to standard output"), "{args:?}: {message}");
    }
}

/// `catoptric ... | head -0`: whoever read it has seen enough.
#[test]
fn output_that_nobody_reads() {
    let folder = folder();
    for args in talkers() {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = command(&folder, &args).stdout(writer).output().expect("the program starts");
        let message = String::from_utf8_lossy(&output.stderr);
        // The verdict is that of the command, which found out all the same.
        let read = command(&folder, &args).output().expect("the program starts");
        assert_eq!(output.status.code(), read.status.code(), "{args:?}: {message}");
        assert!(matches!(read.status.code(), Some(0 | 1)), "{args:?}");
        assert!(!message.contains("catoptric: "), "{args:?}: {message}");
    }
}

/// `catoptric ... >&-`: an answer that goes nowhere is an error, also where the program starts itself again to silence a layer of Mesa.
#[test]
fn output_that_is_closed() {
    let folder = folder();
    for args in talkers() {
        for redirection in [">&-", "1</dev/null"] {
            let message = refusal(&by_shell(&folder, redirection, &args));
            assert!(message.contains("standard output is"), "{args:?} {redirection}: {message}");
        }
        // Whoever discards the answer on purpose has it: for writing alone, as shells do, and for both, as Python does.
        for redirection in [">/dev/null", "1<>/dev/null"] {
            let output = by_shell(&folder, redirection, &args);
            // Poles of a cube are beyond what `quality` takes, which is its verdict.
            let verdict = i32::from(args[0] == "quality");
            assert_eq!(output.status.code(), Some(verdict), "{args:?} {redirection}");
        }
    }
    let args = [String::from("info"), mesh("cube")];
    let mut shell = Command::new("sh");
    shell.args(["-c", "exec \"$0\" \"$@\" >&-", env!("CARGO_BIN_EXE_catoptric")]).args(&args);
    shell.env_remove("NODEVICE_SELECT").env_remove("XDG_RUNTIME_DIR");
    refusal(&shell.stdin(Stdio::null()).output().expect("a shell"));
}

/// A check that fails fails, whether or not its report is read to the end.
#[test]
fn verdicts_that_nobody_reads() {
    let folder = folder();
    let args = ["verify", &mesh("cube"), "--size=16x16", "--plant=point"];
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let output = folder.command(&args).stdout(writer).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

fn by_shell(folder: &Folder, redirection: &str, args: &[String]) -> Output {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("exec \"$0\" \"$@\" {redirection}"), env!("CARGO_BIN_EXE_catoptric")]);
    shell.args(args).current_dir(folder.path("."));
    shell.stdin(Stdio::null()).output().expect("a shell")
}

/// No standard streams at all: files are written all the same, never into one of ours.
#[test]
fn streams_that_are_closed() {
    let folder = folder();
    let args: Vec<String> = ["render", &mesh("cube"), "--size=16x16", "-o", "view.png"].map(String::from).into();
    let output = by_shell(&folder, "<&- >&- 2>&-", &args);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(image::open(folder.path("view.png")).expect("a picture").width(), 16);
    let refused: Vec<String> = ["render", "no-such.obj"].map(String::from).into();
    assert_eq!(by_shell(&folder, "<&- >&- 2>&-", &refused).status.code(), Some(2));
}

/// Messages that nobody takes change no exit code.
#[cfg(target_os = "linux")]
#[test]
fn messages_that_are_lost() {
    let folder = folder();
    let cube = mesh("cube");
    for (args, code) in [
        (vec!["render", "no-such.obj"], 2),
        (vec!["render", "--no-such-flag"], 2),
        (vec!["render", &cube, "--size=16x16", "-o", "view.png"], 0),
        (vec!["render", &cube, "--size=16x16", "-o", "view.png", "--timings"], 0),
        (vec!["lines", &cube, "--count=3", "--timings", "-o", "lines.svg"], 0),
    ] {
        let args: Vec<String> = args.into_iter().map(String::from).collect();
        let output = by_shell(&folder, "2>/dev/full", &args);
        assert_eq!(output.status.code(), Some(code), "{args:?}");
    }
}
