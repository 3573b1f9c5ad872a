//! Hidden-line removal: which parts of curves a camera sees.

use super::occluder::Occluder;
use super::{Curve, Place};
use crate::field::{Camera, Projection, Ray};
use crate::stam::LimitSurface;
use glam::DVec3;
use rayon::prelude::*;

/// Part of the diagonal in front of a point that does not hide it: the surface that the curve lies on, seen at a grazing angle.
const CLEAR: f64 = 3e-4;
/// Pixels after which a curve is looked at again.
const STEP: f64 = 2.0;
/// Halvings that find where a curve disappears: to less than a thousandth of a pixel.
const HALVINGS: u32 = 12;

/// A place on a curve.
#[derive(Debug, Clone, Copy)]
struct At {
    position: DVec3,
    place: Place,
}

/// The parts of curves on a surface that are in front of everything else of it, as `camera` sees them; closed ones stay so if all of
/// them is seen. The ends of parts are points of the chords: within the tolerance of the curve, like those.
///
/// Surfaces hide what is behind them from both sides; what is nearer behind them than 3e-4 diagonals they do not hide. The picture's
/// borders do not count, but points behind the eye are not seen.
pub fn visible(surface: &LimitSurface, camera: &Camera, curves: &[Curve]) -> Vec<Curve> {
    Look::new(surface, camera).visible(curves)
}

/// A surface as what hides things from a camera.
#[derive(Debug)]
pub struct Look<'a> {
    occluder: Occluder,
    camera: &'a Camera,
    clear: f64,
}

impl<'a> Look<'a> {
    /// Of a camera at a surface.
    pub fn new(surface: &LimitSurface, camera: &'a Camera) -> Look<'a> {
        Look { occluder: Occluder::new(surface), camera, clear: CLEAR * surface.diagonal() }
    }

    /// The parts of curves that are seen: [`visible`].
    pub fn visible(&self, curves: &[Curve]) -> Vec<Curve> {
        curves.par_iter().flat_map_iter(|curve| self.parts(curve)).collect()
    }

    /// Whether a point of the surface is in front of everything else of it: see [`visible`].
    pub fn sees(&self, point: DVec3) -> bool {
        let camera = self.camera;
        let forward = camera.axes().forward;
        if (point - camera.eye).dot(forward) <= 0.0 {
            return false;
        }
        let (direction, reach) = match camera.projection {
            Projection::Perspective { .. } => {
                let to_eye = camera.eye - point;
                (to_eye.normalize_or_zero(), to_eye.length())
            }
            Projection::Orthographic { .. } => (-forward, (point - camera.eye).dot(forward)),
        };
        !self.occluder.is_hit(&Ray { origin: point, direction }, [self.clear, reach])
    }

    /// Pixels of a segment, about.
    fn pixels(&self, from: DVec3, to: DVec3) -> f64 {
        let axes = self.camera.axes();
        let depth = match self.camera.projection {
            Projection::Perspective { .. } => (from - self.camera.eye).dot(axes.forward).max(f64::MIN_POSITIVE),
            Projection::Orthographic { .. } => 1.0,
        };
        from.distance(to) * axes.scale[1] / depth * 0.5 * f64::from(self.camera.size[1])
    }

    fn parts(&self, curve: &Curve) -> Vec<Curve> {
        let count = curve.points.len();
        let at = |k: usize| At { position: curve.points[k % count], place: curve.places[k % count] };
        let segments = if curve.closed { count } else { count - 1 };
        let mut parts: Vec<Vec<At>> = Vec::new();
        let mut open: Option<Vec<At>> = self.sees(at(0).position).then(|| vec![at(0)]);
        for k in 0..segments {
            let [from, to] = [at(k), at(k + 1)];
            let pieces = (self.pixels(from.position, to.position) / STEP).ceil().clamp(1.0, 1000.0) as u32;
            let mut last = (0.0, open.is_some());
            for piece in 1..=pieces {
                let part = f64::from(piece) / f64::from(pieces);
                let here = if piece == pieces { to } else { between(from, to, part) };
                let is_seen = self.sees(here.position);
                if is_seen != last.1 {
                    let edge = self.edge(from, to, last, part);
                    if is_seen {
                        open = Some(vec![edge]);
                    } else if let Some(mut part) = open.take() {
                        part.push(edge);
                        parts.push(part);
                    }
                }
                last = (part, is_seen);
            }
            if let Some(part) = &mut open {
                part.push(to);
            }
        }
        let Some(mut last) = open else { return rebuilt(curve, parts) };
        if curve.closed {
            if parts.is_empty() && last.len() == count + 1 {
                return vec![curve.clone()];
            }
            // What goes on beyond the start belongs to the first part.
            if let Some(first) = parts.first_mut().filter(|first| first[0].position == at(0).position) {
                last.pop();
                last.append(first);
                *first = last;
                return rebuilt(curve, parts);
            }
        }
        parts.push(last);
        rebuilt(curve, parts)
    }

    /// Where a segment appears or disappears, between a part of it that was looked at and a later one.
    fn edge(&self, from: At, to: At, (mut low, was_seen): (f64, bool), mut high: f64) -> At {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.sees(between(from, to, middle).position) == was_seen {
                low = middle;
            } else {
                high = middle;
            }
        }
        between(from, to, if was_seen { low } else { high })
    }
}

/// A point of a chord; its place is exact at the ends, and on one ptex face to first order.
fn between(from: At, to: At, part: f64) -> At {
    let mix = |a: f64, b: f64| a + part * (b - a);
    let place = match from.place.face == to.place.face {
        true => Place { u: mix(from.place.u, to.place.u), v: mix(from.place.v, to.place.v), ..from.place },
        false => {
            if part < 0.5 {
                from.place
            } else {
                to.place
            }
        }
    };
    At { position: from.position.lerp(to.position, part), place }
}

/// Open curves of the parts that have two points at least.
fn rebuilt(curve: &Curve, parts: Vec<Vec<At>>) -> Vec<Curve> {
    let of_part = |part: Vec<At>| {
        let (points, places) = part.into_iter().map(|at| (at.position, at.place)).unzip();
        Curve { closed: false, points, places, value: curve.value, light: curve.light }.without_repeats()
    };
    parts.into_iter().map(of_part).filter(|part| part.points.len() > 1).collect()
}
