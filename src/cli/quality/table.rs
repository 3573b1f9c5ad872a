//! The verdict as text: a summary, and a list in columns.

use super::Verdict;
use crate::line::count;
use crate::quality::{
    Break, Chain, Extremes, Feature, FeatureKind, Kind, Line, LineBreak, Nearby, Ranked, Spot, Subject, Unjudged,
    Unwelded, Vertex,
};
use crate::statistics::{exact, short};
use glam::DVec3;
use std::fmt::Write;

/// Columns of the list; those of words are aligned to the left.
const COLUMNS: [(&str, bool); 13] = [
    ("rank", false),
    ("kind", true),
    ("edges or vertex", true),
    ("face,u,v", true),
    ("x,y,z", true),
    ("G0", false),
    ("G1 deg", false),
    ("G2 %", false),
    ("conc", true),
    ("radius", false),
    ("jump", false),
    ("turn", false),
    ("worst", false),
];

/// Figures below are rounding, for people.
const ROUNDING: f64 = 1e-9;

type Row = [String; COLUMNS.len()];

/// The summary, the worst `most` of the list and the verdict.
pub(super) fn text(verdict: &Verdict<'_>, most: usize) -> String {
    let mut out = summary(verdict);
    let diagonal = verdict.mesh.diagonal();
    let all = verdict.judged().count();
    let rows: Vec<Row> =
        verdict.judged().take(most).enumerate().map(|(i, ranked)| row(verdict, i + 1, ranked, diagonal)).collect();
    if !rows.is_empty() {
        out.push('\n');
        out += &aligned(&rows);
    }
    if all > rows.len() {
        let _ = writeln!(out, "... and {} more (--count)", all - rows.len());
    }
    if !rows.is_empty() {
        let _ = writeln!(
            out,
            "G0: gap, {0}. G2: 2 |k1 - k2| / (|k1| + |k2|). conc: curvature changes its sign. radius: the least across a\n\
             semi-sharp crease, {0}. jump, turn: of the field's lines, in distances between them, degrees. worst: how many\n\
             times its limit the worst figure is. ~0: below 1e-9.",
            verdict.limits.unit()
        );
    }
    let over = verdict.over();
    let _ = match (verdict.passes(), all) {
        (None, _) => writeln!(out, "\nnothing to judge: {}", why_nothing(verdict)),
        (Some(false), _) => writeln!(out, "\nFAIL: {over} of {all} over their limits"),
        (Some(true), 0) => {
            writeln!(out, "\npass: the smooth joints ({}) are within their limits", verdict.smooth_joints())
        }
        (Some(true), _) => writeln!(out, "\npass: none of {all} is over its limits"),
    };
    out
}

/// Why no place is judged, and what to do.
fn why_nothing(verdict: &Verdict<'_>) -> String {
    let quality = verdict.quality;
    let Unjudged { edges_without_surface, nonmanifold_edges, nonmanifold_vertices } = &quality.unjudged;
    let unjudged = edges_without_surface.len() + nonmanifold_edges.len() + nonmanifold_vertices.len();
    if !verdict.ranked.is_empty() || quality.smooth_joints > 0 {
        "all that was found is ignored; leave --ignore out".to_owned()
    } else if unjudged > 0 {
        "what there is stands above as not judged; mend the mesh there".to_owned()
    } else {
        let weld = short(quality.weld * verdict.limits.gap_unit());
        let unit = verdict.limits.unit();
        format!("no two patches meet, and no boundary is within {weld} {unit} of another one; give --weld a distance")
    }
}

/// A distance that is no smaller, in one digit.
fn rounded_up(x: f64) -> f64 {
    let exponent = x.log10().floor();
    let digit = (x / 10f64.powf(exponent)).ceil();
    format!("{digit}e{exponent}").parse().unwrap_or(x)
}

/// What is wrong with the mesh rather than with the shape, a line each.
fn about_the_mesh(verdict: &Verdict<'_>) -> String {
    let quality = verdict.quality;
    let (unit, scale) = (verdict.limits.unit(), verdict.limits.gap_unit());
    let place = |p: DVec3| coordinates(p, verdict.mesh.diagonal());
    let mut out = String::new();
    if let Some(why) = &verdict.without_area {
        let _ = writeln!(out, "the surface has no area: {why}");
    }
    for sentence in verdict.orientation.sentences(verdict.mesh) {
        let _ = writeln!(out, "{sentence}");
    }
    let turned = quality.features.iter().filter(|feature| feature.reversed).count();
    if turned > 0 {
        let what = if turned == 1 { "1 seam joins" } else { &format!("{turned} seams join") };
        let _ = writeln!(out, "{what} faces that run against each other; angles are those with one side flipped");
    }
    if let Some(Unwelded { count, first: [a, b], distance }) = quality.unwelded {
        let weld = short(quality.weld * scale);
        let at = place(verdict.mesh.points[a as usize]);
        let are = if count == 1 { "control vertex on a boundary lies" } else { "control vertices on boundaries lie" };
        let _ = writeln!(
            out,
            "{count} {are} within {weld} {unit} of another one, unwelded: the first are {a} and {b}, {} apart, at {at}; \
             merge them to make one surface",
            short(distance * scale)
        );
    }
    if let Some(Nearby { distance, position, .. }) = quality.nearby {
        let distance = distance * scale;
        let _ = writeln!(
            out,
            "a boundary runs {} {unit} beside another one, at {}: --weld {} judges it",
            short(distance),
            place(position),
            exact(rounded_up(distance))
        );
    }
    out
}

fn summary(verdict: &Verdict<'_>) -> String {
    let quality = verdict.quality;
    let mut out = String::new();
    let kinds = [
        (["crease", "creases"], Kind::Feature(FeatureKind::Crease)),
        (["semi-sharp crease", "semi-sharp creases"], Kind::Feature(FeatureKind::SemiSharp)),
        (["seam", "seams"], Kind::Feature(FeatureKind::Seam)),
        (["vertex", "vertices"], Kind::Vertex),
    ];
    let counts = kinds.map(|([one, many], kind)| {
        let of: Vec<&Ranked<'_>> = verdict.ranked.iter().filter(|ranked| ranked.kind() == kind).collect();
        let over = of.iter().filter(|ranked| ranked.is_over()).count();
        let ignored = if verdict.ignored.iter().any(|i| i.kind() == kind) { ", ignored" } else { "" };
        format!("{} {} ({over} over{ignored})", of.len(), if of.len() == 1 { one } else { many })
    });
    let _ = writeln!(out, "{}: {}", verdict.mesh.name, counts.join(", "));
    let Extremes { samples, gap, angle_deg, difference, .. } = quality.smooth;
    let broken = verdict.ranked.iter().filter(|ranked| ranked.kind() == Kind::Feature(FeatureKind::Smooth)).count();
    let _ = writeln!(
        out,
        "{} at {} ({} over): gap {}, angle {}, curvature {}",
        count(quality.smooth_joints, "smooth joint"),
        count(samples, "point"),
        count(broken, "line"),
        short(gap * verdict.limits.gap_unit()),
        angle_deg.map_or("-".to_owned(), short),
        difference.map_or("-".to_owned(), |difference| short(100.0 * difference) + " %"),
    );
    let Unjudged { edges_without_surface, nonmanifold_edges, nonmanifold_vertices } = &quality.unjudged;
    for (unjudged, what, why) in [
        (edges_without_surface.len(), "edge", "without surfaces on two sides (boundary rule none)"),
        (nonmanifold_edges.len(), "edge", "not manifold"),
        (nonmanifold_vertices.len(), "vertex", "not manifold: sheets that share no edge meet there"),
    ] {
        if unjudged > 0 {
            let _ = writeln!(out, "{} not judged: {why}", count(unjudged, what));
        }
    }
    out += &about_the_mesh(verdict);
    let limits = &verdict.limits;
    let _ = writeln!(
        out,
        "limits: gap {} {}, angle {} degrees, curvature {} %; field: {}",
        exact(limits.gap),
        limits.unit(),
        exact(limits.angle_deg),
        exact(limits.percent),
        verdict.field.method
    );
    out
}

fn aligned(rows: &[Row]) -> String {
    let header = COLUMNS.map(|(name, _)| name.to_owned());
    let all = || std::iter::once(&header).chain(rows);
    let widths: Vec<usize> =
        (0..COLUMNS.len()).map(|column| all().map(|row| row[column].chars().count()).max().unwrap_or(0)).collect();
    let mut out = String::new();
    for row in all() {
        let cells = row.iter().zip(&widths).zip(COLUMNS).map(|((cell, &width), (_, is_left))| match is_left {
            true => format!("{cell:<width$}"),
            false => format!("{cell:>width$}"),
        });
        let _ = writeln!(out, "{}", cells.collect::<Vec<_>>().join(" ").trim_end());
    }
    out
}

/// The name, and the prim that the place lies on.
fn of_prim(name: String, verdict: &Verdict<'_>, ranked: &Ranked<'_>) -> String {
    match ranked.spot().and_then(|(place, _)| verdict.parts.name(place.face)) {
        Some(prim) => format!("{name} of {prim}"),
        None => name,
    }
}

fn row(verdict: &Verdict<'_>, rank: usize, ranked: &Ranked<'_>, diagonal: f64) -> Row {
    let none = || "-".to_owned();
    let (place, position) = match ranked.spot() {
        Some((place, position)) => {
            let place = format!("{},{},{}", place.face, part(place.u), part(place.v));
            (place, coordinates(position, diagonal))
        }
        None => (none(), none()),
    };
    let figures = Figures::of(ranked);
    let gap = figures.gap * verdict.limits.gap_unit();
    let (worst, ratio) = ranked.worst();
    let worst = match (worst, ratio) {
        (Break::Angle, f64::INFINITY) => "no plane".to_owned(),
        _ if ratio <= 1.0 => "within".to_owned(),
        _ => format!("{} {}x", worst.name(), short(ratio)),
    };
    [
        rank.to_string(),
        kind(ranked),
        of_prim(name(&ranked.subject), verdict, ranked),
        place,
        position,
        figure(gap),
        figures.angle_deg.map_or_else(none, figure),
        figures.difference.map_or_else(none, |difference| short(100.0 * difference)),
        if figures.concave { "yes".to_owned() } else { String::new() },
        figures.radius.map_or_else(none, |radius| short(radius * verdict.limits.gap_unit())),
        figures.line.map_or_else(none, |line| figure(line.lines)),
        figures.turn_deg.map_or_else(none, figure),
        worst,
    ]
}

/// A point to a hundredth of the diagonal, or a little better.
fn coordinates(position: DVec3, diagonal: f64) -> String {
    let digits = (2.5 - diagonal.log10()).ceil().clamp(0.0, 9.0) as usize;
    position.to_array().map(|x| fixed(x, digits)).join(",")
}

/// A number in few digits; what is rounding is about 0.
fn figure(x: f64) -> String {
    if x != 0.0 && x.abs() < ROUNDING { "~0".to_owned() } else { short(x) }
}

/// A number with so many decimals; what is rounded to 0 has no sign.
fn fixed(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().all(|c| matches!(c, b'0' | b'.')) => size.to_owned(),
        _ => text,
    }
}

/// A parameter with at most three decimals.
fn part(x: f64) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn kind(ranked: &Ranked<'_>) -> String {
    match ranked.subject {
        Subject::Feature(Feature { kind: FeatureKind::Seam, reversed: true, .. }) => "seam, flipped".to_owned(),
        Subject::Feature(feature) if feature.kind == FeatureKind::SemiSharp => {
            let [least, most] = feature.sharpness;
            if least == most { format!("sharp {most}") } else { format!("sharp {least}-{most}") }
        }
        _ => ranked.kind().name().to_owned(),
    }
}

/// What a row says.
struct Figures {
    gap: f64,
    angle_deg: Option<f64>,
    difference: Option<f64>,
    concave: bool,
    radius: Option<f64>,
    line: Option<LineBreak>,
    turn_deg: Option<f64>,
}

impl Figures {
    fn of(ranked: &Ranked<'_>) -> Figures {
        match ranked.subject {
            Subject::Feature(feature) => {
                let Extremes { gap, angle_deg, difference, concave, line, .. } = feature.extremes;
                let turn_deg = line.and_then(|line| line.turn_deg);
                Figures { gap, angle_deg, difference, concave, radius: feature.radius, line, turn_deg }
            }
            Subject::Vertex(vertex) => Figures {
                gap: vertex.gap,
                angle_deg: vertex.angle_deg,
                difference: vertex.difference(),
                concave: false,
                radius: None,
                line: None,
                turn_deg: vertex.rings.last().and_then(|ring| ring.turn_deg),
            },
        }
    }
}

/// Edges or a vertex, in few letters.
fn name(subject: &Subject<'_>) -> String {
    match subject {
        Subject::Feature(feature) => match (&feature.chain, feature.line) {
            (Some(chain), _) => match feature.beside.first() {
                Some(other) => format!("{} beside {}", chain_name(chain), chain_name(other)),
                None => chain_name(chain),
            },
            (None, Line::Edge([a, b])) => format!("{a}-{b}"),
            (None, Line::Spoke { face, corner }) => format!("face {face}, spoke {corner}"),
            (None, Line::Inside { ptex }) => format!("inside ptex {ptex}"),
        },
        Subject::Vertex(Vertex { spot, faces, kind, .. }) => {
            let spot = match spot {
                Spot::Vertex(vertex) => vertex.to_string(),
                Spot::Centre(face) => format!("centre of {face}"),
                Spot::Middle([a, b]) => format!("middle of {a}-{b}"),
                Spot::Inside(ptex) => format!("inside ptex {ptex}"),
            };
            format!("{spot} {}, {}", kind.name(), count(*faces, "face"))
        }
    }
}

fn chain_name(chain: &Chain) -> String {
    let edges = chain.edges().count();
    match (&chain.vertices[..], chain.closed) {
        ([a, b], _) => format!("{a}-{b}"),
        ([a, b, c], false) => format!("{a}-{b}-{c}"),
        ([a, b, .., z], false) => format!("{a}-{b}..{z} ({edges})"),
        ([a, b, ..], true) => format!("{a}-{b}..{a} ({edges})"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        let texts = [-0.004, -0.0, 0.004, -0.006, -12.0].map(|x| fixed(x, 2));
        assert_eq!(texts, ["0.00", "0.00", "0.00", "-0.01", "-12.00"]);
        assert_eq!([fixed(-0.4, 0), fixed(-0.6, 0)], ["0", "-1"]);
    }
}
