//! Where a surface breaks, and how badly: along creases, between patches, round extraordinary vertices.
//!
//! Theory: a surface engineer asks of a joint how large its gap is (G0), the angle between the tangent planes (G1), and how
//! much the curvature across it differs (G2). Lines that are mirrored show each break one order lower: an angle makes them
//! jump, a difference in curvature gives them a kink (Beier & Chen 1994, Property 2; Ulmet 2003, section 6). Catmull-Clark surfaces
//! are C2 but along infinitely sharp edges and at extraordinary vertices, where curvature has no limit in general: it depends on
//! the direction, and for valences above 4 it grows without bound (Doo & Sabin 1978; Peters & Reif 2008).
//!
//! Boundaries that lie on or near each other are joints too, which topology does not know ([`FeatureKind::Seam`]).
//!
//! Practice: [`Quality::measure`] evaluates both sides of every joint of a [`LimitSurface`] and rings round its vertices; [`Quality::ranked`] lists it.
//! [`Continuity`] and [`LineBreak`] compare two jets, wherever they come from. docs/QUALITY.md has the definitions.

mod boundary;
mod chain;
mod continuity;
mod control;
mod feature;
mod finding;
mod form;
mod joint;
mod limits;
mod line_break;
mod ranking;
mod seam;
mod sheets;
mod slope;
mod vertex;

pub use chain::Chain;
pub use continuity::Continuity;
pub use control::{Line, Spot};
pub use feature::{Feature, FeatureKind};
pub use finding::{Extremes, Finding};
pub use form::Form;
pub use joint::Piece;
pub use limits::{Break, Limits, WELD};
pub use line_break::LineBreak;
pub use ranking::{Kind, Ranked, Subject};
pub use seam::{Nearby, Unwelded};
pub use vertex::{RINGS, Ring, Vertex, Wedge, rings};

use crate::field::{Camera, Field};
use crate::mesh::SubdivMesh;
use crate::stam::LimitSurface;
use boundary::Boundary;
use control::Control;
use joint::{Gauge, Tally};
use seam::Seams;

/// A field as a camera sees it: the lines that breaks of the surface break.
#[derive(Debug, Clone, Copy)]
pub struct Reading<'a> {
    /// What is read.
    pub field: &'a Field,
    /// From where.
    pub camera: &'a Camera,
}

/// All that was measured of a surface.
#[derive(Debug, Clone)]
pub struct Quality {
    /// Creases, infinitely sharp ones first, then semi-sharp ones; then smooth lines whose joints exceed the limits; then seams.
    pub features: Vec<Feature>,
    /// All joints inside the smooth surface together. They are C2 but for rounding, which this proves.
    pub smooth: Extremes,
    /// How many these are.
    pub smooth_joints: usize,
    /// Extraordinary vertices.
    pub vertices: Vec<Vertex>,
    /// Where nothing was compared.
    pub unjudged: Unjudged,
    /// How far apart boundaries were taken as a seam, model units.
    pub weld: f64,
    /// Control vertices on boundaries that lie on others within that distance.
    pub unwelded: Option<Unwelded>,
    /// A boundary that lies beside another one, a little farther away than that.
    pub nearby: Option<Nearby>,
}

/// Where faces of the control mesh meet, but nothing was compared. Edges have the lower vertex first; holes do not count as faces.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Unjudged {
    /// Edges that several faces share, of which at most one has a surface: the boundary rule is none.
    pub edges_without_surface: Vec<[u32; 2]>,
    /// Edges that several faces with a surface share, but not as a manifold: three or more of them. Two that run along it in the same
    /// direction are a seam; they are here where seams are not looked for.
    pub nonmanifold_edges: Vec<[u32; 2]>,
    /// Vertices at which sheets meet that share no edge there, and of which several have a surface.
    pub nonmanifold_vertices: Vec<u32>,
}

impl Quality {
    /// Measures a surface. `mesh`: the control mesh that it was made of; `reading`: the field whose lines are looked at.
    pub fn measure(
        mesh: &SubdivMesh,
        surface: &LimitSurface,
        reading: Option<Reading<'_>>,
        limits: &Limits,
    ) -> Quality {
        let control = Control::new(mesh);
        let adjacency = surface.adjacency();
        let coordinate = mesh.points.iter().fold(0.0f64, |most, p| most.max(p.abs().max_element()));
        let gauge = Gauge { surface, control: &control, limits, reading, coordinate };
        let Tally { smooth, smooth_pieces, pieces, mut edges } = gauge.tally(&adjacency);
        let boundary = Boundary::new(surface, &control, &adjacency);
        let weld = limits.weld.unwrap_or(WELD * surface.diagonal());
        let seams = Seams::new(&gauge, &boundary, weld);
        edges.extend(seams.edges);
        edges.sort_unstable();
        let mut features = feature::features(&control, &pieces);
        features.extend(seams.features);
        Quality {
            features,
            smooth,
            smooth_joints: smooth_pieces,
            vertices: vertex::vertices(surface, &control, &adjacency, reading, coordinate),
            unjudged: control.unjudged(surface, &edges),
            weld,
            unwelded: seams.unwelded,
            nearby: seams.nearby,
        }
    }
}
