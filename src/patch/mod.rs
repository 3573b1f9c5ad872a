//! What the limit surface is made of: one patch for every leaf of the quadtree over each ptex face.

/// What rules apply in a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PatchKind {
    /// Uniform bicubic B-spline, phantom points beyond boundaries and infinitely sharp edges.
    Regular,
    /// A smooth extraordinary vertex at local (0,0).
    Smooth,
    /// An extraordinary vertex with one infinitely sharp edge.
    Dart,
    /// A crease or boundary vertex, with other than two faces in this sector.
    Crease,
    /// A corner vertex, with other than one face in this sector.
    Corner,
}

/// One leaf of the quadtree over a ptex face; its own local (u,v) span [0,1]^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Ptex face that the patch lies in.
    pub ptex: u32,
    /// Depth in the quadtree of the ptex face: the patch spans 2^-depth in u and v.
    pub depth: u8,
    /// Position in the quadtree, in units of 2^-depth.
    pub origin: [u16; 2],
    /// Quarter turns: local (0,0) lies at corner `rotation` of the quadtree cell (corners (0,0), (1,0), (1,1), (0,1)).
    pub rotation: u8,
    /// Rules.
    pub kind: PatchKind,
    /// Bit e: the neighbour across local edge e (0: v=0, 1: u=1, 2: v=1, 3: u=0) is split once more.
    pub transition: u8,
}
