//! Extraordinary vertices: what curvature does round them.

use super::control::{Control, Spot};
use super::form::{Form, axes};
use super::joint::{on_edge, place, rounding};
use super::sheets::Fans;
use super::slope::{slope, turn_deg};
use super::{Break, Limits, Reading};
use crate::curves::Place;
use crate::osd::INFINITE_SHARPNESS;
use crate::patch::{Adjacency, PatchKind};
use crate::stam::LimitSurface;
use crate::statistics::angle_deg;
use glam::{DQuat, DVec2, DVec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Rings that are looked at: radii 2^-1 to 2^-RINGS of the patches.
pub const RINGS: usize = 8;

/// A patch at a point, which is its corner `corner` (corners (0,0), (1,0), (1,1), (0,1)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wedge {
    /// Patch.
    pub patch: u32,
    /// Which corner.
    pub corner: u8,
}

impl Wedge {
    /// Local parameters of a point, given by its distances from the corner along the two edges there, counter-clockwise.
    fn local(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        [[a, b], [1.0 - b, a], [1.0 - a, 1.0 - b], [b, 1.0 - a]][usize::from(self.corner)]
    }
}

/// Curvature on a small ring round a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Radius in control edges: the ring is a square in the parameters of each face.
    pub radius: f64,
    /// Mean distance of its points from the vertex, model units.
    pub distance: f64,
    /// Smallest and largest principal curvature on it, one over model units.
    pub principal: [f64; 2],
    /// Largest size of a principal curvature on it.
    pub curvature: f64,
    /// 2 |A - B| / (|A| + |B|) of the two points of the ring whose second fundamental forms A and B, carried to the vertex, are
    /// farthest apart, 0 to 2; 0 where they are apart by rounding. |A| is the largest principal curvature by size. On a surface with a
    /// curvature at the vertex it vanishes with the radius.
    pub spread: f64,
    /// Largest angle between contours of the field at two points of the ring, degrees, 0 to 90: how much lines that run into the vertex
    /// from several sides disagree; `None` without a field, or where it says nothing there.
    pub turn_deg: Option<f64>,
}

/// An extraordinary vertex, or one of the sectors that infinitely sharp edges divide it into.
#[derive(Debug, Clone, PartialEq)]
pub struct Vertex {
    /// Which point of the control mesh.
    pub spot: Spot,
    /// Its rule.
    pub kind: PatchKind,
    /// Faces with a surface round it, in this sector.
    pub faces: usize,
    /// Its patches.
    pub wedges: Vec<Wedge>,
    /// Where it is, in one of its faces.
    pub place: Place,
    /// Where it is in space.
    pub position: DVec3,
    /// Largest distance between its positions on two patches, model units.
    pub gap: f64,
    /// Largest angle between the normals of two of its patches at it, degrees; `None` where one has none.
    pub angle_deg: Option<f64>,
    /// Its rules have a tangent plane there for every position of the control points but degenerate ones
    /// ([`RingClass::has_tangent_plane`](crate::patch::RingClass::has_tangent_plane)).
    pub tangent_plane: bool,
    /// From the largest ring to the smallest.
    pub rings: Vec<Ring>,
    /// Curvature on the smallest ring over that on the next larger one: 1 where it has a limit, above where it grows without bound
    /// towards the vertex, below where it fades. `None` where the surface is flat.
    pub growth: Option<f64>,
}

impl Vertex {
    /// Difference in curvature, 0 to 2: the spread on the smallest ring. `None` without a tangent plane.
    pub fn difference(&self) -> Option<f64> {
        self.rings.last().map(|ring| ring.spread).filter(|_| self.tangent_plane)
    }

    /// How many times its limit each figure is. Where its rules have no tangent plane and the surface is curved, the angle is infinitely many
    /// times its limit although the normals of the patches may agree at the vertex itself, as they do in crease sectors of five faces
    /// and more; where they do not, the angle says more.
    pub fn ratios(&self, limits: &Limits) -> [(Break, f64); 3] {
        let is_flat = self.rings.last().is_some_and(|ring| ring.curvature == 0.0);
        let is_shown = self.tangent_plane || is_flat || self.angle_deg.is_some_and(|angle| angle > limits.angle_deg);
        limits.ratios(self.gap, self.angle_deg.filter(|_| is_shown), self.difference())
    }
}

/// The patches of each sector of each extraordinary vertex.
///
/// Patches belong together that meet along an edge, and those at a control vertex between which only faces without a surface lie.
fn sectors(surface: &LimitSurface, control: &Control<'_>, adjacency: &Adjacency) -> Vec<Vec<Wedge>> {
    let irregular: Vec<usize> = (0..surface.patches().len()).filter(|&patch| surface.class(patch).is_some()).collect();
    let mut groups: BTreeMap<usize, usize> = irregular.iter().map(|&patch| (patch, patch)).collect();
    fn root(groups: &mut BTreeMap<usize, usize>, mut patch: usize) -> usize {
        while groups[&patch] != patch {
            let next = groups[&groups[&patch]];
            groups.insert(patch, next);
            patch = next;
        }
        patch
    }
    for &patch in &irregular {
        for (edge, end) in [(0, 0), (3, 1)] {
            let Some(neighbour) = adjacency.at(patch, edge, [0.0, 1.0][end]) else { continue };
            let other = neighbour.patch as usize;
            let meets = on_edge(neighbour.edge, neighbour.other[end]) == [0.0; 2] && surface.class(other).is_some();
            if meets && !neighbour.sharp {
                let [a, b] = [patch, other].map(|patch| root(&mut groups, patch));
                groups.insert(a.max(b), a.min(b));
            }
        }
    }
    let mut spots: BTreeMap<Spot, Vec<usize>> = BTreeMap::new();
    for &patch in &irregular {
        spots.entry(control.spot(&surface.patches()[patch])).or_default().push(patch);
    }
    spots.retain(|spot, patches| {
        let first = root(&mut groups, patches[0]);
        matches!(spot, Spot::Vertex(_)) && patches.iter().any(|&patch| root(&mut groups, patch) != first)
    });
    let fans = Fans::new(control, |vertex| spots.contains_key(&Spot::Vertex(vertex)));
    for (spot, patches) in &spots {
        let Spot::Vertex(vertex) = *spot else { continue };
        for sector in fans.at(vertex, |edge| control.sharpness(edge) < INFINITE_SHARPNESS) {
            let inside = patches.iter().filter(|&&patch| sector.contains(&control.face(&surface.patches()[patch])));
            let inside: Vec<usize> = inside.copied().collect();
            for pair in inside.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|patch| root(&mut groups, patch));
                groups.insert(a.max(b), a.min(b));
            }
        }
    }
    let mut sectors: BTreeMap<usize, Vec<Wedge>> = BTreeMap::new();
    for &patch in &irregular {
        let first = root(&mut groups, patch);
        sectors.entry(first).or_default().push(Wedge { patch: patch as u32, corner: 0 });
    }
    sectors.into_values().collect()
}

/// All extraordinary vertices, sector by sector.
pub(super) fn vertices(
    surface: &LimitSurface,
    control: &Control<'_>,
    adjacency: &Adjacency,
    reading: Option<Reading<'_>>,
    coordinate: f64,
) -> Vec<Vertex> {
    let vertex = |wedges: Vec<Wedge>| {
        let first = wedges[0].patch as usize;
        let tips: Vec<_> =
            wedges.iter().map(|wedge| surface.evaluate(wedge.patch as usize, wedge.local([0.0; 2]))).collect();
        let pairs = (0..tips.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let (mut gap, mut angle) = (0.0f64, 0.0f64);
        for (i, j) in pairs {
            gap = gap.max(tips[i].position.distance(tips[j].position));
            angle = angle.max(angle_deg(tips[i].normal, tips[j].normal));
        }
        let has_normals = tips.iter().all(|tip| tip.normal != DVec3::ZERO);
        let rings = rings(surface, &wedges, reading, coordinate);
        let growth = match &rings[..] {
            [.., a, b] if a.curvature > 0.0 && b.curvature > 0.0 => Some(b.curvature / a.curvature),
            _ => None,
        };
        let class = surface.class(first).map(|class| surface.classes()[class]);
        Vertex {
            spot: control.spot(&surface.patches()[first]),
            kind: surface.kind(first),
            faces: wedges.len(),
            place: place(surface, first, [0.0; 2]),
            position: tips[0].position,
            gap,
            angle_deg: has_normals.then_some(angle),
            tangent_plane: class.is_some_and(|class| class.has_tangent_plane()),
            wedges,
            rings,
            growth,
        }
    };
    let mut found: Vec<Vertex> = sectors(surface, control, adjacency).into_par_iter().map(vertex).collect();
    found.sort_by_key(|vertex| (vertex.spot, vertex.wedges[0].patch));
    found
}

/// Curvature on rings round a point whose wedges are given; largest ring first. `coordinate`: the largest coordinate of the control
/// points by size, for what is rounding. Empty where the first wedge has no normal at the point.
pub fn rings(surface: &LimitSurface, wedges: &[Wedge], reading: Option<Reading<'_>>, coordinate: f64) -> Vec<Ring> {
    let Some(first) = wedges.first() else { return Vec::new() };
    let tip = surface.evaluate(first.patch as usize, first.local([0.0; 2]));
    if tip.normal == DVec3::ZERO {
        return Vec::new();
    }
    let level = |wedge: &Wedge| surface.patches()[wedge.patch as usize].levels()[0];
    let deepest = wedges.iter().map(level).max().unwrap_or(0);
    // Points a patch: fifty or so a ring, but always one.
    let count = (48 / wedges.len()).clamp(1, 8);
    let ring = |k: usize| {
        let radius = 0.5f64.powi(k as i32 + i32::from(deepest));
        let mut samples: Vec<Sample> = Vec::new();
        let mut distance = 0.0;
        for wedge in wedges {
            let r = radius * f64::from(1u32 << level(wedge));
            for i in 0..count {
                // Round the square, from one edge to the other.
                let turn = 2.0 * (i as f64 + 0.5) / count as f64;
                let uv = wedge.local([r * (2.0 - turn).min(1.0), r * turn.min(1.0)]);
                let jet = surface.evaluate_second(wedge.patch as usize, uv);
                distance += jet.first.position.distance(tip.position) / (wedges.len() * count) as f64;
                let carried =
                    DQuat::from_rotation_arc(tip.normal, jet.first.normal) * tip.normal.any_orthonormal_vector();
                let Some(frame) = axes(&jet, carried) else { continue };
                let Some(form) = Form::of(&jet, frame) else { continue };
                let rounding = rounding(surface, wedge.patch as usize, uv, &jet, coordinate);
                let slope = reading.and_then(|reading| slope(reading.field, reading.camera, &jet, frame, rounding));
                samples.push(Sample { form, rounding, slope });
            }
        }
        Sample::ring(&samples, radius, distance)
    };
    (1..=RINGS).map(ring).collect()
}

/// A point of a ring.
struct Sample {
    form: Form,
    rounding: f64,
    slope: Option<DVec2>,
}

impl Sample {
    fn ring(samples: &[Sample], radius: f64, distance: f64) -> Ring {
        let mut ring = Ring { radius, distance, principal: [0.0; 2], curvature: 0.0, spread: 0.0, turn_deg: None };
        let mut range: Option<[f64; 2]> = None;
        let mut apart = 0.0;
        for (i, a) in samples.iter().enumerate() {
            let mean = 0.5 * (a.form.first + a.form.second);
            let half = a.form.norm() - mean.abs();
            let [low, high] = range.unwrap_or([mean; 2]);
            range = Some([low.min(mean - half), high.max(mean + half)]);
            if a.form.norm() > a.rounding {
                ring.curvature = ring.curvature.max(a.form.norm());
            }
            for b in &samples[..i] {
                let difference = a.form.minus(&b.form).norm();
                if difference > apart && difference > a.rounding + b.rounding {
                    apart = difference;
                    ring.spread = 2.0 * difference / (a.form.norm() + b.form.norm());
                }
                if let Some((p, q)) = a.slope.zip(b.slope) {
                    let turn = turn_deg(p, q);
                    ring.turn_deg = Some(turn.min(180.0 - turn).max(ring.turn_deg.unwrap_or(0.0)));
                }
            }
        }
        ring.principal = range.unwrap_or_default();
        ring
    }
}
