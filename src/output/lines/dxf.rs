//! DXF of release 12 (AC1009): what every CAD program reads; it needs no handles.
//!
//! A curve is a 3D `POLYLINE` on the layer of its light. Its extended data, of the application CATOPTRIC, has the value
//! (group 1040) and the light (1071). Release 12 knows no unit of length.

use super::{Lines, groups, one_line, shortest};
use glam::DVec3;
use std::io::{Result, Write};

/// Longest comment that is written on one line: the format allows 255 bytes, and an escape has up to 7.
const COMMENT: usize = 240;
/// Bit of group 70 of a polyline: it is closed.
const CLOSED: u8 = 1;
/// Bit of group 70 of a polyline: it is one in space.
const IN_SPACE: u8 = 8;
/// Bit of group 70 of a vertex: it is one of a polyline in space.
const VERTEX_IN_SPACE: u8 = 32;

/// The file of groups: pairs of a code and a value, a line each.
struct Groups<'a>(&'a mut dyn Write);

impl Groups<'_> {
    fn put(&mut self, code: u16, value: &str) -> Result<()> {
        writeln!(self.0, "{code:>3}\n{value}")
    }

    fn number(&mut self, code: u16, value: f64) -> Result<()> {
        self.put(code, &shortest(value))
    }

    /// Codes 10, 20 and 30.
    fn point(&mut self, point: DVec3) -> Result<()> {
        [10, 20, 30].into_iter().zip(point.to_array()).try_for_each(|(code, x)| self.number(code, x))
    }

    /// Comments of one text, cut where it is too long; joined again without anything between they are the text.
    fn comment(&mut self, text: &str) -> Result<()> {
        let text = ascii(&one_line(text));
        let mut rest = text.as_str();
        while !rest.is_empty() {
            // Readers take spaces off the ends, so there is none at a cut.
            let fits = |&at: &usize| !rest[at - 1..].starts_with(' ') && !rest[at..].starts_with(' ');
            let at = match rest.len() {
                length if length <= COMMENT => length,
                _ => (1..=COMMENT).rev().find(fits).unwrap_or(COMMENT),
            };
            self.put(999, &rest[..at])?;
            rest = &rest[at..];
        }
        Ok(())
    }

    /// A table with these entries: names, and what else they have.
    fn table(&mut self, name: &str, entries: &[(&str, &[(u16, &str)])]) -> Result<()> {
        self.put(0, "TABLE")?;
        self.put(2, name)?;
        self.put(70, &entries.len().to_string())?;
        for (entry, groups) in entries {
            self.put(0, name)?;
            self.put(2, entry)?;
            self.put(70, "0")?;
            groups.iter().try_for_each(|(code, value)| self.put(*code, value))?;
        }
        self.put(0, "ENDTAB")
    }
}

/// Letters beyond ASCII as `\U+XXXX`, in UTF-16, as AutoCAD writes them.
fn ascii(text: &str) -> String {
    let mut units = [0; 2];
    text.chars().fold(String::with_capacity(text.len()), |mut ascii, c| {
        match c.is_ascii() {
            true => ascii.push(c),
            false => c.encode_utf16(&mut units).iter().for_each(|unit| ascii += &format!("\\U+{unit:04X}")),
        }
        ascii
    })
}

pub(super) fn write(lines: &Lines<'_>, out: &mut dyn Write) -> Result<()> {
    let groups = groups(lines.curves);
    let names: Vec<String> = groups.iter().map(|group| group.name.to_uppercase()).collect();
    let mut file = Groups(out);
    file.comment(lines.made_by)?;

    file.put(0, "SECTION")?;
    file.put(2, "HEADER")?;
    file.put(9, "$ACADVER")?;
    file.put(1, "AC1009")?;
    let points = || groups.iter().flat_map(|group| &group.curves).flat_map(|curve| &curve.points).copied();
    if let Some(low) = points().reduce(DVec3::min)
        && let Some(high) = points().reduce(DVec3::max)
    {
        for (name, corner) in [("$EXTMIN", low), ("$EXTMAX", high)] {
            file.put(9, name)?;
            file.point(corner)?;
        }
    }
    file.put(0, "ENDSEC")?;

    file.put(0, "SECTION")?;
    file.put(2, "TABLES")?;
    let continuous: &[(u16, &str)] = &[(3, "Solid line"), (72, "65"), (73, "0"), (40, "0.0")];
    file.table("LTYPE", &[("CONTINUOUS", continuous)])?;
    // Colours 1 to 6, red to magenta, so that neighbouring lights differ; 7 is black or white.
    const COLOURS: [&[(u16, &str)]; 7] = [
        &[(62, "7"), (6, "CONTINUOUS")],
        &[(62, "1"), (6, "CONTINUOUS")],
        &[(62, "2"), (6, "CONTINUOUS")],
        &[(62, "3"), (6, "CONTINUOUS")],
        &[(62, "4"), (6, "CONTINUOUS")],
        &[(62, "5"), (6, "CONTINUOUS")],
        &[(62, "6"), (6, "CONTINUOUS")],
    ];
    let layers = names.iter().enumerate().map(|(i, name)| (name.as_str(), COLOURS[1 + i % 6]));
    file.table("LAYER", &std::iter::once(("0", COLOURS[0])).chain(layers).collect::<Vec<_>>())?;
    file.table("APPID", &[("CATOPTRIC", &[])])?;
    file.put(0, "ENDSEC")?;

    file.put(0, "SECTION")?;
    file.put(2, "ENTITIES")?;
    for (group, layer) in groups.iter().zip(&names) {
        for curve in &group.curves {
            file.put(0, "POLYLINE")?;
            file.put(8, layer)?;
            file.put(66, "1")?;
            file.point(DVec3::ZERO)?;
            file.put(70, &(IN_SPACE | if curve.closed { CLOSED } else { 0 }).to_string())?;
            file.put(1001, "CATOPTRIC")?;
            file.number(1040, group.value)?;
            file.put(1071, &group.light.to_string())?;
            for &point in &curve.points {
                file.put(0, "VERTEX")?;
                file.put(8, layer)?;
                file.point(point)?;
                file.put(70, &VERTEX_IN_SPACE.to_string())?;
            }
            file.put(0, "SEQEND")?;
            file.put(8, layer)?;
        }
    }
    file.put(0, "ENDSEC")?;
    file.put(0, "EOF")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_comments_are_cut_where_no_space_is_and_join_again() {
        for length in [1, 3, 239, 240, 241, 1000] {
            let text: String = "ab  c ".chars().cycle().take(length).collect();
            let text = text.trim_end();
            let mut out = Vec::new();
            Groups(&mut out).comment(text).expect("memory takes it");
            let written = String::from_utf8(out).expect("it is ASCII");
            let values: Vec<&str> = written.lines().skip(1).step_by(2).map(str::trim).collect();
            assert!(values.iter().all(|value| value.len() <= COMMENT));
            assert_eq!(values.concat(), text);
        }
    }

    #[test]
    fn letters_are_escaped() {
        assert_eq!(ascii("a\u{fc}\u{1f697}"), "a\\U+00FC\\U+D83D\\U+DE97");
    }
}
