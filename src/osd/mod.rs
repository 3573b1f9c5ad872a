//! OpenSubdiv (3.5.0 up to below 4.0) through `ffi/osd.h`: topology refinement ([`Refiner`]) and the regression references
//! ([`LimitStencils`], [`Far`], [`Bfr`]), and what benchmarks hold us against ([`BfrPeer`], [`OsdPeer`]). The only `unsafe` of the crate lives here.
//!
//! Each C++ object has one owner that releases it once. OpenSubdiv validates almost nothing, so every mesh passes
//! [`SubdivMesh::validate`](crate::mesh::SubdivMesh::validate) on its way in.
#![allow(unsafe_code)] // the one room where the crate's `deny` is lifted

#[cfg(feature = "peers")]
mod embree;
mod patches;
mod peers;
mod process;
mod raw;
mod reference;
mod refiner;
mod stencils;
mod version;

#[cfg(feature = "peers")]
pub use embree::{EmbreeCamera, EmbreeSamples, EmbreeSubdivision, EmbreeTriangles};
pub use patches::{EndCap, FarNet, FarOptions, FarPatch, Isolation};
pub use peers::{BfrPeer, OsdPeer, PeerSamples};
pub use process::{Allocator, name_fatal_signals, on_out_of_memory, share_one_arena, stdout_was_closed};
pub use reference::{Answer, Bfr, Far, Location, Reference, ReferenceJet};
pub use refiner::{Level, LimitMasks, NO_TWIN, Refiner, Rule};
pub use stencils::{LimitStencils, Stencil};
pub use version::{Version, version};

use crate::mesh::{Boundary, Creasing, MeshError, Scheme, SubdivMesh, TriangleRule};
use std::ffi::CStr;

/// Deepest isolation of OpenSubdiv (3.5.0 to 3.6.0): beyond it, patches are silently wrong or memory is corrupted.
pub const MAX_ISOLATION: u32 = 10;

/// Sharpness from which an edge or vertex is infinitely sharp (`Sdc::Crease::SHARPNESS_INFINITE`).
pub const INFINITE_SHARPNESS: f32 = 10.0;

/// Why there is no refined topology or no reference evaluator.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The mesh cannot be handed to OpenSubdiv.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// OpenSubdiv reported an error or threw an exception.
    #[error("OpenSubdiv: {0}")]
    OpenSubdiv(String),
}

/// Turns the status of a call made on this thread into a `Result`.
fn check(status: raw::osd_status) -> Result<(), Error> {
    if status == raw::OSD_OK {
        return Ok(());
    }
    // SAFETY: osd_message returns a C string that lives until the next call on this thread.
    let message = unsafe { CStr::from_ptr(raw::osd_message()) };
    let message = message.to_string_lossy();
    if message.contains("bad_alloc") {
        let limit = crate::memory::limit();
        let at_start = if limit.bytes == u64::MAX { String::new() } else { format!("; at the start {limit}") };
        return Err(Error::OpenSubdiv(format!("out of memory{at_start}")));
    }
    Err(Error::OpenSubdiv(message.trim().replace('\n', " ")))
}

/// A count or index as the C interface takes it.
fn int(n: usize, what: &str) -> Result<i32, Error> {
    i32::try_from(n).map_err(|_| Error::OpenSubdiv(format!("{what} out of range: {n}")))
}

/// A validated mesh, whose counts and indices fit 32 bits, in the layout of `osd_mesh`.
struct Descriptor {
    face_sizes: Vec<i32>,
    face_vertices: Vec<i32>,
    crease_vertices: Vec<i32>,
    crease_sharpness: Vec<f32>,
    corner_vertices: Vec<i32>,
    corner_sharpness: Vec<f32>,
    holes: Vec<i32>,
    points: Vec<f64>,
    scheme: raw::osd_scheme,
    boundary: raw::osd_boundary,
    creasing: raw::osd_creasing,
    triangles: raw::osd_triangles,
}

impl Descriptor {
    fn new(mesh: &SubdivMesh) -> Result<Self, Error> {
        mesh.validate()?;
        let signed = |indices: &[u32]| indices.iter().map(|&i| i as i32).collect();
        Ok(Self {
            face_sizes: signed(&mesh.face_sizes),
            face_vertices: signed(&mesh.face_vertices),
            crease_vertices: mesh.creases.iter().flat_map(|c| c.vertices.map(|v| v as i32)).collect(),
            crease_sharpness: mesh.creases.iter().map(|c| c.sharpness).collect(),
            corner_vertices: mesh.corners.iter().map(|c| c.vertex as i32).collect(),
            corner_sharpness: mesh.corners.iter().map(|c| c.sharpness).collect(),
            holes: signed(&mesh.holes),
            points: mesh.points.iter().flat_map(|p| p.to_array()).collect(),
            scheme: match mesh.scheme {
                Scheme::CatmullClark => raw::OSD_SCHEME_CATMULL_CLARK,
                Scheme::Loop => raw::OSD_SCHEME_LOOP,
                Scheme::Bilinear | Scheme::None => raw::OSD_SCHEME_BILINEAR,
            },
            boundary: match mesh.boundary {
                Boundary::None => raw::OSD_BOUNDARY_NONE,
                Boundary::EdgeOnly => raw::OSD_BOUNDARY_EDGE_ONLY,
                Boundary::EdgeAndCorner => raw::OSD_BOUNDARY_EDGE_AND_CORNER,
            },
            creasing: match mesh.creasing {
                Creasing::Uniform => raw::OSD_CREASING_UNIFORM,
                Creasing::Chaikin => raw::OSD_CREASING_CHAIKIN,
            },
            triangles: match mesh.triangles {
                TriangleRule::CatmullClark => raw::OSD_TRIANGLES_CATMULL_CLARK,
                TriangleRule::Smooth => raw::OSD_TRIANGLES_SMOOTH,
            },
        })
    }

    /// The C view of this mesh; valid while `self` is borrowed.
    fn as_raw(&self) -> raw::osd_mesh {
        raw::osd_mesh {
            vertex_count: (self.points.len() / 3) as i32,
            face_count: self.face_sizes.len() as i32,
            face_sizes: self.face_sizes.as_ptr(),
            face_vertices: self.face_vertices.as_ptr(),
            crease_count: self.crease_sharpness.len() as i32,
            crease_vertices: self.crease_vertices.as_ptr(),
            crease_sharpness: self.crease_sharpness.as_ptr(),
            corner_count: self.corner_sharpness.len() as i32,
            corner_vertices: self.corner_vertices.as_ptr(),
            corner_sharpness: self.corner_sharpness.as_ptr(),
            hole_count: self.holes.len() as i32,
            holes: self.holes.as_ptr(),
            scheme: self.scheme,
            boundary: self.boundary,
            creasing: self.creasing,
            triangles: self.triangles,
        }
    }
}
