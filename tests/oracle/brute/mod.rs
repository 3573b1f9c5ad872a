//! Catmull-Clark limits by brute force: an oracle that shares nothing with OpenSubdiv or with catoptric's tables.
//!
//! # Theory
//! Refine, and keep only the faces round the point that is followed: three rings suffice, because subdivision reaches
//! two rings far and halves distances. After n levels every point i/2^n is a vertex; where it is regular, the masks of the
//! uniform cubic B-spline give its limit and its derivatives exactly, and where not, it is followed until it stands still.
//!
//! # Practice
//! Cages are moved so that the followed vertex is at the origin, level by level: differences keep their relative
//! precision at any depth, as in the normalised tables that they judge.
#![allow(dead_code, reason = "each test program uses its part")]

mod cage;
mod limit;
mod refine;
mod rules;

pub use cage::Cage;
pub use refine::Children;

use catoptric::mesh::SubdivMesh;
use glam::DVec3;

/// Parameters of the corners of a ptex face.
pub const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// A quad of a refined cage, and where it lies in its ptex face.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    pub face: usize,
    pub ptex: u32,
    pub origin: [f64; 2],
    pub size: f64,
}

impl Cell {
    /// Ptex parameters of a corner.
    pub fn parameters(&self, corner: usize) -> [f64; 2] {
        [0, 1].map(|k| self.origin[k] + self.size * CORNERS[corner][k])
    }

    fn child(&self, corner: usize, face: usize) -> Self {
        let size = 0.5 * self.size;
        Self { face, size, origin: [0, 1].map(|k| self.origin[k] + size * CORNERS[corner][k]), ..*self }
    }
}

/// The whole mesh after `levels` refinements, at least one, and its cells.
pub fn refined(mesh: &SubdivMesh, levels: usize) -> (Cage, Vec<Cell>) {
    let mut cage = Cage::new(mesh);
    let Children { cage: first, faces, .. } = cage.refine();
    let (mut cells, mut ptex) = (Vec::new(), 0);
    for children in faces {
        let quad = children.len() == 4;
        for (corner, child) in children.iter().enumerate() {
            let whole = Cell { face: child.expect("complete"), ptex, origin: [0.0; 2], size: 1.0 };
            cells.push(if quad { whole.child(corner, whole.face) } else { whole });
            ptex += u32::from(!quad);
        }
        ptex += u32::from(quad);
    }
    cage = first;
    for _ in 1..levels {
        let Children { cage: next, faces, .. } = cage.refine();
        let split = |cell: &Cell| {
            let children = faces[cell.face].iter().enumerate();
            children.map(|(k, child)| cell.child(k, child.expect("complete"))).collect::<Vec<_>>()
        };
        cells = cells.iter().flat_map(split).collect();
        cage = next;
    }
    (cage, cells)
}

/// The way down to one corner of a ptex face, ever finer.
pub struct Descent {
    pub cage: Cage,
    pub cell: Cell,
    /// The corner's place in the cell; its vertex is vertex 0 of the cage, at the origin.
    pub corner: usize,
    /// Where the cage's origin lies.
    pub offset: DVec3,
}

impl Descent {
    /// At the corner of a cell of a refined cage.
    pub fn new(cage: &Cage, cell: Cell, corner: usize) -> Self {
        let seeds: Vec<usize> = (0..4).map(|k| cage.at(cell.face, corner + k)).collect();
        let offset = cage.points[seeds[0]];
        let (cropped, faces) = cage.crop(&seeds, offset);
        Self { cage: cropped, cell: Cell { face: faces[&cell.face], ..cell }, corner, offset }
    }

    /// One level down.
    pub fn step(&mut self) {
        let Children { cage, faces, .. } = self.cage.refine();
        let face = faces[self.cell.face][self.corner].expect("two rings are complete");
        let before = self.offset;
        *self = Self::new(&cage, self.cell.child(self.corner, face), self.corner);
        self.offset += before;
    }
}
