//! What makes a row of the report.

use super::flaw::Flaw;
use crate::patch::PatchKind;

/// The tiers, in report order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum TierName {
    Vertex,
    Dyadic,
    Regular,
    Fragment,
    EndCap,
    /// Another program's answers.
    Results,
}

impl TierName {
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Dyadic => "dyadic",
            Self::Regular => "regular",
            Self::Fragment => "fragment",
            Self::EndCap => "endcap",
            Self::Results => "results",
        }
    }
}

/// What is compared with, in report order: the main reference first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Against {
    /// Our own f64, for another program's answers.
    Limit,
    /// `PrimvarRefiner::Limit`.
    LimitMasks,
    /// `Far::LimitStencilTable` in double precision at isolation 10.
    LimitStencils,
    /// `Far::PatchTable` at isolation 10.
    Far,
    /// Bfr surfaces where they are exact.
    Bfr,
    /// Bfr's default end caps.
    BfrEndCaps,
    /// Our own f64, at what a picture sees.
    F64,
    /// Our own f64, on all patches.
    F64AllPatches,
}

impl Against {
    pub fn name(self) -> &'static str {
        match self {
            Self::Limit => "limit",
            Self::LimitMasks => "limit masks",
            Self::LimitStencils => "limit stencils level 10",
            Self::Far => "Far level 10",
            Self::Bfr => "Bfr",
            Self::BfrEndCaps => "Bfr 2/6",
            Self::F64 => "f64",
            Self::F64AllPatches => "f64 all patches",
        }
    }
}

/// Identifies a bin: one row of the report. Ordered as rows are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    pub tier: TierName,
    pub against: Against,
    /// `None` where we have no surface.
    pub kind: Option<PatchKind>,
    /// Why the reference is wrong here.
    pub known_wrong: Option<Flaw>,
}

impl Key {
    pub fn new(tier: TierName, against: Against, kind: Option<PatchKind>) -> Self {
        Self { tier, against, kind, known_wrong: None }
    }

    /// The 99.99th percentile of the normals is judged, and the largest only capped: a budget of the picture, not a
    /// rounding error.
    pub fn judges_percentile(&self) -> bool {
        self.tier == TierName::Fragment
    }
}
