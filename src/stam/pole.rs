//! Vertices of many faces: what their patches share is computed once for all of them.
//!
//! # Theory
//! The points of level n, (B / lambda)^(n-1) C ([`class`](super::class)), fall into the ring (the vertex, its spokes, the opposite
//! corners of its quads) and five to seven points outside it, which belong to one patch. The ring's points follow from the ring's
//! alone, so they are the same for all N patches at the vertex. The windows of a level follow from the outer points and from
//! the ring near the patch; of the rules that they need only that of the vertex itself reads all of the ring, and its point is
//! the ring's first of the next level.
//!
//! # Changes
//! Classes of few faces keep matrices Mhat(n) instead, 24 weights for each of the 2N + 8 control points a level. With a class for
//! each face and all points for each patch, time and memory would grow with the square of N. Here a level costs N for the ring and
//! a constant for each patch.
//!
//! # Practice
//! [`Poles`] belongs to the points of a surface and is filled where something is asked for: a [`Pole`] by the first of its patches, and the
//! [`NEAR`] first levels of a patch when it is evaluated. [`Wedge`] walks down the levels of one patch.

use super::class::{ClassTable, LEVELS, WINDOW_POINTS, grid_place};
use super::loop_rows::{LOOP_WINDOW, LoopRows};
use super::rows::{Row, Rows};
use super::surface::combine;
use crate::patch::{self, Patches, RingClass, Tip};
use glam::{DAffine3, DMat3, DVec3};
use std::sync::{Arc, OnceLock};

/// Levels of a patch that are kept for evaluation: all of it but 4^-12 of its area, 7 kB. Deeper ones are computed from the first
/// for each sample, which takes some 20 microseconds.
const NEAR: usize = 12;

/// The poles of a surface. Clones share them.
#[derive(Debug, Clone)]
pub(super) struct Poles {
    poles: Arc<[OnceLock<Pole>]>,
    /// The windows of the first levels of each patch.
    near: Arc<[OnceLock<Box<[DVec3]>>]>,
}

/// What a surface stores, as its poles read it.
#[derive(Clone, Copy)]
pub(super) struct Stored<'a> {
    pub patches: &'a Patches,
    pub tables: &'a [Arc<ClassTable>],
    pub points: &'a [DVec3],
}

/// A vertex of many faces, where it is stored.
#[derive(Debug)]
struct Pole {
    /// The refined vertex, and its limit position s0 relative to it.
    centre: DVec3,
    offset: DVec3,
    /// Ring points of level 1 to [`LEVELS`] + 1, relative to s0.
    levels: Vec<Vec<DVec3>>,
    /// The ring's limit position relative to s0, level by level: 0 but for rounding.
    constants: Vec<DVec3>,
    /// Boxes round the ring's points, level by level.
    boxes: Vec<[DVec3; 2]>,
    tangents: Tangents,
}

/// Directions in the tangent plane at a vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangents {
    /// Two that span it; `None` where there is no tangent plane.
    both: Option<[DVec3; 2]>,
    /// Takes the place of the second one where the two are parallel.
    spare: Option<DVec3>,
    /// Size of the control points.
    size: f64,
}

impl Tangents {
    /// Of control points relative to the limit position.
    pub fn new(table: &ClassTable, points: &[DVec3]) -> Self {
        let along = |weights: &Vec<f64>| combine(weights, points);
        Self {
            both: table.tangents.as_ref().map(|both| both.each_ref().map(along)),
            spare: table.spare.as_ref().map(along),
            size: points.iter().fold(0.0f64, |size, p| size.max(p.length())),
        }
    }

    fn mapped(self, map: DMat3) -> Self {
        let stretch = map.x_axis.length().max(map.y_axis.length()).max(map.z_axis.length());
        Self {
            both: self.both.map(|both| both.map(|d| map * d)),
            spare: self.spare.map(|d| map * d),
            size: self.size * stretch,
        }
    }

    /// The unit normal of the plane; `None` where there is none.
    pub fn normal(&self) -> Option<DVec3> {
        let [first, second] = self.both?;
        let normal = |a: DVec3, b: DVec3| {
            let across = a.normalize_or_zero().cross(b.normalize_or_zero());
            let clear = a.length().min(b.length()) > 1e-12 * self.size && across.length() > 1e-12;
            clear.then(|| across.normalize())
        };
        normal(first, second).or_else(|| normal(first, self.spare?))
    }
}

impl Pole {
    fn new(table: &ClassTable, ring: &[DVec3]) -> Self {
        // Relative to the vertex first: world coordinates would cost digits.
        let centre = ring[0];
        let offset = ring.iter().zip(&table.limit).map(|(&p, &w)| w * (p - centre)).sum::<DVec3>();
        let first: Vec<DVec3> = ring.iter().map(|&p| (p - centre) - offset).collect();
        let tangents = Tangents::new(table, &first);
        let (mut levels, mut constants) = (vec![first], Vec::with_capacity(LEVELS));
        for level in 0..LEVELS {
            let (constant, next) = table.ring_step(&levels[level]);
            constants.push(constant);
            levels.push(next);
        }
        let around =
            |points: &Vec<DVec3>| points.iter().fold([points[0]; 2], |[low, high], &p| [low.min(p), high.max(p)]);
        Self { centre, offset, boxes: levels.iter().map(around).collect(), levels, constants, tangents }
    }

    /// What the rule of the vertex makes of the ring of a level, from 0, before it is taken relative to the limit and scaled.
    fn vertex_point(&self, level: usize, lambda: f64) -> DVec3 {
        lambda * self.levels[level + 1][0] + self.constants[level]
    }

    fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(&level[..])).sum()
    }
}

/// Places of the windows of a level.
fn places(class: RingClass) -> Vec<(isize, isize)> {
    match class.triangles {
        true => LOOP_WINDOW.iter().map(|&[a, b]| (a, b)).collect(),
        false => (0..WINDOW_POINTS).map(grid_place).collect(),
    }
}

impl Poles {
    pub fn new(patches: &Patches) -> Self {
        Self {
            poles: (0..patches.ring_count()).map(|_| OnceLock::new()).collect(),
            near: (0..patches.wedge_count()).map(|_| OnceLock::new()).collect(),
        }
    }

    /// Bytes of what has been asked for.
    pub fn bytes(&self) -> usize {
        let poles: usize = self.poles.iter().filter_map(OnceLock::get).map(Pole::bytes).sum();
        poles + self.near.iter().filter_map(OnceLock::get).map(|near| size_of_val(&near[..])).sum::<usize>()
    }

    /// A patch of a large fan from level 1, moved to its place; `None` for others.
    pub fn wedge(&self, of: Stored<'_>, patch: usize, transform: Option<&DAffine3>) -> Option<Wedge<'_>> {
        let (_, wedge) = of.patches.wedge(patch)?;
        Some(Wedge::new(self.pole(of, wedge), of, patch, wedge, transform))
    }

    fn pole(&self, of: Stored<'_>, wedge: patch::Wedge) -> &Pole {
        self.poles[wedge.ring as usize].get_or_init(|| {
            let ring = of.patches.ring(wedge.ring as usize).iter().map(|&vertex| of.points[vertex as usize]);
            Pole::new(&of.tables[wedge.class as usize], &ring.collect::<Vec<_>>())
        })
    }

    /// What is the same at every point of a patch of a large fan; `None` for others.
    pub fn vertex(&self, of: Stored<'_>, patch: usize, transform: Option<&DAffine3>) -> Option<PoleVertex> {
        let (_, wedge) = of.patches.wedge(patch)?;
        let pole = self.pole(of, wedge);
        Some(PoleVertex {
            limit: placed(pole.centre + pole.offset, transform),
            tangents: transform.map_or(pole.tangents, |transform| pole.tangents.mapped(transform.matrix3)),
        })
    }

    /// The points of one window of a level, which are those numbered `point(k)` of `W` points of the level; a patch of a large fan.
    pub fn window<const W: usize, const N: usize>(
        &self,
        of: Stored<'_>,
        patch: usize,
        transform: Option<&DAffine3>,
        level: usize,
        point: impl Fn(usize) -> usize,
    ) -> [DVec3; N] {
        let (number, wedge) = of.patches.wedge(patch).expect("a patch of a large fan");
        let from_first = || Wedge::new(self.pole(of, wedge), of, patch, wedge, None);
        let mut deep = [DVec3::ZERO; W];
        let points = if level <= NEAR {
            let near = self.near[number].get_or_init(|| {
                let mut wedge = from_first();
                (0..NEAR).flat_map(|_| wedge.descend::<W>()).collect()
            });
            &near[W * (level - 1)..W * level]
        } else {
            let mut wedge = from_first();
            (0..level).for_each(|_| deep = wedge.descend::<W>());
            &deep[..]
        };
        std::array::from_fn(|k| turned(points[point(k)], transform.map(|transform| transform.matrix3)))
    }
}

fn placed(point: DVec3, transform: Option<&DAffine3>) -> DVec3 {
    transform.map_or(point, |transform| transform.transform_point3(point))
}

fn turned(point: DVec3, map: Option<DMat3>) -> DVec3 {
    map.map_or(point, |map| map * point)
}

/// The vertex of a patch of a large fan, where the patch is.
pub(super) struct PoleVertex {
    /// s0.
    pub limit: DVec3,
    pub tangents: Tangents,
}

/// A patch at a vertex of many faces, at one of its levels.
#[derive(Debug, Clone)]
pub(super) struct Wedge<'a> {
    pole: &'a Pole,
    lambda: f64,
    /// The windows of a level as sums of ring points, by number, and of outer points, which are numbered after them.
    rows: Vec<Row>,
    /// The window that the rule of the vertex gives, where that rule reads all of the ring.
    vertex: Option<usize>,
    /// The windows that are the outer points of the next level.
    outer_places: Vec<usize>,
    /// Outer points of this level, relative to s0, where the patch is stored.
    outer: Vec<DVec3>,
    /// The level, from 0; that of the ring stays at the last one.
    level: usize,
    /// What moves the patch to its place.
    map: Option<DMat3>,
    limit: DVec3,
}

impl<'a> Wedge<'a> {
    fn new(
        pole: &'a Pole,
        Stored { patches, points, tables }: Stored<'_>,
        patch: usize,
        wedge: patch::Wedge,
        transform: Option<&DAffine3>,
    ) -> Self {
        let class = wedge.class_of_face(patches.classes());
        let places = places(class);
        let place_of = |place| places.iter().position(|&window| window == place);
        let vertex = if class.tip == Tip::Smooth { place_of((0, 0)) } else { None };
        let row = |(window, &(a, b)): (usize, &(isize, isize))| match class.triangles {
            _ if vertex == Some(window) => Row::new(),
            true => LoopRows::new(class).refined(a, b),
            false => Rows::new(class).refined(a, b),
        };
        let outer = patches.own_support(patch).iter().map(|&vertex| points[vertex as usize]);
        Self {
            lambda: tables[wedge.class as usize].lambda,
            rows: places.iter().enumerate().map(row).collect(),
            vertex,
            outer_places: class.outer().into_iter().filter_map(place_of).collect(),
            outer: outer.map(|p| (p - pole.centre) - pole.offset).collect(),
            level: 0,
            map: transform.map(|transform| transform.matrix3),
            limit: placed(pole.centre + pole.offset, transform),
            pole,
        }
    }

    /// s0, where the patch is.
    pub fn limit(&self) -> DVec3 {
        self.limit
    }

    /// Points relative to s0 in whose hull all that is left of the patch lies: the corners of a box round the ring, and the outer
    /// points.
    pub fn hull(&self) -> impl Iterator<Item = DVec3> {
        let [low, high] = self.pole.boxes[self.level.min(LEVELS)];
        let corner = move |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
        (0..8).map(corner).chain(self.outer.iter().copied()).map(|p| turned(p, self.map))
    }

    /// Phat of this level, relative to s0: the points of a level of the class, of which there are `W`.
    pub fn windows<const W: usize>(&self) -> [DVec3; W] {
        self.stored_windows().map(|p| turned(p, self.map))
    }

    /// As [`windows`](Self::windows), and goes one level deeper.
    pub fn descend<const W: usize>(&mut self) -> [DVec3; W] {
        let windows: [DVec3; W] = self.stored_windows();
        let constant = self.pole.constants[self.level.min(LEVELS - 1)];
        for (outer, &place) in self.outer.iter_mut().zip(&self.outer_places) {
            *outer = (windows[place] - constant) / self.lambda;
        }
        self.level += 1;
        windows.map(|p| turned(p, self.map))
    }

    fn stored_windows<const W: usize>(&self) -> [DVec3; W] {
        let level = self.level.min(LEVELS - 1);
        let ring = &self.pole.levels[level];
        let point = |k: usize| if k < ring.len() { ring[k] } else { self.outer[k - ring.len()] };
        std::array::from_fn(|window| match self.vertex == Some(window) {
            true => self.pole.vertex_point(level, self.lambda),
            false => self.rows[window].iter().map(|&(k, w)| w * point(k)).sum(),
        })
    }

    /// The patch that a linear map makes of this one.
    pub fn mapped(self, map: DMat3) -> Self {
        let own = self.map.unwrap_or(DMat3::IDENTITY);
        Self { map: Some(map * own), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::SubdivMesh;
    use crate::stam::{LimitSurface, Net, Window};
    use crate::test_meshes::{fan, triangle_fan};

    /// Fans of `faces` faces of every kind.
    fn fans(faces: u32) -> Vec<SubdivMesh> {
        let (third, half) = (faces / 3, faces / 2);
        vec![
            fan(faces, true, &[]),
            fan(faces, true, &[third]),
            fan(faces, true, &[0, half]),
            fan(faces, true, &[0, third, 2 * third]),
            fan(faces, false, &[]),
            triangle_fan(faces, &[]),
            triangle_fan(faces, &[third]),
            triangle_fan(faces, &[1, half]),
        ]
    }

    /// All points of a patch stepped by its class, as it would be if no patch shared anything.
    fn stepped(surface: &LimitSurface, patch: usize, levels: usize) -> Vec<Vec<DVec3>> {
        let (_, wedge) = surface.patches_stored().wedge(patch).expect("a patch of a large fan");
        let table = ClassTable::new(wedge.class_of_face(surface.classes()));
        assert!(!table.keeps_matrices());
        let support = surface.support(patch);
        assert_eq!(support.len(), table.support());
        let points: Vec<DVec3> = support.iter().map(|&vertex| surface.refined_point(vertex)).collect();
        let limit = combine(&table.limit, &points);
        let points: Vec<DVec3> = points.into_iter().map(|p| p - limit).collect();
        let of = |level| match surface.has_triangles() {
            true => table.loop_level_points(level, &points).to_vec(),
            false => table.level_points(level, &points).to_vec(),
        };
        (1..=levels).map(of).collect()
    }

    #[test]
    fn patches_share_what_each_would_compute() {
        let mut kinds = std::collections::BTreeMap::new();
        for mesh in fans(20).into_iter().chain(fans(47)) {
            let surface = LimitSurface::new(&mesh).expect("it has a surface");
            let wedges = (0..surface.patches().len()).filter(|&patch| surface.wedge(patch).is_some());
            for patch in wedges {
                *kinds.entry((surface.kind(patch).name(), surface.has_triangles())).or_insert(0) += 1;
                let expected = stepped(&surface, patch, 30);
                let found: Vec<Vec<DVec3>> = match surface.net(patch, 30) {
                    Net::Irregular { levels, .. } => levels.iter().map(|level| level.to_vec()).collect(),
                    Net::IrregularTriangle { levels, .. } => levels.iter().map(|level| level.to_vec()).collect(),
                    net => panic!("{net:?}"),
                };
                for (level, (expected, found)) in expected.iter().zip(&found).enumerate() {
                    for (a, b) in expected.iter().zip(found) {
                        assert!(
                            a.distance(*b) < 1e-12,
                            "{:?} patch {patch}, level {level}: {a} {b}",
                            surface.kind(patch)
                        );
                    }
                }
                // All that is left of the patch lies in the hull.
                let mut rings = surface.rings(patch).expect("an irregular patch");
                for level in 0..20 {
                    let far = DVec3::INFINITY;
                    let [low, high] = rings.hull().fold([far, -far], |[low, high], p| [low.min(p), high.max(p)]);
                    for [u, v] in [[1.0, 0.0], [0.6, 0.4], [0.3, 0.1], [0.0, 0.7], [0.0, 0.0]] {
                        let uv = [u, v].map(|x| x * 0.5f64.powi(level));
                        let p = surface.evaluate(patch, uv).position - rings.limit();
                        assert!(p.cmpge(low - 1e-14).all() && p.cmple(high + 1e-14).all(), "{level} {uv:?}: {p}");
                    }
                    rings.descend();
                }
            }
        }
        println!("{kinds:?}");
        assert_eq!(kinds.len(), 7, "{kinds:?}");
    }

    /// Curves are traced on nets and corrected by evaluation: both see the same bits, near the vertex and far from it.
    #[test]
    fn nets_have_the_bits_of_evaluation() {
        for mesh in fans(33).iter().take(5) {
            let surface = LimitSurface::new(mesh).expect("it has a surface");
            for patch in (0..surface.patches().len()).filter(|&patch| surface.wedge(patch).is_some()).step_by(5) {
                let Net::Irregular { levels, .. } = surface.net(patch, LEVELS) else { panic!("quads") };
                for level in [1, 2, NEAR, NEAR + 1, 40, LEVELS] {
                    let size = 0.5f64.powi(level as i32);
                    for uv in [[1.5 * size, 0.3 * size], [1.2 * size, 1.7 * size], [0.1 * size, 1.1 * size]] {
                        let window = Window::at(uv);
                        assert_eq!(window.level as usize, level);
                        let net: [DVec3; 16] =
                            surface.pole_window::<WINDOW_POINTS, 16>(patch, level, |k| window.point(k));
                        let expected: [DVec3; 16] = std::array::from_fn(|k| levels[level - 1][window.point(k)]);
                        assert_eq!(net, expected, "level {level}");
                    }
                }
            }
        }
    }

    /// What a fan takes grows with its faces, not with their square: lists, classes and their tables, and what is kept of all
    /// patches once they have been evaluated.
    #[test]
    fn fans_take_memory_by_their_faces() {
        let bytes = |mesh: &SubdivMesh| {
            let surface = LimitSurface::new(mesh).expect("it has a surface");
            let mut jets = (0..surface.patches().len()).map(|patch| surface.evaluate(patch, [0.3, 0.2]));
            assert!(jets.all(|jet| jet.position.is_finite()));
            let tables: usize = surface.tables().iter().map(|table| table.bytes()).sum();
            (surface.classes().len(), surface.bytes() as f64 + tables as f64)
        };
        for (small, large) in fans(64).iter().zip(&fans(512)) {
            let [(few, small), (many, large)] = [small, large].map(bytes);
            assert_eq!(few, many, "classes");
            println!("{small} {large}");
            assert!(large < 1.05 * 8.0 * small && large < 512.0 * 40_000.0, "{small} {large}");
        }
    }
}
