//! Messages quote what users and files say; they are one line that a terminal takes all the same.

use std::borrow::Cow;

/// Characters beyond which a message is cut.
const LONGEST: usize = 700;

/// The text with control characters as escapes, cut in its middle where it is very long: what is wrong stands first,
/// and what to do last.
pub(crate) fn printable(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() { line.extend(c.escape_default()) } else { line.push(c) }
    }
    let count = line.chars().count();
    if count <= LONGEST {
        return line;
    }
    let part = LONGEST / 2;
    let chars = || line.chars();
    chars().take(part).chain("...".chars()).chain(chars().skip(count - part)).collect()
}

/// A number and what it counts: `1 face`, `2 faces`, `0 vertices`. The noun is given in the singular.
pub(crate) fn count(number: usize, noun: &str) -> String {
    format!("{number} {}", counted(number, noun))
}

/// A noun as it stands after a number. It is given in the singular.
pub(crate) fn counted(number: usize, noun: &str) -> Cow<'_, str> {
    match number {
        1 => noun.into(),
        _ if noun.ends_with("vertex") => format!("{}ices", &noun[..noun.len() - 2]).into(),
        _ if noun.ends_with(['s', 'h', 'x']) => format!("{noun}es").into(),
        _ => format!("{noun}s").into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_their_plural() {
        let all = |noun: &str| [0, 1, 2].map(|number| count(number, noun));
        assert_eq!(all("crease"), ["0 creases", "1 crease", "2 creases"]);
        assert_eq!(all("sharp vertex"), ["0 sharp vertices", "1 sharp vertex", "2 sharp vertices"]);
        assert_eq!(all("patch"), ["0 patches", "1 patch", "2 patches"]);
    }

    #[test]
    fn lines_are_one_line_of_a_length() {
        assert_eq!(printable("a\tb\u{1b}[31m\r\n\u{85}"), "a\\tb\\u{1b}[31m\\r\\n\\u{85}");
        assert_eq!(printable("caf\u{e9}, \u{4e2d}"), "caf\u{e9}, \u{4e2d}");
        let long = printable(&format!("begin {} end", "\u{e9}\0".repeat(1000)));
        assert!(long.starts_with("begin ") && long.ends_with(" end") && long.contains("..."));
        assert_eq!(long.chars().count(), LONGEST + 3);
    }
}
