//! Parts of a surface that are others in another place: patches and refined points are stored once.
//!
//! Refinement commutes with affine maps, so the net of an instance is that of its original, moved, to rounding. What is kept of each
//! patch of an instance is its [`Patch`] alone (16 bytes).

use crate::mesh::{Originals, PtexParts, SubdivMesh};
use crate::patch::{Patch, Patches};
use glam::DAffine3;
use std::ops::Range;

/// Where the patches of each part of a scene are stored.
#[derive(Debug)]
pub(super) struct Instances {
    parts: Vec<Placed>,
    /// All patches of the scene.
    patches: Vec<Patch>,
    ptex_count: usize,
}

/// A part of the scene.
#[derive(Debug)]
pub(super) struct Placed {
    /// First patch and ptex face in the scene.
    pub patch: u32,
    pub ptex: u32,
    /// Where these are stored.
    pub stored: Range<u32>,
    stored_ptex: u32,
    /// First patch, in the scene, of the part that it repeats, and which transform moves that; itself if there is none.
    original: u32,
    transform_index: usize,
    /// What moves the stored points here.
    pub transform: Option<DAffine3>,
}

impl Instances {
    /// `stored`: the patches of `originals`.
    pub fn new(scene: &SubdivMesh, originals: &Originals, stored: &Patches) -> Self {
        let own = originals.mesh.ptex_parts();
        let stored_ptex: Vec<Range<u32>> = own.iter().map(|(_, ptex)| ptex).collect();
        let at = |ptex: u32| stored.all().partition_point(|patch| patch.ptex < ptex) as u32;
        let parts: PtexParts<'_> = scene.ptex_parts();
        let mut out = Self { parts: Vec::new(), patches: Vec::new(), ptex_count: scene.ptex_count() };
        let mut transforms = 0;
        for ((part, ptex), &index) in parts.iter().zip(&originals.part) {
            let Range { start, end } = stored_ptex[index as usize];
            let patches = at(start)..at(end);
            let patch = out.patches.len() as u32;
            let original = part.repeats.map_or(patch, |repeat| out.parts[repeat.part as usize].patch);
            out.parts.push(Placed {
                patch,
                ptex: ptex.start,
                stored: patches.clone(),
                stored_ptex: start,
                original,
                transform_index: transforms,
                transform: part.repeats.map(|repeat| repeat.transform),
            });
            transforms += usize::from(part.repeats.is_some());
            let moved = |patch: &Patch| Patch { ptex: patch.ptex - start + ptex.start, ..*patch };
            out.patches.extend(stored.all()[patches.start as usize..patches.end as usize].iter().map(moved));
        }
        out
    }

    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    pub fn ptex_count(&self) -> usize {
        self.ptex_count
    }

    pub fn parts(&self) -> &[Placed] {
        &self.parts
    }

    /// The part that a patch is of.
    fn part(&self, patch: usize) -> &Placed {
        &self.parts[self.parts.partition_point(|part| part.patch as usize <= patch) - 1]
    }

    /// Of a patch of an instance: the patch of the scene that it repeats, and which transform moves it.
    pub fn original(&self, patch: usize) -> Option<(usize, usize)> {
        let part = self.part(patch);
        part.transform.map(|_| (patch - part.patch as usize + part.original as usize, part.transform_index))
    }

    /// Where a patch is stored, and what moves it.
    pub fn stored(&self, patch: usize) -> (usize, Option<&DAffine3>) {
        let part = self.part(patch);
        (patch - part.patch as usize + part.stored.start as usize, part.transform.as_ref())
    }

    /// Ptex face of the stored surface, and the number to add to its patches.
    pub fn stored_ptex(&self, ptex: u32) -> (u32, impl Fn(usize) -> usize) {
        let part = &self.parts[self.parts.partition_point(|part| part.ptex <= ptex) - 1];
        let (first, stored) = (part.patch as usize, part.stored.start as usize);
        (ptex - part.ptex + part.stored_ptex, move |patch| patch - stored + first)
    }
}
