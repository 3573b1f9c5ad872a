//! Wavefront OBJ: polylines as `l` elements.

use super::{Lines, groups, one_line, shortest};
use std::io::{Result, Write};

/// An object a light, with its value in a comment; closed curves name their first point again at the end.
pub(super) fn write(lines: &Lines<'_>, out: &mut dyn Write) -> Result<()> {
    writeln!(out, "# {}", one_line(lines.made_by))?;
    writeln!(out, "# field {}", one_line(lines.field))?;
    // Counted from 1, through the whole file.
    let mut next = 1;
    for group in groups(lines.curves) {
        writeln!(out, "o {}", group.name)?;
        writeln!(out, "# light {} value {}", group.light, shortest(group.value))?;
        for curve in group.curves {
            for point in &curve.points {
                let [x, y, z] = point.to_array().map(shortest);
                writeln!(out, "v {x} {y} {z}")?;
            }
            let (first, end) = (next, next + curve.points.len());
            out.write_all(b"l")?;
            (first..end).chain(curve.closed.then_some(first)).try_for_each(|index| write!(out, " {index}"))?;
            out.write_all(b"\n")?;
            next = end;
        }
    }
    Ok(())
}
