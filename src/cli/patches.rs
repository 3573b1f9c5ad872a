//! Whose patches are drawn: the exact ones, or OpenSubdiv's.

use super::Failure;
use super::account::Account;
use crate::adaptive::AdaptivePatches;
use crate::gpu::{Gpu, TableLayout, Tables, tables};
use crate::memory;
use crate::mesh::SubdivMesh;
use crate::osd::{EndCap, Isolation, MAX_ISOLATION};
use crate::stam::LimitSurface;
use clap::{Args, ValueEnum};
use std::fmt;
use std::str::FromStr;

/// Bytes that the passes of a picture take, and the driver.
const PICTURES: u64 = 400 << 20;

#[derive(Debug, Args)]
pub(super) struct PatchesArgs {
    /// Whose patches are drawn: the exact limit's, or OpenSubdiv's with features isolated to LEVEL, 1 to 10 (without one, as
    /// OpenSubdiv does by default: smooth ones to 2, sharp ones to 6)
    #[arg(long, value_name = "stam|osd[:LEVEL]", default_value_t)]
    pub patches: Patches,
    /// What OpenSubdiv's patches end in at features [default: gregory]
    #[arg(long, value_enum, value_name = "KIND")]
    pub end_caps: Option<EndCapName>,
    /// Draw the exact limit, OpenSubdiv's patches, and what they do to reflection lines (pixels) and normals (degrees), side by
    /// side in one .png
    #[arg(long)]
    pub compare: bool,
}

/// Whose patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Patches {
    #[default]
    Stam,
    Osd(Isolation),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum EndCapName {
    /// Gregory patches
    Gregory,
    /// Bicubic B-splines
    Bspline,
}

impl FromStr for Patches {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let level = |text: &str| text.parse().ok().filter(|level| (1..=MAX_ISOLATION).contains(level));
        match text.split_once(':') {
            None if text == "stam" => Ok(Self::Stam),
            None if text == "osd" => Ok(Self::Osd(Isolation::DEFAULT)),
            Some(("osd", text)) => match level(text) {
                Some(level) => Ok(Self::Osd(Isolation::uniform(level))),
                None => Err(format!("osd:LEVEL takes a level from 1 to {MAX_ISOLATION}")),
            },
            _ => Err("give stam, osd or osd:LEVEL".to_owned()),
        }
    }
}

impl fmt::Display for Patches {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stam => f.write_str("stam"),
            Self::Osd(Isolation::DEFAULT) => f.write_str("osd"),
            Self::Osd(isolation) => write!(f, "osd:{}", isolation.sharp),
        }
    }
}

impl PatchesArgs {
    /// Refuses options that contradict each other.
    pub fn check(&self) -> Result<(), Failure> {
        match self.patches {
            Patches::Stam if self.end_caps.is_some() && !self.compare => Err(Failure::Bad(
                "--end-caps is for OpenSubdiv's patches; add --patches osd or --compare, or leave it out".to_owned(),
            )),
            _ => Ok(()),
        }
    }

    /// What the patches end in.
    pub fn end_cap(&self) -> EndCap {
        match self.end_caps {
            None | Some(EndCapName::Gregory) => EndCap::Gregory,
            Some(EndCapName::Bspline) => EndCap::BSpline,
        }
    }

    /// Isolation of OpenSubdiv's patches where they are asked for, or compared with.
    pub fn isolation(&self) -> Option<Isolation> {
        match self.patches {
            Patches::Osd(isolation) => Some(isolation),
            Patches::Stam => self.compare.then_some(Isolation::DEFAULT),
        }
    }

    /// Tables of OpenSubdiv's patches.
    pub fn upload_osd(
        &self,
        mesh: &SubdivMesh,
        isolation: Isolation,
        gpu: &Gpu,
        account: &mut Account,
    ) -> Result<(AdaptivePatches, Tables), Failure> {
        let patches = account
            .time("OpenSubdiv's patches", || AdaptivePatches::new(mesh, isolation, self.end_cap()))
            .map_err(|e| Failure::of(mesh, e))?;
        let tables = account.time("tables", || gpu.upload_patches(&patches))?;
        Ok((patches, tables))
    }

    /// Whether the exact patches are drawn, alone or first.
    pub fn draws_exact(&self) -> bool {
        self.compare || self.patches == Patches::Stam
    }

    /// Tables of the patches that are drawn, first or alone.
    pub fn upload(
        &self,
        mesh: &SubdivMesh,
        surface: &LimitSurface,
        layout: TableLayout,
        gpu: &Gpu,
        account: &mut Account,
    ) -> Result<Tables, Failure> {
        match self.patches {
            Patches::Osd(isolation) if !self.compare => Ok(self.upload_osd(mesh, isolation, gpu, account)?.1),
            _ => {
                if gpu.is_software() {
                    // Its memory is the machine's.
                    let needs = surface.bytes() + tables::bytes(surface, layout).min(tables::BUDGET) + PICTURES;
                    memory::check(needs).map_err(|error| Failure::of(mesh, format!("to be drawn {error}")))?;
                }
                Ok(account.time("tables", || gpu.upload_as(surface, layout))?)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_are_written_as_they_are_read() {
        for text in ["stam", "osd", "osd:1", "osd:10"] {
            assert_eq!(text.parse::<Patches>().map(|patches| patches.to_string()), Ok(text.to_owned()));
        }
        for text in ["", "osd:", "osd:0", "osd:11", "osd:-1", "osd:2.5", "stam:2", "OSD", "osd:2:3"] {
            assert!(text.parse::<Patches>().is_err(), "{text}");
        }
    }
}
