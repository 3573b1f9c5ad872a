//! Finds the patches of a triangle mesh under Loop's rules, as [`tree`](super::tree) does for those of Catmull and Clark.
//!
//! A face of any level is a leaf as soon as its limit has a closed form: all three corners regular (6 faces, or 3 beside a
//! boundary or an infinitely sharp edge, or 1 at a corner), or one extraordinary vertex whose spokes are the only
//! features of the other two. After one level the corners that are new are regular, so there is at most one.

use super::fan::{Fan, LargeFans};
use super::lattice::{NEIGHBOURS, NET};
use super::piece::Piece;
use super::tree::{PHANTOM, kind_of};
use super::{Node, Patch, PatchError, PatchKind, Patches, RingClass, Shape, Support, SupportKind, Wedge};
use crate::osd::{Level, Refiner, Rule};
use std::collections::HashMap;

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Unvisited,
    Leaf,
    Split,
}

struct Walk {
    levels: Vec<Level>,
    /// First refined vertex of each level in the concatenated points.
    first_vertex: Vec<usize>,
    /// For each level and vertex: finite sharpness on it or on an edge of it, so its rules still change.
    restless: Vec<Vec<bool>>,
    states: Vec<Vec<State>>,
    /// Level and face of each patch.
    places: Vec<(usize, usize)>,
    class_indices: HashMap<RingClass, u32>,
    fans: [Fan; 3],
    large: LargeFans,
    /// Numbers of the lists of large fans among those of `out`, by their numbers in `large`.
    rings: HashMap<u32, u32>,
    out: Patches,
}

/// Cell of the quadtree over a ptex face.
#[derive(Clone, Copy)]
struct Cell {
    ptex: u32,
    depth: u8,
    origin: [u16; 2],
    shape: Shape,
}

impl Cell {
    /// The child at a corner, or the one in the middle (3).
    fn child(self, number: usize) -> Self {
        let turned = self.shape == Shape::TurnedTriangle;
        // In a turned cell corner 0 is at the far corner, and the middle is upright again.
        let [du, dv] = match (turned, number) {
            (false, 0 | 3) => [0, 0],
            (false, 1) | (true, 2) => [1, 0],
            (false, _) | (true, 1) => [0, 1],
            (true, _) => [1, 1],
        };
        let shape = if turned == (number == 3) { Shape::Triangle } else { Shape::TurnedTriangle };
        Self { depth: self.depth + 1, origin: [2 * self.origin[0] + du, 2 * self.origin[1] + dv], shape, ..self }
    }
}

/// The patches of a piece's own faces. Ptex faces are numbered as in the whole mesh, refined vertices as in the piece.
pub(super) fn build(refiner: &Refiner, piece: &Piece<'_>) -> Result<Patches, PatchError> {
    let levels = (0..refiner.level_count()).map(|i| refiner.level(i)).collect::<Result<Vec<_>, _>>()?;
    let first_vertex =
        refiner.vertex_counts().iter().scan(0, |sum, &count| Some(std::mem::replace(sum, *sum + count))).collect();
    let mut walk = Walk {
        first_vertex,
        restless: levels.iter().map(Level::restless).collect(),
        states: levels.iter().map(|level| vec![State::Unvisited; level.face_count()]).collect(),
        places: Vec::new(),
        class_indices: HashMap::new(),
        fans: Default::default(),
        large: LargeFans::default(),
        rings: HashMap::new(),
        out: Patches { triangles: true, ..Patches::default() },
        levels,
    };
    for face in piece.core.clone() {
        let ptex = piece.first_ptex + (face - piece.core.start) as u32;
        let root = walk.root(face, ptex)?;
        walk.out.roots.push(root);
    }
    let out = std::mem::take(&mut walk.out);
    let places = std::mem::take(&mut walk.places);
    // Whether the neighbours are split is all that is wanted of them.
    piece.beside(&walk.levels[0]).into_iter().try_for_each(|face| walk.root(face, 0).map(drop))?;
    (walk.out, walk.places) = (out, places);
    walk.mark_transitions();
    Ok(walk.out)
}

impl Walk {
    fn root(&mut self, face: usize, ptex: u32) -> Result<Node, PatchError> {
        self.visit(0, face, Cell { ptex, depth: 0, origin: [0, 0], shape: Shape::Triangle })
    }

    fn visit(&mut self, level: usize, face: usize, cell: Cell) -> Result<Node, PatchError> {
        if self.levels[level].face_holes[face] != 0 {
            return Ok(Node::Hole);
        }
        let leaf = self.leaf(level, face, cell);
        if let Some(patch) = leaf {
            self.states[level][face] = State::Leaf;
            self.places.push((level, face));
            self.out.patches.push(patch);
            return Ok(Node::Leaf(self.out.patches.len() as u32 - 1));
        }
        self.states[level][face] = State::Split;
        let faces = self.children(level, face)?;
        let mut children = [Node::Hole; 4];
        for (number, node) in children.iter_mut().enumerate() {
            *node = self.visit(level + 1, faces[number], cell.child(number))?;
        }
        self.out.splits.push(children);
        Ok(Node::Split(self.out.splits.len() as u32 - 1))
    }

    /// The children of a face: at its corners, which they show at the same place, and in the middle, whose corner k lies
    /// opposite to the face's.
    fn children(&self, level: usize, face: usize) -> Result<[usize; 4], PatchError> {
        let topology = &self.levels[level];
        let corners = topology.corners(face);
        let numbers = [0, 1, 2, 3].map(|k| match k {
            3 => topology.face_middles[face],
            k => topology.face_children[corners.start + k],
        });
        let Some(next) = self.levels.get(level + 1).filter(|_| numbers.iter().all(|&n| n >= 0)) else {
            return Err(PatchError::NotRefined { level, face });
        };
        let faces = numbers.map(|n| n as usize);
        let vertex = |child: usize, place: usize| next.face_vertices[next.corners(faces[child]).start + place];
        let at_corner = |k: usize| topology.vertex_children[topology.face_vertices[corners.start + k] as usize];
        let [next_to, before] = [1, 2].map(|step| move |k: usize| (k + step) % 3);
        let expected = |k: usize| {
            let middle = vertex(3, k);
            vertex(k, k) == at_corner(k)
                && middle == vertex(next_to(k), before(k))
                && middle == vertex(before(k), next_to(k))
        };
        if (0..3).all(expected) { Ok(faces) } else { Err(PatchError::ChildOrder { level, face }) }
    }

    /// The patch of a face, if its limit has a closed form at this level.
    fn leaf(&mut self, level: usize, face: usize, cell: Cell) -> Option<Patch> {
        let topology = &self.levels[level];
        let mut corners = topology.corners(face);
        if corners.any(|i| self.restless[level][topology.face_vertices[i] as usize]) {
            return None;
        }
        for (corner, fan) in self.fans.iter_mut().enumerate() {
            fan.gather(&self.levels, level, face, corner, &mut self.large);
        }
        let irregular: Vec<usize> = (0..3).filter(|&i| !is_regular(&self.fans[i])).collect();
        let (kind, rotation) = match irregular[..] {
            [] => (PatchKind::Regular, 0),
            [corner] if self.stands_alone(corner) => (kind_of(&self.fans[corner])?, corner),
            _ => return None,
        };
        let support = self.support(level, kind, rotation);
        self.out.supports.push(support);
        Some(Patch {
            ptex: cell.ptex,
            shape: cell.shape,
            depth: [cell.depth; 2],
            quadrant: false,
            origin: cell.origin,
            rotation: rotation as u8,
            kind,
            transition: 0,
        })
    }

    /// Whether the other two corners carry no feature except the spokes of the extraordinary vertex.
    fn stands_alone(&self, corner: usize) -> bool {
        let [next, before] = [1, 2].map(|i| &self.fans[(corner + i) % 3]);
        // `next` sees the spoke as the edge that comes in: its sector of three ends there, so the own face is the last one.
        let along = |fan: &Fan, index: usize| match fan.rule {
            Some(Rule::Smooth) => true,
            Some(Rule::Crease) => fan.index == index,
            _ => false,
        };
        along(next, 2) && along(before, 0)
    }

    fn support(&mut self, level: usize, kind: PatchKind, rotation: usize) -> Support {
        let base = self.first_vertex[level];
        let global = |vertex: usize| (base + vertex) as u32;
        let mut net = [PHANTOM; SLOTS * SLOTS];
        for corner in 0..3 {
            if corner == 0 && kind != PatchKind::Regular {
                continue;
            }
            let fan = &self.fans[(rotation + corner) % 3];
            let at = [[0, 0], [1, 0], [0, 1]][corner];
            net[slot(at)] = global(fan.vertex);
            // The own face lies between the neighbours 0 and 1, whose directions turn by 120 degrees from corner to corner.
            let [first, last] = match fan.closed {
                true => [0, 5],
                false => [-(fan.index as isize), (fan.faces() - fan.index) as isize],
            };
            for k in first..=last {
                let [i, j] = NEIGHBOURS[(k + 2 * corner as isize).rem_euclid(6) as usize];
                if let Some(vertex) = fan.spoke(k) {
                    net[slot([at[0] + i, at[1] + j])] = global(vertex);
                }
            }
        }
        let first = self.out.vertices.len() as u32;
        if kind == PatchKind::Regular {
            self.out.vertices.extend(NET.map(|place| net[slot(place)]));
            return Support { first, kind: SupportKind::Net };
        }
        let fan = &self.fans[rotation];
        let class = RingClass { triangles: true, ..RingClass::new(fan) };
        let outer = class.outer().into_iter().map(|(i, j)| net[slot([i, j])]);
        let ring = [fan.vertex].into_iter().chain(fan.spokes().iter().copied());
        let Some(number) = fan.large() else {
            self.out.vertices.extend(ring.map(global).chain(outer));
            return Support { first, kind: SupportKind::Class(self.out.class_index(&mut self.class_indices, class)) };
        };
        let next = self.out.rings.len() as u32;
        let list = *self.rings.entry(number).or_insert(next);
        if list == next {
            self.out.push_ring(ring.map(global));
        }
        let first = self.out.vertices.len() as u32;
        self.out.vertices.extend(outer);
        let class_index = self.out.class_index(&mut self.class_indices, class.of_all_faces());
        let wedge = Wedge { class: class_index, ring: list, face: class.index };
        self.out.push_wedge(first, wedge)
    }

    fn mark_transitions(&mut self) {
        for (patch, &(level, face)) in self.out.patches.iter_mut().zip(&self.places) {
            let topology = &self.levels[level];
            for (edge, offset) in topology.corners(face).enumerate() {
                let faces = topology.edge_faces[topology.face_edges[offset] as usize];
                let neighbour = if faces[0] == face as i32 { faces[1] } else { faces[0] };
                let split = usize::try_from(neighbour).is_ok_and(|f| self.states[level][f] == State::Split);
                patch.transition |= u8::from(split) << ((edge + 3 - patch.rotation as usize) % 3);
            }
        }
    }
}

/// Places of the lattice along each axis, from -1 to 2.
const SLOTS: usize = 4;

/// Index of a place of the lattice.
fn slot([i, j]: [isize; 2]) -> usize {
    SLOTS * (j + 1) as usize + (i + 1) as usize
}

/// The rules round the vertex are those of the box spline with phantom points.
fn is_regular(fan: &Fan) -> bool {
    match fan.rule {
        Some(Rule::Smooth) => fan.closed && fan.faces() == 6,
        Some(Rule::Crease) => !fan.closed && fan.faces() == 3,
        Some(Rule::Corner) => !fan.closed && fan.faces() == 1,
        _ => false,
    }
}
