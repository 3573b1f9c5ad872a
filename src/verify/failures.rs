//! Where samples failed.

use super::bin::{Failed, FailedPatches};
use super::difference::Sample;
use crate::line::count;
use crate::mesh::{PtexParts, SubdivMesh};
use crate::patch::PatchKind;
use crate::stam::LimitSurface;
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt;

/// Patches that a report lists, the worst first.
const LISTED: usize = 5;

/// Which parts of the surface failed samples lie in.
#[derive(Debug, Clone, Serialize)]
pub struct Failures {
    /// Failed samples.
    pub samples: usize,
    /// Patches with failed samples, and ptex faces without a patch of ours.
    pub patches: usize,
    /// Ptex faces with failed samples.
    pub ptex_faces: usize,
    /// Faces of the control mesh with failed samples.
    pub control_faces: usize,
    /// The worst patches.
    pub worst: Vec<FailedPatch>,
}

/// A patch with failed samples.
#[derive(Debug, Clone, Serialize)]
pub struct FailedPatch {
    /// Index among all patches of the mesh; absent where we have no surface and OpenSubdiv has one.
    pub patch: Option<u32>,
    /// Patch kind, or `hole`.
    pub kind: &'static str,
    /// Ptex face.
    pub ptex_face: u32,
    /// Face of the control mesh, counted from 0.
    pub control_face: u32,
    /// Path of the prim that the face is of; absent for meshes that are not from a stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prim: Option<String>,
    /// Parameters of the ptex face that the patch spans.
    pub u: [f64; 2],
    /// Parameters of the ptex face that the patch spans.
    pub v: [f64; 2],
    /// Failed samples.
    pub samples: usize,
    /// The worst of them.
    pub worst: Sample,
    /// Error of the worst over what is allowed; absent where either is no number.
    pub times_allowed: Option<f64>,
}

/// Face of the control mesh of each ptex face.
pub(super) fn control_faces(mesh: &SubdivMesh) -> Vec<u32> {
    let ptex = |(face, &size): (usize, &u32)| {
        let count = mesh.ptex_faces_of(size as usize);
        std::iter::repeat_n(face as u32, count)
    };
    mesh.face_sizes.iter().enumerate().flat_map(ptex).collect()
}

impl Failures {
    /// `None` where nothing failed.
    pub(super) fn new(
        failed: &FailedPatches,
        surface: &LimitSurface,
        control_faces: &[u32],
        parts: &PtexParts<'_>,
    ) -> Option<Self> {
        if failed.is_empty() {
            return None;
        }
        let faces: BTreeSet<u32> = failed.keys().map(|&(face, _)| face).collect();
        let controls: BTreeSet<u32> = faces.iter().map(|&face| control_faces[face as usize]).collect();
        let mut ranked: Vec<_> = failed.iter().collect();
        ranked.sort_by(|a, b| b.1.worst.share.total_cmp(&a.1.worst.share));
        let describe = |(&(ptex_face, patch), failed): (&(u32, Option<u32>), &Failed)| {
            let found = patch.map(|patch| &surface.patches()[patch as usize]);
            let corners =
                found.map_or([[0.0; 2], [1.0; 2]], |patch| [[0.0, 0.0], [1.0, 1.0]].map(|c| patch.to_ptex(c)));
            let span = |i: usize| [corners[0][i].min(corners[1][i]), corners[0][i].max(corners[1][i])];
            FailedPatch {
                patch,
                kind: found.map_or("hole", |patch| PatchKind::name(patch.kind)),
                ptex_face,
                control_face: control_faces[ptex_face as usize],
                prim: parts.name(ptex_face).map(str::to_owned),
                u: span(0),
                v: span(1),
                samples: failed.samples,
                worst: failed.worst.sample,
                times_allowed: Some(failed.worst.share).filter(|share| share.is_finite()),
            }
        };
        Some(Self {
            samples: failed.values().map(|failed| failed.samples).sum(),
            patches: failed.len(),
            ptex_faces: faces.len(),
            control_faces: controls.len(),
            worst: ranked.into_iter().take(LISTED).map(describe).collect(),
        })
    }
}

impl fmt::Display for Failures {
    /// One line: how many samples in how many patches and faces.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} in {} of {} ({})",
            count(self.samples, "sample"),
            count(self.patches, "patch"),
            count(self.ptex_faces, "ptex face"),
            count(self.control_faces, "control face"),
        )
    }
}

impl fmt::Display for FailedPatch {
    /// One line: which patch, how many samples, how bad.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ptex_face, control_face, u, v, kind, worst, .. } = self;
        match self.patch {
            Some(patch) => write!(f, "patch {patch} ({kind}), ptex face {ptex_face}")?,
            None => write!(f, "no patch, ptex face {ptex_face}")?,
        }
        write!(f, " (u {}..{}, v {}..{}), control face {control_face}", u[0], u[1], v[0], v[1])?;
        self.prim.as_ref().map_or(Ok(()), |prim| write!(f, " of {prim}"))?;
        write!(f, ": ")?;
        write!(f, "{}, worst ", count(self.samples, "sample"))?;
        match self.times_allowed {
            Some(times) => write!(f, "{times:.1e} times what is allowed")?,
            None => write!(f, "not comparable")?,
        }
        write!(f, " at {},{},{}", worst.face, worst.u, worst.v)
    }
}
