//! Tokens in their plainest form.

use super::Numbers;
use super::token::{Kind, Token, quotes};

/// Writes a token; `numbers` says how numbers are written.
pub(super) fn token(token: Token<'_>, numbers: Numbers, out: &mut Vec<u8>) {
    match token.kind {
        Kind::Number => number(token.text, numbers, out),
        Kind::Text => string(token.text, out),
        Kind::Name | Kind::Asset | Kind::Path | Kind::Mark | Kind::Rest => out.extend_from_slice(token.text),
    }
}

/// `.5` as `0.5`, `5.` as `5.0`, `+5` as `5`; `1e3` as `1000` where numbers are whole.
fn number(text: &[u8], numbers: Numbers, out: &mut Vec<u8>) {
    let text = text.strip_prefix(b"+").unwrap_or(text);
    let (sign, size) = text.strip_prefix(b"-").map_or((&b""[..], text), |size| (&b"-"[..], size));
    if size == b"nan" {
        return out.extend_from_slice(size);
    }
    let is_plain = size.iter().all(u8::is_ascii_digit);
    if numbers == Numbers::Whole
        && !is_plain
        && let Some(whole) = whole(text)
    {
        return out.extend_from_slice(whole.to_string().as_bytes());
    }
    out.extend_from_slice(sign);
    match size.iter().position(|&byte| byte == b'.') {
        None => out.extend_from_slice(size),
        Some(point) => {
            let (before, after) = (&size[..point], &size[point + 1..]);
            out.extend_from_slice(if before.is_empty() { b"0" } else { before });
            out.push(b'.');
            if !after.first().is_some_and(u8::is_ascii_digit) {
                out.push(b'0');
            }
            out.extend_from_slice(after);
        }
    }
}

/// A number cut off behind the point, if an i64 holds it.
fn whole(text: &[u8]) -> Option<i64> {
    let value: f64 = std::str::from_utf8(text).ok()?.parse().ok()?;
    // 2^63 and more saturate, so they are refused here.
    (value.abs() < 9.2e18).then_some(value.trunc() as i64)
}

/// A string in double quotes, whatever it had; escapes stay, line breaks too.
fn string(text: &[u8], out: &mut Vec<u8>) {
    let quotes = quotes(text);
    let mut inside = text[quotes..text.len() - quotes].iter();
    out.push(b'"');
    while let Some(&byte) = inside.next() {
        match byte {
            b'"' => out.extend_from_slice(b"\\\""),
            b'\\' => match inside.next() {
                // openusd takes no escaped line break; it is the line break.
                Some(b'\n') => out.push(b'\n'),
                Some(&escaped) => out.extend([b'\\', escaped]),
                None => {}
            },
            _ => out.push(byte),
        }
    }
    out.push(b'"');
}

/// What a truth value says, if it is one: USD takes words, numbers and strings.
pub(super) fn truth(token: Token<'_>) -> Option<&'static str> {
    let text = match token.kind {
        Kind::Text => &token.text[quotes(token.text)..token.text.len() - quotes(token.text)],
        _ => token.text,
    };
    let text = std::str::from_utf8(text).ok()?.to_ascii_lowercase();
    match text.as_str() {
        "true" | "yes" => Some("true"),
        "false" | "no" => Some("false"),
        number => number.parse().ok().map(|value: f64| if value == 0.0 { "false" } else { "true" }),
    }
}
