//! Logical lines of a text file: comments cut off, continued lines joined, physical line numbers kept.

use super::number;

/// Lends one logical line after the other.
///
/// A line ends with LF, CR LF or a lone CR. `#` starts a comment, but for that of `-1.#IND` and its like. A line whose
/// last character (before a comment, there is none after it) is `\` goes on in the next one. Only a continued line is
/// copied.
pub(super) struct LogicalLines<'a> {
    rest: &'a [u8],
    number: u32,
    joined: Vec<u8>,
    /// Number of comments so far that say what a crease would, and the line of the first.
    pub(super) crease_comments: (usize, u32),
}

impl<'a> LogicalLines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: text, number: 0, joined: Vec::new(), crease_comments: (0, 0) }
    }

    /// The next logical line and the number, from 1, of the physical line it starts on.
    pub(super) fn next(&mut self) -> Option<(u32, &[u8])> {
        let line = self.physical()?;
        let first = self.number;
        let Some(start) = continued(line) else {
            return Some((first, line));
        };
        self.joined.clear();
        self.joined.extend_from_slice(start);
        while let Some(line) = self.physical() {
            // The break itself separates two tokens.
            self.joined.push(b' ');
            match continued(line) {
                Some(part) => self.joined.extend_from_slice(part),
                None => {
                    self.joined.extend_from_slice(line);
                    break;
                }
            }
        }
        Some((first, &self.joined))
    }

    /// The next physical line, without its end and its comment.
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number = self.number.saturating_add(1);
        let is_end = |b: &u8| *b == b'\n' || *b == b'\r';
        let end = self.rest.iter().position(is_end).unwrap_or(self.rest.len());
        let (line, tail) = self.rest.split_at(end);
        self.rest = tail.strip_prefix(b"\r\n").unwrap_or(tail.get(1..).unwrap_or_default());
        let (line, comment) = without_comment(line);
        if is_crease(comment) {
            let (count, first) = self.crease_comments;
            self.crease_comments = (count + 1, if count == 0 { self.number } else { first });
        }
        Some(line)
    }
}

/// A line, and the comment behind it with its `#`.
fn without_comment(line: &[u8]) -> (&[u8], &[u8]) {
    let mut start = 0;
    while let Some(found) = line[start..].iter().position(|&b| b == b'#') {
        let hash = start + found;
        if !number::has_hash(line, hash) {
            return line.split_at(hash);
        }
        start = hash + 1;
    }
    line.split_at(line.len())
}

/// Whether a comment is the word crease and three numbers or more, as some programs write creases.
fn is_crease(comment: &[u8]) -> bool {
    let text = comment.trim_ascii_start().strip_prefix(b"#").unwrap_or_default().trim_ascii_start();
    let Some((word, numbers)) = text.split_at_checked(6) else { return false };
    let is_number = |token: &str| token.parse::<f64>().is_ok();
    let tokens = || std::str::from_utf8(numbers).unwrap_or("x").split_ascii_whitespace();
    word.eq_ignore_ascii_case(b"crease") && tokens().count() >= 3 && tokens().all(is_number)
}

/// The line without its final `\`, if it has one.
fn continued(line: &[u8]) -> Option<&[u8]> {
    line.trim_ascii_end().strip_suffix(b"\\")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<(u32, String)> {
        let mut lines = LogicalLines::new(text.as_bytes());
        let mut found = Vec::new();
        while let Some((number, line)) = lines.next() {
            found.push((number, String::from_utf8(line.to_vec()).unwrap()));
        }
        found
    }

    fn expected(lines: &[(u32, &str)]) -> Vec<(u32, String)> {
        lines.iter().map(|(n, s)| (*n, (*s).to_owned())).collect()
    }

    #[test]
    fn every_kind_of_line_end_counts_once() {
        assert_eq!(all("a\nb\r\nc\rd"), expected(&[(1, "a"), (2, "b"), (3, "c"), (4, "d")]));
        assert_eq!(all("a\n\r\nb\n"), expected(&[(1, "a"), (2, ""), (3, "b")]));
    }

    #[test]
    fn continued_lines_keep_their_first_number() {
        assert_eq!(all("f 1\\\n2 \\ \r\n3\nv"), expected(&[(1, "f 1 2  3"), (4, "v")]));
        assert_eq!(all("f 1 \\"), expected(&[(1, "f 1 ")]));
    }

    #[test]
    fn a_hash_in_a_number_starts_no_comment() {
        for text in ["v -1.#IND 0", "v 0 1.#QNAN0 1.#INF", "v 1.#J"] {
            assert_eq!(all(text), expected(&[(1, text)]));
            assert_eq!(all(&format!("{text}#IND")), expected(&[(1, text)]));
        }
        for text in ["f 1 2 3.", "f 1 2 x1."] {
            assert_eq!(all(&format!("{text}#Indeed")), expected(&[(1, text)]));
        }
        assert_eq!(all("usemtl a.#IND"), expected(&[(1, "usemtl a.")]));
    }

    #[test]
    fn comments_that_say_creases_are_counted() {
        let text = "# crease 1 2 3.5\nv 1 # Crease: 1 2 3\nf 1 #crease 2 3 1 0\n# crease edges below\n# crease 1 2\n#CREASE 1 2 3";
        let mut lines = LogicalLines::new(text.as_bytes());
        while lines.next().is_some() {}
        assert_eq!(lines.crease_comments, (3, 1));
    }

    #[test]
    fn a_comment_ends_the_line_and_does_not_continue() {
        assert_eq!(all("v 1#x\nf 1. #2"), expected(&[(1, "v 1"), (2, "f 1. ")]));
        assert_eq!(all("v 1 # x \\\n# C:\\\nw"), expected(&[(1, "v 1 "), (2, ""), (3, "w")]));
    }
}
