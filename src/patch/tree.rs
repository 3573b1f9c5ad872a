//! Finds the patches: walks the refined levels and stops at the first face whose limit is known in closed form.

use super::adjacency::PtexEdges;
use super::fan::{Fan, LargeFans};
use super::piece::Piece;
use super::strips;
use super::{Node, Patch, PatchError, PatchKind, Patches, RingClass, Shape, Strips, Support, SupportKind, Tip, Wedge};
use crate::osd::{INFINITE_SHARPNESS, Level, Refiner, Rule};
use std::collections::HashMap;

/// No vertex: a phantom point beyond a boundary or an infinitely sharp edge.
pub const PHANTOM: u32 = u32::MAX;

/// What became of a face of a level.
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
    /// Level and face of each patch, and which of its local edges lie on the face's own (a bit each).
    places: Vec<(usize, usize, u8)>,
    class_indices: HashMap<RingClass, u32>,
    /// First row weights of a sharpness.
    row_indices: HashMap<u32, u32>,
    fans: [Fan; 4],
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
}

impl Cell {
    fn child(self, corner: usize) -> Self {
        let [du, dv] = [[0, 0], [1, 0], [1, 1], [0, 1]][corner];
        Self { depth: self.depth + 1, origin: [2 * self.origin[0] + du, 2 * self.origin[1] + dv], ..self }
    }
}

/// The patches of a piece's own faces. Ptex faces are numbered as in the whole mesh, refined vertices and lines as in the piece.
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
        row_indices: HashMap::new(),
        fans: Default::default(),
        large: LargeFans::default(),
        rings: HashMap::new(),
        out: Patches::default(),
        levels,
    };
    let mut ptex = piece.first_ptex;
    for face in piece.core.clone() {
        walk.root(face, &mut ptex)?;
    }
    walk.visit_beside(piece)?;
    walk.mark_transitions();
    walk.out.ptex_edges = PtexEdges::new(&walk.levels[0], piece, false);
    Ok(walk.out)
}

impl Walk {
    /// A control face, whose first ptex face is `ptex`; then that is the next one's.
    fn root(&mut self, face: usize, ptex: &mut u32) -> Result<(), PatchError> {
        let size = self.levels[0].corners(face).len();
        let mut cell = || Cell { ptex: std::mem::replace(ptex, *ptex + 1), depth: 0, origin: [0, 0] };
        if size == 4 {
            let node = self.visit(0, face, cell())?;
            self.out.roots.push(node);
            return Ok(());
        }
        self.states[0][face] = State::Split;
        for corner in 0..size {
            let cell = cell();
            let node = match self.levels[0].face_holes[face] {
                0 => {
                    let child = self.child(0, face, corner, 0)?;
                    self.visit(1, child, cell)?
                }
                _ => Node::Hole,
            };
            self.out.roots.push(node);
        }
        Ok(())
    }

    /// Visits the faces across an edge from the piece's own: whether they are split is all that is wanted of them.
    fn visit_beside(&mut self, piece: &Piece<'_>) -> Result<(), PatchError> {
        let own = (std::mem::take(&mut self.out), std::mem::take(&mut self.places));
        // Numbers of classes and rows that come up here are not used: nothing follows.
        piece.beside(&self.levels[0]).into_iter().try_for_each(|face| self.root(face, &mut 0))?;
        (self.out, self.places) = own;
        Ok(())
    }

    /// The child of a face at a corner, which must show that corner at place `expected`.
    fn child(&self, level: usize, face: usize, corner: usize, expected: usize) -> Result<usize, PatchError> {
        let topology = &self.levels[level];
        let offset = topology.corners(face).start + corner;
        let child =
            usize::try_from(topology.face_children[offset]).map_err(|_| PatchError::NotRefined { level, face })?;
        let next = &self.levels[level + 1];
        let vertex = next.face_vertices[next.corners(child).start + expected];
        if vertex != topology.vertex_children[topology.face_vertices[offset] as usize] {
            return Err(PatchError::ChildOrder { level, face });
        }
        Ok(child)
    }

    fn visit(&mut self, level: usize, face: usize, cell: Cell) -> Result<Node, PatchError> {
        if self.levels[level].face_holes[face] != 0 {
            return Ok(Node::Hole);
        }
        let leaf = self.leaf(level, face, cell);
        if let Some(strips) = self.strips(level, face, cell) {
            return Ok(strips);
        }
        if let Some(patch) = leaf {
            self.states[level][face] = State::Leaf;
            self.places.push((level, face, 0b1111));
            self.out.patches.push(patch);
            return Ok(Node::Leaf(self.out.patches.len() as u32 - 1));
        }
        self.states[level][face] = State::Split;
        let mut children = [Node::Hole; 4];
        for (corner, node) in children.iter_mut().enumerate() {
            let child = self.child(level, face, corner, corner)?;
            *node = self.visit(level + 1, child, cell.child(corner))?;
        }
        self.out.splits.push(children);
        Ok(Node::Split(self.out.splits.len() as u32 - 1))
    }

    /// The patch of a face, if its limit has a closed form at this level.
    fn leaf(&mut self, level: usize, face: usize, cell: Cell) -> Option<Patch> {
        let topology = &self.levels[level];
        let corners = topology.corners(face);
        if corners.clone().any(|i| self.restless[level][topology.face_vertices[i] as usize]) {
            return None;
        }
        for (corner, fan) in self.fans.iter_mut().enumerate() {
            fan.gather(&self.levels, level, face, corner, &mut self.large);
        }
        let irregular: Vec<usize> = (0..4).filter(|&i| !self.fans[i].is_regular()).collect();
        let (kind, rotation) = match irregular[..] {
            [] => (PatchKind::Regular, 0),
            [corner] if self.stands_alone(corner) => (kind_of(&self.fans[corner])?, corner),
            _ => return None,
        };
        let support = self.support(level, kind, rotation);
        self.out.supports.push(support);
        Some(Patch {
            ptex: cell.ptex,
            shape: Shape::Square,
            depth: [cell.depth; 2],
            quadrant: level > usize::from(cell.depth),
            origin: cell.origin,
            rotation: rotation as u8,
            kind,
            transition: 0,
        })
    }

    /// The strips of a face whose only feature is one semi-sharp crease edge, constant beyond both its ends.
    fn strips(&mut self, level: usize, face: usize, cell: Cell) -> Option<Node> {
        let topology = &self.levels[level];
        let corners = topology.corners(face);
        let sharpness = |edge: usize| topology.edge_sharpness[topology.face_edges[corners.start + edge] as usize];
        let sharp: Vec<usize> = (0..corners.len()).filter(|&edge| sharpness(edge) > 0.0).collect();
        let &[edge] = &sharp[..] else { return None };
        let crease = sharpness(edge);
        let vertex = |corner: usize| topology.face_vertices[corners.start + (edge + corner) % 4] as usize;
        let restless = |corner: usize| self.restless[level][vertex(corner)];
        if corners.len() != 4 || crease >= INFINITE_SHARPNESS || restless(2) || restless(3) {
            return None;
        }
        if [0, 1].into_iter().any(|corner| topology.vertex_sharpness[vertex(corner)] > 0.0) {
            return None;
        }
        for (corner, fan) in self.fans.iter_mut().enumerate() {
            fan.gather(&self.levels, level, face, corner, &mut self.large);
        }
        let fan = |corner: usize| &self.fans[(edge + corner) % 4];
        let smooth = |corner: usize| fan(corner).is_regular() && fan(corner).rule == Some(Rule::Smooth);
        if !(fan(0).continues_crease(0) && fan(1).continues_crease(1) && smooth(2) && smooth(3)) {
            return None;
        }
        self.states[level][face] = State::Leaf;
        Some(self.push_strips(level, face, cell, edge, crease))
    }

    fn push_strips(&mut self, level: usize, face: usize, cell: Cell, edge: usize, crease: f32) -> Node {
        let support = self.support(level, PatchKind::Regular, edge);
        let first_patch = self.out.patches.len() as u32;
        let first_rows = *self.row_indices.entry(crease.to_bits()).or_insert_with(|| {
            self.out.row_weights.extend(strips::stack(crease));
            (self.out.row_weights.len() - crease.ceil() as usize - 1) as u32
        });
        let count = crease.ceil() as u8 + 1;
        for strip in 0..count {
            let last = strip + 1 == count;
            let finer = if last { strip } else { strip + 1 };
            // Local v runs across the crease: along the cell's v or u, in its direction or against it.
            let (axis, against) = [(1, false), (0, true), (1, true), (0, false)][edge];
            let index = u16::from(!last);
            let index = if against { (1 << finer) - 1 - index } else { index };
            let (mut depth, mut origin) = ([cell.depth; 2], cell.origin);
            depth[axis] += finer;
            origin[axis] = (origin[axis] << finer) + index;
            self.places.push((level, face, u8::from(strip == 0) << 2 | u8::from(last)));
            self.out.supports.push(Support { kind: SupportKind::Strip(first_rows + u32::from(strip)), ..support });
            self.out.patches.push(Patch {
                ptex: cell.ptex,
                shape: Shape::Square,
                depth,
                quadrant: level > usize::from(cell.depth),
                origin,
                rotation: edge as u8,
                kind: PatchKind::Regular,
                transition: 0,
            });
        }
        self.out.strips.push(Strips { first: first_patch, count, rotation: edge as u8 });
        Node::Strips(self.out.strips.len() as u32 - 1)
    }

    /// Whether the other three corners carry no feature except the spokes of the extraordinary vertex, so that the
    /// class says everything (docs/LIMIT.md, section 2.2).
    fn stands_alone(&self, corner: usize) -> bool {
        let [ev, next, far, before] = std::array::from_fn(|i| &self.fans[(corner + i) % 4]);
        // `next` sees the spoke as the edge that comes in: its sector ends there, so the own face is the last one.
        let along_first = match next.rule {
            Some(Rule::Smooth) => true,
            Some(Rule::Crease) => next.index == 1,
            _ => false,
        };
        let along_second = match before.rule {
            Some(Rule::Smooth) => true,
            Some(Rule::Crease) => before.index == 0,
            _ => false,
        };
        ev.has_only_quads() && far.rule == Some(Rule::Smooth) && along_first && along_second
    }

    fn support(&mut self, level: usize, kind: PatchKind, rotation: usize) -> Support {
        let base = self.first_vertex[level];
        let global = |vertex: usize| (base + vertex) as u32;
        let mut grid = [PHANTOM; 16];
        for corner in 0..4 {
            let fan = &self.fans[(rotation + corner) % 4];
            if corner > 0 || kind == PatchKind::Regular {
                place(&mut grid, fan, corner, global);
            }
        }
        let first = self.out.vertices.len() as u32;
        if kind == PatchKind::Regular {
            self.out.vertices.extend(grid);
            return Support { first, kind: SupportKind::Net };
        }
        let fan = &self.fans[rotation];
        let class = RingClass::new(fan);
        let outer = class.outer().into_iter().map(|(i, j)| grid[slot(i, j)]);
        let ring = [fan.vertex].into_iter().chain(fan.spokes().iter().copied()).chain(fan.opposites().iter().copied());
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
        for (patch, &(level, face, edges)) in self.out.patches.iter_mut().zip(&self.places) {
            let topology = &self.levels[level];
            for (edge, offset) in topology.corners(face).enumerate() {
                let faces = topology.edge_faces[topology.face_edges[offset] as usize];
                let neighbour = if faces[0] == face as i32 { faces[1] } else { faces[0] };
                let split = usize::try_from(neighbour).is_ok_and(|f| self.states[level][f] == State::Split);
                let local = (edge + 4 - patch.rotation as usize) % 4;
                patch.transition |= (u8::from(split) << local) & edges;
            }
        }
    }
}

/// Index of the grid point (i,j), i and j in -1..=2, in a 4x4 net.
pub(crate) fn slot(i: isize, j: isize) -> usize {
    (4 * (j + 1) + i + 1) as usize
}

/// Places what a regular corner's fan knows into the 4x4 net of the face.
fn place(grid: &mut [u32; 16], fan: &Fan, corner: usize, global: impl Fn(usize) -> u32) {
    // Position of the corner, and the directions to the next and the previous one.
    let (at, u, v) =
        [([0, 0], [1, 0], [0, 1]), ([1, 0], [0, 1], [-1, 0]), ([1, 1], [-1, 0], [0, -1]), ([0, 1], [0, -1], [1, 0])]
            [corner];
    let mut put = |i: isize, j: isize, vertex: Option<usize>| {
        if let Some(vertex) = vertex {
            grid[slot(at[0] + i * u[0] + j * v[0], at[1] + i * u[1] + j * v[1])] = global(vertex);
        }
    };
    put(0, 0, Some(fan.vertex));
    put(1, 0, fan.spoke(0));
    put(1, 1, fan.opposite(0));
    put(0, 1, fan.spoke(1));
    put(-1, 0, fan.spoke(2));
    put(-1, 1, fan.opposite(1));
    put(0, -1, fan.spoke(-1));
    put(1, -1, fan.opposite(-1));
    if fan.closed {
        put(-1, -1, fan.opposite(2));
    }
}

pub(super) fn kind_of(fan: &Fan) -> Option<PatchKind> {
    match (fan.rule?, fan.closed) {
        (Rule::Smooth, true) => Some(PatchKind::Smooth),
        (Rule::Dart, true) => Some(PatchKind::Dart),
        (Rule::Crease, false) => Some(PatchKind::Crease),
        (Rule::Corner, _) => Some(PatchKind::Corner),
        _ => None,
    }
}

impl RingClass {
    pub(super) fn new(fan: &Fan) -> Self {
        let tip = match fan.rule {
            Some(Rule::Crease) => Tip::Crease,
            Some(Rule::Corner) => Tip::Corner,
            _ => Tip::Smooth,
        };
        let dart = fan.closed.then(|| fan.sharpness().iter().position(|&s| s >= INFINITE_SHARPNESS)).flatten();
        Self {
            triangles: false,
            faces: fan.faces() as u16,
            closed: fan.closed,
            index: fan.index as u16,
            tip,
            sharp_spoke: dart.map(|i| i as u16),
        }
    }
}
