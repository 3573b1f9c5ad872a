//! Errors planted on purpose, to show that the checks catch and locate them.

use super::VerifyError;
use super::key::Against;
use super::rounding::Rounding;
use crate::mesh::SubdivMesh;
use crate::osd::INFINITE_SHARPNESS;
use crate::stam::LimitSurface;
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// An error in our evaluation; the references keep the true mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plant {
    /// One control point of one patch's table is off by 1e-6 of the diagonal, on the GPU too.
    Point {
        /// The patch.
        patch: usize,
        /// Which of its control points: a corner by default, the extraordinary one if it has one.
        point: Option<usize>,
    },
    /// A crease follows a wrong rule: an infinitely sharp one is smooth, another one is sharper by a level.
    Crease(usize),
    /// u and v are swapped when f64 is evaluated.
    Swap,
    /// A reference evaluator reads out of bounds, and its process ends.
    Crash(Crash),
}

/// A reference evaluator whose process can be made to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crash {
    /// `PrimvarRefiner::Limit`.
    LimitMasks,
    /// `Far::LimitStencilTable`.
    LimitStencils,
    /// `Far::PatchTable`.
    Far,
    /// Bfr's surfaces.
    Bfr,
}

impl Crash {
    const ALL: [(&'static str, Self, Against); 4] = [
        ("masks", Self::LimitMasks, Against::LimitMasks),
        ("stencils", Self::LimitStencils, Against::LimitStencils),
        ("far", Self::Far, Against::Far),
        ("bfr", Self::Bfr, Against::Bfr),
    ];
}

/// What a planted point is off by, of the diagonal.
const OFFSET: f64 = 1e-6;

impl Plant {
    /// The reference that is to crash.
    pub(super) fn crash(self) -> Option<Against> {
        let Self::Crash(crash) = self else { return None };
        Crash::ALL.into_iter().find(|&(_, other, _)| other == crash).map(|(.., against)| against)
    }

    /// The mesh that our evaluation is made to see.
    pub(super) fn mesh(self, mesh: &SubdivMesh) -> Result<SubdivMesh, VerifyError> {
        let mut mesh = mesh.clone();
        if let Self::Crease(index) = self {
            let count = mesh.creases.len();
            let missing = VerifyError::Plant { what: "crease", index, count };
            let sharpness = &mut mesh.creases.get_mut(index).ok_or(missing)?.sharpness;
            *sharpness = match *sharpness {
                sharp if sharp >= INFINITE_SHARPNESS => 0.0,
                sharp if sharp + 1.0 >= INFINITE_SHARPNESS => sharp - 1.0,
                sharp => sharp + 1.0,
            };
        }
        Ok(mesh)
    }

    /// The surface that our evaluation is made to use, from that of [`mesh`](Self::mesh); with `offset` 0 the same topology and
    /// no error.
    fn moved(self, surface: LimitSurface, offset: DVec3) -> Result<LimitSurface, VerifyError> {
        let Self::Point { patch, point } = self else { return Ok(surface) };
        let count = surface.patches().len();
        if patch >= count {
            return Err(VerifyError::Plant { what: "patch", index: patch, count });
        }
        // Point 5 of a regular net is a corner of its patch, never a phantom; point 0 of a ring is the vertex.
        let point = point.unwrap_or(if surface.class(patch).is_some() { 0 } else { 5 });
        surface.with_point_moved(patch, point, offset).ok_or(VerifyError::Plant {
            what: "control point",
            index: point,
            count: surface.support(patch).len(),
        })
    }

    pub(super) fn surface(self, mesh: &SubdivMesh) -> Result<LimitSurface, VerifyError> {
        let offset = DVec3::splat(OFFSET * Rounding::of(mesh).unit / 3f64.sqrt());
        self.moved(LimitSurface::new(&self.mesh(mesh)?)?, offset)
    }

    /// The surface of [`surface`](Self::surface) over other refined points, without the offset.
    pub(super) fn linear(self, surface: LimitSurface) -> Result<LimitSurface, VerifyError> {
        self.moved(surface, DVec3::ZERO)
    }
}

impl FromStr for Plant {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let usage = || "give point[:PATCH[:POINT]], crease[:N], swap or crash:masks|stencils|far|bfr".to_owned();
        if let Some(name) = text.strip_prefix("crash:") {
            let crash = Crash::ALL.into_iter().find(|&(known, ..)| known == name);
            return crash.map(|(_, crash, _)| Self::Crash(crash)).ok_or_else(usage);
        }
        let mut words = text.split(':');
        let name = words.next().unwrap_or_default();
        let numbers: Vec<usize> = words.map(|word| word.parse().map_err(|_| usage())).collect::<Result<_, _>>()?;
        match (name, &numbers[..]) {
            ("point", []) => Ok(Self::Point { patch: 0, point: None }),
            ("point", &[patch]) => Ok(Self::Point { patch, point: None }),
            ("point", &[patch, point]) => Ok(Self::Point { patch, point: Some(point) }),
            ("crease", []) => Ok(Self::Crease(0)),
            ("crease", &[crease]) => Ok(Self::Crease(crease)),
            ("swap", []) => Ok(Self::Swap),
            _ => Err(usage()),
        }
    }
}

impl fmt::Display for Plant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Point { patch, point: None } => write!(f, "point:{patch}"),
            Self::Point { patch, point: Some(point) } => write!(f, "point:{patch}:{point}"),
            Self::Crease(crease) => write!(f, "crease:{crease}"),
            Self::Swap => write!(f, "swap"),
            Self::Crash(crash) => {
                let name = Crash::ALL.into_iter().find(|(_, other, _)| other == crash).map_or("", |(name, ..)| name);
                write!(f, "crash:{name}")
            }
        }
    }
}
