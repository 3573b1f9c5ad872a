//! The usual mistakes: what else failing answers could be the answers to.

use super::likeness::TYPICAL;
use super::search::{Supposed, search};
use super::{Answer, Judge, sample_set};
use crate::mesh::{Boundary, Creasing, Scheme, SubdivMesh, TriangleRule};
use crate::patch::PatchKind;
use crate::stam::{Jet, LimitSurface};
use crate::verify::Sample;
use crate::verify::difference::{Check, Difference, Normal, angle_deg};
use crate::verify::rounding::turn_deg;
use glam::DVec3;
use serde::Serialize;
use std::collections::HashMap;
use std::fmt;

/// A mistake that explains answers which fail.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What fails: `position`, `derivative` or `normal`, or `answer`, where it explains all three.
    pub quantity: &'static str,
    /// What the program seems to do, and what is asked for.
    pub mistake: String,
    /// Failing answers that this explains,
    pub fits: usize,
    /// of so many that were looked at.
    pub of: usize,
    /// Largest distance between the answers that it explains and what it predicts, in parts of the diagonal; `None` where it predicts no
    /// positions.
    pub residual: Option<f64>,
    /// Of another program: its answers, those that pass included, and how many were looked at.
    pub all: Option<[usize; 2]>,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, mistake, fits, of, residual, all } = self;
        write!(f, "{mistake} (explains {fits} of {of} {quantity}s that fail")?;
        if let Some([fits, all]) = all {
            write!(f, " and {fits} of {all} in all")?;
        }
        if let Some(residual) = residual {
            write!(f, ", to {residual:.1e} of the diagonal")?;
        }
        f.write_str(")")
    }
}

/// The program that comes nearest to answers that none explains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nearest {
    /// What it does.
    pub program: String,
    /// Part of the failing answers that are its answers, of those on the faces that were looked at.
    pub part: f64,
    /// Median distance of the others from its answers, in parts of the diagonal.
    pub missed: f64,
}

impl fmt::Display for Nearest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { program, part, missed } = self;
        let per_cent = (100.0 * part).floor();
        write!(
            f,
            "{program} explains {per_cent} % of what fails; the rest is {missed:.1e} of the diagonal off (median)"
        )
    }
}

/// What was found out about answers that fail.
#[derive(Debug, Default)]
pub(super) struct Diagnosis {
    pub findings: Vec<Finding>,
    /// Where no program explains them and no mistake does.
    pub nearest: Option<Nearest>,
}

/// An answer, and where there is a surface the exact limit and how far off it is.
pub(super) type Judged = (Answer, Option<(Jet, Difference)>);

/// Failing answers that are looked at, spread over all.
const MOST: usize = 2000;

/// A mistake explains an answer if it leaves this part of the error or less, or an error that is allowed.
const LEFT: f64 = 0.01;

/// A mistake may be made beside others if it explains this part of what fails.
const LIKELY: f64 = 0.1;

/// A mistake is named if it explains this part of what fails.
const SHARE: f64 = 0.9;

/// Finds what explains the failing positions; derivatives and normals where positions hold. `per_face` are the
/// samples of each face that were asked.
pub(super) fn find(judge: &Judge<'_>, per_face: usize, answers: &[Judged]) -> Diagnosis {
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
    if positions.is_empty() && derivatives.is_empty() && normals.is_empty() {
        return Diagnosis::default();
    }
    let others = other_rules(judge.subject.mesh);
    let others = others.into_iter().filter_map(|(mistake, mesh)| {
        let surface = LimitSurface::new(&mesh).ok()?;
        Some((mistake, mesh, surface))
    });
    let others: Vec<Rules> = others.collect();
    let examined = Search {
        judge,
        faces: Faces::of(judge.subject.mesh),
        coarse: coarse(judge, answers),
        rows: rows(judge, per_face),
    };
    let mistakes = examined.mistakes(&others);
    let counts: Vec<Count> = mistakes.iter().map(|mistake| examined.count(&positions, mistake)).collect();

    // Beside many positions that are wrong, a few derivatives are so for the same reason.
    let by_derivative = derivatives.len() >= positions.len() && !derivatives.is_empty();
    let by_normal = normals.len() >= positions.len() && !normals.is_empty();
    let usual = [
        examined.positions(&positions, &mistakes, &counts),
        examined.derivatives(&derivatives).filter(|_| by_derivative),
        examined.normals(&normals).filter(|_| by_normal),
    ];
    let to_rounding = counts.iter().map(|count| count.to_rounding).max().unwrap_or(0);
    let all_said = (positions.is_empty() || to_rounding as f64 >= TO_ROUNDING * positions.len() as f64)
        && (!by_derivative || usual[1].is_some())
        && (!by_normal || usual[2].is_some());
    if all_said {
        return Diagnosis { findings: usual.into_iter().flatten().collect(), nearest: None };
    }
    let (program, near) = examined.program(answers, &positions, &mistakes, &counts);
    if let Some(program) = program {
        return Diagnosis { findings: vec![program], nearest: None };
    }
    let [position, derivative, normal] = usual;
    let found = [
        position.or_else(|| examined.inexact("position", &positions)),
        derivative.or_else(|| examined.inexact("derivative", &derivatives).filter(|_| by_derivative)),
        normal.or_else(|| examined.inexact("normal", &normals).filter(|_| by_normal)),
    ];
    let findings: Vec<Finding> = found.into_iter().flatten().collect();
    let nearest = near.filter(|_| findings.is_empty());
    Diagnosis { findings, nearest }
}

/// A mistake, the mesh by its rules and its limit.
type Rules = (String, SubdivMesh, LimitSurface);

/// Part of the failing positions that a mistake about places or rules leaves no more than rounding of, if nothing else is wrong.
const TO_ROUNDING: f64 = 0.999;

/// A program for which the samples in holes do not count answers the next sample instead: by the sample that was asked, the one that it
/// answers. None where there are no such samples.
fn rows(judge: &Judge<'_>, per_face: usize) -> HashMap<Row, Sample> {
    let surface = judge.subject.surface;
    let asked: Vec<Sample> = sample_set(surface, per_face).collect();
    let has_surface = |at: &Sample| surface.locate(at.face, [at.u, at.v]).is_some();
    let kept: Vec<Sample> = asked.iter().copied().filter(has_surface).collect();
    if kept.len() == asked.len() {
        return HashMap::new();
    }
    asked.into_iter().map(row).zip(kept).collect()
}

/// A sample as 32-bit floats, as programs may write it.
type Row = (u32, [u32; 2]);

fn row(at: Sample) -> Row {
    (at.face, [at.u, at.v].map(|x| (x as f32).to_bits()))
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
pub(super) const SINGLE: f64 = (f32::EPSILON as f64) / f64::EPSILON;

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
    rows: HashMap<Row, Sample>,
}

/// A mistake about places or rules.
struct Mistake<'a> {
    what: String,
    mesh: &'a SubdivMesh,
    surface: &'a LimitSurface,
    place: Box<dyn Fn(Sample) -> Option<Sample> + Sync + 'a>,
    /// It is about rules: derivatives are those of the other surface.
    about_rules: bool,
}

/// Failing positions that a mistake explains.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    fits: usize,
    /// Those of which it leaves no more than rounding.
    to_rounding: usize,
    /// The most that it leaves of one, in diagonals; `None` if it says nothing about positions.
    residual: Option<f64>,
}

impl Search<'_> {
    fn surface(&self) -> &LimitSurface {
        self.judge.subject.surface
    }

    /// The mistake that explains most, if it explains enough.
    fn best(&self, quantity: &'static str, failing: &[&Judged], mistakes: Vec<(String, Count)>) -> Option<Finding> {
        // The first of those that explain as much.
        let (mistake, Count { fits, residual, .. }) = mistakes.into_iter().rev().max_by_key(|(_, count)| count.fits)?;
        let enough = fits > 0 && fits as f64 >= SHARE * failing.len() as f64;
        let place = self.place(failing);
        enough.then(|| Finding { quantity, mistake: mistake + place, fits, of: failing.len(), residual, all: None })
    }

    /// Where everything fails, if that says something.
    fn place(&self, failing: &[&Judged]) -> &'static str {
        let on_n_gon = |judged: &&Judged| self.faces.siblings(judged.0.at.face).1 > 1;
        let quads = self.judge.subject.mesh.face_sizes.contains(&4);
        if quads && failing.iter().all(on_n_gon) { ", on the sub-faces of n-gons" } else { "" }
    }

    /// All mistakes about places and rules, one of which may be made.
    fn mistakes<'a>(&'a self, others: &'a [Rules]) -> Vec<Mistake<'a>> {
        let (mesh, surface) = (self.judge.subject.mesh, self.surface());
        let mut mistakes = Vec::new();
        let mut suppose = |what: String, place: Box<dyn Fn(Sample) -> Option<Sample> + Sync + 'a>| {
            mistakes.push(Mistake { what, mesh, surface, place, about_rules: false });
        };
        for (turns, mirrored) in (0..8).map(|i| (i % 4, i >= 4)).skip(1) {
            let mistake = match (turns, mirrored) {
                (0, true) => "u and v are swapped".to_owned(),
                (turns, false) => format!("(u,v) start at corner {turns} of the ptex face instead of corner 0"),
                (turns, true) => format!("u and v are swapped, and start at corner {turns} of the ptex face"),
            };
            let place = move |s: Sample| {
                let [u, v] = if mirrored { [s.v, s.u] } else { [s.u, s.v] };
                let [u, v] = turned(turns, [u, v]);
                Some(Sample { u, v, ..s })
            };
            suppose(mistake, Box::new(place));
        }
        let control_face = |s: Sample| {
            let &(first, count) = self.faces.ptex.get(s.face as usize)?;
            (count == 1).then_some(Sample { face: first, ..s })
        };
        suppose("faces are counted as faces of the control mesh, not as ptex faces".to_owned(), Box::new(control_face));
        for shift in 1..self.faces.ptex.iter().map(|&(_, count)| count).max().unwrap_or(0).min(8) {
            let mistake = format!("the sub-faces of n-gons are counted from corner {shift} instead of corner 0");
            let place = move |s: Sample| {
                let (first, count) = self.faces.siblings(s.face);
                (count > 1).then(|| Sample { face: first + (s.face - first + shift) % count, ..s })
            };
            suppose(mistake, Box::new(place));
        }
        if !self.rows.is_empty() {
            let mistake =
                "samples in holes were left out, but not their rows: each row has the answer to a later sample";
            suppose(mistake.to_owned(), Box::new(|s| self.rows.get(&row(s)).copied()));
        }
        for (what, mesh, surface) in others {
            mistakes.push(Mistake { what: what.clone(), mesh, surface, place: Box::new(Some), about_rules: true });
        }
        mistakes
    }

    fn positions(&self, failing: &[&Judged], mistakes: &[Mistake<'_>], counts: &[Count]) -> Option<Finding> {
        if failing.is_empty() {
            return None;
        }
        let counted = mistakes.iter().zip(counts).map(|(mistake, count)| (mistake.what.clone(), *count));
        self.best("position", failing, counted.collect())
    }

    /// Failing answers that would be right for another place, on another surface.
    fn count(&self, failing: &[&Judged], mistake: &Mistake<'_>) -> Count {
        let rounding = &self.judge.subject.rounding;
        let allowed = self.judge.tolerances.position;
        let rounded = SINGLE * rounding.position() / TYPICAL;
        let mut out = Count::default();
        for (answer, judged) in failing {
            let error = judged.as_ref().map_or(f64::INFINITY, |(_, d)| d.position.error);
            let there = (mistake.place)(answer.at).and_then(|s| mistake.surface.evaluate_ptex(s.face, [s.u, s.v]));
            let distance = |(_, jet): (usize, Jet)| Some(jet.position.distance(answer.position?) / rounding.unit);
            let Some(left) = there.and_then(distance) else { continue };
            // An answer in a hole has no error to leave a part of.
            let most = if error.is_finite() { allowed.max(LEFT * error) } else { allowed };
            if left <= most {
                out.fits += 1;
                out.to_rounding += usize::from(left <= rounded);
                out.residual = Some(left.max(out.residual.unwrap_or(0.0)));
            }
        }
        out
    }

    /// Another program that answers so, alone or beside one of the mistakes; else the one that comes nearest without a mistake.
    fn program(
        &self,
        answers: &[Judged],
        positions: &[&Judged],
        mistakes: &[Mistake<'_>],
        counts: &[Count],
    ) -> (Option<Finding>, Option<Nearest>) {
        let subject = self.judge.subject;
        if !matches!(subject.mesh.scheme, Scheme::CatmullClark) {
            return (None, None);
        }
        let alone = Supposed {
            mistake: None,
            mesh: subject.mesh,
            surface: self.surface(),
            place: &Some,
            positions_alone: false,
        };
        let (found, nearest) = search(self.judge, answers, &alone);
        if found.is_some() {
            return (found, None);
        }
        // The likeliest mistakes: at least a part of what fails is as each says.
        let mut likely: Vec<(usize, &Mistake<'_>)> = counts.iter().map(|count| count.fits).zip(mistakes).collect();
        likely.retain(|&(fits, _)| fits as f64 >= LIKELY * positions.len() as f64 && fits > 0);
        likely.sort_by_key(|&(fits, _)| std::cmp::Reverse(fits));
        for (_, Mistake { what, mesh, surface, place, about_rules }) in likely.into_iter().take(1) {
            let mistake = Some(what.clone());
            let supposed = Supposed { mistake, mesh, surface, place, positions_alone: !about_rules };
            if let (Some(found), _) = search(self.judge, answers, &supposed) {
                return (Some(found), None);
            }
        }
        (None, nearest)
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
        let count = |fits: &dyn Fn(&Pair) -> bool| counted(pairs.iter().filter(|pair| fits(pair)).count());
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
        self.best("derivative", failing, mistakes)
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
            counted(failing.iter().filter(opposite).count()),
        );
        self.best("normal", failing, vec![flipped])
    }

    /// No mistake about what is asked for: a lack of digits, or patches that are approximated.
    fn inexact(&self, quantity: &'static str, failing: &[&Judged]) -> Option<Finding> {
        if failing.is_empty() {
            return None;
        }
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
            told.then(|| Finding {
                quantity,
                mistake: mistake.to_owned(),
                fits,
                of: failing.len(),
                residual: None,
                all: None,
            })
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
        self.best(quantity, failing, vec![(mistake.to_owned(), counted(failing.iter().filter(fits).count()))])
    }
}

/// So many failing answers, of which no distances are known.
fn counted(fits: usize) -> Count {
    Count { fits, ..Count::default() }
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
