//! Which program failing answers could come from: every one is asked, about a few faces first, and then about all.

use super::Judge;
use super::diagnosis::{Finding, Judged, Nearest};
use super::excerpt::{Excerpt, Neighbours};
use super::likeness::{Habit, Likeness, Precision, Witness};
use super::program::{Ground, Program, Reply};
use crate::mesh::SubdivMesh;
use crate::osd::Location;
use crate::stam::LimitSurface;
use crate::verify::Sample;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What else is supposed about answers while programs are tried.
pub(super) struct Supposed<'a> {
    /// A mistake, if one is supposed.
    pub mistake: Option<String>,
    /// The mesh by the rules that are supposed, and its limit.
    pub mesh: &'a SubdivMesh,
    pub surface: &'a LimitSurface,
    /// Where a sample lies in truth.
    pub place: &'a (dyn Fn(Sample) -> Option<Sample> + Sync),
    /// Derivatives and normals may be anything.
    pub positions_alone: bool,
}

/// Control faces that every program is asked about first.
const FEW: usize = 12;

/// Those of them that are asked about before the others, and the part of their failing answers that a program has to explain.
const FIRST: usize = 2;
const FIRST_PART: f64 = 0.3;

/// Most control faces that a program is asked about in the end, and how many at a time.
const MOST: usize = 2048;
const AT_A_TIME: usize = 128;

/// A program with its habits that explains the answers about a few faces.
#[derive(Clone)]
struct Candidate {
    program: Program,
    habit: Habit,
    precision: Precision,
    likeness: Likeness,
}

/// Answers about some faces, and where they lie.
struct Asked<'a> {
    witnesses: Vec<Witness<'a>>,
    places: Vec<Option<Location>>,
    excerpt: Excerpt,
}

/// Looks for the program among all. The second is the one that came nearest, where none is it.
pub(super) fn search(
    judge: &Judge<'_>,
    answers: &[Judged],
    supposed: &Supposed<'_>,
) -> (Option<Finding>, Option<Nearest>) {
    let neighbours = Neighbours::of(supposed.mesh);
    let by_face = by_face(answers, supposed, &neighbours);
    let fails = |judged: &&Judged| failing(judged, supposed.positions_alone);
    let (few, worst) = few(&by_face, &fails);
    let asked = ask(&neighbours, &by_face, &few, supposed);
    let first = ask(&neighbours, &by_face, &worst, supposed);
    let has_features = supposed.mesh.creases.len() + supposed.mesh.corners.len() > 0 || has_boundary(supposed.mesh);
    let mut stages = Program::of_opensubdiv(has_features);
    stages.push(Program::facets());
    let mut nearest: Option<Nearest> = None;
    let mut found: Option<Finding> = None;
    for programs in stages {
        let ask = |asked: &Asked<'_>, programs: &[Program]| -> Vec<(Vec<Candidate>, Option<Nearest>)> {
            programs.par_iter().map(|&program| candidates(judge, asked, program, supposed)).collect()
        };
        let promising = |(found, near): &(Vec<Candidate>, Option<Nearest>)| {
            !found.is_empty() || near.as_ref().is_none_or(|near| near.part >= FIRST_PART)
        };
        let screened = ask(&first, &programs);
        let programs: Vec<Program> = programs
            .iter()
            .zip(&screened)
            .filter(|&(_, found)| promising(found))
            .map(|(program, _)| *program)
            .collect();
        let asked = ask(&asked, &programs);
        for near in asked.iter().filter_map(|(_, near)| near.as_ref()) {
            if nearest.as_ref().is_none_or(|n| near.part > n.part) {
                nearest = Some(near.clone());
            }
        }
        let accepted = asked.into_iter().flat_map(|(candidates, _)| candidates);
        let (alone, full): (Vec<_>, Vec<_>) = accepted.partition(|c| c.habit.positions_alone);
        for mut accepted in [full, alone] {
            for _attempt in 0..ATTEMPTS {
                let Some(best) = best(&accepted).cloned() else { break };
                let same = |c: &&Candidate| c.precision == best.precision && !best.likeness.beats(&c.likeness);
                let ties: Vec<&Candidate> = accepted.iter().filter(same).collect();
                match confirm(judge, &neighbours, &by_face, &best, &ties, supposed) {
                    Ok(finding) => {
                        // Positions alone may be those of two programs to within a few; whoever gives the rest too may come later.
                        let least = if best.habit.positions_alone { 1.0 } else { WHOLE };
                        let is_whole = |[fits, all]: [usize; 2]| fits as f64 >= least * all as f64;
                        if is_whole([finding.fits, finding.of]) && finding.all.is_none_or(is_whole) {
                            return (Some(finding), None);
                        }
                        if found.as_ref().is_none_or(|f| finding.fits > f.fits) {
                            found = Some(finding);
                        }
                        break;
                    }
                    Err(near) => {
                        nearest = nearest.into_iter().chain(near).reduce(|a, b| if b.part > a.part { b } else { a });
                        accepted.retain(|c| (c.program, c.habit) != (best.program, best.habit));
                    }
                }
            }
        }
    }
    (found, nearest.filter(|nearest| nearest.part > 0.0))
}

/// Programs of a stage that explain a few faces and are tried on all.
const ATTEMPTS: usize = 3;

/// Part of the failing answers, and of all, that must be explained for no other program to be asked.
const WHOLE: f64 = 0.999;

/// Whether an answer fails in what is compared.
fn failing(judged: &Judged, positions_alone: bool) -> bool {
    let Some((_, difference)) = judged.1 else { return true };
    let normal = match difference.normal {
        super::Normal::Judged(check) => check.share() > 1.0,
        _ => false,
    };
    difference.position.share() > 1.0
        || !positions_alone && (normal || difference.derivative.is_some_and(|check| check.share() > 1.0))
}

fn has_boundary(mesh: &SubdivMesh) -> bool {
    let mut edges: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (_, vertices) in mesh.faces() {
        for (&a, &b) in vertices.iter().zip(vertices.iter().cycle().skip(1)) {
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    edges.values().any(|&faces| faces != 2)
}

/// Answers by the control face on which they are supposed to lie, with the place; those that lie nowhere are left out.
type ByFace<'a> = BTreeMap<u32, Vec<(&'a Judged, Location)>>;

fn by_face<'a>(answers: &'a [Judged], supposed: &Supposed<'_>, neighbours: &Neighbours<'_>) -> ByFace<'a> {
    let mut by_face = ByFace::new();
    for judged in answers {
        if let Some(Sample { face, u, v }) = (supposed.place)(judged.0.at) {
            by_face.entry(neighbours.control_face(face)).or_default().push((judged, (face, u, v)));
        }
    }
    by_face
}

/// A few faces with answers that fail, spread over all of them: half of them those on which most fail. The second are the first of these.
fn few(by_face: &ByFace<'_>, fails: &dyn Fn(&&Judged) -> bool) -> (BTreeSet<u32>, BTreeSet<u32>) {
    let count = |answers: &Vec<(&Judged, Location)>| answers.iter().filter(|(judged, _)| fails(judged)).count();
    let mut failing: Vec<(usize, u32)> =
        by_face.iter().map(|(&face, answers)| (count(answers), face)).filter(|&(count, _)| count > 0).collect();
    let step = failing.len().div_ceil(FEW / 2).max(1);
    let mut few: BTreeSet<u32> = failing.iter().step_by(step).map(|&(_, face)| face).collect();
    failing.sort_by_key(|&(count, face)| (std::cmp::Reverse(count), face));
    let worst = failing.iter().take(FIRST).map(|&(_, face)| face).collect();
    for (_, face) in failing {
        if few.len() >= FEW {
            break;
        }
        few.insert(face);
    }
    (few, worst)
}

fn ask<'a>(
    neighbours: &Neighbours<'_>,
    by_face: &ByFace<'a>,
    faces: &BTreeSet<u32>,
    supposed: &Supposed<'_>,
) -> Asked<'a> {
    let faces: Vec<u32> = faces.iter().copied().collect();
    let excerpt = Excerpt::new(neighbours, &faces);
    let answers = || faces.iter().filter_map(|face| by_face.get(face)).flatten();
    let on_part = |place: &Location| !supposed.positions_alone && excerpt.is_part(place.0) == Some(true);
    Asked {
        witnesses: answers().map(|(judged, place)| Witness { judged, on_part: on_part(place) }).collect(),
        places: answers().map(|(_, place)| Some(*place)).collect(),
        excerpt,
    }
}

/// Parameters as 32-bit floats.
fn rounded(places: &[Option<Location>]) -> Vec<Option<Location>> {
    let round = |x: f64| f64::from(x as f32);
    places.iter().map(|place| place.map(|(face, u, v)| (face, round(u), round(v)))).collect()
}

fn replies(program: Program, asked: &Asked<'_>, single: bool, surface: &LimitSurface) -> Option<Vec<Reply>> {
    let ground = Ground { excerpt: &asked.excerpt, surface };
    let places = if single { &rounded(&asked.places) } else { &asked.places };
    // What OpenSubdiv refuses is no explanation.
    program.replies(ground, places).ok()
}

/// The habits with which a program explains the answers, and how near it comes.
fn candidates(
    judge: &Judge<'_>,
    asked: &Asked<'_>,
    program: Program,
    supposed: &Supposed<'_>,
) -> (Vec<Candidate>, Option<Nearest>) {
    let (mut found, mut nearest) = (Vec::new(), None::<Nearest>);
    let parts = asked.witnesses.iter().any(|witness| witness.on_part);
    for single_parameters in [false, true] {
        let Some(replies) = replies(program, asked, single_parameters, supposed.surface) else { continue };
        for [doubled, positions_alone] in [[false, false], [true, false], [false, true]] {
            if doubled && !parts || supposed.positions_alone && !positions_alone {
                continue;
            }
            let habit = Habit { single_parameters, doubled, positions_alone };
            for precision in [Precision::Double, Precision::Single] {
                let likeness = Likeness::of(judge, &asked.witnesses, &replies, habit, precision);
                if likeness.explains() {
                    found.push(Candidate { program, habit, precision, likeness });
                    break;
                }
                let is_nearer = nearest.as_ref().is_none_or(|n| likeness.part() > n.part);
                if precision == Precision::Single && likeness.tells() && is_nearer {
                    let program = name(program, habit);
                    nearest = Some(Nearest { program, part: likeness.part(), missed: likeness.missed });
                }
            }
        }
    }
    (found, nearest)
}

/// What the answers are most like; the first of those that are equally so.
fn best(accepted: &[Candidate]) -> Option<&Candidate> {
    let double = accepted.iter().filter(|c| c.precision == Precision::Double);
    let single = accepted.iter().filter(|c| c.precision == Precision::Single);
    let champion = |best: &'_ Candidate, next: &'_ Candidate| next.likeness.beats(&best.likeness);
    let pick = |a, b| if champion(a, b) { b } else { a };
    double.reduce(pick).or_else(|| single.reduce(pick))
}

fn name(program: Program, habit: Habit) -> String {
    let mut name = program.to_string();
    if habit.single_parameters {
        name += ", at parameters rounded to 32 bits";
    }
    if habit.doubled {
        name += ", with its derivatives on the parts of n-gons, which are twice as long";
    }
    name
}

/// Asks the program about all faces, or as many as are looked at, and says what it explains, or how near it comes.
fn confirm(
    judge: &Judge<'_>,
    neighbours: &Neighbours<'_>,
    by_face: &ByFace<'_>,
    best: &Candidate,
    ties: &[&Candidate],
    supposed: &Supposed<'_>,
) -> Result<Finding, Option<Nearest>> {
    let step = by_face.len().div_ceil(MOST).max(1);
    let faces: Vec<u32> = by_face.keys().step_by(step).copied().collect();
    let chunk = |faces: &[u32]| {
        let asked = ask(neighbours, by_face, &faces.iter().copied().collect(), supposed);
        let replies = replies(best.program, &asked, best.habit.single_parameters, supposed.surface)?;
        Some(Likeness::of(judge, &asked.witnesses, &replies, best.habit, best.precision))
    };
    let chunks: Option<Vec<Likeness>> = faces.par_chunks(AT_A_TIME).map(chunk).collect();
    let all = chunks.and_then(|chunks| chunks.into_iter().reduce(Likeness::and)).ok_or(None::<Nearest>)?;
    if !all.explains() {
        let program = name(best.program, best.habit);
        return Err(Some(Nearest { program, part: all.part(), missed: all.missed }));
    }
    let mut mistake = String::new();
    if let Some(supposed) = &supposed.mistake {
        mistake = format!("{supposed}; but for that, ");
    }
    mistake = mistake + "the answers are those of " + &name(best.program, best.habit);
    mistake += &also(best, ties);
    let positions_alone = best.habit.positions_alone;
    if positions_alone && !supposed.positions_alone {
        mistake += ", but for derivatives and normals, which are not";
    }
    if best.precision == Precision::Single {
        mistake += ", to the rounding of 32-bit floats";
    }
    Ok(Finding {
        quantity: if positions_alone { "position" } else { "answer" },
        mistake,
        fits: all.failing_fits,
        of: all.failing,
        residual: Some(all.residual),
        all: Some([all.fits, all.all]),
    })
}

/// Which other programs the answers could come from as well.
fn also(best: &Candidate, ties: &[&Candidate]) -> String {
    let mut levels: Vec<u32> = Vec::new();
    if let Some((family, own)) = best.program.family() {
        let same = ties.iter().filter(|c| c.habit == best.habit).filter_map(|c| c.program.family());
        levels = same.filter(|(other, level)| *other == family && *level != own).map(|(_, level)| level).collect();
    }
    levels.sort_unstable();
    levels.dedup();
    let mut also = match levels.as_slice() {
        [] => String::new(),
        [level] => format!(" (level {level} gives the same here)"),
        [first, .., last] => format!(" (levels {first} to {last} give the same here)"),
    };
    let is_bfr = |program: Program| matches!(program, Program::Bfr { .. });
    if let Some(other) = ties.iter().find(|c| c.habit == best.habit && is_bfr(c.program) != is_bfr(best.program)) {
        also += &format!(" ({} gives the same here)", other.program);
    }
    also
}
