//! The usual mistakes: what else failing answers could be the answers to.

use super::{Answer, Judge};
use crate::mesh::{Boundary, Creasing, SubdivMesh, TriangleRule};
use crate::patch::PatchKind;
use crate::stam::{Jet, LimitSurface};
use crate::verify::Sample;
use crate::verify::difference::{Check, Difference, Normal, angle_deg};
use crate::verify::rounding::turn_deg;
use glam::DVec3;
use serde::Serialize;
use std::fmt;

/// A mistake that explains answers which fail.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What fails: `position`, `derivative` or `normal`.
    pub quantity: &'static str,
    /// What the program seems to do, and what is asked for.
    pub mistake: String,
    /// Failing answers that this explains,
    pub fits: usize,
    /// of so many that were looked at.
    pub of: usize,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, mistake, fits, of } = self;
        write!(f, "{mistake} (explains {fits} of {of} {quantity}s that fail)")
    }
}

/// An answer, and where there is a surface the exact limit and how far off it is.
pub(super) type Judged = (Answer, Option<(Jet, Difference)>);

/// Failing answers that are looked at, spread over all.
const MOST: usize = 2000;

/// A mistake explains an answer if it leaves this part of the error or less, or an error that is allowed.
const LEFT: f64 = 0.01;

/// A mistake is named if it explains this part of what fails.
const SHARE: f64 = 0.9;

/// Finds what explains the failing positions; derivatives and normals where positions hold.
pub(super) fn find(judge: &Judge<'_>, answers: &[Judged]) -> Vec<Finding> {
    let fails = |check: Check| check.share() > 1.0;
    let pick = |wanted: &dyn Fn(&Judged) -> bool| -> Vec<&Judged> {
        let all: Vec<&Judged> = answers.iter().filter(|judged| wanted(judged)).collect();
        all.iter().step_by(all.len().div_ceil(MOST).max(1)).copied().collect()
    };
    let misplaced = |judged: &Judged| judged.1.is_none_or(|(_, d)| fails(d.position));
    let positions = pick(&misplaced);
    let derivatives = pick(&|j| !misplaced(j) && j.1.is_some_and(|(_, d)| d.derivative.is_some_and(fails)));
    let normals =
        pick(&|j| !misplaced(j) && j.1.is_some_and(|(_, d)| matches!(d.normal, Normal::Judged(check) if fails(check))));
    let search = Search { judge, faces: Faces::of(judge.subject.mesh), coarse: coarse(judge, answers) };
    let found = [
        search.positions(&positions),
        // Beside many positions that are wrong, a few derivatives are so for the same reason.
        search.derivatives(&derivatives).filter(|_| derivatives.len() >= positions.len()),
        search.normals(&normals).filter(|_| normals.len() >= positions.len()),
    ];
    found.into_iter().flatten().collect()
}

/// Whether answers everywhere are as rough as 32-bit floats: half of them off by more than 1/64 of a rounding of the largest
/// coordinate. In 64 bits they are off by 2^-29 of that.
fn coarse(judge: &Judge<'_>, answers: &[Judged]) -> bool {
    let mut errors: Vec<f64> = answers.iter().filter_map(|judged| Some(judged.1?.1.position.error)).collect();
    errors.sort_by(f64::total_cmp);
    // `Rounding` counts 64 roundings.
    let rounding = SINGLE * judge.subject.rounding.position() / 64.0;
    errors.get(errors.len() / 2).is_some_and(|&median| median > rounding / 64.0)
}

/// Roundings of 32-bit floats over those of 64 bits.
const SINGLE: f64 = (f32::EPSILON as f64) / f64::EPSILON;

/// Ptex faces of the control faces.
struct Faces {
    /// First ptex face of each control face, and their number.
    ptex: Vec<(u32, u32)>,
    /// Control face of each ptex face.
    control: Vec<u32>,
}

impl Faces {
    fn of(mesh: &SubdivMesh) -> Self {
        let (mut ptex, mut control) = (Vec::new(), Vec::new());
        for (face, &size) in mesh.face_sizes.iter().enumerate() {
            let count = if size == 4 { 1 } else { size };
            ptex.push((control.len() as u32, count));
            control.extend(std::iter::repeat_n(face as u32, count as usize));
        }
        Self { ptex, control }
    }

    /// First ptex face and number of ptex faces of the control face that has this one.
    fn siblings(&self, ptex: u32) -> (u32, u32) {
        self.ptex[self.control[ptex as usize] as usize]
    }
}

struct Search<'a> {
    judge: &'a Judge<'a>,
    faces: Faces,
    /// All answers are rough.
    coarse: bool,
}

impl Search<'_> {
    fn surface(&self) -> &LimitSurface {
        self.judge.subject.surface
    }

    /// The mistake that explains most, if it explains enough.
    fn best(&self, quantity: &'static str, failing: &[&Judged], mistakes: Vec<(String, usize)>) -> Option<Finding> {
        // The first of those that explain as much.
        let (mistake, fits) = mistakes.into_iter().rev().max_by_key(|(_, fits)| *fits)?;
        let enough = fits > 0 && fits as f64 >= SHARE * failing.len() as f64;
        let place = self.place(failing);
        enough.then(|| Finding { quantity, mistake: mistake + place, fits, of: failing.len() })
    }

    /// Where everything fails, if that says something.
    fn place(&self, failing: &[&Judged]) -> &'static str {
        let on_n_gon = |judged: &&Judged| self.faces.siblings(judged.0.at.face).1 > 1;
        let quads = self.judge.subject.mesh.face_sizes.contains(&4);
        if quads && failing.iter().all(on_n_gon) { ", on the sub-faces of n-gons" } else { "" }
    }

    fn positions(&self, failing: &[&Judged]) -> Option<Finding> {
        if failing.is_empty() {
            return None;
        }
        let mut mistakes = Vec::new();
        let mut suppose = |mistake: String, surface: &LimitSurface, place: &dyn Fn(Sample) -> Option<Sample>| {
            mistakes.push((mistake, self.count(failing, surface, place)));
        };
        let surface = self.surface();
        for (turns, mirrored) in (0..8).map(|i| (i % 4, i >= 4)).skip(1) {
            let mistake = match (turns, mirrored) {
                (0, true) => "u and v are swapped".to_owned(),
                (turns, false) => format!("(u,v) start at corner {turns} of the ptex face instead of corner 0"),
                (turns, true) => format!("u and v are swapped, and start at corner {turns} of the ptex face"),
            };
            suppose(mistake, surface, &|s| {
                let [u, v] = if mirrored { [s.v, s.u] } else { [s.u, s.v] };
                let [u, v] = turned(turns, [u, v]);
                Some(Sample { u, v, ..s })
            });
        }
        suppose("faces are counted as faces of the control mesh, not as ptex faces".to_owned(), surface, &|s| {
            let &(first, count) = self.faces.ptex.get(s.face as usize)?;
            (count == 1).then_some(Sample { face: first, ..s })
        });
        for shift in 1..self.faces.ptex.iter().map(|&(_, count)| count).max().unwrap_or(0).min(8) {
            let mistake = format!("the sub-faces of n-gons are counted from corner {shift} instead of corner 0");
            suppose(mistake, surface, &|s| {
                let (first, count) = self.faces.siblings(s.face);
                (count > 1).then(|| Sample { face: first + (s.face - first + shift) % count, ..s })
            });
        }
        for (mistake, mesh) in other_rules(self.judge.subject.mesh) {
            if let Ok(surface) = LimitSurface::new(&mesh) {
                suppose(mistake, &surface, &Some);
            }
        }
        self.best("position", failing, mistakes).or_else(|| self.inexact("position", failing))
    }

    /// Failing answers that would be right for another place, on another surface.
    fn count(&self, failing: &[&Judged], surface: &LimitSurface, place: &dyn Fn(Sample) -> Option<Sample>) -> usize {
        let unit = self.judge.subject.rounding.unit;
        let allowed = self.judge.tolerances.position;
        let fits = |(answer, judged): &&&Judged| {
            let error = judged.as_ref().map_or(f64::INFINITY, |(_, d)| d.position.error);
            let there = place(answer.at).and_then(|s| surface.evaluate_ptex(s.face, [s.u, s.v]));
            let distance = |(_, jet): (usize, Jet)| Some(jet.position.distance(answer.position?) / unit);
            // An answer in a hole has no error to leave a part of.
            let most = if error.is_finite() { allowed.max(LEFT * error) } else { allowed };
            there.and_then(distance).is_some_and(|left| left <= most)
        };
        failing.iter().filter(fits).count()
    }

    fn derivatives(&self, failing: &[&Judged]) -> Option<Finding> {
        /// Derivatives, those of the limit, and the length that a mistake may leave of their difference.
        type Pair = ([DVec3; 2], [DVec3; 2], f64);
        let unit = self.judge.subject.rounding.unit;
        let given = |j: &&Judged| -> Option<Pair> {
            let (jet, difference) = j.1?;
            let Check { error, allowed } = difference.derivative?;
            Some((j.0.derivatives?, [jet.du, jet.dv], unit * allowed.max(LEFT * error)))
        };
        let pairs: Vec<Pair> = failing.iter().filter_map(given).collect();
        if pairs.is_empty() {
            return None;
        }
        let count = |fits: &dyn Fn(&Pair) -> bool| pairs.iter().filter(|pair| fits(pair)).count();
        let both = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2], left| a.distance(c) <= left && b.distance(d) <= left;
        let mut mistakes = vec![(
            "the derivatives by u and by v are swapped".to_owned(),
            count(&|&([du, dv], exact, left)| both([dv, du], exact, left)),
        )];
        let scaled = |by: f64| move |&(given, exact, left): &Pair| both(given, exact.map(|d| by * d), left);
        for (by, name) in [(0.5, "half as long as"), (2.0, "twice as long as"), (-1.0, "opposite to")] {
            mistakes.push((
                format!("the derivatives are {name} those by the u and v of the ptex face"),
                count(&scaled(by)),
            ));
        }
        // By the parameters of patches of any size.
        let power_of_two = |pair: &Pair| {
            let by = 2f64.powf((pair.0[0].length() / pair.1[0].length()).log2().round());
            by.is_finite() && by != 1.0 && scaled(by)(pair)
        };
        mistakes.push((
            "the derivatives are by the u and v of sub-patches (powers of two), not of the ptex face".to_owned(),
            count(&power_of_two),
        ));
        self.best("derivative", failing, mistakes).or_else(|| self.inexact("derivative", failing))
    }

    fn normals(&self, failing: &[&Judged]) -> Option<Finding> {
        if failing.is_empty() {
            return None;
        }
        let opposite = |j: &&&Judged| {
            let Some((normal, (jet, difference))) = j.0.normal.zip(j.1) else { return false };
            let Normal::Judged(check) = difference.normal else { return false };
            angle_deg(-normal, jet.normal) <= check.allowed.max(LEFT * check.error)
        };
        let flipped = (
            "the normals point the other way: they are to be du x dv".to_owned(),
            failing.iter().filter(opposite).count(),
        );
        self.best("normal", failing, vec![flipped]).or_else(|| self.inexact("normal", failing))
    }

    /// No mistake about what is asked for: a lack of digits, or patches that are approximated.
    fn inexact(&self, quantity: &'static str, failing: &[&Judged]) -> Option<Finding> {
        self.single_precision(quantity, failing).or_else(|| {
            let irregular = |j: &&&Judged| {
                let place = self.surface().locate(j.0.at.face, [j.0.at.u, j.0.at.v]);
                place.is_some_and(|(patch, _)| self.surface().kind(patch) != PatchKind::Regular)
            };
            let fits = failing.iter().filter(irregular).count();
            // On a mesh without regular patches it says nothing.
            let told = fits == failing.len() && self.surface().patches().iter().any(|p| p.kind == PatchKind::Regular);
            let mistake =
                "all are on patches with an extraordinary vertex, which seem to be approximated (as by end caps)";
            told.then(|| Finding { quantity, mistake: mistake.to_owned(), fits, of: failing.len() })
        })
    }

    /// Whether 32-bit floats in world coordinates explain what fails: their roundings, as [`Rounding`](crate::verify::rounding::Rounding)
    /// counts those of 64 bits.
    fn single_precision(&self, quantity: &'static str, failing: &[&Judged]) -> Option<Finding> {
        if !self.coarse {
            return None;
        }
        let rounding = &self.judge.subject.rounding;
        let fits = |j: &&&Judged| {
            let Some((jet, difference)) = j.1 else { return false };
            let cell = self.surface().locate(j.0.at.face, [j.0.at.u, j.0.at.v]).map_or(1.0, |(patch, _)| {
                let [u, v] = self.surface().patches()[patch].scale();
                1.0 / u.max(v)
            });
            let derivative = SINGLE * rounding.derivative(cell);
            match quantity {
                "position" => difference.position.error <= SINGLE * rounding.position(),
                "derivative" => difference.derivative.is_some_and(|check| check.error <= derivative / rounding.unit),
                _ => {
                    matches!(difference.normal, Normal::Judged(check) if check.error <= turn_deg(jet.du, jet.dv, derivative))
                }
            }
        };
        let mistake = "the errors are as large as the rounding of 32-bit floats in world coordinates: evaluate relative to a point near \
                       by, or in 64 bits, or allow for it (--tolerance)";
        self.best(quantity, failing, vec![(mistake.to_owned(), failing.iter().filter(fits).count())])
    }
}

/// Parameters of the same point in a frame that starts at corner `turns`, back in the face's own.
fn turned(turns: usize, [u, v]: [f64; 2]) -> [f64; 2] {
    match turns {
        0 => [u, v],
        1 => [1.0 - v, u],
        2 => [1.0 - u, 1.0 - v],
        _ => [v, 1.0 - u],
    }
}

/// The mesh by rules that it does not ask for.
fn other_rules(mesh: &SubdivMesh) -> Vec<(String, SubdivMesh)> {
    let name = |boundary| match boundary {
        Boundary::None => "none",
        Boundary::EdgeOnly => "edge only",
        Boundary::EdgeAndCorner => "edge and corner",
    };
    let mut others = Vec::new();
    for boundary in [Boundary::EdgeOnly, Boundary::EdgeAndCorner].into_iter().filter(|b| *b != mesh.boundary) {
        let mistake = format!("the boundary rule is {}, the mesh asks for {}", name(boundary), name(mesh.boundary));
        others.push((mistake, SubdivMesh { boundary, ..mesh.clone() }));
    }
    if !mesh.creases.is_empty() || !mesh.corners.is_empty() {
        let smooth = SubdivMesh { creases: Vec::new(), corners: Vec::new(), ..mesh.clone() };
        others.push(("creases and corners are ignored".to_owned(), smooth));
        let (creasing, mistake) = match mesh.creasing {
            Creasing::Uniform => {
                (Creasing::Chaikin, "sharpness decays by Chaikin's rule, the mesh asks for the uniform one")
            }
            Creasing::Chaikin => {
                (Creasing::Uniform, "sharpness decays by the uniform rule, the mesh asks for Chaikin's")
            }
        };
        others.push((mistake.to_owned(), SubdivMesh { creasing, ..mesh.clone() }));
    }
    if mesh.triangles == TriangleRule::Smooth {
        let mistake = "triangles are refined as other faces, the mesh asks for the smooth rule".to_owned();
        others.push((mistake, SubdivMesh { triangles: TriangleRule::CatmullClark, ..mesh.clone() }));
    }
    if !mesh.holes.is_empty() {
        others.push(("holes are filled".to_owned(), SubdivMesh { holes: Vec::new(), ..mesh.clone() }));
    }
    others
}
