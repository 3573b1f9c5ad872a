//! All that was found in one list, the worst first.

use super::{Break, Feature, FeatureKind, Limits, Quality, Spot, Vertex};
use crate::curves::Place;
use glam::DVec3;

/// What a place of the list is about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Subject<'a> {
    /// A crease, or a line inside the smooth surface.
    Feature(&'a Feature),
    /// An extraordinary vertex, or one of its sectors.
    Vertex(&'a Vertex),
}

/// Kinds of subjects, as people ask for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Of [`Subject::Feature`].
    Feature(FeatureKind),
    /// [`Subject::Vertex`].
    Vertex,
}

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 5] = [
        Kind::Feature(FeatureKind::Crease),
        Kind::Feature(FeatureKind::SemiSharp),
        Kind::Feature(FeatureKind::Smooth),
        Kind::Feature(FeatureKind::Seam),
        Kind::Vertex,
    ];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Feature(kind) => kind.name(),
            Kind::Vertex => "vertex",
        }
    }
}

/// A place of the list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranked<'a> {
    /// What it is about.
    pub subject: Subject<'a>,
    /// How many times its limit each figure is; an angle is infinitely many times its limit where there is no tangent plane.
    pub ratios: [(Break, f64); 3],
}

impl Ranked<'_> {
    /// Its kind.
    pub fn kind(&self) -> Kind {
        match self.subject {
            Subject::Feature(feature) => Kind::Feature(feature.kind),
            Subject::Vertex(_) => Kind::Vertex,
        }
    }

    /// The figure that is the largest multiple of its limit, and how many times it is.
    pub fn worst(&self) -> (Break, f64) {
        self.ratios.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a }).unwrap_or((Break::Gap, 0.0))
    }

    /// How many times its limit the worst figure is.
    pub fn severity(&self) -> f64 {
        self.worst().1
    }

    /// Whether a figure exceeds its limit.
    pub fn is_over(&self) -> bool {
        self.severity() > 1.0
    }

    /// Where it is worst: place and position, world space. `None` for a feature none of whose points was measured.
    pub fn spot(&self) -> Option<(Place, DVec3)> {
        match self.subject {
            Subject::Feature(feature) => feature.extremes.worst.map(|(_, worst)| (worst.place, worst.position)),
            Subject::Vertex(vertex) => Some((vertex.place, vertex.position)),
        }
    }
}

impl Feature {
    /// How many times its limit each figure is.
    pub fn ratios(&self, limits: &Limits) -> [(Break, f64); 3] {
        let extremes = &self.extremes;
        let angle = extremes.angle_deg.filter(|_| extremes.undefined == 0);
        limits.ratios(extremes.gap, angle, extremes.difference)
    }
}

impl Vertex {
    /// A number that tells vertices of the mesh apart, for lists.
    pub(super) fn number(&self) -> u32 {
        match self.spot {
            Spot::Vertex(n) | Spot::Centre(n) | Spot::Inside(n) | Spot::Middle([n, _]) => n,
        }
    }
}

impl Quality {
    /// Creases, broken smooth lines and vertices, the worst first: what is the largest multiple of its limit. Of equals, the one with the
    /// larger sum of all multiples; where these are rounding, as along semi-sharp creases, the smaller radius; then creases, lines and
    /// vertices in the order of their numbers. `limits`: those that it was measured by.
    pub fn ranked(&self, limits: &Limits) -> Vec<Ranked<'_>> {
        /// Part of a limit that is rounding.
        const ROUNDING: f64 = 1e-6;
        let features = self.features.iter().map(|feature| {
            let number = feature.chain.as_ref().map_or(0, |chain| chain.vertices[0]);
            let ranked = Ranked { subject: Subject::Feature(feature), ratios: feature.ratios(limits) };
            (ranked, feature.radius.unwrap_or(f64::INFINITY), number)
        });
        let vertices = self.vertices.iter().map(|vertex| {
            let ranked = Ranked { subject: Subject::Vertex(vertex), ratios: vertex.ratios(limits) };
            (ranked, f64::INFINITY, vertex.number())
        });
        let mut all: Vec<(Ranked<'_>, f64, u32)> = features.chain(vertices).collect();
        let known = |ratio: f64| if ratio > ROUNDING { ratio } else { 0.0 };
        let sum = |ranked: &Ranked<'_>| -> f64 { ranked.ratios.iter().map(|&(_, ratio)| known(ratio)).sum() };
        all.sort_by(|(a, r, m), (b, s, n)| {
            let worse = known(b.severity()).total_cmp(&known(a.severity())).then(sum(b).total_cmp(&sum(a)));
            worse.then(r.total_cmp(s)).then(a.kind().cmp(&b.kind())).then(m.cmp(n))
        });
        all.into_iter().map(|(ranked, ..)| ranked).collect()
    }
}
