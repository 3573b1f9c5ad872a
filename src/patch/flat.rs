//! The patches of schemes that leave faces where they are: each ptex face is the bilinear patch of its corners.
//!
//! A bilinear patch is a bicubic B-spline whose net is the bilinear map at (i,j), and that is what phantom points 2a - b
//! beyond all four edges make of the four corners: the face has boundaries all round.

use super::adjacency::PtexEdges;
use super::piece::Piece;
use super::tree::{PHANTOM, slot};
use super::{Node, Patch, PatchError, PatchKind, Patches, Shape, Support, SupportKind};
use crate::osd::{Level, Refiner};

/// The patches of a piece whose faces, those that are no quads, are refined once.
pub(super) fn build(refiner: &Refiner, piece: &Piece<'_>) -> Result<Patches, PatchError> {
    let control = refiner.level(0)?;
    // Without such faces OpenSubdiv has no level 1.
    let middles = if refiner.level_count() > 1 { refiner.level(1)? } else { Level::default() };
    let mut out = Patches { ptex_edges: PtexEdges::new(&control, piece, true), ..Patches::default() };
    for face in piece.core.clone() {
        let corners = control.corners(face);
        let hole = control.face_holes[face] != 0;
        if corners.len() == 4 {
            out.push_face(piece.first_ptex, (!hole).then(|| corner_vertices(&control, face, 0)), false);
            continue;
        }
        for corner in corners {
            let not_refined = PatchError::NotRefined { level: 0, face };
            let child = usize::try_from(control.face_children[corner]);
            let quadrant = match (hole, child) {
                (true, _) => None,
                (false, Ok(child)) => Some(corner_vertices(&middles, child, control.vertex_count())),
                (false, Err(_)) => return Err(not_refined),
            };
            if let Some([first, ..]) = quadrant {
                let vertex = control.face_vertices[corner] as usize;
                if first as usize != control.vertex_count() + control.vertex_children[vertex] as usize {
                    return Err(PatchError::ChildOrder { level: 0, face });
                }
            }
            out.push_face(piece.first_ptex, quadrant, true);
        }
    }
    Ok(out)
}

/// The vertices of a quad, counted from the first one of level 0.
fn corner_vertices(level: &Level, face: usize, first: usize) -> [u32; 4] {
    let corners = level.corners(face);
    std::array::from_fn(|k| (first + level.face_vertices[corners.start + k] as usize) as u32)
}

impl Patches {
    /// Adds a ptex face with these corners, counter-clockwise from (0,0); `None` for a hole. The first one is `first_ptex`.
    fn push_face(&mut self, first_ptex: u32, corners: Option<[u32; 4]>, quadrant: bool) {
        let ptex = first_ptex + self.roots.len() as u32;
        let Some([a, b, c, d]) = corners else {
            self.roots.push(Node::Hole);
            return;
        };
        let mut net = [PHANTOM; 16];
        for ([i, j], vertex) in [([0, 0], a), ([1, 0], b), ([1, 1], c), ([0, 1], d)] {
            net[slot(i, j)] = vertex;
        }
        self.roots.push(Node::Leaf(self.patches.len() as u32));
        self.supports.push(Support { first: self.vertices.len() as u32, kind: SupportKind::Net });
        self.vertices.extend(net);
        self.patches.push(Patch {
            ptex,
            shape: Shape::Square,
            depth: [0; 2],
            quadrant,
            origin: [0; 2],
            rotation: 0,
            kind: PatchKind::Regular,
            transition: 0,
        });
    }
}
