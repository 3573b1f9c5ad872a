//! Numbers as text, and what is written in place of one.

/// What a number is written as that is none: `None` for text that does not look like it.
///
/// `nan` and `inf` are what C and most languages print, with or without a sign; `-nan(ind)` is Microsoft's since 2015,
/// and `-1.#IND`, `1.#QNAN`, `1.#INF` before, with zeros behind for a precision, or rounded to `1.#J`.
pub(super) fn not_finite(token: &[u8]) -> Option<NotFinite> {
    let text = std::str::from_utf8(token).ok()?.trim_start_matches(['+', '-']).to_ascii_lowercase();
    let after_hash = text.split_once(".#").filter(|(digits, _)| digits.bytes().all(|b| b.is_ascii_digit()));
    let word = after_hash.map_or(text.as_str(), |(_, word)| word);
    let starts = |words: &[&str]| words.iter().any(|start| word.starts_with(start));
    let is_nan = match after_hash {
        Some(_) => starts(&["ind", "qnan", "snan", "nan"]),
        None => word == "nan" || word.starts_with("nan("),
    };
    let is_infinite = match after_hash {
        Some(_) => starts(&["inf", "j"]),
        None => matches!(word, "inf" | "infinity"),
    };
    match (is_nan, is_infinite) {
        (true, _) => Some(NotFinite::NotANumber),
        (_, true) => Some(NotFinite::Infinite),
        _ => None,
    }
}

/// What a computation leaves that has no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NotFinite {
    NotANumber,
    Infinite,
}

impl NotFinite {
    /// How it came about, after "the program that wrote it".
    pub(super) fn cause(self) -> &'static str {
        match self {
            Self::NotANumber => "computed 0/0",
            Self::Infinite => "divided by 0 or overflowed",
        }
    }
}

/// Whether the `#` at an index of a line belongs to a number as Microsoft's libraries wrote it, and starts no comment.
pub(super) fn has_hash(line: &[u8], hash: usize) -> bool {
    let before = line[..hash].rsplit(u8::is_ascii_whitespace).next().unwrap_or_default();
    let before = before.strip_suffix(b".").map(|digits| digits.strip_prefix(b"-").unwrap_or(digits));
    let is_digits = before.is_some_and(|digits| !digits.is_empty() && digits.iter().all(u8::is_ascii_digit));
    is_digits && {
        let after = line[hash + 1..].split(|&b| !b.is_ascii_uppercase()).next().unwrap_or_default();
        matches!(after, b"IND" | b"INF" | b"QNAN" | b"SNAN" | b"NAN" | b"J")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_known_in_every_spelling() {
        for text in
            ["nan", "NaN", "-nan", "+nan", "-nan(ind)", "nan(snan)", "-1.#IND", "1.#QNAN", "1.#SNAN0", "-1.#IND00"]
        {
            assert_eq!(not_finite(text.as_bytes()), Some(NotFinite::NotANumber), "{text}");
        }
        for text in ["inf", "-inf", "INF", "Infinity", "-infinity", "1.#INF", "-1.#INF00", "1.#J"] {
            assert_eq!(not_finite(text.as_bytes()), Some(NotFinite::Infinite), "{text}");
        }
        for text in ["1.5", "", "-", "info", "nano", "1.#", "x.#IND", "#IND", "1e999", "\u{221e}"] {
            assert_eq!(not_finite(text.as_bytes()), None, "{text}");
        }
    }
}
