//! What the limit surface is made of: one [`Patch`] for every leaf of the quadtree over each ptex face.
//!
//! OpenSubdiv refines; this station decides where to stop. A face of any level is a leaf as soon as its limit has a
//! closed form: all four corners regular (boundaries and infinitely sharp edges included), or one extraordinary vertex
//! whose rules no longer change and whose spokes are the only features of the other corners. Then a [`RingClass`] says
//! everything about the patch but its points. Smooth extraordinary vertices, darts, crease and corner sectors all end
//! at level 2 at the latest. Along a semi-sharp crease of constant sharpness a face is a stack of strips; only where
//! sharpness varies or creases meet does it take ceil(sharpness) levels.

mod adjacency;
mod fan;
mod flat;
mod forecast;
pub mod lattice;
mod loop_tree;
mod piece;
mod refine;
mod strips;
mod tree;
mod triangle;

pub use adjacency::{Adjacency, Neighbour};
pub(crate) use refine::refiner;
pub use refine::{Refinement, Watch};
pub use tree::PHANTOM;
pub(crate) use tree::slot;

use std::borrow::Cow;
use std::collections::HashMap;

/// Faces round a vertex beyond which they share what they have in common, and nothing is tabulated by class: a class for each
/// face, with the points of all, would take memory and time with the square of their number.
pub const LARGE_FAN: usize = 16;

/// Why the patches of a mesh were not found.
#[derive(Debug, thiserror::Error)]
pub enum PatchError {
    /// OpenSubdiv refused the mesh.
    #[error(transparent)]
    Osd(#[from] crate::osd::Error),
    /// A face has no closed form and OpenSubdiv did not refine it further.
    #[error("face {face} of level {level} has features that isolation does not resolve: please report this mesh")]
    NotRefined {
        /// Refinement level.
        level: usize,
        /// Face index in the level.
        face: usize,
    },
    /// The process may not take so much memory.
    #[error("to be refined {0}")]
    Memory(#[from] crate::memory::TooMuch),
    /// Refined vertices are counted in 32 bits.
    #[error("the refined mesh has more points than 32-bit indices can count; split it")]
    TooManyPoints,
    /// OpenSubdiv numbered child faces in an order we do not know.
    #[error("face {face} of level {level}: unexpected order of its child faces: please report this mesh")]
    ChildOrder {
        /// Refinement level.
        level: usize,
        /// Face index in the level.
        face: usize,
    },
}

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

impl PatchKind {
    /// All kinds, in report order.
    pub const ALL: [Self; 5] = [Self::Regular, Self::Smooth, Self::Dart, Self::Crease, Self::Corner];

    /// Name in reports and in the `kind` column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Regular => "regular",
            Self::Smooth => "smooth",
            Self::Dart => "dart",
            Self::Crease => "crease",
            Self::Corner => "corner",
        }
    }
}

/// Where the parameters of a patch lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shape {
    /// The unit square.
    #[default]
    Square,
    /// The triangle u >= 0, v >= 0, u + v <= 1 (Loop's scheme).
    Triangle,
    /// The same, turned by half a turn: its corner (0,0) lies at the far corner of its cell.
    TurnedTriangle,
}

/// One leaf of the quadtree over a ptex face; its own local (u,v) span the unit square, or the half of it below its diagonal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Ptex face that the patch lies in.
    pub ptex: u32,
    /// Domain of its parameters.
    pub shape: Shape,
    /// Depth in u and in v: the patch spans 2^-depth of the ptex face each way. They differ for the strips along a
    /// semi-sharp crease.
    pub depth: [u8; 2],
    /// The ptex face is a quadrant of an n-gon: its sides are as long as those of quads one level deeper.
    pub quadrant: bool,
    /// Position of its cell in the ptex face, in units of 2^-depth.
    pub origin: [u16; 2],
    /// Quarter turns: local (0,0) lies at corner `rotation` of the cell (corners (0,0), (1,0), (1,1), (0,1)). Of a triangle
    /// third turns: the corner of the triangle.
    pub rotation: u8,
    /// Rules.
    pub kind: PatchKind,
    /// Bit e: the neighbour across local edge e (0: v=0, 1: u=1, 2: v=1, 3: u=0; of a triangle 0: v=0, 1: u+v=1, 2: u=0) is
    /// split once more.
    pub transition: u8,
}

impl Patch {
    /// Patch-local parameters of a point of the ptex face that lies in this patch.
    pub fn to_local(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        if self.shape != Shape::Square {
            return self.in_triangle([u, v]);
        }
        let scale = self.scale();
        let [u, v] = [u * scale[0] - f64::from(self.origin[0]), v * scale[1] - f64::from(self.origin[1])];
        turn_in(self.rotation, [u, v])
    }

    /// Local parameters that one ptex parameter spans, for each ptex parameter: 2^depth.
    pub fn scale(&self) -> [f64; 2] {
        self.depth.map(|depth| f64::from(1u32 << depth))
    }

    /// Refinement levels along the local u and v: edges of one level are as long, whatever their ptex face.
    pub fn levels(&self) -> [u8; 2] {
        let [u, v] = self.depth.map(|depth| depth + u8::from(self.quadrant));
        if self.rotation.is_multiple_of(2) { [u, v] } else { [v, u] }
    }

    /// Ptex parameters of a patch-local point.
    pub fn to_ptex(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        if self.shape != Shape::Square {
            return self.of_triangle([s, t]);
        }
        let [u, v] = match self.rotation {
            0 => [s, t],
            1 => [1.0 - t, s],
            2 => [1.0 - s, 1.0 - t],
            _ => [t, 1.0 - s],
        };
        let scale = self.scale();
        [(u + f64::from(self.origin[0])) / scale[0], (v + f64::from(self.origin[1])) / scale[1]]
    }
}

/// Parameters of a cell in the frame whose (0,0) is the cell's corner `rotation`.
fn turn_in(rotation: u8, [u, v]: [f64; 2]) -> [f64; 2] {
    match rotation {
        0 => [u, v],
        1 => [v, 1.0 - u],
        2 => [1.0 - u, 1.0 - v],
        _ => [1.0 - v, u],
    }
}

/// The rule at the tip of a sector or ring.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Tip {
    /// The smooth vertex rule (smooth vertices and darts).
    Smooth,
    /// The crease rule along the two bounding edges.
    Crease,
    /// The vertex stays where it is.
    Corner,
}

/// What all irregular patches with the same subdivision matrices share (docs/LIMIT.md, section 2.2).
///
/// The faces round the vertex are counted counter-clockwise; face i lies between spoke i and spoke i+1. A closed ring
/// starts at the patch itself, an open sector at its first sharp or boundary edge. Of more than [`LARGE_FAN`] faces the class
/// is that of them all, with the index 0, and [`Patches::wedge`] says which face a patch is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RingClass {
    /// Faces are triangles under Loop's rules, not quads under those of Catmull and Clark.
    pub triangles: bool,
    /// Faces in the ring or sector.
    pub faces: u16,
    /// Goes all the way round.
    pub closed: bool,
    /// Which face the patch is.
    pub index: u16,
    /// Rule at the vertex.
    pub tip: Tip,
    /// The infinitely sharp spoke of a dart.
    pub sharp_spoke: Option<u16>,
}

impl RingClass {
    /// Number of spokes.
    pub fn spokes(&self) -> usize {
        usize::from(self.faces) + usize::from(!self.closed)
    }

    /// Whether a spoke is infinitely sharp or a boundary.
    pub fn is_sharp(&self, spoke: usize) -> bool {
        match self.closed {
            true => self.sharp_spoke == Some(spoke as u16),
            false => spoke == 0 || spoke == usize::from(self.faces),
        }
    }

    /// The two spokes of the patch: v = 0 and u = 0.
    pub fn own_spokes(&self) -> [usize; 2] {
        let first = usize::from(self.index);
        [first, (first + 1) % self.spokes()]
    }

    /// Grid positions of the points outside the ring, in the order in which a support lists them.
    pub fn outer(&self) -> Vec<(isize, isize)> {
        let [first, second] = self.own_spokes();
        let mut points = match self.triangles {
            true => vec![(2, 0), (1, 1), (0, 2)],
            false => vec![(2, 0), (2, 1), (2, 2), (1, 2), (0, 2)],
        };
        if !self.is_sharp(first) {
            points.push((2, -1));
        }
        if !self.is_sharp(second) {
            points.push((-1, 2));
        }
        points
    }

    /// The class of a large fan, whichever of its faces this is.
    fn of_all_faces(self) -> Self {
        Self { index: 0, ..self }
    }

    /// Points round the vertex, it included: those that the subdivided ones follow from.
    pub fn ring(&self) -> usize {
        self.support() - self.outer().len()
    }

    /// Whether the surface has a tangent plane at the vertex (docs/LIMIT.md, section 5). Not so for rings of two faces,
    /// cones, and where directions inside a sector outgrow those along its edges: creases of five faces and more on a
    /// side, corners of three and more; of triangles, seven and four. The normal there is the limit inside the patch.
    pub fn has_tangent_plane(&self) -> bool {
        let [crease, corner] = if self.triangles { [7, 4] } else { [5, 3] };
        match (self.closed, self.tip) {
            (true, Tip::Smooth) => self.faces > 2,
            (true, _) => false,
            (false, Tip::Crease) => self.faces < crease,
            (false, _) => self.faces < corner,
        }
    }

    /// Number of control points: the vertex, its spokes, the opposite corners of its quads, the outer points (2N+8 for
    /// a smooth vertex of valence N, as in Stam 1998; N+6 for triangles, as in Stam 1999).
    pub fn support(&self) -> usize {
        let opposite = if self.triangles { 0 } else { usize::from(self.faces) };
        1 + self.spokes() + opposite + self.outer().len()
    }
}

impl Wedge {
    /// The class of the patch itself: that of its fan, and which face it is.
    pub fn class_of_face(&self, classes: &[RingClass]) -> RingClass {
        RingClass { index: self.face, ..classes[self.class as usize] }
    }
}

/// A node of the quadtree over a ptex face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Node {
    /// No surface.
    Hole,
    /// A patch.
    Leaf(u32),
    /// Four children, at corners (0,0), (1,0), (1,1), (0,1).
    Split(u32),
    /// Strips along a semi-sharp crease.
    Strips(u32),
}

/// The strips of a cell along its edge `rotation`, across the cell's local v: patch `first` + i spans v in
/// [2^-(i+1), 2^-i], but the last one [0, 2^-i].
#[derive(Debug, Clone, Copy)]
struct Strips {
    first: u32,
    count: u8,
    rotation: u8,
}

/// Rows of a 4x4 net as sums of the four rows that its support lists.
pub type RowWeights = [[f64; 4]; 4];

/// Where the control points of a patch are listed.
#[derive(Debug, Clone, Copy)]
struct Support {
    first: u32,
    kind: SupportKind,
}

#[derive(Debug, Clone, Copy)]
enum SupportKind {
    /// A net.
    Net,
    /// The rows of a net whose weights these are.
    Strip(u32),
    /// What the class says.
    Class(u32),
    /// The points outside the ring of a wedge.
    Wedge(u32),
}

/// A patch at a vertex of more than [`LARGE_FAN`] faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wedge {
    /// Index into [`Patches::classes`].
    pub class: u32,
    /// Index into the rings of [`Patches`]: the vertex, its spokes and the opposite corners of its quads, which all faces of the fan
    /// share.
    pub ring: u32,
    /// Which face of the fan it is.
    pub face: u16,
}

/// The patches of a mesh and the quadtrees that find them. Topology only: control points may move without it changing.
#[derive(Debug, Clone, Default)]
pub struct Patches {
    /// Patches are triangles: supports, quadtrees and parameters are those of Loop's scheme.
    triangles: bool,
    patches: Vec<Patch>,
    supports: Vec<Support>,
    vertices: Vec<u32>,
    classes: Vec<RingClass>,
    /// Where the points of large fans are listed: first and number.
    rings: Vec<[u32; 2]>,
    wedges: Vec<Wedge>,
    roots: Vec<Node>,
    splits: Vec<[Node; 4]>,
    strips: Vec<Strips>,
    row_weights: Vec<RowWeights>,
    ptex_edges: adjacency::PtexEdges,
}

impl Patches {
    /// All patches, in ptex order.
    pub fn all(&self) -> &[Patch] {
        &self.patches
    }

    /// The classes of the irregular patches.
    pub fn classes(&self) -> &[RingClass] {
        &self.classes
    }

    /// Index into [`classes`](Self::classes) of an irregular patch.
    pub fn class(&self, patch: usize) -> Option<usize> {
        match self.supports[patch].kind {
            SupportKind::Class(class) => Some(class as usize),
            SupportKind::Wedge(wedge) => Some(self.wedges[wedge as usize].class as usize),
            _ => None,
        }
    }

    /// Of a patch at a vertex of more than [`LARGE_FAN`] faces: its number among those, and what it is.
    pub fn wedge(&self, patch: usize) -> Option<(usize, Wedge)> {
        match self.supports[patch].kind {
            SupportKind::Wedge(wedge) => Some((wedge as usize, self.wedges[wedge as usize])),
            _ => None,
        }
    }

    /// Number of patches that are [wedges](Self::wedge).
    pub fn wedge_count(&self) -> usize {
        self.wedges.len()
    }

    /// Refined vertices of a large fan: the vertex, its spokes and the opposite corners of its quads, counter-clockwise.
    pub fn ring(&self, ring: usize) -> &[u32] {
        let [first, count] = self.rings[ring].map(|x| x as usize);
        &self.vertices[first..first + count]
    }

    /// Number of [rings](Self::ring).
    pub fn ring_count(&self) -> usize {
        self.rings.len()
    }

    /// Refined vertices that control a patch: for a regular one the 4x4 net, u fastest, or the 12 points of a box spline
    /// ([`stam::box_spline`](crate::stam::box_spline)), [`PHANTOM`] beyond sharp edges; else the support of its class. That of a
    /// [wedge](Self::wedge) is its ring, from the ring's own beginning, and the points outside it: put together for the call.
    pub fn support(&self, patch: usize) -> Cow<'_, [u32]> {
        match self.wedge(patch) {
            Some((_, wedge)) => [self.ring(wedge.ring as usize), self.own_support(patch)].concat().into(),
            None => self.own_support(patch).into(),
        }
    }

    /// As [`support`](Self::support), of a wedge without its ring.
    pub(crate) fn own_support(&self, patch: usize) -> &[u32] {
        let Support { first, kind } = self.supports[patch];
        let length = match kind {
            SupportKind::Net | SupportKind::Strip(_) if self.triangles => lattice::NET.len(),
            SupportKind::Net | SupportKind::Strip(_) => 16,
            SupportKind::Class(class) => self.classes[class as usize].support(),
            SupportKind::Wedge(wedge) => self.wedges[wedge as usize].class_of_face(&self.classes).outer().len(),
        };
        &self.vertices[first as usize..][..length]
    }

    /// Index of a class, which is new where `known` does not have it.
    fn class_index(&mut self, known: &mut HashMap<RingClass, u32>, class: RingClass) -> u32 {
        let next = known.len() as u32;
        let index = *known.entry(class).or_insert(next);
        if index == next {
            self.classes.push(class);
        }
        index
    }

    fn push_ring(&mut self, vertices: impl Iterator<Item = u32>) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(vertices);
        self.rings.push([first, self.vertices.len() as u32 - first]);
    }

    fn push_wedge(&mut self, first: u32, wedge: Wedge) -> Support {
        self.wedges.push(wedge);
        Support { first, kind: SupportKind::Wedge(self.wedges.len() as u32 - 1) }
    }

    /// Bytes of all this.
    pub(crate) fn bytes(&self) -> u64 {
        let Self { patches, supports, vertices, roots, splits, strips, row_weights, ptex_edges, .. } = self;
        let lists = [
            size_of_val(&self.rings[..]),
            size_of_val(&self.wedges[..]),
            size_of_val(&patches[..]),
            size_of_val(&supports[..]),
            size_of_val(&vertices[..]),
            size_of_val(&roots[..]),
            size_of_val(&splits[..]),
            size_of_val(&strips[..]),
            size_of_val(&row_weights[..]),
            ptex_edges.bytes(),
        ];
        lists.iter().sum::<usize>() as u64
    }

    /// The supports of all patches.
    pub(crate) fn supports(&self) -> &[u32] {
        &self.vertices
    }

    /// Lets another vertex be point `point` of a patch's support, and of those that share it (strips). A wedge gets a ring of its
    /// own where the point is one of the ring.
    pub(crate) fn set_support(&mut self, patch: usize, point: usize, vertex: u32) {
        let mut first = self.supports[patch].first as usize;
        let mut place = point;
        if let Some((number, wedge)) = self.wedge(patch) {
            let ring = self.ring(wedge.ring as usize).to_vec();
            match place.checked_sub(ring.len()) {
                Some(outer) => place = outer,
                None => {
                    self.wedges[number].ring = self.rings.len() as u32;
                    first = self.vertices.len();
                    self.push_ring(ring.into_iter());
                }
            }
        }
        self.vertices[first + place] = vertex;
    }

    /// How the rows (v = const) of a strip's net follow from the four rows of its support; `None` for other patches.
    pub fn row_weights(&self, patch: usize) -> Option<&RowWeights> {
        match self.supports[patch].kind {
            SupportKind::Strip(rows) => Some(&self.row_weights[rows as usize]),
            _ => None,
        }
    }

    /// Whether patches are triangles, under Loop's scheme.
    pub fn are_triangles(&self) -> bool {
        self.triangles
    }

    /// Number of ptex faces, holes included.
    pub fn ptex_count(&self) -> usize {
        self.roots.len()
    }

    /// The patch at (u,v), each 0 to 1, of a ptex face, and the patch-local parameters; `None` in a hole. Of a triangle, u + v
    /// is at most 1.
    ///
    /// # Panics
    /// `ptex` is not below [`ptex_count`](Self::ptex_count).
    pub fn locate(&self, ptex: u32, uv: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let mut node = self.roots[ptex as usize];
        let [mut u, mut v] = uv;
        // The binary digits of u and v say which child they lie in; at 1 all are 1. A tree has ten levels at most.
        let digits = uv.map(|x| ((x * 65536.0) as u32).min(65535));
        let mut depth = 0;
        let patch = loop {
            match node {
                Node::Hole => break None,
                Node::Leaf(patch) => break Some(patch),
                Node::Strips(strips) => {
                    let Strips { first, count, rotation } = self.strips[strips as usize];
                    let inside = |k: usize| uv[k] * f64::from(1u32 << depth) - f64::from(digits[k] >> (16 - depth));
                    let [_, across] = turn_in(rotation, [inside(0), inside(1)]);
                    let strip = (1..u32::from(count)).find(|&i| across >= 0.5f64.powi(i as i32));
                    break Some(first + strip.map_or(u32::from(count), |i| i) - 1);
                }
                Node::Split(children) if self.triangles => {
                    let (child, inside) = triangle::quarter([u, v]);
                    [u, v] = inside;
                    node = self.splits[children as usize][child];
                }
                Node::Split(children) => {
                    depth += 1;
                    let [right, up] = digits.map(|digits| (digits >> (16 - depth)) as usize & 1);
                    node = self.splits[children as usize][[[0, 3], [1, 2]][right][up]];
                }
            }
        }?;
        let local = self.patches[patch as usize].to_local(uv);
        Some((patch as usize, local.map(|x| x.clamp(0.0, 1.0))))
    }
}
