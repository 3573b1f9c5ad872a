//! Lights that end: what of a curve lies within their extent along the lines.

use crate::curves::{Curve, Place};
use crate::field::{Camera, Field};
use crate::patch::Adjacency;
use crate::stam::LimitSurface;
use glam::{DVec2, DVec3};

/// Looks between two neighbouring points of a curve: where a surface is flat they are far apart.
const LOOKS: u32 = 8;
/// Halvings of a piece between two looks, to the last digits.
const HALVINGS: u32 = 60;

struct Cutter<'a> {
    surface: &'a LimitSurface,
    adjacency: Adjacency,
    field: &'a Field,
    camera: &'a Camera,
}

/// A point of a curve between two of its points.
#[derive(Clone, Copy)]
struct Node {
    place: Place,
    position: DVec3,
    is_within: bool,
}

/// The parts of curves whose second coordinate is within the light's half length. Cuts are points of the contour.
pub(super) fn within(surface: &LimitSurface, field: &Field, camera: &Camera, curves: Vec<Curve>) -> Vec<Curve> {
    let cutter = Cutter { surface, adjacency: surface.adjacency(), field, camera };
    curves.into_iter().flat_map(|curve| cutter.cut(curve)).collect()
}

impl Cutter<'_> {
    fn field_at(&self, place: Place) -> Option<DVec2> {
        let (patch, local) = self.surface.locate(place.face, [place.u, place.v])?;
        self.field.at(self.surface, self.camera, patch, local)
    }

    fn is_within(&self, place: Place) -> bool {
        self.field_at(place).is_some_and(|value| value.y.abs() <= self.field.light.half[1])
    }

    fn cut(&self, curve: Curve) -> Vec<Curve> {
        let count = curve.points.len();
        let empty = || Curve { closed: false, points: Vec::new(), places: Vec::new(), ..curve };
        let mut parts = vec![empty()];
        let push = |parts: &mut Vec<Curve>, place: Place, position: DVec3| {
            if let Some(part) = parts.last_mut() {
                part.points.push(position);
                part.places.push(place);
            }
        };
        let node = |i: usize| {
            let place = curve.places[i];
            Node { place, position: curve.points[i], is_within: self.is_within(place) }
        };
        let first = node(0);
        let mut before = first;
        if first.is_within {
            push(&mut parts, first.place, first.position);
        }
        let pieces = if curve.closed { count } else { count - 1 };
        let mut is_cut = !first.is_within;
        for i in 1..=pieces {
            let end = node(i % count);
            let mut was_within = before.is_within;
            for node in self.cut_chord(curve.value, before, end) {
                is_cut = true;
                if node.is_within && !was_within {
                    // It comes in here.
                    parts.push(empty());
                }
                if node.is_within || was_within {
                    push(&mut parts, node.place, node.position);
                }
                was_within = node.is_within;
            }
            if end.is_within {
                push(&mut parts, end.place, end.position);
            }
            before = end;
        }
        if !is_cut {
            return vec![curve];
        }
        parts.retain(|part| part.points.len() > 1);
        if curve.closed && first.is_within && parts.len() > 1 {
            // The last part ends where the first one begins.
            let head = parts.remove(0);
            if let Some(tail) = parts.last_mut() {
                tail.points.extend(&head.points[1..]);
                tail.places.extend(&head.places[1..]);
            }
        }
        parts.into_iter().map(Curve::without_repeats).filter(|part| part.points.len() > 1).collect()
    }

    /// Points between two if the light ends there: those where it does, of which `is_within` says whether what follows is within, and the
    /// others that were looked at. A part of a chord is another chord, which may be farther from the contour than the tolerance; between
    /// these they are an eighth as long.
    fn cut_chord(&self, value: f64, from: Node, to: Node) -> Vec<Node> {
        let Some([a, b]) = self.on_one_face(from.place, to.place) else {
            // No face has both, which no tracer leaves us: the cut is as near as the chord is.
            let half = Node { position: 0.5 * (from.position + to.position), ..to };
            return if from.is_within == to.is_within { Vec::new() } else { vec![half] };
        };
        let at = |t: f64| match t {
            0.0 => from,
            1.0 => to,
            t => self.between(value, a, b, t),
        };
        let (mut found, mut is_cut) = (Vec::new(), false);
        let mut start = from;
        for k in 1..=LOOKS {
            let [mut low, mut high] = [k - 1, k].map(|k| f64::from(k) / f64::from(LOOKS));
            let end = at(high);
            if start.is_within != end.is_within {
                let mut last = end;
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    let node = at(middle);
                    if node.is_within == end.is_within {
                        (high, last) = (middle, node);
                    } else {
                        low = middle;
                    }
                }
                found.push(last);
                is_cut = true;
            }
            if k < LOOKS && end.position.is_finite() {
                found.push(end);
            }
            start = end;
        }
        if is_cut { found } else { Vec::new() }
    }

    /// The point of the contour across the place at `t` between two places of one face.
    fn between(&self, value: f64, a: Place, b: Place, t: f64) -> Node {
        let [from, to] = [a, b].map(|place| DVec2::new(place.u, place.v));
        let (along, start) = (to - from, from.lerp(to, t));
        let place = |aside: f64| {
            let at = (start + along.perp() * aside).clamp(DVec2::ZERO, DVec2::ONE);
            Place { face: a.face, u: at.x, v: at.y }
        };
        let error = |aside: f64| self.field_at(place(aside)).map(|found| found.x - value);
        // The secant method: the chord is near the contour.
        let (mut x, mut y) = (0.0, 1e-3);
        let (mut fx, mut fy) = (error(x), error(y));
        for _ in 0..30 {
            let (Some(ex), Some(ey)) = (fx, fy) else { break };
            let next = y - ey * (y - x) / (ey - ex);
            if !next.is_finite() || next.abs() > 1.0 || next == y {
                break;
            }
            (x, fx) = (y, fy);
            (y, fy) = (next, error(next));
        }
        let best = if fx.unwrap_or(f64::INFINITY).abs() < fy.unwrap_or(f64::INFINITY).abs() { x } else { y };
        let place = place(best);
        let position = self.surface.evaluate_ptex(place.face, [place.u, place.v]);
        let position = position.map_or(DVec3::NAN, |(_, jet)| jet.position);
        Node { place, position, is_within: self.is_within(place) }
    }

    /// Two neighbouring places as places of one ptex face: one of them may be on the edge to the other's.
    fn on_one_face(&self, a: Place, b: Place) -> Option<[Place; 2]> {
        if a.face == b.face {
            return Some([a, b]);
        }
        let carried = |place: Place, face: u32| {
            let (patch, [u, v]) = self.surface.locate(place.face, [place.u, place.v])?;
            let edges = [(v == 0.0, u), (u == 1.0, v), (v == 1.0, 1.0 - u), (u == 0.0, 1.0 - v)];
            (0..4u8).zip(edges).filter(|(_, (is_on, _))| *is_on).find_map(|(edge, (_, t))| {
                let neighbour = self.adjacency.at(patch, edge, t)?;
                let other = &self.surface.patches()[neighbour.patch as usize];
                let [u, v] = other.to_ptex(neighbour.carry(edge, [u, v]));
                (other.ptex == face).then_some(Place { face, u, v })
            })
        };
        carried(a, b.face).map(|a| [a, b]).or_else(|| carried(b, a.face).map(|b| [a, b]))
    }
}
