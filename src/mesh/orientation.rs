//! Which faces run against their neighbours.
//!
//! Two faces that share an edge agree where one runs along it and the other back. Faces hang together over the edges that exactly two of
//! them have, holes aside; of such a component, the side with fewer faces is the one that is named. A component all of whose faces
//! agree is right, whichever way its normals point.

use super::SubdivMesh;
use std::fmt;

/// What [`SubdivMesh::orientation`] finds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Orientation {
    /// Faces that run against their neighbours, in ascending order: of each component the smaller side, and of two equal sides the one
    /// without the component's first face.
    pub reversed: Vec<u32>,
    /// First face of each component that has one side only, as a Moebius strip: whichever faces are turned, two neighbours disagree.
    pub one_sided: Vec<u32>,
}

/// Where a face is, for people: `face 1 (line 10)`, `face 3 of /World/Car`, or `face 3`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FacePlace<'a> {
    /// Index of the face; within its part where there is one.
    pub face: u32,
    /// Line of the file on which the face stands, from 1.
    pub line: Option<u32>,
    /// Path of the prim that the face is of.
    pub prim: Option<&'a str>,
}

impl fmt::Display for FacePlace<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "face {}", self.face)?;
        match (self.line, self.prim) {
            (Some(line), _) => write!(f, " (line {line})"),
            (None, Some(prim)) => write!(f, " of {prim}"),
            (None, None) => Ok(()),
        }
    }
}

impl Orientation {
    /// Sentences that say what is wrong and what to do, one a kind; none where all faces agree.
    pub fn sentences(&self, mesh: &SubdivMesh) -> Vec<String> {
        let mut sentences = Vec::new();
        if let Some(&first) = self.reversed.first() {
            let place = mesh.face_place(first);
            sentences.push(match self.reversed.len() {
                1 => format!(
                    "1 face runs against its neighbours, {place}: the surface is cut open along its edges; flip it"
                ),
                count => format!(
                    "{count} faces run against their neighbours, the first is {place}: the surface is cut open along \
                     their edges; flip them"
                ),
            });
        }
        if let Some(&first) = self.one_sided.first() {
            let place = mesh.face_place(first);
            let what = match self.one_sided.len() {
                1 => format!("the faces that hang together with {place} have one side only, as a Moebius strip"),
                count => format!("{count} components have one side only, as a Moebius strip, the first with {place}"),
            };
            sentences.push(format!("{what}: no way to turn them makes all agree; cut the strip across"));
        }
        sentences
    }
}

/// An edge as the face that runs along it sees it.
#[derive(Clone, Copy, Default)]
struct Side {
    /// The vertex of the edge with the higher index; the lower one is the bucket.
    far: u32,
    face: u32,
    /// The face runs from the lower vertex to the higher one.
    upwards: bool,
}

impl SubdivMesh {
    /// Where a face is, for messages.
    pub fn face_place(&self, face: u32) -> FacePlace<'_> {
        let line = self.face_lines.get(face as usize).copied();
        let part = self.parts.iter().find(|part| part.faces.contains(&face));
        FacePlace {
            face: part.map_or(face, |part| face - part.faces.start),
            line,
            prim: part.map(|part| part.name.as_str()),
        }
    }

    /// Which faces run against their neighbours. Holes are no neighbours, nor are faces beyond an edge that three or more have.
    ///
    /// The time is linear in the number of face vertices.
    ///
    /// # Panics
    /// If a face names a vertex that is not there, which [`validate`](Self::validate) refuses.
    pub fn orientation(&self) -> Orientation {
        let (starts, sides) = self.sides();
        let shared = |visit: &mut dyn FnMut(&Side, &Side)| {
            for range in starts.windows(2) {
                let bucket = &sides[range[0] as usize..range[1] as usize];
                for pair in bucket.chunk_by(|a, b| a.far == b.far) {
                    if let [a, b] = pair
                        && a.face != b.face
                    {
                        visit(a, b);
                    }
                }
            }
        };
        let mut is_consistent = true;
        shared(&mut |a, b| is_consistent &= a.upwards != b.upwards);
        if is_consistent {
            return Orientation::default();
        }
        let mut sheets = Sheets::new(self.face_count());
        shared(&mut |a, b| sheets.join(a.face, b.face, a.upwards == b.upwards));
        sheets.orientation(self)
    }

    /// All sides of faces that are no holes, sorted by the two vertices of the edge, and where those of each lower vertex begin.
    fn sides(&self) -> (Vec<u32>, Vec<Side>) {
        let mut is_hole = vec![false; self.face_count()];
        self.holes.iter().for_each(|&hole| is_hole[hole as usize] = true);
        let visible = || self.faces().filter(|(face, _)| !is_hole[*face]);
        let mut starts = vec![0u32; self.points.len() + 1];
        for (_, face) in visible() {
            let mut previous = face[face.len() - 1];
            for &vertex in face {
                starts[previous.min(vertex) as usize + 1] += 1;
                previous = vertex;
            }
        }
        for vertex in 0..self.points.len() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut sides = vec![Side::default(); starts[self.points.len()] as usize];
        for (index, face) in visible() {
            let mut previous = face[face.len() - 1];
            for &vertex in face {
                let place = &mut next[previous.min(vertex) as usize];
                sides[*place as usize] =
                    Side { far: previous.max(vertex), face: index as u32, upwards: previous < vertex };
                *place += 1;
                previous = vertex;
            }
        }
        for range in starts.windows(2) {
            sides[range[0] as usize..range[1] as usize].sort_unstable_by_key(|side| (side.far, side.face));
        }
        (starts, sides)
    }
}

/// Faces that hang together, as trees: each face knows whether it runs with its parent or against it.
struct Sheets {
    parent: Vec<u32>,
    against: Vec<bool>,
    one_sided: Vec<bool>,
}

impl Sheets {
    fn new(faces: usize) -> Sheets {
        Sheets { parent: (0..faces as u32).collect(), against: vec![false; faces], one_sided: vec![false; faces] }
    }

    /// The root of a face, and whether the face runs against it. The path is halved on the way.
    fn root(&mut self, mut face: u32) -> (u32, bool) {
        let mut against = false;
        while self.parent[face as usize] != face {
            let index = face as usize;
            let parent = self.parent[index] as usize;
            let grandparent = self.parent[parent];
            if grandparent as usize != parent {
                self.against[index] ^= self.against[parent];
                self.parent[index] = grandparent;
            }
            against ^= self.against[index];
            face = self.parent[index];
        }
        (face, against)
    }

    /// Two neighbours; `against`: one of them runs against the other.
    fn join(&mut self, a: u32, b: u32, against: bool) {
        let ((root_a, of_a), (root_b, of_b)) = (self.root(a), self.root(b));
        let differs = of_a ^ of_b ^ against;
        if root_a == root_b {
            self.one_sided[root_a as usize] |= differs;
            return;
        }
        // The lower face stays the root, so that roots are the first faces of their components.
        let (root, child) = (root_a.min(root_b), root_a.max(root_b));
        self.parent[child as usize] = root;
        self.against[child as usize] = differs;
        self.one_sided[root as usize] |= self.one_sided[child as usize];
    }

    fn orientation(mut self, mesh: &SubdivMesh) -> Orientation {
        let sides: Vec<(u32, bool)> = (0..mesh.face_count() as u32).map(|face| self.root(face)).collect();
        // Of each root: faces that run with it, and against it.
        let mut counts = vec![[0u32; 2]; sides.len()];
        sides.iter().for_each(|&(root, against)| counts[root as usize][usize::from(against)] += 1);
        let mut orientation = Orientation::default();
        for (face, (root, against)) in (0..).zip(sides) {
            let [with, other] = counts[root as usize];
            if self.one_sided[root as usize] {
                orientation.one_sided.extend((face == root).then_some(face));
            } else if against == (other <= with) {
                orientation.reversed.push(face);
            }
        }
        orientation
    }
}
