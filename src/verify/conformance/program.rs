//! Programs that answers could come from: OpenSubdiv's evaluators at any setting, and facets.

use super::excerpt::Excerpt;
use crate::osd::{
    Answer, Bfr, EndCap, Error, Far, FarOptions, Isolation, Level, Location, MAX_ISOLATION, Reference, Refiner,
};
use crate::stam::LimitSurface;
use glam::DVec3;
use std::fmt;

/// A way to evaluate a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Program {
    /// The limit.
    Exact,
    /// `Far::PatchTable`, and limit stencils that are made of one.
    Far(FarOptions),
    /// `Bfr` with approximation levels for smooth and for sharp features.
    Bfr { smooth: u32, sharp: u32 },
    /// The mesh refined so many times, its faces taken for bilinear; their corners moved to the limit or not.
    Facets { level: u32, at_limit: bool },
}

/// What a program says about a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Said {
    pub position: DVec3,
    /// By the u and v of the ptex face.
    pub derivatives: [DVec3; 2],
    /// Side of the patch that answered, in parameters of the ptex face: rounding shows in derivatives in inverse proportion.
    pub cell: f64,
}

/// What a program can say: about a point it may have no answer, or may not have been asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reply {
    NotAsked,
    NoSurface,
    Said(Said),
}

/// What programs are made of: faces of a mesh and its limit.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub excerpt: &'a Excerpt,
    pub surface: &'a LimitSurface,
}

/// Most refinements of a whole neighbourhood: 1024 faces a face.
const MOST_REFINED: u32 = 5;

impl Program {
    /// OpenSubdiv's evaluators at all settings that can make a difference, in stages: the usual and simple ones first.
    pub fn of_opensubdiv(has_features: bool) -> Vec<Vec<Program>> {
        let levels = 1..=MAX_ISOLATION;
        let tables = |[smoothed_creases, legacy_corners, single_crease]: [bool; 3]| -> Vec<Program> {
            let caps = [EndCap::Gregory, EndCap::BSpline, EndCap::Bilinear];
            let options = caps.into_iter().flat_map(|end_cap| {
                levels.clone().map(move |level| {
                    let isolation = Isolation::uniform(level);
                    FarOptions { isolation, end_cap, smoothed_creases, legacy_corners, single_crease }
                })
            });
            options.map(Program::Far).collect()
        };
        let (smooth, sharp) = Bfr::DEFAULT_LEVELS;
        let mut usual = vec![Program::Exact];
        usual.extend(tables([false; 3]));
        usual.push(Program::Bfr { smooth, sharp });
        usual.extend(levels.clone().map(|level| Program::Bfr { smooth: level, sharp: level }));
        let mut stages = vec![usual];
        if !has_features {
            stages.push(levels.map(|smooth| Program::Bfr { smooth, sharp }).collect());
            return stages;
        }
        let defaults = [[true, false, false], [false, true, false], [true, true, false]];
        stages.push(defaults.into_iter().flat_map(tables).collect());
        // Smooth features less deep than sharp ones (`AdaptiveOptions::secondaryLevel`).
        let pairs = levels.clone().flat_map(|sharp| (1..sharp).map(move |smooth| Isolation { sharp, smooth }));
        let mut other_levels: Vec<Program> =
            pairs.map(|isolation| Program::Far(FarOptions::exact(isolation, EndCap::Gregory))).collect();
        other_levels
            .extend(levels.clone().flat_map(|smooth| levels.clone().map(move |sharp| Program::Bfr { smooth, sharp })));
        stages.push(other_levels);
        let single_crease = [[false, false, true], [true, false, true], [true, true, true]];
        stages.push(single_crease.into_iter().flat_map(tables).collect());
        stages
    }

    /// Facets of all sizes.
    pub fn facets() -> Vec<Program> {
        let at_limit = (0..=MAX_ISOLATION).map(|level| Program::Facets { level, at_limit: true });
        at_limit.chain((0..=MOST_REFINED).map(|level| Program::Facets { level, at_limit: false })).collect()
    }

    /// The same program at another level, where all that it does is said by one.
    pub fn family(self) -> Option<(Program, u32)> {
        match self {
            Program::Far(options) if options.isolation.sharp == options.isolation.smooth => {
                let isolation = Isolation::uniform(1);
                Some((Program::Far(FarOptions { isolation, ..options }), options.isolation.sharp))
            }
            Program::Facets { level, at_limit } => Some((Program::Facets { level: 0, at_limit }, level)),
            _ => None,
        }
    }

    /// What it says at (ptex face, u, v) of the whole mesh; `None`, and faces that the excerpt does not have, have no surface.
    pub fn replies(self, ground: Ground<'_>, places: &[Option<Location>]) -> Result<Vec<Reply>, Error> {
        let Ground { excerpt, surface } = ground;
        // Faces of the whole mesh become those of the excerpt; others have no surface.
        let local = |place: &Option<Location>| place.and_then(|(face, u, v)| Some((excerpt.ptex(face)?, u, v)));
        let asked: Vec<Location> = places.iter().filter_map(local).collect();
        let mut answers = match self {
            Program::Exact => Vec::new(),
            Program::Far(options) => Far::with_options(&excerpt.mesh, options)?.evaluate(&asked)?,
            Program::Bfr { smooth, sharp } => Bfr::new(&excerpt.mesh, (smooth, sharp))?.evaluate(&asked)?,
            Program::Facets { level, at_limit } => {
                let net = if at_limit { None } else { Some(Net::new(excerpt, level)?) };
                let facet = |place: &Option<Location>| {
                    let (face, u, v) = (*place)?;
                    match &net {
                        Some(net) => net.facet((excerpt.ptex(face)?, u, v)),
                        None => facet_at_limit(surface, level, excerpt.is_part(face)?, (face, u, v)),
                    }
                };
                return Ok(places.iter().map(|place| facet(place).map_or(Reply::NoSurface, Reply::Said)).collect());
            }
        }
        .into_iter();
        // Bfr does not say how large the patch is inside its face: features are corners and edges, and patches halve towards them.
        let side = |u: f64, v: f64| match self {
            Program::Bfr { smooth, sharp } => {
                let to_edge = [u, 1.0 - u, v, 1.0 - v].into_iter().fold(1.0, f64::min);
                to_edge.max(0.5f64.powi(smooth.max(sharp) as i32))
            }
            _ => 1.0,
        };
        let reply = |place: &Option<Location>| {
            let Some((face, u, v)) = *place else { return Reply::NoSurface };
            if self == Program::Exact {
                let at_place = ((face as usize) < surface.ptex_count()).then(|| surface.evaluate_ptex(face, [u, v]));
                return at_place.flatten().map_or(Reply::NoSurface, |(patch, jet)| {
                    let [du, dv] = surface.patches()[patch].scale();
                    Reply::Said(Said { position: jet.position, derivatives: [jet.du, jet.dv], cell: 1.0 / du.max(dv) })
                });
            }
            if excerpt.ptex(face).is_none() {
                return Reply::NoSurface;
            }
            match answers.next() {
                None => Reply::NoSurface,
                Some(jet) => match jet.answer {
                    Answer::None => Reply::NoSurface,
                    Answer::NotAsked => Reply::NotAsked,
                    Answer::Regular | Answer::EndCap => Reply::Said(Said {
                        position: jet.position,
                        derivatives: [jet.du, jet.dv],
                        cell: jet.cell.min(if jet.answer == Answer::EndCap { side(u, v) } else { 1.0 }),
                    }),
                },
            }
        };
        Ok(places.iter().map(reply).collect())
    }
}

/// The bilinear face with these corners, counter-clockwise, that is `side` of a ptex face wide.
fn bilinear([a, b, c, d]: [DVec3; 4], [s, t]: [f64; 2], side: f64) -> Said {
    let (along, across) = (a.lerp(b, s), d.lerp(c, s));
    let du = (b - a).lerp(c - d, t) / side;
    let dv = (across - along) / side;
    Said { position: along.lerp(across, t), derivatives: [du, dv], cell: side }
}

/// Which of `cells` a parameter lies in, and where in it.
fn cell_of(x: f64, cells: f64) -> (f64, f64) {
    let first = (x * cells).floor().clamp(0.0, cells - 1.0);
    (first, x * cells - first)
}

/// The facet with corners on the limit. A part of an n-gon is there after one refinement.
fn facet_at_limit(surface: &LimitSurface, level: u32, is_part: bool, (face, u, v): Location) -> Option<Said> {
    if is_part && level == 0 || face as usize >= surface.ptex_count() {
        return None;
    }
    let cells = 2f64.powi(level as i32 - i32::from(is_part));
    let ((i, s), (j, t)) = (cell_of(u, cells), cell_of(v, cells));
    let corner = |di, dj| Some(surface.evaluate_ptex(face, [(i + di) / cells, (j + dj) / cells])?.1.position);
    let corners = [corner(0.0, 0.0)?, corner(1.0, 0.0)?, corner(1.0, 1.0)?, corner(0.0, 1.0)?];
    Some(bilinear(corners, [s, t], 1.0 / cells))
}

/// The refined mesh.
struct Net {
    levels: Vec<Level>,
    /// Those of the last level.
    points: Vec<DVec3>,
    /// Control face of each ptex face, and the corner at which it lies if the face is no quad.
    faces: Vec<(usize, Option<usize>)>,
}

impl Net {
    fn new(excerpt: &Excerpt, level: u32) -> Result<Self, Error> {
        let mesh = &excerpt.mesh;
        let faces = mesh.face_sizes.iter().enumerate().flat_map(|(face, &size)| {
            let parts = if size == 4 { 0..1 } else { 0..size as usize };
            parts.map(move |corner| (face, (size != 4).then_some(corner)))
        });
        let faces = faces.collect();
        if level == 0 {
            let refiner = Refiner::adaptive(mesh, 1, 1, false)?;
            return Ok(Self { levels: vec![refiner.level(0)?], points: mesh.points.clone(), faces });
        }
        let refiner = Refiner::uniform(mesh, level)?;
        let levels = (0..=level as usize).map(|level| refiner.level(level)).collect::<Result<Vec<_>, _>>()?;
        let all = refiner.interpolate(&mesh.points)?;
        let points = all[all.len() - levels.last().map_or(0, Level::vertex_count)..].to_vec();
        Ok(Self { levels, points, faces })
    }

    /// The child at a corner, and which of its own corners is the same vertex.
    fn child(&self, level: usize, corner: usize) -> Option<(usize, usize)> {
        let (parent, below) = (&self.levels[level], self.levels.get(level + 1)?);
        let child = usize::try_from(parent.face_children[corner]).ok()?;
        let vertex = parent.vertex_children[parent.face_vertices[corner] as usize];
        let place = below.corners(child).position(|corner| below.face_vertices[corner] == vertex)?;
        Some((child, place))
    }

    fn facet(&self, (ptex, mut u, mut v): Location) -> Option<Said> {
        let &(mut face, part) = self.faces.get(ptex as usize)?;
        if self.levels[0].face_holes[face] != 0 {
            return None;
        }
        // The corner of the face at which the parameters are (0,0).
        let (mut first, mut level, mut side) = (0, 0, 1.0);
        if let Some(corner) = part {
            (face, first) = self.child(0, self.levels[0].corners(face).start + corner)?;
            level = 1;
        }
        while level + 1 < self.levels.len() {
            let (right, upper) = (u >= 0.5, v >= 0.5);
            let quarter = [[0, 3], [1, 2]][usize::from(right)][usize::from(upper)];
            let (child, place) = self.child(level, self.levels[level].corners(face).start + (first + quarter) % 4)?;
            (u, v) = (2.0 * u - f64::from(u8::from(right)), 2.0 * v - f64::from(u8::from(upper)));
            (face, first) = (child, (place + 4 - quarter) % 4);
            (level, side) = (level + 1, side / 2.0);
        }
        let last = &self.levels[level];
        let start = last.corners(face).start;
        let corners = [0, 1, 2, 3].map(|k| self.points[last.face_vertices[start + (first + k) % 4] as usize]);
        Some(bilinear(corners, [u, v], side))
    }
}

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("the exact limit"),
            Self::Far(FarOptions { isolation, end_cap, smoothed_creases, legacy_corners, single_crease }) => {
                f.write_str("OpenSubdiv's patches (Far) at isolation ")?;
                match isolation.sharp == isolation.smooth {
                    true => write!(f, "{}", isolation.sharp)?,
                    false => write!(f, "{}, {} round smooth features", isolation.sharp, isolation.smooth)?,
                }
                f.write_str(match end_cap {
                    EndCap::Gregory => " with Gregory end caps",
                    EndCap::BSpline => " with B-spline end caps",
                    EndCap::Bilinear => " with bilinear end caps",
                })?;
                let options = [
                    (smoothed_creases, "useInfSharpPatch off, as is its default"),
                    (legacy_corners, "generateLegacySharpCornerPatches on, as is its default"),
                    (single_crease, "useSingleCreasePatch on"),
                ];
                for (_, option) in options.iter().filter(|(on, _)| **on) {
                    write!(f, ", {option}")?;
                }
                Ok(())
            }
            Self::Bfr { smooth, sharp } if (*smooth, *sharp) == Bfr::DEFAULT_LEVELS => {
                write!(f, "OpenSubdiv's Bfr at its default approximation levels ({smooth} smooth, {sharp} sharp)")
            }
            Self::Bfr { smooth, sharp } => {
                write!(f, "OpenSubdiv's Bfr at approximation levels {smooth} (smooth) and {sharp} (sharp)")
            }
            Self::Facets { level, at_limit: true } => {
                write!(f, "the mesh refined {level} times, with its vertices moved to the limit and flat between them")
            }
            Self::Facets { level, at_limit: false } => {
                write!(f, "the mesh refined {level} times and flat between its vertices, which are not on the limit")
            }
        }
    }
}
