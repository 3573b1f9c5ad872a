//! What a package and a bug report need: version, adapters, manual pages, completions.

use super::Folder;
use std::process::{Command, Output};

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn the_version_names_opensubdiv_too() {
    let folder = Folder::new();
    for flag in ["--version", "-V"] {
        let output = folder.run([flag]);
        assert!(output.status.success() && output.stderr.is_empty());
        let said = text(&output.stdout);
        let begin = format!("catoptric {} (OpenSubdiv {}", env!("CARGO_PKG_VERSION"), catoptric::osd::version());
        let rest = said.strip_prefix(&begin).unwrap_or_else(|| panic!("{said}"));
        // The commit is there where the program was built in a working tree.
        let commit = rest.strip_suffix(")\n").expect("one line").trim_start_matches(", commit ");
        let hash = commit.trim_end_matches(", changed");
        assert!(hash.is_empty() || hash.len() == 12 && hash.chars().all(|c| c.is_ascii_hexdigit()), "{said}");
    }
}

fn with_adapter(name: &str, args: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.args(args).env("CATOPTRIC_ADAPTER", name).current_dir(folder.path());
    command.output().expect("the program starts")
}

#[test]
fn adapters_are_listed_and_the_chosen_one_is_marked() {
    let output = with_adapter("software", &["adapters"]);
    let list = text(&output.stdout);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    let chosen: Vec<&str> = list.lines().filter(|line| line.starts_with("* ")).collect();
    assert!(chosen.len() == 1 && chosen[0].contains("  software  "), "{list}");
    let name = chosen[0][2..].split("  ").next().expect("a name");
    // A name that matches nothing: the names that there are, exit code 3.
    let output = with_adapter("GeForce 9999", &["render", "--size", "8x8"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    let line = "catoptric: CATOPTRIC_ADAPTER: no GPU adapter matches \"GeForce 9999\"; this machine has ";
    assert!(said.starts_with(line) && said.contains(name) && said.lines().count() == 1, "{said}");
    // Neither is work that can do without an adapter done without the one that is asked for.
    assert_eq!(with_adapter("GeForce 9999", &["verify", "--only", "0,0,0"]).status.code(), Some(3));
    let output = with_adapter("GeForce 9999", &["adapters"]);
    assert!(output.status.code() == Some(3) && text(&output.stdout).contains(name));
    assert!(!text(&output.stdout).contains('*'));
}

#[test]
fn manual_pages_are_written_for_every_command() {
    let folder = Folder::new();
    let output = folder.run(["man", "share/man1"]);
    assert!(output.status.success() && output.stdout.is_empty(), "{}", text(&output.stderr));
    let said = text(&output.stderr);
    for (page, part) in [
        ("catoptric.1", "catoptric\\-verify(1)"),
        ("catoptric-render.1", "\\-\\-pipeline"),
        ("catoptric-verify.1", "\\-\\-baseline"),
        ("catoptric-adapters.1", "CATOPTRIC_ADAPTER"),
    ] {
        let path = folder.path("share/man1").join(page);
        let text = std::fs::read_to_string(&path).expect(page);
        assert!(text.contains(".TH catoptric") && text.contains(part), "{page}: {text}");
        assert!(said.contains(&format!("wrote share/man1/{page}\n")), "{said}");
    }
    folder.file("file", "");
    assert!(folder.refused(&["man", "file/x"]).contains("file is a file, not a folder"));
}

#[test]
fn completions_are_printed_for_every_shell() {
    let folder = Folder::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let output = folder.run(["completions", shell]);
        let text = text(&output.stdout);
        assert!(output.status.success() && output.stderr.is_empty());
        assert!(text.contains("pipeline") && text.contains("adapters"), "{shell}: {text}");
    }
}
