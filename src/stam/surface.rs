//! The limit surface of a mesh: patches, points, tables, evaluation.

use super::box_spline;
use super::class::{ClassTable, WINDOW_POINTS};
use super::instances::{Instances, Placed};
use super::loop_rows::LOOP_WINDOW;
use super::pole::{PoleVertex, Poles, Stored, Wedge};
use crate::mesh::SubdivMesh;
use crate::patch::{Adjacency, PHANTOM, Patch, PatchError, PatchKind, Patches, Refinement, RingClass, Watch, slot};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::Arc;

/// The control net of a patch, as an evaluator wants it.
#[derive(Debug, Clone)]
pub enum Net {
    /// 16 uniform bicubic B-spline points, u fastest: point (i,j), i and j in -1..=2, at `4*(j+1) + (i+1)`; the corners
    /// of the patch are at 5, 6, 10, 9.
    Regular([DVec3; 16]),
    /// Normalised Stam table, docs/LIMIT.md, section 4.
    Irregular {
        /// s0, the limit position of the extraordinary vertex at local (0,0).
        limit: DVec3,
        /// lambda, the largest eigenvalue of the subdivision matrix below 1.
        lambda: f64,
        /// Phat of level n at `levels[n-1]`: 24 points, the grid (a,b), a and b in -1..=3, u fastest, without (-1,-1):
        /// point (a,b) at `5*(b+1) + (a+1) - 1`.
        levels: Vec<[DVec3; WINDOW_POINTS]>,
    },
    /// The 12 points of a quartic box spline, as [`box_spline`](super::box_spline) names them.
    Triangle([DVec3; box_spline::POINTS]),
    /// Normalised Stam table of a triangle, docs/LIMIT.md, section 8.
    IrregularTriangle {
        /// s0, the limit position of the extraordinary vertex at local (0,0).
        limit: DVec3,
        /// lambda, the largest eigenvalue of the subdivision matrix below 1.
        lambda: f64,
        /// Phat of level n at `levels[n-1]`, at the places of [`LOOP_WINDOW`].
        levels: Vec<[DVec3; LOOP_WINDOW.len()]>,
    },
}

/// The limit surface of a mesh. Clones share their data.
#[derive(Debug, Clone)]
pub struct LimitSurface {
    patches: Arc<Patches>,
    tables: Arc<Vec<Arc<ClassTable>>>,
    /// Refined points of all levels.
    points: Arc<Vec<DVec3>>,
    /// Where parts of a scene are others in another place, what is in `patches` and `points` once.
    instances: Option<Arc<Instances>>,
    /// What patches at vertices of many faces share.
    poles: Poles,
    diagonal: f64,
}

impl LimitSurface {
    /// Refines the mesh and builds its patches and tables. Parts that repeat others ([`Part::repeats`](crate::mesh::Part::repeats))
    /// take the patches and refined points of those, which are moved as they are read.
    ///
    /// # Errors
    /// The mesh is not valid, OpenSubdiv refuses it, or a face stays without a closed form.
    pub fn new(mesh: &SubdivMesh) -> Result<Self, PatchError> {
        Self::watched(mesh, &|_, _| ())
    }

    /// As [`new`](Self::new); `watch` is told how far it is.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn watched(mesh: &SubdivMesh, watch: Watch<'_>) -> Result<Self, PatchError> {
        let Some(originals) = mesh.originals() else { return Self::flat(mesh, watch) };
        mesh.validate_points().map_err(crate::osd::Error::from)?;
        let stored = Self::flat(&originals.mesh, watch)?;
        let instances = Instances::new(mesh, &originals, &stored.patches);
        Ok(Self { instances: Some(Arc::new(instances)), diagonal: mesh.diagonal(), ..stored })
    }

    /// As [`watched`](Self::watched), with everything stored as often as it is there.
    pub(crate) fn flat(mesh: &SubdivMesh, watch: Watch<'_>) -> Result<Self, PatchError> {
        let (patches, points) = Patches::with_points(mesh, watch)?;
        Ok(Self::of(patches, points, mesh))
    }

    /// As [`new`](Self::new), with what makes refined points of control points.
    pub(super) fn with_refinement(mesh: &SubdivMesh) -> Result<(Self, Refinement), PatchError> {
        let (patches, mut refinement) = Patches::new(mesh)?;
        let points = refinement.interpolate(&mesh.points)?;
        Ok((Self::of(patches, points, mesh), refinement))
    }

    fn of(patches: Patches, points: Vec<DVec3>, mesh: &SubdivMesh) -> Self {
        let tables = patches.classes().par_iter().map(|&class| ClassTable::shared(class)).collect();
        Self {
            poles: Poles::new(&patches),
            patches: Arc::new(patches),
            tables: Arc::new(tables),
            points: Arc::new(points),
            instances: None,
            diagonal: mesh.diagonal(),
        }
    }

    /// All patches, in ptex order.
    pub fn patches(&self) -> &[Patch] {
        self.instances.as_ref().map_or(self.patches.all(), |instances| instances.patches())
    }

    /// Number of patches that are stored: those of instances are those of their originals.
    pub fn stored_patches(&self) -> usize {
        self.patches.all().len()
    }

    /// Of a patch of an instance: the earlier patch that it repeats, and which of [`transforms`](Self::transforms) moves that.
    pub fn instance(&self, patch: usize) -> Option<(usize, usize)> {
        self.instances.as_ref()?.original(patch)
    }

    /// What moves the originals of instances, one an instance.
    pub fn transforms(&self) -> Vec<DAffine3> {
        let parts = self.instances.iter().flat_map(|instances| instances.parts());
        parts.filter_map(|part| part.transform).collect()
    }

    /// Where a patch is stored, and what moves it from there.
    fn stored(&self, patch: usize) -> (usize, Option<&DAffine3>) {
        self.instances.as_ref().map_or((patch, None), |instances| instances.stored(patch))
    }

    /// The classes of the irregular patches, in the order of their tables.
    pub fn classes(&self) -> &[RingClass] {
        self.patches.classes()
    }

    /// The class tables.
    pub fn tables(&self) -> &[Arc<ClassTable>] {
        &self.tables
    }

    /// Index into [`classes`](Self::classes) of an irregular patch.
    pub fn class(&self, patch: usize) -> Option<usize> {
        self.patches.class(self.stored(patch).0)
    }

    /// Bytes of patches, of points, and of what is kept at vertices of many faces by now; tables of classes are small beside them.
    pub fn bytes(&self) -> u64 {
        let instances = self.instances.as_ref().map_or(0, |instances| size_of_val(instances.patches()));
        self.patches.bytes() + (size_of_val(&self.points[..]) + instances + self.poles.bytes()) as u64
    }

    /// Number of ptex faces, holes included.
    pub fn ptex_count(&self) -> usize {
        self.instances.as_ref().map_or(self.patches.ptex_count(), |instances| instances.ptex_count())
    }

    /// Length of the bounding-box diagonal of the control points: the unit of every tolerance.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// A box that encloses the limit surface: that of the refined points that control it (all rules are convex
    /// combinations). `None` for a surface without patches.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let both = |[low, high]: [DVec3; 2], [a, b]: [DVec3; 2]| [low.min(a), high.max(b)];
        let used = |vertex: &&u32| **vertex != PHANTOM;
        let Some(instances) = &self.instances else {
            let of = |vertices: &[u32]| {
                vertices.iter().filter(used).map(|&vertex| [self.points[vertex as usize]; 2]).reduce(both)
            };
            return self.patches.supports().par_chunks(1 << 16).filter_map(of).reduce_with(both);
        };
        let of_part = |part: &Placed| {
            let place = |&vertex: &u32| {
                let stored = self.points[vertex as usize];
                [part.transform.map_or(stored, |transform| transform.transform_point3(stored)); 2]
            };
            let supports = part.stored.clone().flat_map(|patch| self.patches.own_support(patch as usize));
            let mut rings: Vec<u32> =
                part.stored.clone().filter_map(|patch| Some(self.patches.wedge(patch as usize)?.1.ring)).collect();
            rings.sort_unstable();
            rings.dedup();
            let rings = rings.iter().flat_map(|&ring| self.patches.ring(ring as usize));
            supports.filter(used).chain(rings).map(place).reduce(both)
        };
        instances.parts().par_iter().filter_map(of_part).reduce_with(both)
    }

    /// The patch at (u,v), each 0 to 1, of a ptex face, and the patch-local parameters; `None` in a hole.
    ///
    /// # Panics
    /// `ptex` is not below [`ptex_count`](Self::ptex_count).
    pub fn locate(&self, ptex: u32, uv: [f64; 2]) -> Option<(usize, [f64; 2])> {
        let Some(instances) = &self.instances else { return self.patches.locate(ptex, uv) };
        let (stored, to_scene) = instances.stored_ptex(ptex);
        self.patches.locate(stored, uv).map(|(patch, uv)| (to_scene(patch), uv))
    }

    /// What lies across every edge of every patch.
    pub fn adjacency(&self) -> Adjacency {
        let stored = Adjacency::new(&self.patches);
        match &self.instances {
            Some(instances) => stored.repeated(instances.parts().iter().map(|part| part.stored.clone())),
            None => stored,
        }
    }

    /// The patches that are stored.
    #[cfg(test)]
    pub(super) fn patches_stored(&self) -> &Patches {
        &self.patches
    }

    /// The kind of a patch.
    pub fn kind(&self, patch: usize) -> PatchKind {
        self.patches()[patch].kind
    }

    /// Some control point of a patch, phantom points left out.
    pub(crate) fn control_point(&self, patch: usize) -> DVec3 {
        let (stored, transform) = self.stored(patch);
        let mut support = self.patches.own_support(stored).iter();
        let vertex = support.find(|&&vertex| vertex != PHANTOM).expect("corners are control points");
        let point = self.points[*vertex as usize];
        transform.map_or(point, |transform| transform.transform_point3(point))
    }

    /// Refined vertices that control a patch, [`PHANTOM`] where there is none.
    pub(crate) fn support(&self, patch: usize) -> Cow<'_, [u32]> {
        self.patches.support(self.stored(patch).0)
    }

    /// Whether patches are triangles, under Loop's scheme.
    pub fn has_triangles(&self) -> bool {
        self.patches.are_triangles()
    }

    /// A net of stored points, moved to where the patch is.
    pub(super) fn moved_from_stored<const N: usize>(&self, patch: usize, net: [DVec3; N]) -> [DVec3; N] {
        match self.stored(patch).1 {
            Some(transform) => net.map(|point| transform.transform_point3(point)),
            None => net,
        }
    }

    /// A point of the unit square, folded into the triangle where patches are triangles.
    pub(crate) fn folded(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        if self.has_triangles() && u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] }
    }

    /// A refined point, where it is stored.
    pub(super) fn refined_point(&self, vertex: u32) -> DVec3 {
        self.points[vertex as usize]
    }

    /// Number of refined points, of all levels.
    pub(crate) fn refined_points(&self) -> usize {
        self.points.len()
    }

    /// The same patches over other refined points, those of all levels.
    pub(crate) fn with_refined(&self, points: Vec<DVec3>) -> Self {
        Self { poles: Poles::new(&self.patches), points: Arc::new(points), ..self.clone() }
    }

    /// As [`with_refined`](Self::with_refined), of a mesh with another diagonal.
    pub(super) fn moved(&self, points: Vec<DVec3>, diagonal: f64) -> Self {
        Self { diagonal, ..self.with_refined(points) }
    }

    /// A surface with an error: point `point` of the support of a patch is moved, for this patch alone (strips along a
    /// crease share their support). `None` if there is no such point.
    pub(crate) fn with_point_moved(&self, patch: usize, point: usize, by: DVec3) -> Option<Self> {
        let patch = self.stored(patch).0;
        let vertex = *self.patches.support(patch).get(point).filter(|&&vertex| vertex != PHANTOM)?;
        let (mut patches, mut points) = ((*self.patches).clone(), (*self.points).clone());
        patches.set_support(patch, point, points.len() as u32);
        points.push(points[vertex as usize] + by);
        let poles = Poles::new(&patches);
        Some(Self { patches: Arc::new(patches), points: Arc::new(points), poles, ..self.clone() })
    }

    /// The 16 points of a regular patch, phantom points filled in.
    pub(crate) fn regular_net(&self, patch: usize) -> [DVec3; 16] {
        let (patch, transform) = self.stored(patch);
        let support = self.patches.own_support(patch);
        let mut net = [DVec3::ZERO; 16];
        for (point, &vertex) in net.iter_mut().zip(support) {
            if vertex != PHANTOM {
                let stored = self.points[vertex as usize];
                *point = transform.map_or(stored, |transform| transform.transform_point3(stored));
            }
        }
        // A point beyond a sharp edge mirrors the inner row at the edge: rows first, then columns, which fills corners.
        let phantom = |i, j| support[slot(i, j)] == PHANTOM;
        let mut mirror = |to: (isize, isize), step: (isize, isize)| {
            let at = |k: isize| slot(to.0 + k * step.0, to.1 + k * step.1);
            net[at(0)] = 2.0 * net[at(1)] - net[at(2)];
        };
        for (j, step) in [(-1, 1), (2, -1)] {
            if phantom(0, j) {
                (-1..=2).for_each(|i| mirror((i, j), (0, step)));
            }
        }
        for (i, step) in [(-1, 1), (2, -1)] {
            if phantom(i, 0) {
                (-1..=2).for_each(|j| mirror((i, j), (step, 0)));
            }
        }
        let Some(rows) = self.patches.row_weights(patch) else { return net };
        std::array::from_fn(|k| (0..4).map(|row| rows[k / 4][row] * net[4 * row + k % 4]).sum())
    }

    /// Control points of an irregular patch of a small class relative to s0, and s0.
    pub(super) fn irregular_net(&self, patch: usize, table: &ClassTable) -> (Vec<DVec3>, DVec3) {
        let (patch, transform) = self.stored(patch);
        let stored = self.patches.own_support(patch).iter().map(|&vertex| self.points[vertex as usize]);
        let mut points: Vec<DVec3> = match transform {
            Some(transform) => stored.map(|point| transform.transform_point3(point)).collect(),
            None => stored.collect(),
        };
        // Relative to the vertex first: world coordinates would cost digits.
        let centre = points[0];
        let offset = points.iter().zip(&table.limit).map(|(&p, &w)| w * (p - centre)).sum::<DVec3>();
        let limit = centre + offset;
        for point in &mut points {
            *point = (*point - centre) - offset;
        }
        (points, limit)
    }

    /// A patch at a vertex of many faces, from level 1.
    pub(super) fn wedge(&self, patch: usize) -> Option<Wedge<'_>> {
        let (stored, transform) = self.stored(patch);
        self.poles.wedge(self.stores(), stored, transform)
    }

    /// Of a patch at a vertex of many faces: that vertex.
    pub(super) fn pole_vertex(&self, patch: usize) -> Option<PoleVertex> {
        let (stored, transform) = self.stored(patch);
        self.poles.vertex(self.stores(), stored, transform)
    }

    /// Of a patch at a vertex of many faces: the points numbered `point(k)` among the `W` points of a level.
    pub(super) fn pole_window<const W: usize, const N: usize>(
        &self,
        patch: usize,
        level: usize,
        point: impl Fn(usize) -> usize,
    ) -> [DVec3; N] {
        let (stored, transform) = self.stored(patch);
        self.poles.window::<W, N>(self.stores(), stored, transform, level, point)
    }

    fn stores(&self) -> Stored<'_> {
        Stored { patches: &self.patches, tables: &self.tables, points: &self.points }
    }

    /// Points of the levels of an irregular patch whose class keeps its matrices, each by its level and its number there, as in
    /// [`ClassTable::weights`]; none of others.
    pub(crate) fn window_points(&self, patch: usize, picked: &[[usize; 2]]) -> Vec<DVec3> {
        let Some(class) = self.class(patch) else { return Vec::new() };
        let table = &self.tables[class];
        if !table.keeps_matrices() {
            return Vec::new();
        }
        let (points, _) = self.irregular_net(patch, table);
        picked.iter().filter_map(|&[level, k]| Some(combine(table.weights(level, k)?, &points))).collect()
    }

    /// Control net of a patch; `levels` (1 to [`LEVELS`](super::LEVELS)) levels of it where it is irregular, with the bits of
    /// [`evaluate`](Self::evaluate).
    pub fn net(&self, patch: usize, levels: usize) -> Net {
        let of = |table: &ClassTable, points: &[DVec3]| {
            (1..=levels).map(|level| table.level_points(level, points)).collect()
        };
        self.net_by(patch, levels, of)
    }

    /// The same in vectors: faster, with last bits of their own.
    pub(crate) fn net_for_tables(&self, patch: usize, levels: usize) -> Net {
        self.net_by(patch, levels, |table, points| table.all_level_points(levels, points))
    }

    fn net_by(
        &self,
        patch: usize,
        levels: usize,
        quads: impl Fn(&ClassTable, &[DVec3]) -> Vec<[DVec3; WINDOW_POINTS]>,
    ) -> Net {
        let triangles = self.has_triangles();
        let Some(class) = self.class(patch) else {
            return if triangles {
                Net::Triangle(self.triangle_net(patch))
            } else {
                Net::Regular(self.regular_net(patch))
            };
        };
        let table = &self.tables[class];
        if let Some(mut wedge) = self.wedge(patch) {
            let (limit, lambda) = (wedge.limit(), table.lambda);
            return match triangles {
                true => {
                    Net::IrregularTriangle { limit, lambda, levels: (0..levels).map(|_| wedge.descend()).collect() }
                }
                false => Net::Irregular { limit, lambda, levels: (0..levels).map(|_| wedge.descend()).collect() },
            };
        }
        let (points, limit) = self.irregular_net(patch, table);
        if triangles {
            let levels = (1..=levels).map(|level| table.loop_level_points(level, &points)).collect();
            return Net::IrregularTriangle { limit, lambda: table.lambda, levels };
        }
        Net::Irregular { limit, lambda: table.lambda, levels: quads(table, &points) }
    }
}

/// A weighted sum of points.
pub(super) fn combine(weights: &[f64], points: &[DVec3]) -> DVec3 {
    weights.iter().zip(points).map(|(&w, &p)| w * p).sum()
}
