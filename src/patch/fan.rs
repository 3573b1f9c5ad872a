//! The faces round a vertex, as far as they influence one of them.

use super::LARGE_FAN;
use crate::osd::{INFINITE_SHARPNESS, Level, NO_TWIN, Rule};
use std::collections::HashMap;
use std::rc::Rc;

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
    /// The face that the fan was made for.
    pub index: usize,
    /// Where the fan is large, what all its faces share: number and spokes. It takes the place of `own`.
    shared: Option<(u32, Rc<Spokes>)>,
    own: Spokes,
}

/// What lies round the vertex of a fan.
#[derive(Debug, Clone, Default)]
struct Spokes {
    /// Vertex at the far end of each spoke.
    ends: Vec<usize>,
    /// Sharpness of each spoke; infinite at the ends of an open fan.
    sharpness: Vec<f32>,
    /// Opposite corner of each face.
    opposites: Vec<usize>,
    /// All faces are quads.
    quads: bool,
}

impl Spokes {
    fn clear(&mut self) {
        self.ends.clear();
        self.sharpness.clear();
        self.opposites.clear();
        self.quads = true;
    }
}

/// The fans of more than [`LARGE_FAN`] faces that a walk has met. Each is gathered once for all its faces, for otherwise the
/// walk would take time with the square of their number.
#[derive(Debug, Default)]
pub(super) struct LargeFans {
    /// For each level: vertices that have such a fan. Empty where no vertex of the level has.
    vertices: Vec<Vec<bool>>,
    /// Number of the fan, and which face of it, by level and corner.
    corners: HashMap<(usize, usize), (u32, u32)>,
    fans: Vec<Fan>,
}

impl LargeFans {
    fn find(&self, level: usize, vertex: usize, corner: usize) -> Option<Fan> {
        if !*self.vertices.get(level)?.get(vertex)? {
            return None;
        }
        let &(fan, index) = self.corners.get(&(level, corner))?;
        Some(Fan { index: index as usize, ..self.fans[fan as usize].clone() })
    }

    /// Keeps the fan of a corner. A closed one is turned to begin at its sharp spoke if it has one (a dart), else at the
    /// first of its corners in the level: wherever the walk comes from, the order is the same.
    fn keep(&mut self, levels: &[Level], level: usize, own: usize, fan: &mut Fan) {
        let (topology, through_sharp) = (&levels[level], fan.rule == Some(Rule::Dart));
        let mut corners = Vec::with_capacity(fan.faces());
        let mut at = Some(own);
        if !fan.closed {
            (0..fan.index).for_each(|_| at = at.and_then(|at| turn(topology, at, false, through_sharp)));
        }
        while let Some(corner) = at.filter(|_| corners.len() < fan.faces()) {
            corners.push(corner);
            at = turn(topology, corner, true, through_sharp);
        }
        if fan.closed {
            let sharp = fan.own.sharpness.iter().position(|&s| s >= INFINITE_SHARPNESS);
            let lowest = (0..corners.len()).min_by_key(|&i| corners[i]).unwrap_or(0);
            let first = sharp.unwrap_or(lowest);
            corners.rotate_left(first);
            fan.own.ends.rotate_left(first);
            fan.own.sharpness.rotate_left(first);
            fan.own.opposites.rotate_left(first);
            fan.index = (fan.faces() - first) % fan.faces();
        }
        let number = self.fans.len() as u32;
        self.corners.extend(corners.iter().enumerate().map(|(i, &corner)| ((level, corner), (number, i as u32))));
        self.vertices.resize(levels.len().max(self.vertices.len()), Vec::new());
        self.vertices[level].resize(topology.vertex_count(), false);
        self.vertices[level][fan.vertex] = true;
        fan.shared = Some((number, Rc::new(std::mem::take(&mut fan.own))));
        self.fans.push(fan.clone());
    }
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
    /// The fan round corner `corner` (0-based, within the face) of a level, for `face`.
    pub fn gather(&mut self, levels: &[Level], level: usize, face: usize, corner: usize, large: &mut LargeFans) {
        let topology = &levels[level];
        let own = topology.corners(face).start + corner;
        let vertex = topology.face_vertices[own] as usize;
        if let Some(known) = large.find(level, vertex, own) {
            let own = std::mem::take(&mut self.own);
            *self = Self { own, ..known };
            return;
        }
        let rule = topology.vertex_rules[vertex];
        *self = Self { vertex, rule: Some(rule), own: std::mem::take(&mut self.own), ..Self::default() };
        self.gather_spokes(topology, own, rule == Rule::Dart);
        if self.faces() > LARGE_FAN {
            large.keep(levels, level, own, self);
        }
    }

    fn gather_spokes(&mut self, level: &Level, own: usize, through_sharp: bool) {
        self.own.clear();
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
            self.own.clear();
            self.walk(level, first, through_sharp);
        }
        self.own.sharpness[0] = INFINITE_SHARPNESS;
    }

    /// Collects the faces counter-clockwise from the one of this corner on; whether they go all the way round.
    fn walk(&mut self, level: &Level, first: usize, through_sharp: bool) -> bool {
        let mut at = first;
        loop {
            let next = level.next(at);
            self.own.ends.push(level.face_vertices[next] as usize);
            self.own.sharpness.push(level.edge_sharpness[level.face_edges[at] as usize]);
            self.own.opposites.push(level.face_vertices[level.next(next)] as usize);
            self.own.quads &= level.is_quad(at);
            match turn(level, at, true, through_sharp) {
                Some(next) if next == first => return true,
                Some(next) => at = next,
                None => {
                    self.own.ends.push(level.face_vertices[level.previous(at)] as usize);
                    self.own.sharpness.push(INFINITE_SHARPNESS);
                    return false;
                }
            }
        }
    }

    fn round(&self) -> &Spokes {
        self.shared.as_ref().map_or(&self.own, |(_, spokes)| spokes)
    }

    /// Vertex at the far end of each spoke.
    pub fn spokes(&self) -> &[usize] {
        &self.round().ends
    }

    /// Sharpness of each spoke; infinite at the ends of an open fan.
    pub fn sharpness(&self) -> &[f32] {
        &self.round().sharpness
    }

    /// Opposite corner of each face.
    pub fn opposites(&self) -> &[usize] {
        &self.round().opposites
    }

    /// Whether all faces are quads.
    pub fn has_only_quads(&self) -> bool {
        self.round().quads
    }

    /// Number of a large fan among those of the walk.
    pub fn large(&self) -> Option<u32> {
        self.shared.as_ref().map(|&(number, _)| number)
    }

    /// Number of faces.
    pub fn faces(&self) -> usize {
        self.opposites().len()
    }

    /// The rules round the vertex are those of a uniform bicubic B-spline with phantom points.
    pub fn is_regular(&self) -> bool {
        self.has_only_quads()
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
        let expected = |spoke: usize| if spoke % 2 == along { self.sharpness()[along] } else { 0.0 };
        self.has_only_quads()
            && self.closed
            && self.faces() == 4
            && self.rule == Some(Rule::Crease)
            && (0..4).all(|spoke| self.sharpness()[spoke] == expected(spoke))
    }

    /// Spoke `offset` places counter-clockwise of the own face's first one; `None` beyond an open end.
    pub fn spoke(&self, offset: isize) -> Option<usize> {
        self.slot(offset, self.spokes().len()).map(|i| self.spokes()[i])
    }

    /// Opposite corner of the face `offset` places counter-clockwise of the own one; `None` beyond an open end.
    pub fn opposite(&self, offset: isize) -> Option<usize> {
        self.slot(offset, self.opposites().len()).map(|i| self.opposites()[i])
    }

    fn slot(&self, offset: isize, count: usize) -> Option<usize> {
        let i = self.index as isize + offset;
        if self.closed {
            return Some(i.rem_euclid(count as isize) as usize);
        }
        (0..count as isize).contains(&i).then_some(i as usize)
    }
}
