//! File names with a place for a frame's number.

/// Least digits of a frame's number in a file name.
const DIGITS: usize = 4;
/// Most digits of a frame's number: file names end at some 255 bytes.
const MOST_DIGITS: usize = 100;

/// A file name with a place for the frame's number.
pub(super) struct Numbered {
    before: String,
    digits: usize,
    after: String,
}

impl Numbered {
    /// With the place that the name has, or before its extension; `last` is the greatest number. `None` where the name has
    /// several places, one for absurdly many digits, or none and no extension.
    pub(super) fn new(name: &str, last: u32) -> Option<Numbered> {
        if places(name).next().is_some() {
            return Numbered::placed(name);
        }
        let dot = name.rfind('.')?;
        // So many digits that names sort like numbers.
        let digits = DIGITS.max(last.to_string().len());
        Some(Numbered { before: format!("{}_", &name[..dot]), digits, after: name[dot..].to_owned() })
    }

    /// With the one place that the name has.
    pub(super) fn placed(name: &str) -> Option<Numbered> {
        let mut places = places(name);
        let (start, end, digits) = places.next()?;
        let fine = places.next().is_none() && digits <= MOST_DIGITS;
        fine.then(|| Numbered { before: name[..start].to_owned(), digits, after: name[end..].to_owned() })
    }

    /// The name with `#` in place of the number, however many digits it has.
    pub(super) fn pattern(&self) -> String {
        format!("{}#{}", self.before, self.after)
    }

    pub(super) fn of(&self, frame: u32) -> String {
        format!("{}{frame:0digits$}{}", self.before, self.after, digits = self.digits)
    }
}

/// Start, end and digits of every `####` and `%04d` of a name.
fn places(name: &str) -> impl Iterator<Item = (usize, usize, usize)> {
    let bytes = name.as_bytes();
    let run = move |start: usize, what: fn(&u8) -> bool| bytes[start..].iter().take_while(|&b| what(b)).count();
    (0..bytes.len()).filter_map(move |start| match bytes[start] {
        b'#' if start == 0 || bytes[start - 1] != b'#' => {
            let digits = run(start, |&b| b == b'#');
            Some((start, start + digits, digits))
        }
        b'%' => {
            let digits = run(start + 1, u8::is_ascii_digit);
            let end = start + 1 + digits;
            let wide = name[start + 1..end].parse().unwrap_or(if digits == 0 { 1 } else { usize::MAX });
            (bytes.get(end) == Some(&b'd')).then_some((start, end + 1, wide))
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_where_the_name_says() {
        let name = |name: &str, last: u32, frame: u32| Numbered::new(name, last).map(|name| name.of(frame));
        let some = |name: &str| Some(name.to_owned());
        assert_eq!(name("view.png", 36, 1), some("view_0001.png"));
        assert_eq!(name("a.b.exr", 20_000, 12), some("a.b_00012.exr"));
        assert_eq!(name("car-##.png", 200, 7), some("car-07.png"));
        assert_eq!(name("car-##.png", 200, 123), some("car-123.png"));
        assert_eq!(name("%06d.png", 5, 5), some("000005.png"));
        assert_eq!(name("a%d.png", 5, 5), some("a5.png"));
        assert_eq!(name("100%.png", 5, 5), some("100%_0005.png"));
        assert_eq!(name("\u{fc}#.png", 5, 5), some("\u{fc}5.png"));
        for bad in ["#-#.png", "%d_%02d.png", "#%d.png", "%0999d.png", "%0999999999999999999999d.png"] {
            assert_eq!(name(bad, 5, 1), None, "{bad}");
        }
        assert!(Numbered::placed("view.png").is_none());
        assert_eq!(Numbered::placed("m.####.obj").map(|name| name.of(12)), some("m.0012.obj"));
    }
}
