//! The patches of a `Far::PatchTable`, copied out.

use super::raw;
use glam::DVec3;
use std::fmt;

/// How deep OpenSubdiv refines round features before end caps take over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Isolation {
    /// Levels round sharp edges and vertices, 1 to [`MAX_ISOLATION`](super::MAX_ISOLATION).
    pub sharp: u32,
    /// Levels round all else, 1 to [`sharp`](Self::sharp).
    pub smooth: u32,
}

impl Isolation {
    /// OpenSubdiv's own choice (`Bfr::SurfaceFactory::Options`): smooth features to level 2, sharp ones to 6.
    pub const DEFAULT: Isolation = Isolation { sharp: 6, smooth: 2 };

    /// All features to the same level.
    pub fn uniform(level: u32) -> Isolation {
        Isolation { sharp: level, smooth: level }
    }
}

impl fmt::Display for Isolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.sharp == self.smooth {
            true => write!(f, "{}", self.sharp),
            false => write!(f, "{}/{}", self.smooth, self.sharp),
        }
    }
}

/// What stands for the surface where refinement ends at a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EndCap {
    /// Gregory patches (`ENDCAP_GREGORY_BASIS`), OpenSubdiv's most exact.
    #[default]
    Gregory,
    /// Bicubic B-splines that ignore the extraordinary vertex (`ENDCAP_BSPLINE_BASIS`).
    BSpline,
    /// Bilinear quads (`ENDCAP_BILINEAR_BASIS`).
    Bilinear,
}

impl fmt::Display for EndCap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Gregory => "gregory",
            Self::BSpline => "bspline",
            Self::Bilinear => "bilinear",
        })
    }
}

/// How a patch table is made. By default it is exact where it can be; the flags are what OpenSubdiv's users have by default or can ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FarOptions {
    /// How deep it is refined.
    pub isolation: Isolation,
    /// What stands where refinement ends.
    pub end_cap: EndCap,
    /// Infinitely sharp creases are refined like extraordinary vertices, and smoothed where that ends (`useInfSharpPatch = false`, the
    /// library's default).
    pub smoothed_creases: bool,
    /// Smooth corners of boundaries are sharp (`generateLegacySharpCornerPatches = true`, the library's default).
    pub legacy_corners: bool,
    /// Faces along semi-sharp creases are single patches (`useSingleCreasePatch = true`), which the library evaluates as if they had no
    /// crease: their sharpness is for its shaders alone.
    pub single_crease: bool,
}

impl FarOptions {
    /// Exact where it can be: infinitely sharp patches on, legacy corners and single-crease patches off.
    pub fn exact(isolation: Isolation, end_cap: EndCap) -> Self {
        Self { isolation, end_cap, smoothed_creases: false, legacy_corners: false, single_crease: false }
    }
}

/// Control points of a patch.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "most patches are splines; a box each would cost more than it saves")]
pub enum FarNet {
    /// A uniform bicubic B-spline, u fastest, phantom points included.
    BSpline([DVec3; 16]),
    /// For each corner from (0,0) counter-clockwise: P, e+, e-, f+, f-.
    Gregory(Box<[DVec3; 20]>),
}

impl FarNet {
    /// All control points.
    pub fn points(&self) -> &[DVec3] {
        match self {
            Self::BSpline(points) => points,
            Self::Gregory(points) => points.as_slice(),
        }
    }
}

/// A patch of OpenSubdiv's feature-adaptive refinement.
#[derive(Debug, Clone, PartialEq)]
pub struct FarPatch {
    /// Ptex face.
    pub ptex: u32,
    /// (u,v) of its first corner in the ptex face.
    pub origin: [f64; 2],
    /// Its side is 2^-depth of the ptex face.
    pub depth: u8,
    /// Refinement level of its face in the control mesh.
    pub level: u8,
    /// Bit i: smaller patches lie beyond edge i (v = 0, u = 1, v = 1, u = 0).
    pub transition: u8,
    /// It approximates the limit.
    pub is_end_cap: bool,
    /// Its control points.
    pub net: FarNet,
}

impl FarPatch {
    /// From a record of the C interface and as many points as it says: 4, 16 or 20.
    pub(super) fn new(record: &raw::osd_far_patch, points: &[DVec3]) -> FarPatch {
        let net = match points {
            points if points.len() == 20 => FarNet::Gregory(Box::new(std::array::from_fn(|k| points[k]))),
            // A bilinear quad is the spline whose phantom points lie beyond all four edges.
            &[a, b, c, d] => {
                let mut net = [DVec3::ZERO; 16];
                [net[5], net[6], net[10], net[9]] = [a, b, c, d];
                extrapolate(&mut net, 0b1111);
                FarNet::BSpline(net)
            }
            points => {
                let mut net = std::array::from_fn(|k| points[k]);
                extrapolate(&mut net, record.boundary);
                FarNet::BSpline(net)
            }
        };
        FarPatch {
            ptex: record.face as u32,
            origin: record.origin,
            depth: record.depth,
            level: record.level,
            transition: record.transition,
            is_end_cap: record.end_cap != 0,
            net,
        }
    }

    /// Parameters of the ptex face at those of the patch.
    pub fn to_ptex(&self, uv: [f64; 2]) -> [f64; 2] {
        let side = 0.5f64.powi(i32::from(self.depth));
        [0, 1].map(|k| self.origin[k] + side * uv[k])
    }
}

/// Puts the phantom points 2a - b beyond the edges that `boundary` says.
fn extrapolate(net: &mut [DVec3; 16], boundary: u8) {
    // Of each edge: its first point, its first neighbour inwards, and the step along it.
    const EDGES: [[usize; 3]; 4] = [[0, 4, 1], [3, 2, 4], [12, 8, 1], [0, 1, 4]];
    for (edge, [first, inner, step]) in EDGES.into_iter().enumerate() {
        if boundary >> edge & 1 == 1 {
            for k in 0..4 {
                let (a, inwards) = (inner + k * step, inner.wrapping_sub(first));
                net[first + k * step] = 2.0 * net[a] - net[a.wrapping_add(inwards)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Phantom points continue a plane, whatever stood in their place.
    #[test]
    fn phantom_points_continue_the_surface() {
        let plane: [DVec3; 16] = std::array::from_fn(|k| DVec3::new((k % 4) as f64, (k / 4) as f64, 0.0));
        for boundary in 0..16u8 {
            let beyond = |k: usize| {
                let edges = [k < 4, k % 4 == 3, k >= 12, k.is_multiple_of(4)];
                (0..4).any(|edge| boundary >> edge & 1 == 1 && edges[edge])
            };
            let mut net: [DVec3; 16] = std::array::from_fn(|k| if beyond(k) { DVec3::NAN } else { plane[k] });
            extrapolate(&mut net, boundary);
            assert_eq!(net, plane, "{boundary:04b}");
        }
    }
}
