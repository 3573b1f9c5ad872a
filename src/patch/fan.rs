//! The faces round a vertex, as far as they influence one of them.

use crate::osd::{INFINITE_SHARPNESS, Level, NO_TWIN, Rule};

/// Faces, spokes and opposite corners round a vertex, counter-clockwise.
///
/// A closed fan goes all the way round a smooth vertex or a dart; an open one is the sector between two edges that
/// stop all influence: infinitely sharp, boundary or not manifold. Face i lies between the spokes i and i+1 (in a
/// closed fan the last face ends at spoke 0).
#[derive(Debug, Clone, Default)]
pub(super) struct Fan {
    /// The vertex at the centre.
    pub vertex: usize,
    /// Its rule.
    pub rule: Option<Rule>,
    /// Goes all the way round.
    pub closed: bool,
    /// Vertex at the far end of each spoke.
    pub spokes: Vec<usize>,
    /// Sharpness of each spoke; infinite at the ends of an open fan.
    pub sharpness: Vec<f32>,
    /// Opposite corner of each face.
    pub opposites: Vec<usize>,
    /// The face that the fan was made for.
    pub index: usize,
    /// All faces are quads.
    pub quads: bool,
}

/// The same vertex in the next face counter-clockwise (across the incoming edge of the corner) or clockwise (across the outgoing
/// edge); `None` where the edge stops influence.
fn turn(level: &Level, corner: usize, counter_clockwise: bool, through_sharp: bool) -> Option<usize> {
    let across = if counter_clockwise { level.previous(corner) } else { corner };
    if !through_sharp && level.edge_sharpness[level.face_edges[across] as usize] >= INFINITE_SHARPNESS {
        return None;
    }
    match level.twins[across] {
        NO_TWIN => None,
        twin if counter_clockwise => Some(twin as usize),
        twin => Some(level.next(twin as usize)),
    }
}

impl Fan {
    /// The fan round corner `corner` (0-based, within the face) for `face`.
    pub fn gather(&mut self, level: &Level, face: usize, corner: usize) {
        let own = level.corners(face).start + corner;
        let vertex = level.face_vertices[own] as usize;
        let rule = level.vertex_rules[vertex];
        let through_sharp = rule == Rule::Dart;
        *self = Self {
            vertex,
            rule: Some(rule),
            spokes: std::mem::take(&mut self.spokes),
            sharpness: std::mem::take(&mut self.sharpness),
            opposites: std::mem::take(&mut self.opposites),
            quads: true,
            ..Self::default()
        };
        self.spokes.clear();
        self.sharpness.clear();
        self.opposites.clear();

        self.closed = self.walk(level, own, through_sharp);
        if self.closed {
            return;
        }
        let mut first = own;
        while let Some(next) = turn(level, first, false, through_sharp) {
            first = next;
            self.index += 1;
        }
        if self.index > 0 {
            self.spokes.clear();
            self.sharpness.clear();
            self.opposites.clear();
            self.walk(level, first, through_sharp);
        }
        self.sharpness[0] = INFINITE_SHARPNESS;
    }

    /// Collects the faces counter-clockwise from the one of this corner on; whether they go all the way round.
    fn walk(&mut self, level: &Level, first: usize, through_sharp: bool) -> bool {
        let mut at = first;
        loop {
            let next = level.next(at);
            self.spokes.push(level.face_vertices[next] as usize);
            self.sharpness.push(level.edge_sharpness[level.face_edges[at] as usize]);
            self.opposites.push(level.face_vertices[level.next(next)] as usize);
            self.quads &= level.is_quad(at);
            match turn(level, at, true, through_sharp) {
                Some(next) if next == first => return true,
                Some(next) => at = next,
                None => {
                    self.spokes.push(level.face_vertices[level.previous(at)] as usize);
                    self.sharpness.push(INFINITE_SHARPNESS);
                    return false;
                }
            }
        }
    }

    /// Number of faces.
    pub fn faces(&self) -> usize {
        self.opposites.len()
    }

    /// The rules round the vertex are those of a uniform bicubic B-spline with phantom points.
    pub fn is_regular(&self) -> bool {
        self.quads
            && match self.rule {
                Some(Rule::Smooth) => self.closed && self.faces() == 4,
                Some(Rule::Crease) => !self.closed && self.faces() == 2,
                Some(Rule::Corner) => !self.closed && self.faces() == 1,
                _ => false,
            }
    }

    /// The fan of a vertex in the middle of a regular crease of constant sharpness: the own face's edge `along` (0: its
    /// first spoke, 1: its second) and the spoke opposite to it, and no other feature.
    pub fn continues_crease(&self, along: usize) -> bool {
        let expected = |spoke: usize| if spoke % 2 == along { self.sharpness[along] } else { 0.0 };
        self.quads
            && self.closed
            && self.faces() == 4
            && self.rule == Some(Rule::Crease)
            && (0..4).all(|spoke| self.sharpness[spoke] == expected(spoke))
    }

    /// Spoke `offset` places counter-clockwise of the own face's first one; `None` beyond an open end.
    pub fn spoke(&self, offset: isize) -> Option<usize> {
        self.slot(offset, self.spokes.len()).map(|i| self.spokes[i])
    }

    /// Opposite corner of the face `offset` places counter-clockwise of the own one; `None` beyond an open end.
    pub fn opposite(&self, offset: isize) -> Option<usize> {
        self.slot(offset, self.opposites.len()).map(|i| self.opposites[i])
    }

    fn slot(&self, offset: isize, count: usize) -> Option<usize> {
        let i = self.index as isize + offset;
        if self.closed {
            return Some(i.rem_euclid(count as isize) as usize);
        }
        (0..count as isize).contains(&i).then_some(i as usize)
    }
}
