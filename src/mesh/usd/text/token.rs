//! Tokens of USDA: what lies between white space and comments.

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A keyword, type or name, with its namespaces.
    Name,
    Number,
    /// A string, with its quotes.
    Text,
    /// `@...@` or `@@@...@@@`.
    Asset,
    /// `<...>`.
    Path,
    /// A single byte of punctuation, or one that belongs nowhere.
    Mark,
    /// All that follows something that has no end.
    Rest,
}

/// A token, and how many lines end between it and the one before.
#[derive(Debug, Clone, Copy)]
pub(super) struct Token<'a> {
    pub(super) kind: Kind,
    pub(super) text: &'a [u8],
    pub(super) breaks: usize,
}

impl Token<'_> {
    pub(super) fn is_mark(&self, mark: u8) -> bool {
        self.kind == Kind::Mark && self.text == [mark]
    }

    pub(super) fn is_name(&self, name: &str) -> bool {
        self.kind == Kind::Name && self.text == name.as_bytes()
    }
}

/// The tokens of a text, one after the other.
#[derive(Debug, Clone)]
pub(super) struct Tokens<'a> {
    text: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { text, at: 0 }
    }

    fn rest(&self) -> &'a [u8] {
        &self.text[self.at.min(self.text.len())..]
    }

    /// Skips white space and comments; `None` where a comment has no end. Gives the lines that end there.
    fn skip_blank(&mut self) -> usize {
        let start = self.at;
        loop {
            let rest = self.rest();
            let length = match rest {
                [b' ' | b'\t' | b'\r' | b'\n' | 0x0c | 0x0b, ..] => 1,
                [b'#', ..] | [b'/', b'/', ..] => line_length(rest),
                [b'/', b'*', ..] => match find(&rest[2..], b"*/") {
                    Some(end) => end + 4,
                    None => break,
                },
                _ => break,
            };
            self.at += length;
        }
        breaks(&self.text[start..self.at])
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        let breaks = self.skip_blank();
        let rest = self.rest();
        let first = *rest.first()?;
        let (kind, length) = match first {
            b'"' | b'\'' => ended(Kind::Text, string_length(rest)),
            b'@' => ended(Kind::Asset, asset_length(rest)),
            b'<' => ended(Kind::Path, path_length(rest)),
            b'/' if rest.starts_with(b"/*") => ended(Kind::Rest, None),
            _ if is_name_start(first) => (Kind::Name, name_length(rest)),
            _ => number_length(rest).map_or((Kind::Mark, 1), |length| (Kind::Number, length)),
        };
        let length = length.min(rest.len());
        self.at += length;
        Some(Token { kind, text: &rest[..length], breaks })
    }
}

/// A token of some length, or all the rest where it does not end.
fn ended(kind: Kind, length: Option<usize>) -> (Kind, usize) {
    length.map_or((Kind::Rest, usize::MAX), |length| (kind, length))
}

pub(super) fn breaks(text: &[u8]) -> usize {
    text.iter().filter(|&&byte| byte == b'\n').count()
}

fn find(text: &[u8], what: &[u8]) -> Option<usize> {
    text.windows(what.len()).position(|window| window == what)
}

fn line_length(text: &[u8]) -> usize {
    text.iter().take_while(|byte| !matches!(byte, b'\n' | b'\r')).count()
}

fn is_name_start(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_' || byte >= 0x80
}

fn name_length(text: &[u8]) -> usize {
    let is_part = |byte: u8| is_name_start(byte) || byte.is_ascii_digit() || byte == b':';
    let length = text.iter().take_while(|&&byte| is_part(byte)).count();
    // `post: held` of a spline: a colon at the end is punctuation.
    length - text[..length].iter().rev().take_while(|&&byte| byte == b':').count()
}

/// Length of the quotes at the start of a string, and of the string with both.
fn string_length(text: &[u8]) -> Option<usize> {
    let quotes = quotes(text);
    let end = &text[..quotes];
    let mut at = quotes;
    while at < text.len() {
        match text[at] {
            b'\\' => at += 2,
            _ if text[at..].starts_with(end) => return Some(at + quotes),
            _ => at += 1,
        }
    }
    None
}

/// How many quotes a string begins and ends with.
pub(super) fn quotes(text: &[u8]) -> usize {
    if text.starts_with(b"\"\"\"") || text.starts_with(b"'''") { 3 } else { 1 }
}

fn asset_length(text: &[u8]) -> Option<usize> {
    if !text.starts_with(b"@@@") {
        return Some(find(&text[1..], b"@")? + 2);
    }
    let mut at = 3;
    while at < text.len() {
        match &text[at..] {
            [b'\\', b'@', b'@', b'@', ..] => at += 4,
            // Up to two more may belong to the path.
            rest if rest.starts_with(b"@@@") => {
                return Some(at + rest.iter().take(5).take_while(|&&byte| byte == b'@').count());
            }
            _ => at += 1,
        }
    }
    None
}

fn path_length(text: &[u8]) -> Option<usize> {
    Some(text.iter().position(|&byte| byte == b'>')? + 1)
}

/// Length of the number at the start of a text: `5`, `.5`, `5.`, `+5`, `-.5e-2`, `-inf`.
fn number_length(text: &[u8]) -> Option<usize> {
    let sign = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let digits = |at: usize| text[at.min(text.len())..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    if sign > 0 && (text[sign..].starts_with(b"inf") || text[sign..].starts_with(b"nan")) {
        return Some(sign + 3);
    }
    let whole = digits(sign);
    let mut at = sign + whole;
    let mut fraction = 0;
    if text.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        // The dot of `.5` and `5.`; alone it is punctuation.
        if whole + fraction > 0 {
            at += 1 + fraction;
        }
    }
    if whole + fraction == 0 {
        return None;
    }
    if matches!(text.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    Some(at)
}
