//! What is known to be wrong in OpenSubdiv, by version.

use crate::osd::{Version, version};

/// A mistake of one of OpenSubdiv's reference evaluators. Samples that it touches are rows of their own in the report, with this
/// reason, and are held to what any wrong reference can be off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Flaw {
    /// End caps beside a dart meet the limit nowhere.
    DartEndCap,
    /// `PrimvarRefiner::Limit` has no mask of a dart.
    DartMask,
    /// The limit masks of smooth vertices assume three edges and more.
    MaskOfValence2,
    /// `PrimvarRefiner::Limit` applies the rule of the last level, before finite sharpness has decayed.
    FiniteSharpnessInMasks,
    /// Beside an edge of more than two faces, patches can run as along a crease.
    PatchNotManifold,
}

impl Flaw {
    #[cfg(test)]
    pub const ALL: [Self; 5] =
        [Self::DartEndCap, Self::DartMask, Self::MaskOfValence2, Self::FiniteSharpnessInMasks, Self::PatchNotManifold];

    /// What the report says.
    pub fn reason(self) -> &'static str {
        match self {
            Self::FiniteSharpnessInMasks => "limit masks ignore finite sharpness",
            Self::DartMask => "limit mask of infinitely sharp darts",
            Self::MaskOfValence2 => "limit mask of interior valence 2",
            Self::DartEndCap => "end cap at infinitely sharp darts",
            Self::PatchNotManifold => "patches at vertices that are not manifold",
        }
    }

    /// The first version without it; `None` if the newest version that was measured (3.6.0) still has it.
    fn mended_in(self) -> Option<Version> {
        match self {
            Self::FiniteSharpnessInMasks
            | Self::DartMask
            | Self::MaskOfValence2
            | Self::DartEndCap
            | Self::PatchNotManifold => None,
        }
    }

    /// Itself, if the version in use has it.
    pub fn in_use(self) -> Option<Self> {
        self.is_in(version()).then_some(self)
    }

    fn is_in(self, version: Version) -> bool {
        self.mended_in().is_none_or(|mended| version < mended)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flaw_is_in_the_version_that_it_was_found_in() {
        for flaw in Flaw::ALL {
            assert!(flaw.is_in(Version::new(3, 5, 0)), "{}", flaw.reason());
            assert!(flaw.mended_in().is_none_or(|mended| !flaw.is_in(mended)), "{}", flaw.reason());
        }
    }
}
