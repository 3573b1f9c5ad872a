//! The conformance test as a user of another program meets it: files in and out, exit codes, the example in Python.

use super::command::schema_errors;
use super::{file, json, text};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn mesh(name: &str) -> String {
    file(name).to_str().expect("a UTF-8 path").to_owned()
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("a writable folder");
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).expect("it was written")
    }

    fn run(&self, args: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_catoptric")).args(args).current_dir(&self.0).output().expect("it starts")
    }

    /// Runs what must end with this exit code; what it says on both outputs.
    fn ends(&self, code: i32, args: &[&str]) -> String {
        let output = self.run(args);
        let text = text(&[output.stdout, output.stderr].concat());
        assert_eq!(output.status.code(), Some(code), "{args:?}: {text}");
        text
    }
}

#[test]
fn our_own_answers_pass_by_every_backend() {
    let folder = Folder::new();
    let mesh = mesh("hole");
    folder.ends(0, &["verify", &mesh, "--samples-out", "s.csv", "--samples", "30"]);
    let set = folder.read("s.csv");
    assert_eq!(set.lines().next(), Some("face,u,v"));
    for (backend, tolerance) in [("cpu", "1e-11,1e-6,1e-9"), ("gpu", "2e-6")] {
        folder.ends(0, &["eval", &mesh, "--samples", "s.csv", "-o", "r.csv", "--backend", backend]);
        let args = ["verify", &mesh, "--results", "r.csv", "--samples", "30", "--json", "v.json", "--junit", "v.xml"];
        let text = folder.ends(0, &[&args[..], &["--tolerance", tolerance]].concat());
        assert!(text.contains("r.csv for hole: pass"), "{text}");
        let report = json(&folder.path("v.json"));
        let mesh = &report["meshes"][0];
        assert_eq!((&report["pass"], &mesh["results"]["complete"]), (&true.into(), &true.into()));
        assert!(mesh["tiers"].as_array().expect("rows").iter().all(|row| row["tier"] == "results"));
        assert_eq!(schema_errors(&report), [""; 0]);
        assert!(folder.read("v.xml").contains("standard samples answered"));
    }
    // A part is no pass unless it is asked for.
    let part: String = folder.read("r.csv").lines().take(20).map(|line| format!("{line}\n")).collect();
    folder.write("part.csv", &part);
    let text = folder.ends(1, &["verify", &mesh, "--results", "part.csv", "--samples", "30"]);
    assert!(text.contains("standard samples without an answer"), "{text}");
    folder.ends(0, &["verify", &mesh, "--results", "part.csv", "--samples", "30", "--partial"]);
    // Swapped columns are a wrong answer, and named.
    folder.write("swapped.csv", &folder.read("r.csv").replacen("face,u,v", "face,v,u", 1));
    let text = folder.ends(1, &["verify", &mesh, "--results", "swapped.csv", "--samples", "30"]);
    assert!(text.contains("diagnosis: u and v are swapped"), "{text}");
}

#[test]
fn bad_answers_are_refused_with_their_line() {
    let folder = Folder::new();
    let mesh = mesh("cube");
    let header = "face,u,v,x,y,z";
    for (text, expected) in [
        (String::new(), ":1: the header has no column face"),
        ("face,u,v,x,y\n0,0,0,1,1\n".into(), ":1: the header has no column z"),
        ("face,u,v,x,x,y,z\n0,0,0,1,1,1,1\n".into(), ":1: column x is there twice"),
        (format!("{header},xu,yu\n"), ":1: the header has some of xu,yu,zu"),
        (format!("{header},xu,yu,zu\n"), ":1: the header has derivatives by one of u and v only"),
        (format!("{header},nx\n"), ":1: the header has some of nx,ny,nz"),
        (format!("{header}\n"), "no row has an answer"),
        (format!("{header}\n0,0,0,,,\n0,0,1,nan,nan,nan\n"), "no row has an answer"),
        (format!("{header}\n0,0,0,1,1\n"), ":2: it has more or fewer fields"),
        (format!("{header}\n0,0,0,1,1,1,1\n"), ":2: it has more or fewer fields"),
        (format!("{header}\n0,0,0,1,1,1\n\n1.5,0,0,1,1,1\n"), ":4: face = '1.5'"),
        (format!("{header}\n-1,0,0,1,1,1\n"), ":2: face = '-1'"),
        (format!("{header}\n6,0,0,1,1,1\n"), ":2: ptex face 6 does not exist; the mesh has 6"),
        (format!("{header}\n0,half,0,1,1,1\n"), ":2: u = 'half'"),
        (format!("{header}\n0,0,,1,1,1\n"), ":2: v = ''"),
        (format!("{header}\n0,0,nan,1,1,1\n"), ":2: v = NaN is outside"),
        (format!("{header}\n0,1.5,0,1,1,1\n"), ":2: u = 1.5 is outside"),
        (format!("{header}\n0,0,0,1,one,1\n"), ":2: 'one' is not a number"),
        (format!("{header},nx,ny,nz\n0,0,0,1,1,1,-nan(ind),0,0\n"), ":2: '-nan(ind)' is not a number"),
    ] {
        folder.write("r.csv", &text);
        let message = folder.ends(2, &["verify", &mesh, "--results", "r.csv", "--json", "v.json"]);
        assert!(
            message.lines().count() == 1 && message.contains(&format!("r.csv{expected}")) || expected.starts_with("no"),
            "{message}"
        );
        assert!(message.contains(expected) && !folder.path("v.json").exists(), "{text:?}: {message}");
    }
    std::fs::write(folder.path("r.csv"), b"face,u,v,x,y,z\n0,0,0,1,\xff,1\n").expect("a writable folder");
    assert!(
        folder
            .ends(2, &["verify", &mesh, "--results", "r.csv"])
            .contains("r.csv:2: it has more or fewer fields than the header, or is not text")
    );
    for (args, expected) in [
        (&["--results", "no-such.csv"][..], "no-such.csv: cannot read the answers"),
        (&["--results", "."], "folder"),
        (&["--results", "r.csv", "--tolerance", "0"], "above 0"),
        (&["--results", "r.csv", "--tolerance", "1e-6,1e-3,1e-6,1"], "one to three"),
        (&["--results", "r.csv", "--tolerance", "1e-6,nan"], "above 0"),
        (&["--results", "r.csv", "--samples", "0"], "--samples"),
        (&["--results", "r.csv", "--only", "0,0,0"], "--only"),
        (&["--samples", "9"], "--samples"),
        (&["--partial"], "--results"),
        (&["--samples-out", "no-such-folder/s.csv"], "no-such-folder"),
        (&["--samples-out", "s.csv", "--results", "r.csv"], "--results"),
        (&["--samples-out", "s.csv", &self::mesh("dart")], "one mesh, not 2"),
    ] {
        let message = folder.ends(2, &[&["verify", &mesh], args].concat());
        assert!(message.lines().count() == 1 && message.contains(expected), "{args:?}: {message}");
        assert!(!folder.path("s.csv").exists());
    }
}

/// docs/CONFORMANCE.md, word for word.
#[test]
#[ignore = "needs python3: script/test installs it and runs this"]
fn the_example_in_python_conforms() {
    let folder = Folder::new();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/python/evaluate.py");
    for name in ["cube", "n_gons"] {
        let mesh = mesh(name);
        folder.ends(0, &["verify", &mesh, "--samples-out", "samples.csv"]);
        let args = [&mesh, "samples.csv"];
        let python = Command::new("python3").arg(&script).args(args).current_dir(&folder.0).output().expect("python3");
        assert!(python.status.success(), "{}", text(&python.stderr));
        std::fs::write(folder.path("results.csv"), python.stdout).expect("a writable folder");
        // It counts in 64 bits, so it is as good as the rounding of 64 bits.
        let args = ["verify", &mesh, "--results", "results.csv", "--partial", "--tolerance", "1e-12,1e-6"];
        let text = folder.ends(0, &args);
        assert!(text.contains("Far level 10  normal"), "{text}");
        // It answers a part, and says so.
        assert!(folder.ends(1, &args[..4]).contains("standard samples without an answer"));
    }
}
