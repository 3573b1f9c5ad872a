//! Joints put together: a crease is one thing, however many patches meet along it.

use super::Extremes;
use super::chain::Chain;
use super::control::{Control, Line};
use super::joint::{Measured, Piece};
use std::collections::BTreeMap;

/// Why joints belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeatureKind {
    /// An infinitely sharp crease: a break of the tangent plane that was modelled.
    Crease,
    /// A crease of finite sharpness: curved as strongly as it is sharp, but without a break.
    SemiSharp,
    /// A line inside the smooth surface whose joints exceed their limits all the same.
    Smooth,
    /// Boundaries that lie beside each other without being one edge.
    Seam,
}

impl FeatureKind {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            FeatureKind::Crease => "crease",
            FeatureKind::SemiSharp => "semi-sharp",
            FeatureKind::Smooth => "smooth",
            FeatureKind::Seam => "seam",
        }
    }
}

/// A crease, a smooth line with a break, or a seam.
#[derive(Debug, Clone, PartialEq)]
pub struct Feature {
    /// Which.
    pub kind: FeatureKind,
    /// The crease, or one side of a seam; `None` for smooth lines.
    pub chain: Option<Chain>,
    /// Of a seam: what lies beside the chain. Empty where both sides are one chain, as at a slit or where two faces run along one edge
    /// in the same direction.
    pub beside: Vec<Chain>,
    /// Of a seam: the faces on its two sides run against each other. It is judged as if one side were turned.
    pub reversed: bool,
    /// Line of the control mesh that the worst point lies on.
    pub line: Line,
    /// Least and greatest sharpness along it.
    pub sharpness: [f32; 2],
    /// What its joints are like.
    pub extremes: Extremes,
    /// Smallest radius of curvature across a semi-sharp crease, model units; infinite where it is flat.
    pub radius: Option<f64>,
    /// Its joints, for drawing.
    pub pieces: Vec<Piece>,
}

/// What is known of one line.
#[derive(Default)]
struct Part {
    extremes: Extremes,
    roundest: Option<f64>,
    pieces: Vec<Piece>,
}

/// All features, in the order of their kinds.
pub(super) fn features(control: &Control<'_>, measured: &[Measured]) -> Vec<Feature> {
    let mut parts: BTreeMap<(FeatureKind, Line), Part> = BTreeMap::new();
    for Measured { line, sharp, piece, extremes, roundest } in measured {
        let kind = match (sharp, roundest) {
            (true, _) => FeatureKind::Crease,
            (false, Some(_)) => FeatureKind::SemiSharp,
            (false, None) => FeatureKind::Smooth,
        };
        let part = parts.entry((kind, *line)).or_default();
        part.extremes = part.extremes.and(*extremes);
        part.roundest = roundest.map(|curvature| part.roundest.unwrap_or(0.0).max(curvature)).or(part.roundest);
        part.pieces.push(*piece);
    }
    let mut features = Vec::new();
    for kind in [FeatureKind::Crease, FeatureKind::SemiSharp] {
        let edges: Vec<[u32; 2]> = parts.keys().filter_map(|key| edge_of(key, kind)).collect();
        for chain in Chain::of(&edges) {
            let lines: Vec<Line> = chain.edges().map(Line::Edge).collect();
            let own = lines.iter().filter_map(|&line| Some((line, parts.remove(&(kind, line))?)));
            features.extend(join(control, kind, own.collect::<Vec<_>>(), Some(chain.clone())));
        }
    }
    let smooth =
        parts.into_iter().map(|((_, line), part)| join(control, FeatureKind::Smooth, vec![(line, part)], None));
    features.extend(smooth.flatten());
    features
}

fn edge_of(&(kind, line): &(FeatureKind, Line), wanted: FeatureKind) -> Option<[u32; 2]> {
    match line {
        Line::Edge(edge) if kind == wanted => Some(edge),
        _ => None,
    }
}

fn join(control: &Control<'_>, kind: FeatureKind, parts: Vec<(Line, Part)>, chain: Option<Chain>) -> Option<Feature> {
    let worst = parts.iter().reduce(|a, b| if b.1.extremes.severity() > a.1.extremes.severity() { b } else { a })?;
    let mut feature = Feature {
        kind,
        chain,
        beside: Vec::new(),
        reversed: false,
        line: worst.0,
        sharpness: [f32::INFINITY, 0.0],
        extremes: Extremes::default(),
        radius: None,
        pieces: Vec::new(),
    };
    let mut roundest = None;
    for (line, part) in parts {
        let sharpness = match line {
            Line::Edge(edge) => control.sharpness(edge),
            _ => 0.0,
        };
        feature.sharpness = [feature.sharpness[0].min(sharpness), feature.sharpness[1].max(sharpness)];
        feature.extremes = feature.extremes.and(part.extremes);
        feature.pieces.extend(part.pieces);
        roundest = part.roundest.map(|curvature: f64| curvature.max(roundest.unwrap_or(0.0))).or(roundest);
    }
    feature.radius = roundest.map(|curvature| 1.0 / curvature);
    Some(feature)
}
