//! Light rigs as files and presets: what is read, what is refused, and that files say all of a picture.

mod apart;
mod attached;
mod environment;
mod files;
mod grid;
mod presets;
mod refused;
mod remade;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder to work in, with a mesh.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("a writable folder");
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).expect(name)
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
        command.args(args).current_dir(self.0.path()).output().expect("the program starts")
    }

    fn done(&self, args: &[&str]) {
        let output = self.run(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    }

    /// Renders a small picture of a mesh of the tests, and gives its pixels.
    fn drawn(&self, args: &[&str]) -> Vec<u8> {
        let mesh = mesh();
        let mut all = vec!["render", &mesh, "-o", "view.png"];
        all.extend(args);
        if !args.iter().any(|flag| flag.starts_with("--size")) {
            all.push("--size=96x80");
        }
        self.done(&all);
        self.pixels("view.png")
    }

    fn pixels(&self, name: &str) -> Vec<u8> {
        image::open(self.path(name)).expect(name).to_rgba8().into_raw()
    }

    /// What a picture says of how it was made.
    fn made_by(&self, name: &str) -> String {
        let file = std::fs::read(self.path(name)).expect(name);
        let text = catoptric::output::read_png_made_by(std::io::Cursor::new(file));
        text.expect("a PNG").expect("it says how it was made")
    }

    /// Refused with exit code 2, one line, and all files as before.
    fn refused(&self, args: &[&str]) -> String {
        let before = self.names();
        let output = self.run(args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{args:?}: {message}");
        assert_eq!(self.names(), before, "{args:?} left a file");
        message
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("a readable folder");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
        names.sort();
        names
    }
}

/// The mesh of these tests.
fn mesh() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/corner.obj").display().to_string()
}

/// The words of a command line as a shell takes them: quotes only where words begin and end.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut rest = line.trim_start();
    while !rest.is_empty() {
        let (word, after) = match rest.strip_prefix('\'') {
            Some(quoted) => quoted.split_once('\'').expect("a quote ends"),
            None => rest.split_once(' ').unwrap_or((rest, "")),
        };
        words.push(word.to_owned());
        rest = after.trim_start();
    }
    words
}

/// The flags of a recorded command: what follows the mesh, without the digests.
fn flags(made_by: &str) -> Vec<String> {
    let (command, comment) = made_by.split_once(" # ").expect("a comment");
    let version = format!("catoptric {}, mesh ", env!("CARGO_PKG_VERSION"));
    assert!(comment.strip_prefix(&version).is_some_and(|digests| digests.len() >= 16), "{made_by}");
    words(command.split_once("corner.obj ").expect("the mesh").1)
}
