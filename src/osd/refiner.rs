//! Topology refinement.

use super::{Descriptor, Error, INFINITE_SHARPNESS, MAX_ISOLATION, check, int, raw};
use crate::mesh::SubdivMesh;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::ptr::NonNull;

/// A vertex rule (`Sdc::Crease::Rule`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Rule {
    /// No sharp edge.
    Smooth,
    /// One sharp edge.
    Dart,
    /// Two sharp edges.
    Crease,
    /// A sharp vertex, or three and more sharp edges.
    Corner,
}

impl Rule {
    fn from_raw(rule: u8) -> Self {
        match raw::osd_rule::from(rule) {
            raw::OSD_RULE_SMOOTH => Self::Smooth,
            raw::OSD_RULE_DART => Self::Dart,
            raw::OSD_RULE_CREASE => Self::Crease,
            _ => Self::Corner, // `unknown` is what OpenSubdiv calls non-manifold vertices: it treats them as corners
        }
    }
}

/// One level of refined topology, copied out of OpenSubdiv. Indices are local to the level.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Level {
    /// Face f has the corners `face_offsets[f] .. face_offsets[f+1]` of the four arrays below.
    pub face_offsets: Vec<i32>,
    /// Vertex at each corner.
    pub face_vertices: Vec<i32>,
    /// Edge from each corner to the next.
    pub face_edges: Vec<i32>,
    /// Child face at each corner, -1 where there is none.
    pub face_children: Vec<i32>,
    /// Child of each face that has none of its vertices (Loop's scheme), -1 where there is none.
    pub face_middles: Vec<i32>,
    /// 1 for faces without a limit surface.
    pub face_holes: Vec<u8>,
    /// The faces of each edge: the second is -1 on a boundary, both are -2 where the edge is not manifold.
    pub edge_faces: Vec<[i32; 2]>,
    /// Sharpness of each edge, 0 to 10 (infinite).
    pub edge_sharpness: Vec<f32>,
    /// Sharpness of each vertex, 0 to 10 (infinite).
    pub vertex_sharpness: Vec<f32>,
    /// Rule of each vertex.
    pub vertex_rules: Vec<Rule>,
    /// Child vertex of each vertex in the next level.
    pub vertex_children: Vec<i32>,
    /// Face of each corner.
    pub corner_faces: Vec<u32>,
    /// For the edge from each corner to the next, the corner from which the face across runs along it, the other way;
    /// [`NO_TWIN`] where there is none: at boundaries, and where edges are not manifold or faces are turned against each other.
    pub twins: Vec<u32>,
    /// All faces are quads, as in all refined levels of Catmull and Clark's scheme: corners are then numbered four a face.
    quads: bool,
}

/// No face lies across.
pub const NO_TWIN: u32 = u32::MAX;

impl Level {
    /// Fills `corner_faces`, `twins` and `quads`.
    fn link(&mut self) {
        self.quads = self.face_offsets.windows(2).all(|ends| ends[1] - ends[0] == 4);
        let corners = self.face_vertices.len();
        self.corner_faces = Vec::with_capacity(corners);
        for (face, ends) in self.face_offsets.windows(2).enumerate() {
            self.corner_faces.resize(ends[1] as usize, face as u32);
        }
        self.twins = vec![NO_TWIN; corners];
        let mut first = vec![NO_TWIN; self.edge_faces.len()];
        for corner in 0..corners {
            let edge = self.face_edges[corner] as usize;
            if self.edge_faces[edge][1] < 0 {
                continue;
            }
            let other = std::mem::replace(&mut first[edge], corner as u32);
            if other == NO_TWIN {
                continue;
            }
            let ends = |corner: usize| [corner, self.next(corner)].map(|corner| self.face_vertices[corner]);
            let ([a, b], [c, d]) = (ends(corner), ends(other as usize));
            if a == d && b == c {
                self.twins[corner] = other;
                self.twins[other as usize] = corner as u32;
            }
        }
    }

    /// The next corner of the same face.
    pub fn next(&self, corner: usize) -> usize {
        if self.quads {
            return corner & !3 | (corner + 1) & 3;
        }
        let face = self.corner_faces[corner] as usize;
        if corner + 1 == self.face_offsets[face + 1] as usize { self.face_offsets[face] as usize } else { corner + 1 }
    }

    /// The corner before it in the same face.
    pub fn previous(&self, corner: usize) -> usize {
        if self.quads {
            return corner & !3 | corner.wrapping_sub(1) & 3;
        }
        let face = self.corner_faces[corner] as usize;
        let [start, end] = [self.face_offsets[face], self.face_offsets[face + 1]];
        (if corner == start as usize { end as usize } else { corner }) - 1
    }

    /// Whether the face of a corner is a quad.
    pub fn is_quad(&self, corner: usize) -> bool {
        self.quads || self.corners(self.corner_faces[corner] as usize).len() == 4
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.face_holes.len()
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_sharpness.len()
    }

    /// Corners of a face: a range of the per-corner arrays.
    pub fn corners(&self, face: usize) -> std::ops::Range<usize> {
        self.face_offsets[face] as usize..self.face_offsets[face + 1] as usize
    }

    /// The edges of a face in order: the vertex where each begins, the next vertex, and the edge itself.
    pub fn edges_of_face(&self, face: usize) -> impl Iterator<Item = [usize; 3]> + use<'_> {
        let corners = self.corners(face);
        corners.clone().map(move |i| {
            let next = if i + 1 == corners.end { corners.start } else { i + 1 };
            [self.face_vertices[i], self.face_vertices[next], self.face_edges[i]].map(|index| index as usize)
        })
    }

    /// For each vertex, whether its rules still change: finite sharpness on it or on an edge of it.
    pub fn restless(&self) -> Vec<bool> {
        let finite = |sharpness: f32| sharpness > 0.0 && sharpness < INFINITE_SHARPNESS;
        let mut restless: Vec<bool> = self.vertex_sharpness.iter().map(|&s| finite(s)).collect();
        for [vertex, next, edge] in (0..self.face_count()).flat_map(|face| self.edges_of_face(face)) {
            if finite(self.edge_sharpness[edge]) {
                restless[vertex] = true;
                restless[next] = true;
            }
        }
        restless
    }
}

/// Owner of a `Far::TopologyRefiner`.
///
/// It may move to another thread, but not be shared: OpenSubdiv makes no promise about concurrent reads.
/// ```compile_fail
/// fn shared<T: Sync>() {}
/// shared::<catoptric::osd::Refiner>();
/// ```
/// It is released once, so it cannot be copied.
/// ```compile_fail
/// fn copied<T: Clone>() {}
/// copied::<catoptric::osd::Refiner>();
/// ```
#[derive(Debug)]
pub struct Refiner {
    handle: NonNull<raw::osd_refiner>,
    vertex_counts: Vec<usize>,
}

// SAFETY: the handle is the only reference to the C++ object and the object has no thread affinity.
unsafe impl Send for Refiner {}

impl Drop for Refiner {
    fn drop(&mut self) {
        // SAFETY: the handle came from osd_refiner_create and is released here alone.
        unsafe { raw::osd_refiner_destroy(self.handle.as_ptr()) }
    }
}

impl Refiner {
    /// Refines round every feature: semi-sharp ones to `isolation`, all others to `secondary` levels. With
    /// `single_crease`, faces along a regular crease of constant sharpness stay whole.
    ///
    /// # Errors
    /// The mesh is not valid, `isolation` is not in 1..=10, or OpenSubdiv reports an error.
    pub fn adaptive(mesh: &SubdivMesh, isolation: u32, secondary: u32, single_crease: bool) -> Result<Self, Error> {
        Self::check_level(isolation, 1)?;
        Self::check_level(secondary, 0)?;
        // SAFETY: the handle is live for the call.
        Self::new(mesh, |handle| unsafe {
            raw::osd_refiner_refine_adaptive(handle, isolation as i32, secondary as i32, i32::from(single_crease))
        })
    }

    /// Refines every face to `level`.
    ///
    /// # Errors
    /// The mesh is not valid, `level` is not in 1..=10, or OpenSubdiv reports an error.
    pub fn uniform(mesh: &SubdivMesh, level: u32) -> Result<Self, Error> {
        Self::check_level(level, 1)?;
        // SAFETY: the handle is live for the call.
        Self::new(mesh, |handle| unsafe { raw::osd_refiner_refine_uniform(handle, level as i32) })
    }

    fn check_level(level: u32, least: u32) -> Result<(), Error> {
        if (least..=MAX_ISOLATION).contains(&level) {
            return Ok(());
        }
        Err(Error::OpenSubdiv(format!(
            "refinement level {level} is outside {least} to {MAX_ISOLATION} (3.5.0 corrupts memory above it)"
        )))
    }

    fn new(mesh: &SubdivMesh, refine: impl FnOnce(*mut raw::osd_refiner) -> raw::osd_status) -> Result<Self, Error> {
        let descriptor = Descriptor::new(mesh)?;
        let mut handle = std::ptr::null_mut();
        // SAFETY: the descriptor outlives the call, which copies it; its indices are validated.
        check(unsafe { raw::osd_refiner_create(&descriptor.as_raw(), &mut handle) })?;
        let handle = NonNull::new(handle).expect("a refiner comes with status OK");
        let mut refiner = Self { handle, vertex_counts: Vec::new() };
        check(refine(handle.as_ptr()))?;
        let mut levels = 0;
        // SAFETY: the handle is live and the output is a local.
        check(unsafe { raw::osd_refiner_level_count(handle.as_ptr(), &mut levels) })?;
        for level in 0..levels {
            refiner.vertex_counts.push(refiner.sizes(level)?.vertices as usize);
        }
        Ok(refiner)
    }

    fn sizes(&self, level: i32) -> Result<raw::osd_level_sizes, Error> {
        let mut sizes = raw::osd_level_sizes::default();
        // SAFETY: the handle is live; the callee checks the level.
        check(unsafe { raw::osd_refiner_level_sizes(self.handle.as_ptr(), level, &mut sizes) })?;
        Ok(sizes)
    }

    /// Number of levels, the control mesh included.
    pub fn level_count(&self) -> usize {
        self.vertex_counts.len()
    }

    /// Number of vertices of each level.
    pub fn vertex_counts(&self) -> &[usize] {
        &self.vertex_counts
    }

    /// Copies the topology of a level.
    ///
    /// # Errors
    /// `level` is not below [`level_count`](Self::level_count).
    pub fn level(&self, level: usize) -> Result<Level, Error> {
        let index = int(level, "level")?;
        let sizes = self.sizes(index)?;
        let [vertices, edges, faces, corners] =
            [sizes.vertices, sizes.edges, sizes.faces, sizes.face_vertices].map(|n| n as usize);
        let mut out = Level {
            face_offsets: vec![0; faces + 1],
            face_vertices: vec![0; corners],
            face_edges: vec![0; corners],
            face_children: vec![0; corners],
            face_middles: vec![0; faces],
            face_holes: vec![0; faces],
            edge_faces: vec![[0; 2]; edges],
            edge_sharpness: vec![0.0; edges],
            vertex_sharpness: vec![0.0; vertices],
            vertex_rules: Vec::new(),
            vertex_children: vec![0; vertices],
            corner_faces: Vec::new(),
            twins: Vec::new(),
            quads: false,
        };
        let mut rules = vec![0u8; vertices];
        let arrays = raw::osd_level_arrays {
            face_offsets: out.face_offsets.as_mut_ptr(),
            face_vertices: out.face_vertices.as_mut_ptr(),
            face_edges: out.face_edges.as_mut_ptr(),
            face_children: out.face_children.as_mut_ptr(),
            face_middles: out.face_middles.as_mut_ptr(),
            face_holes: out.face_holes.as_mut_ptr(),
            edge_faces: out.edge_faces.as_mut_ptr().cast(),
            edge_sharpness: out.edge_sharpness.as_mut_ptr(),
            vertex_sharpness: out.vertex_sharpness.as_mut_ptr(),
            vertex_rules: rules.as_mut_ptr(),
            vertex_children: out.vertex_children.as_mut_ptr(),
        };
        // SAFETY: every array has the size that ffi/osd.h states for it.
        check(unsafe { raw::osd_refiner_level(self.handle.as_ptr(), index, &arrays) })?;
        out.vertex_rules = rules.into_iter().map(Rule::from_raw).collect();
        out.link();
        Ok(out)
    }

    /// Refined points of all levels, level 0 (a copy of `points`) first.
    ///
    /// # Errors
    /// OpenSubdiv reports an error.
    ///
    /// # Panics
    /// `points` is not one point for each vertex of level 0.
    pub fn interpolate(&self, points: &[DVec3]) -> Result<Vec<DVec3>, Error> {
        assert_eq!(points.len(), self.vertex_counts[0], "one point a control vertex");
        let mut out = vec![DVec3::ZERO; self.vertex_counts.iter().sum()];
        let source: &[f64] = bytemuck::cast_slice(points);
        let target: &mut [f64] = bytemuck::cast_slice_mut(&mut out);
        // SAFETY: source holds level 0 and target all levels, as the header asks.
        check(unsafe { raw::osd_refiner_interpolate(self.handle.as_ptr(), source.as_ptr(), target.as_mut_ptr()) })?;
        Ok(out)
    }

    /// Limit position and two tangents of each vertex of the last level by `PrimvarRefiner::Limit`, after
    /// [`uniform`](Self::uniform).
    ///
    /// Positions are exact for smooth, crease and boundary vertices without finite sharpness, wrong for infinitely sharp
    /// darts and interior vertices of valence 2 (3.5.0). Tangents are exact for smooth vertices only.
    ///
    /// # Errors
    /// The refinement is adaptive, or OpenSubdiv reports an error.
    ///
    /// # Panics
    /// `points` is not one point for each vertex of the last level.
    pub fn limit(&self, points: &[DVec3]) -> Result<LimitMasks, Error> {
        assert_eq!(Some(&points.len()), self.vertex_counts.last(), "one point a vertex of the last level");
        let mut out = [(); 3].map(|()| vec![DVec3::ZERO; points.len()]);
        let source: &[f64] = bytemuck::cast_slice(points);
        let [positions, first, second] = out.each_mut().map(|x| bytemuck::cast_slice_mut::<DVec3, f64>(x).as_mut_ptr());
        let mut crowded = 0;
        // SAFETY: all four arrays hold the last level, as the header asks; the count is a local.
        check(unsafe {
            raw::osd_refiner_limit(self.handle.as_ptr(), source.as_ptr(), positions, first, second, &mut crowded)
        })?;
        if crowded > 0 {
            return Ok(LimitMasks::NotAsked { crowded: crowded as usize });
        }
        let [positions, first, second] = out;
        Ok(LimitMasks::Answered { positions, tangents: [first, second] })
    }
}

/// What OpenSubdiv's limit masks make of the vertices of a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum LimitMasks {
    /// The limit of each vertex, and two tangents.
    Answered {
        /// Limit positions.
        positions: Vec<DVec3>,
        /// Two tangents of each.
        tangents: [Vec<DVec3>; 2],
    },
    /// OpenSubdiv was not asked, because it would write beyond its arrays: at vertices that are not manifold and have many more
    /// faces than edges, such as the middle of an edge of 11 faces.
    NotAsked {
        /// How many such vertices there are.
        crowded: usize,
    },
}
