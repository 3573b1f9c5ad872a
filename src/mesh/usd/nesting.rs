//! How deep the text of a usda file is nested, told before it is parsed.

/// What ends a piece of text in which brackets are none, and whether a backslash takes the next character out of it.
struct Quoted {
    start: &'static [u8],
    end: &'static [u8],
    escapes: bool,
}

const fn quoted(start: &'static [u8], end: &'static [u8], escapes: bool) -> Quoted {
    Quoted { start, end, escapes }
}

/// Strings, asset paths, prim paths and block comments; the longer of two that begin alike stands first.
const QUOTED: [Quoted; 8] = [
    quoted(b"\"\"\"", b"\"\"\"", false),
    quoted(b"\"", b"\"", true),
    quoted(b"'''", b"'''", false),
    quoted(b"'", b"'", true),
    quoted(b"@@@", b"@@@", false),
    quoted(b"@", b"@", false),
    quoted(b"<", b">", false),
    quoted(b"/*", b"*/", false),
];

/// Most braces, brackets and parentheses that are open at a time.
pub(super) fn depth(text: &[u8]) -> usize {
    let (mut open, mut deepest) = (0_usize, 0);
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        at += 1;
        match byte {
            b'{' | b'[' | b'(' => {
                open += 1;
                deepest = deepest.max(open);
            }
            b'}' | b']' | b')' => open = open.saturating_sub(1),
            b'#' => at += text[at..].iter().take_while(|byte| !matches!(byte, b'\n' | b'\r')).count(),
            b'"' | b'\'' | b'@' | b'<' | b'/' => {
                let rest = &text[at - 1..];
                if let Some(kind) = QUOTED.iter().find(|kind| rest.starts_with(kind.start)) {
                    at = at - 1 + length(rest, kind);
                }
            }
            _ => {}
        }
    }
    deepest
}

/// Length of what is quoted at the start of a text, its ends included.
fn length(text: &[u8], kind: &Quoted) -> usize {
    let mut at = kind.start.len();
    while at < text.len() {
        match text[at] {
            b'\\' if kind.escapes => at += 2,
            _ if text[at..].starts_with(kind.end) => return at + kind.end.len(),
            _ => at += 1,
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::depth;

    #[test]
    fn brackets_count_where_they_are_some() {
        assert_eq!(depth(b"def \"a\" { int[] b = [(1, 2)] } ([{"), 3);
        assert_eq!(depth(b"\"((\\\"((\" '[[\\'[[' @{{@ @@@{{@}}@@@ </((> # {{{{\r /* [\"[ */ ("), 1);
        assert_eq!(depth(b"\"\"\" ((\" \"\"(( \\\"\"\" (("), 2);
        assert_eq!(depth(b"))) ("), 1);
        assert_eq!(depth(b"\" ((("), 0);
    }
}
