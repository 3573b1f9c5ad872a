//! The meshes of a scene: which faces are whose.

use std::ops::Range;

use glam::DAffine3;

use super::SubdivMesh;

/// A mesh of a scene whose meshes were read as one.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Part {
    /// Path of its prim.
    pub name: String,
    /// Its faces among those of the whole.
    pub faces: Range<u32>,
    /// Its points among those of the whole.
    pub points: Range<u32>,
    /// The earlier part that it is in another place, if it is one.
    pub repeats: Option<Repeat>,
}

/// An instance: a part with the topology of an earlier one that repeats none, and its points moved.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Repeat {
    /// Index of the earlier part.
    pub part: u32,
    /// What moves its points to those of the instance, to rounding. It does not mirror.
    pub transform: DAffine3,
}

/// Which part each ptex face is of; see [`SubdivMesh::ptex_parts`].
#[derive(Debug, Clone)]
pub struct PtexParts<'a> {
    parts: &'a [Part],
    /// First ptex face behind each part.
    ends: Vec<u32>,
}

impl<'a> PtexParts<'a> {
    /// The part that a ptex face is of; `None` where the mesh has no parts, or not as many faces.
    pub fn of(&self, ptex: u32) -> Option<&'a Part> {
        self.parts.get(self.ends.partition_point(|&end| end <= ptex))
    }

    /// As [`of`](Self::of), the name alone.
    pub fn name(&self, ptex: u32) -> Option<&'a str> {
        self.of(ptex).map(|part| part.name.as_str())
    }

    /// Each part with its ptex faces.
    pub fn iter(&self) -> impl Iterator<Item = (&'a Part, Range<u32>)> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        self.parts.iter().zip(starts.zip(&self.ends).map(|(start, &end)| start..end))
    }
}

impl SubdivMesh {
    /// Whether both are read from the same prims of a stage.
    pub(crate) fn has_prims_of(&self, other: &Self) -> bool {
        let names = |mesh: &Self| mesh.parts.iter().map(|part| part.name.clone()).collect::<Vec<_>>();
        !self.parts.is_empty() && names(self) == names(other)
    }

    /// Which part each ptex face is of.
    pub fn ptex_parts(&self) -> PtexParts<'_> {
        let mut end = 0;
        let ends = self.parts.iter().map(|part| {
            let sizes = self.face_sizes.get(part.faces.start as usize..part.faces.end as usize).unwrap_or_default();
            end += sizes.iter().map(|&size| self.ptex_faces_of(size as usize) as u32).sum::<u32>();
            end
        });
        PtexParts { ends: ends.collect(), parts: &self.parts }
    }
}
