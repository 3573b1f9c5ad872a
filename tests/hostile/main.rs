//! What goes wrong outside: files that end too early, disks that are full, folders that are locked, signals, odd arguments.
//! One line and exit code 2, and every file whole.

mod degenerate;
mod inputs;
#[cfg(unix)]
mod memory;
mod mutated;
#[cfg(unix)]
mod streams;
mod truncated;
mod values;
#[cfg(unix)]
mod writes;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder to work in.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, content).expect("a writable folder");
        path
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
        command.args(args).current_dir(self.0.path());
        command
    }

    fn run(&self, args: &[&str]) -> Output {
        self.command(args).output().expect("the program starts")
    }

    /// Refused: exit code 2, one line, and all files as before.
    fn refused(&self, args: &[&str]) -> String {
        let before = self.names();
        let message = refusal(&self.run(args));
        assert_eq!(self.names(), before, "{args:?} left a file");
        message
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("a readable folder");
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name();
        let mut names: Vec<String> = entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// The one line of a run that must have been refused.
fn refusal(output: &Output) -> String {
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("catoptric: ") && !message.contains("panicked"), "{message}");
    message
}

/// A mesh of the tests.
fn mesh(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj").display().to_string()
}
