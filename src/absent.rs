//! Why a file cannot be read, in words: what the system says names neither the folder that is missing nor the file in its place.

use std::io::{Error, ErrorKind};
use std::path::Path;

/// What is wrong with a path that cannot be read: part of a line, without the path itself.
pub(crate) fn problem(path: &Path, error: &Error) -> String {
    if path.is_dir() {
        return "it is a folder, where a file is wanted".to_owned();
    }
    match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => missing(path),
        ErrorKind::PermissionDenied => "there is no permission to read it".to_owned(),
        _ => error.to_string(),
    }
}

/// What is missing where a path leads nowhere.
pub(crate) fn missing(path: &Path) -> String {
    if path.is_symlink() {
        return "it is a link that leads nowhere".to_owned();
    }
    match no_folder(path.parent()) {
        Some(folder) => format!("no such file: {folder}"),
        // Who ends a path in a slash means a folder, even where a file has the name.
        None if path.as_os_str().as_encoded_bytes().ends_with(b"/") && path.file_name().is_some() => {
            "no such folder".to_owned()
        }
        None if path.extension().is_some() => "no such file".to_owned(),
        None => "no such file or folder".to_owned(),
    }
}

/// Says which of a folder and those that it is in is missing, or is none.
pub(crate) fn no_folder(folder: Option<&Path>) -> Option<String> {
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir())?;
    let above = || no_folder(folder.parent());
    match folder.exists() {
        true => Some(format!("{} is a file, not a folder", folder.display())),
        false => above().or_else(|| Some(format!("the folder {} does not exist", folder.display()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_the_first_part_that_is_not_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("file"), "").expect("a writable folder");
        let said = |name: &str| missing(&at(name)).replace(&folder.path().display().to_string(), "T");
        assert_eq!(said("a"), "no such file or folder");
        assert_eq!(said("a/"), "no such folder");
        assert_eq!(said("a.obj"), "no such file");
        assert_eq!(said("a/b/c.obj"), "no such file: the folder T/a does not exist");
        assert_eq!(said("file/b/c.obj"), "no such file: T/file is a file, not a folder");
        let error = std::fs::read(folder.path()).expect_err("a folder");
        assert_eq!(problem(folder.path(), &error), "it is a folder, where a file is wanted");
    }
}
